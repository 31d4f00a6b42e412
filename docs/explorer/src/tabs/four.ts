/* A cell of four dimensions, cut at w = const along its last axis. */

import { type App, type Tab } from "../app.ts";
import { parameter } from "../cell.ts";
import { Isovalue, paste, rangeOf, Typed } from "../controls.ts";
import { button, element, written } from "../dom.ts";
import { random } from "../fields.ts";
import { flat, lattice, type Panel } from "../stage.ts";
import { reordered, type State } from "../state.ts";
import { type Point, type Tables } from "../tables.ts";
import { Tessellator } from "../trilinear.ts";

type Spot = [number, number, number, number];

/** The section at w of the tetrahedra that Min's method makes of the cell: polygons in space. */
export function simplicialSection(tables: Tables, g: readonly number[], w: number): Point[][] {
  const polygons: Point[][] = [];
  tables.kuhn4.forEach((corners) => {
    const code = corners.reduce((bits, c, v) => bits | (g[c] >= 0 ? 1 << v : 0), 0);
    for (const row of tables.sections4[code]) {
      const spots = row.map(([i, j]) => between(corners[i], corners[j], parameter(g[corners[i]], g[corners[j]])));
      polygons.push(...cut(spots, w));
    }
  });
  return polygons;
}

function between(a: number, b: number, t: number): Spot {
  return [0, 1, 2, 3].map((axis) => ((a >> axis) & 1) + t * (((b >> axis) & 1) - ((a >> axis) & 1))) as Spot;
}

/** A tetrahedron in four dimensions cut at w: nothing, a triangle, or a quadrilateral. */
function cut(spots: readonly Spot[], w: number): Point[][] {
  const low = spots.filter((spot) => spot[3] < w);
  const high = spots.filter((spot) => spot[3] >= w);
  if (!low.length || !high.length) return [];
  const at = (p: Spot, q: Spot): Point => {
    const t = (w - p[3]) / (q[3] - p[3]);
    return [0, 1, 2].map((axis) => p[axis] + t * (q[axis] - p[axis])) as Point;
  };
  if (low.length === 2 && high.length === 2) {
    const [[a, b], [p, q]] = [low, high];
    return [[at(a, p), at(a, q), at(b, q), at(b, p)]];
  }
  return [low.flatMap((a) => high.map((p) => at(a, p)))];
}

/** The polygons as triangles, right-handed from inside to outside of the sliced cell. */
function facing(polygons: readonly Point[][], g: readonly number[], w: number): { points: Point[]; triangles: number[][]; sides: [Point, Point][] } {
  const points: Point[] = [];
  const triangles: number[][] = [];
  const sides: [Point, Point][] = [];
  for (const polygon of polygons) {
    const start = points.length;
    points.push(...polygon);
    polygon.forEach((p, i) => sides.push([p, polygon[(i + 1) % polygon.length]]));
    for (let i = 2; i < polygon.length; i++) {
      const row = [start, start + i - 1, start + i];
      const [a, b, c] = row.map((n) => points[n]);
      const u = b.map((x, k) => x - a[k]);
      const v = c.map((x, k) => x - a[k]);
      const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const middle = a.map((x, k) => (x + b[k] + c[k]) / 3);
      const length = Math.hypot(...normal) || 1;
      // A short step along the normal leads down: linear in the simplices, read from the slice.
      const step = 1e-3;
      const there = kuhnValue(g, [...middle.map((x, k) => x + (step * normal[k]) / length), w]);
      const back = kuhnValue(g, [...middle.map((x, k) => x - (step * normal[k]) / length), w]);
      triangles.push(there <= back ? row : [row[0], row[2], row[1]]);
    }
  }
  return { points, triangles, sides };
}

/** The function that is linear on Kuhn's simplices: corners are added from the largest coordinate on. */
export function kuhnValue(g: readonly number[], at: readonly number[]): number {
  const order = [0, 1, 2, 3].sort((a, b) => at[b] - at[a]);
  let corner = 0;
  let value = g[0];
  for (const axis of order) {
    const next = corner | (1 << axis);
    value += at[axis] * (g[next] - g[corner]);
    corner = next;
  }
  return value;
}

/** The eight corners of the cell's slice at w: linear along the last axis. */
export function sliced(g: readonly number[], w: number): number[] {
  return Array.from({ length: 8 }, (_, c) => g[c] * (1 - w) + g[c | 8] * w);
}

