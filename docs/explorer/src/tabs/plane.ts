/* Contours: a square of four samples, or a small image, and the ways to join the points. */

import { type App, type Tab } from "../app.ts";
import { parameter } from "../cell.ts";
import { Isovalue, paste, rangeOf, Typed } from "../controls.ts";
import { integers } from "../decisions.ts";
import { button, choice, element, svg, written } from "../dom.ts";
import { KINDS, made, random } from "../fields.ts";
import { rounded, stepFor } from "../handles.ts";
import { type Lattice } from "../state.ts";
import { type Tables } from "../tables.ts";

type Spot = [number, number];

/** The ways to decide an ambiguous square: whether its inside corners are joined. */
const WAYS: [string, string, (g: number[]) => boolean][] = [
  ["separated", "DICONEX, disconnect: always apart", () => false],
  ["joined", "DICONEX, connect: always together", () => true],
  ["mean", "DICONEX, mixed: the mean of the four decides", ([a, b, c, d]) => a + d + (b + c) >= 0],
  ["saddle", "The asymptotic decider: the saddle decides", (g) => saddleJoins(g)],
];

/** Whether the saddle of an ambiguous square is inside, exactly; corners 0 1 / 2 3, 0 and 3 diagonal. */
export function saddleJoins(g: readonly number[]): boolean {
  const [a, b, c, d] = integers(g);
  return g[0] >= 0 ? a * d >= b * c : b * c >= a * d;
}

/** The four values of a square, corner c at (c & 1, c >> 1). */
function squareOf(lattice: Lattice, i: number, j: number): number[] {
  return [0, 1, 2, 3].map((c) => lattice.values[(i + (c & 1)) * lattice.shape[1] + j + (c >> 1)] - lattice.isovalue);
}

/** The segments of a square under a decision, in its own coordinates. */
export function segments(tables: Tables, g: readonly number[], joined: boolean): [Spot, Spot][] {
  const signs = g.reduce((bits, value, c) => bits | (value >= 0 ? 1 << c : 0), 0);
  const at = (edge: number): Spot => {
    const [axis, side] = [edge >> 1, edge & 1];
    const low = axis === 0 ? side << 1 : side;
    const t = parameter(g[low], g[low | (axis === 0 ? 1 : 2)]);
    return axis === 0 ? [t, side] : [side, t];
  };
  return tables.squares[2 * signs + Number(joined)].map(([a, b]) => [at(a), at(b)]);
}

/** The bilinear contour in a square, as rows of points. */
export function hyperbola(g: readonly number[], steps = 60): Spot[][] {
  const low = (s: number) => g[0] + s * (g[1] - g[0]);
  const high = (s: number) => g[2] + s * (g[3] - g[2]);
  const pole = (g[0] - g[2]) / (g[0] - g[2] - (g[1] - g[3]));
  const cuts = [0, 1, g[0] / (g[0] - g[1]), g[2] / (g[2] - g[3]), pole].filter((s) => s >= 0 && s <= 1).sort((p, q) => p - q);
  return cuts.slice(1).flatMap((to, i) => {
    const from = cuts[i];
    const middle = (from + to) / 2;
    if (to - from < 1e-12 || low(middle) >= 0 === high(middle) >= 0) return [];
    const row = Array.from({ length: steps + 1 }, (_, n): Spot => {
      const s = from + ((1 - Math.cos((Math.PI * n) / steps)) / 2) * (to - from);
      const gap = low(s) - high(s);
      return [s, gap === 0 ? 0.5 : Math.min(1, Math.max(0, low(s) / gap))];
    });
    return [row];
  });
}

export class PlaneTab implements Tab {
  private readonly main = svg("svg", { class: "plane large", role: "img", "aria-label": "the bilinear contour" });
  private readonly small = WAYS.map(([, title]) => svg("svg", { class: "plane", role: "img", "aria-label": title }));
  private readonly said = WAYS.map(() => element("span", { class: "quiet" }));
  private readonly isovalue: Isovalue;
  private readonly typed: Typed | null = null;
  /** A hundredth of a picture. */
  private readonly unit: number;
  private held: { n: number; y: number; value: number } | null = null;

