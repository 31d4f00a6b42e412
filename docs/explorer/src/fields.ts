/* Fields to begin with, made from a seed, the same on every machine. */

/** Random numbers in [0, 1) from a seed: Mulberry32. */
export function random(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = state;
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

export const KINDS: [string, string][] = [
  ["noise", "noise"],
  ["smooth", "smoothed noise"],
  ["gyroid", "gyroid, coarsely sampled"],
  ["balls", "two balls that touch"],
];

/** A field of this kind, in C order, to four decimals; null for an unknown kind. */
export function made(kind: string, seed: number, shape: readonly number[]): number[] | null {
  const size = shape.reduce((product, n) => product * n, 1);
  const next = random(seed * 7919 + 17);
  const noise = Array.from({ length: size }, () => 2 * next() - 1);
  const places = noise.map((_, number) => {
    const index: number[] = [];
    for (let axis = shape.length - 1; axis >= 0; axis--) {
      index[axis] = number % shape[axis];
      number = Math.floor(number / shape[axis]);
    }
    return index;
  });
  const round = (values: number[]) => values.map((x) => Number(x.toFixed(4)));
  if (kind === "noise") return round(noise);
  if (kind === "smooth") {
    // The mean over the neighbours, weighted by 1 and 1/2 along each axis.
    const smooth = places.map((place) => {
      let [sum, weights] = [0, 0];
      places.forEach((other, n) => {
        const steps = other.map((x, axis) => Math.abs(x - place[axis]));
        if (Math.max(...steps) > 1) return;
        const weight = 0.5 ** steps.reduce((a, b) => a + b, 0);
        sum += weight * noise[n];
        weights += weight;
      });
      return sum / weights;
    });
    const most = Math.max(...smooth.map(Math.abs));
    return round(smooth.map((x) => x / most));
  }
  const shift = seed * 0.37;
  if (kind === "gyroid")
    return round(
      places.map(([x, y, z = 0]) => {
        const [a, b, c] = [x, y, z].map((t) => 1.9 * t + shift);
        return (Math.sin(a) * Math.cos(b) + Math.sin(b) * Math.cos(c) + Math.sin(c) * Math.cos(a)) / 1.5;
      }),
    );
  if (kind === "balls")
    return round(
      places.map((place) => {
        const far = [0.3, 0.7].map((share) =>
          Math.hypot(...place.map((x, axis) => x - share * (shape[axis] - 1) + 0.13 * Math.sin(shift + axis))),
        );
        return (0.3 * Math.hypot(...shape)) / 2 - Math.min(...far);
      }),
    );
  return null;
}