export class FourTab implements Tab {
  private readonly truth: Panel;
  private readonly simplices: Panel;
  private readonly strip: [number, Panel][];
  private readonly tessellator: Tessellator;
  private readonly coarse: Tessellator;
  private readonly typed: Typed;
  private readonly isovalue: Isovalue;
  private readonly cutAt: Isovalue;

  constructor(private readonly app: App) {
    const { tables, stage, side } = app;
    this.tessellator = new Tessellator(tables);
    this.coarse = new Tessellator(tables, 12);
    this.truth = stage.panel("The slice of the interpolant", true);
    this.simplices = stage.panel("The slice of Min's tetrahedra", true);
    this.strip = [0, 1 / 3, 2 / 3, 1].map((w) => [w, stage.panel(`w = ${written(w, 2)}`)]);
    for (const panel of [this.truth, this.simplices, ...this.strip.map(([, one]) => one)]) {
      panel.fit([2, 2, 2]);
      panel.lines("lattice", lattice([2, 2, 2]));
    }
    const names = Array.from({ length: 16 }, (_, n) => n.toString(2).padStart(4, "0"));
    const set = (n: number, value: number) => this.put({ values: this.lattice.values.map((old, i) => (i === n ? value : old)) });
    this.typed = new Typed(names, () => this.lattice.values, set, 4);
    this.isovalue = new Isovalue("isovalue", () => this.lattice.isovalue, (isovalue) => this.put({ isovalue }));
    this.cutAt = new Isovalue("w", () => this.lattice.w, (w) => this.put({ w: Math.min(1, Math.max(0, w)) }));
    let seed = 0;
    const opposite = Array.from({ length: 16 }, (_, n) => (n === 0 || n === 15 ? 1.5 : -0.5));
    side.append(
      element("section", { class: "presets" },
        button("two opposite corners", () => this.put({ values: opposite, isovalue: 0 })),
        button("random cell", () => {
          const next = random(Date.now() + seed++);
          this.put({ values: opposite.map(() => Number((2 * next() - 1).toFixed(2))), isovalue: 0 });
        })),
      element("p", {}, "A cell of a four-dimensional lattice has sixteen samples, and its isosurface is a body of three dimensions. Cut at w, the interpolant is trilinear and its slice a surface. Min's method cuts the cell in 24 simplices and each simplex in tetrahedra: their slices are triangles and quadrilaterals."),
      element("section", { class: "pinned" }, element("h3", {}, "Where it is cut"), this.cutAt.root),
      element("section", {}, element("h3", {}, "Isovalue"), this.isovalue.root),
      element("section", {}, element("h3", {}, "Sixteen samples, the last index is w"), this.typed.root, paste(() => this.lattice, (values) => this.put({ values }))),
    );
  }

  private get lattice(): State["four"] {
    return this.app.state.four;
  }

  private put(change: Partial<State["four"]>): void {
    Object.assign(this.lattice, change);
    this.app.changed();
  }

  update(): void {
    const { tables } = this.app;
    const { values, isovalue, w } = this.lattice;
    const g = reordered(values).map((value) => value - isovalue);
    const slice = sliced(g, w);
    this.truth.surface("truth", this.tessellator.draw(slice), true);
    this.mark(this.truth, slice);
    this.truth.say(`quadrilinear, at w = ${written(w)}`);
    // On the cell's border a slice would lie in facets: keep a hair inside.
    const within = Math.min(1 - 1e-6, Math.max(1e-6, w));
    const polygons = simplicialSection(tables, g, within);
    const { points, triangles, sides } = facing(polygons, g, within);
    this.simplices.surface("mesh", flat(points, triangles));
    this.simplices.lines("mesh", sides);
    this.mark(this.simplices, slice);
    this.simplices.say(`linear on 24 simplices: ${polygons.length} triangles and quadrilaterals`);
    for (const [at, panel] of this.strip) {
      const there = sliced(g, at);
      panel.surface("truth", this.coarse.draw(there), true);
      this.mark(panel, there);
      panel.say("the interpolant");
    }
    this.typed.show(values);
    this.isovalue.show(rangeOf(this.lattice));
    this.cutAt.show([0, 1]);
  }

  private mark(panel: Panel, slice: readonly number[]): void {
    const { corners } = this.app.tables;
    panel.marks("inside", corners.filter((_, c) => slice[c] >= 0));
    panel.marks("outside", corners.filter((_, c) => slice[c] < 0));
  }
}