  constructor(private readonly app: App) {
    const { side, sheet } = app;
    const { shape } = this.lattice;
    const names = this.lattice.values.map((_, n) => `${Math.floor(n / shape[1])}${n % shape[1]}`);
    if (names.length <= 12) this.typed = new Typed(names, () => this.lattice.values, (n, value) => this.set(n, value), shape[1]);
    const [m, n] = shape;
    const room = 0.14 * Math.max(m, n);
    for (const one of [this.main, ...this.small])
      one.setAttribute("viewBox", [-room, -room, m - 1 + 2 * room, n - 1 + 2 * room].join(" "));
    this.unit = (Math.max(m, n) - 1 + 2 * room) / 100;
    sheet.append(
      element("div", { class: "planes" },
        element("figure", { class: "panel large" }, this.main, element("figcaption", {}, element("b", {}, "The bilinear contour"), element("span", { class: "quiet" }, "hyperbolas, their asymptotes and saddles"))),
        ...WAYS.map(([, title], i) => element("figure", { class: "panel" }, this.small[i], element("figcaption", {}, element("b", {}, title), this.said[i])))),
    );
    this.isovalue = new Isovalue("isovalue", () => this.lattice.isovalue, (isovalue) => this.put({ isovalue }));
    const fresh = (size: number, kind: string, seed: number) => {
      const plane: Lattice = { shape: [size, size], kind, seed, isovalue: 0, values: made(kind, seed, [size, size])! };
      app.go({ ...app.state, plane });
    };
    let seed = this.lattice.seed;
    side.append(
      element("section", { class: "presets" },
        button("one square", () => app.go({ ...app.state, plane: square([0.8, -0.7, -0.5, 0.6]) })),
        button("random square", () => {
          const next = random(Date.now() + seed++);
          app.go({ ...app.state, plane: square([0, 1, 2, 3].map(() => Number((2 * next() - 1).toFixed(2)))) });
        }),
        choice("8 × 8 image of", [["", "choose"], ...KINDS], this.lattice.kind, (kind) => kind && fresh(8, kind, ++seed))),
      element("p", {}, "On a square with two diagonal corners inside there are two ways to join four points. The bilinear contour is a hyperbola: the value at its saddle says which way it runs."),
      element("section", {}, element("h3", {}, "Samples"), ...(this.typed ? [this.typed.root, element("p", { class: "hint" }, "Drag a sample up or down, or type.")] : []), paste(() => this.lattice, (values) => this.put({ values }))),
      element("section", { class: "pinned" }, element("h3", {}, "Isovalue"), this.isovalue.root),
    );
    this.main.addEventListener("pointerdown", (event) => {
      const n = Number((event.target as Element).closest("[data-n]")?.getAttribute("data-n") ?? NaN);
      if (!Number.isInteger(n)) return;
      this.held = { n, y: event.clientY, value: this.lattice.values[n] };
      this.main.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    this.main.addEventListener("pointermove", (event) => {
      const { held } = this;
      if (!held) return;
      const step = stepFor(this.lattice.values);
      this.set(held.n, rounded(held.value + ((held.y - event.clientY) / 4) * step, step));
    });
    for (const name of ["pointerup", "pointercancel"]) this.main.addEventListener(name, () => (this.held = null));
  }

  private get lattice(): Lattice {
    return this.app.state.plane;
  }

  private put(change: Partial<Lattice>): void {
    Object.assign(this.lattice, change, "values" in change ? { kind: "", seed: 0 } : {});
    this.app.changed();
  }

  private set(n: number, value: number): void {
    this.put({ values: this.lattice.values.map((old, i) => (i === n ? value : old)) });
  }

  update(): void {
    const { tables } = this.app;
    const [m, n] = this.lattice.shape;
    const squares = Array.from({ length: (m - 1) * (n - 1) }, (_, at) => [Math.floor(at / (n - 1)), at % (n - 1)]);
    const put = ([x, y]: Spot, [i, j]: number[]) => `${(x + i).toFixed(4)},${(n - 1 - y - j).toFixed(4)}`;
    const truth: SVGElement[] = [];
    const ways: SVGElement[][] = WAYS.map(() => []);
    const wrong = WAYS.map(() => 0);
    let ambiguous = 0;
    for (const at of squares) {
      const g = squareOf(this.lattice, at[0], at[1]);
      const row = (spots: Spot[], kind: string) => svg("polyline", { class: kind, points: spots.map((spot) => put(spot, at)).join(" ") });
      const open = g[0] >= 0 === g[3] >= 0 && g[1] >= 0 === g[2] >= 0 && g[0] >= 0 !== g[1] >= 0;
      if (open) {
        ambiguous++;
        const D = g[0] - g[2] - (g[1] - g[3]);
        const [s, t, value] = [(g[0] - g[2]) / D, (g[0] - g[1]) / D, (g[0] * g[3] - g[1] * g[2]) / D];
        truth.push(row([[s, 0], [s, 1]], "asymptote"), row([[0, t], [1, t]], "asymptote"));
        const [x, y] = put([s, t], at).split(",");
        truth.push(svg("circle", { class: value >= 0 ? "saddle high" : "saddle", cx: x, cy: y, r: String(1.4 * this.unit) }, svg("title", {}, `saddle ${written(value)} from the isovalue`)));
      }
      truth.push(...hyperbola(g).map((spots) => row(spots, "hyperbola")));
      WAYS.forEach(([, , joins], i) => {
        const joined = open && joins(g);
        if (open && joined !== saddleJoins(g)) {
          wrong[i]++;
          ways[i].unshift(svg("rect", { class: "lit", x: String(at[0]), y: String(n - 2 - at[1]), width: "1", height: "1" }));
        }
        ways[i].push(...segments(tables, g, joined).map((spots) => row(spots, "segment")));
      });
    }
    const lattice = squares.map(([i, j]) => svg("rect", { class: "lattice", x: String(i), y: String(n - 2 - j), width: "1", height: "1" }));
    const again = () => lattice.map((one) => one.cloneNode() as SVGElement);
    this.main.replaceChildren(...again(), ...truth, ...this.samples(true));
    this.small.forEach((one, i) => {
      one.replaceChildren(...again(), ...ways[i], ...this.samples(false));
      const of = `${ambiguous} ambiguous ${ambiguous === 1 ? "square" : "squares"}`;
      this.said[i].textContent = ambiguous ? `${wrong[i]} of ${of} unlike the interpolant` : "nothing is ambiguous";
      this.said[i].className = wrong[i] ? "bad" : "good";
    });
    this.typed?.show(this.lattice.values);
    this.isovalue.show(rangeOf(this.lattice));
  }

  private samples(named: boolean): SVGElement[] {
    const { shape, values, isovalue } = this.lattice;
    const [few, unit] = [values.length <= 16, this.unit];
    return values.flatMap((value, at) => {
      const [x, y] = [Math.floor(at / shape[1]), shape[1] - 1 - (at % shape[1])];
      const size = (few ? 1.7 : 0.9) * unit * (named ? 1 : 1.5);
      const disc = svg("circle", { class: value >= isovalue ? "in" : "out", cx: String(x), cy: String(y), r: String(size) }, svg("title", {}, `sample (${x}, ${at % shape[1]}): ${value}`));
      if (!named || !few) return [disc];
      const text = svg("text", { x: String(x), y: String(y - 3.2 * unit), class: "value", "font-size": String(3.6 * unit) }, written(value));
      const grip = svg("circle", { class: "grip", cx: String(x), cy: String(y), r: String(6 * unit) });
      return [svg("g", { "data-n": String(at), class: "sample" }, grip, disc, text)];
    });
  }
}

/** One square with these samples, isovalue 0. */
export function square(values: number[]): Lattice {
  return { shape: [2, 2], values, isovalue: 0, kind: "", seed: 0 };
}
