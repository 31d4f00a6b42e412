/* All 256 signs under their fifteen configurations, all decisions of each, and all cycles. */

import { type App, type Tab } from "../app.ts";
import { draw, mean } from "../cell.ts";
import { button, choice, element, svg } from "../dom.ts";
import { START } from "../stage.ts";
import { type Lattice, reordered, type State } from "../state.ts";
import { inside, key, nodes, type Point, type Rule, type Tables } from "../tables.ts";
import { rows } from "./cell.ts";

const [TURN, TILT] = [START.turn, START.tilt].map((degrees) => (degrees * Math.PI) / 180);
const RIGHT = [-Math.sin(TURN), Math.cos(TURN), 0];
const UP = [-Math.sin(TILT) * Math.cos(TURN), -Math.sin(TILT) * Math.sin(TURN), Math.cos(TILT)];
const EYE = [Math.cos(TILT) * Math.cos(TURN), Math.cos(TILT) * Math.sin(TURN), Math.sin(TILT)];

/** Where a point stands in a thumbnail of 100 x 100, and how near it is. */
function place(p: Point): [number, number, number] {
  const along = (way: number[]) => p.reduce((sum, x, axis) => sum + (x - 0.5) * way[axis], 0);
  return [50 + 52 * along(RIGHT), 50 - 52 * along(UP), along(EYE)];
}

const written = (p: Point) => place(p).slice(0, 2).map((x) => x.toFixed(1)).join(",");

/** A cube with triangles and lines on it, seen as everywhere; nearest parts last. */
function cube(tables: Tables, signs: number, triangles: Point[][], loops: Point[][]): SVGElement {
  const parts: [number, SVGElement][] = [];
  for (const [a, b] of tables.edges) {
    const ends = [tables.corners[a], tables.corners[b]];
    parts.push([mean(ends).reduce((sum, x, axis) => sum + (x - 0.5) * EYE[axis], 0) - 0.01, svg("polyline", { class: "edge", points: ends.map(written).join(" ") })]);
  }
  for (const corners of triangles) {
    const [a, b, c] = corners.map(place);
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    const depth = (a[2] + b[2] + c[2]) / 3;
    parts.push([depth, svg("polygon", { class: area < 0 ? "front" : "back", points: corners.map(written).join(" ") })]);
  }
  tables.corners.forEach((corner, c) => {
    const [x, y, depth] = place(corner);
    parts.push([depth, svg("circle", { class: inside(signs, c) ? "in" : "out", cx: x.toFixed(1), cy: y.toFixed(1), r: "4" })]);
  });
  const over = loops.map((loop) => svg("polygon", { class: "loop", points: loop.map(written).join(" ") }));
  const drawn = parts.sort((p, q) => p[0] - q[0]).map((part) => part[1]);
  return svg("svg", { viewBox: "0 0 100 100", "aria-hidden": "true" }, ...drawn, ...over);
}

/** Values of a cell with these signs and decisions: one in which they happen, or 1 and -1. */
function valuesOf(tables: Tables, signs: number, decisions: number): number[] {
  const cell = tables.cells[key(signs, decisions)];
  return cell ? cell.map((x) => x / 1024) : Array.from({ length: 8 }, (_, c) => (inside(signs, c) ? 1 : -1));
}

/** A rule's tile for signs and decisions, on even values where it has no tunnel. */
function thumbnail(tables: Tables, rule: Rule, signs: number, decisions: number): SVGElement {
  const tile = rule.tile(signs, rule.compares === "trilinear" ? decisions : decisions & 63);
  const even = Array.from({ length: 8 }, (_, c) => (inside(signs, c) ? 1 : -1));
  const g = tile.tunnel || tile.interior.length ? valuesOf(tables, signs, decisions) : even;
  // Place the tile's nodes on these values, whatever the values decide.
  const { points } = draw(tables, { ...rule, compares: "none", tile: () => tile }, g);
  const triangles = rows(tile.triangles).map((row) => row.map((node) => points[node]));
  return cube(tables, signs, triangles, []);
}

export class GalleryTab implements Tab {
  private rule: Rule;
  private readonly configurations = element("div", {});
  private readonly variants = element("section", { class: "variants", "aria-live": "polite" });

  constructor(private readonly app: App) {
    const { tables, sheet, side } = app;
    this.rule = tables.rules.get(app.state.tiles)!;
    const options = [...tables.rules.values()].map((rule) => [rule.name, rule.title] as const);
    side.append(
      element("section", {}, choice("Tiles of", options, this.rule.name, (name) => {
        this.rule = tables.rules.get(name)!;
        app.state.tiles = name;
        app.changed();
        this.showConfigurations();
        this.variants.replaceChildren();
      })),
      element("p", {}, "All 256 signs of eight corners, under the fifteen configurations of 1987. A dot says that the signs leave something open: click to see every decision. What no values can decide has no example and is grey."),
      this.variants,
    );
    sheet.append(this.configurations, this.cycles());
    this.showConfigurations();
  }

  private showConfigurations(): void {
    const { tables } = this.app;
    const groups = Array.from({ length: 15 }, (_, number) =>
      Array.from({ length: 256 }, (_, signs) => signs).filter((signs) => tables.configurations[signs][0] === number),
    );
    this.configurations.replaceChildren(
      ...groups.map((group, number) =>
        element("section", { class: "configuration" },
          element("h3", {}, `Configuration ${number}`, element("small", {}, ` ${group.length} signs`)),
          element("div", { class: "thumbs" }, ...group.map((signs) => this.thumb(signs)))),
      ),
    );
  }

  private thumb(signs: number): HTMLElement {
    const { tables } = this.app;
    const open = this.choices(signs).length > 1;
    const made = element("button", { type: "button", class: open ? "thumb open" : "thumb", "aria-label": `signs ${signs}${open ? ", several decisions" : ""}` }, thumbnail(tables, this.rule, signs, 0), element("span", {}, String(signs)));
    made.addEventListener("click", () => (open ? this.showVariants(signs) : this.openCell(signs, 0)));
    return made;
  }

  /** The decisions that are told apart in a cell with these signs: those of the interpolant. */
  private choices(signs: number): number[] {
    const { tables } = this.app;
    const all = Object.keys(tables.polygons).map(Number).filter((name) => (name & 255) === signs).map((name) => name >> 8);
    const tunnels = Object.keys(tables.cases).map(Number).filter((name) => (name & 255) === signs && name >> 14 > 0).map((name) => name >> 8);
    return [...all, ...tunnels];
  }

  private showVariants(signs: number): void {
    const { tables } = this.app;
    const thumbs = this.choices(signs).map((decisions) => {
      const name = tables.cases[key(signs, decisions)];
      const lengths = tables.polygons[key(signs, decisions & 63)].map((word) => word.length).join("+");
      const words = `${tables.variants[key(signs, decisions & 63)]} · ${name ?? "never"} · ${lengths}`;
      const made = element("button", { type: "button", class: name ? "thumb" : "thumb never" }, thumbnail(tables, this.rule, signs, decisions), element("span", {}, words));
      if (name) made.addEventListener("click", () => this.openCell(signs, decisions));
      else made.disabled = true;
      return made;
    });
    this.variants.replaceChildren(
      button("close", () => this.variants.replaceChildren(), { class: "close small" }),
      element("h3", {}, `Signs ${signs}: every decision`),
      element("p", { class: "hint" }, "Nielson & Hamann's variant, Chernyaev's case, lengths of the cycles. Click for a cell in which it happens."),
      element("div", { class: "thumbs" }, ...thumbs),
    );
    this.app.side.scrollTop = this.variants.offsetTop - this.app.side.offsetTop;
  }

  private openCell(signs: number, decisions: number): void {
    const { app } = this;
    const values = reordered(valuesOf(app.tables, signs, decisions));
    const cell: Lattice = { shape: [2, 2, 2], values, isovalue: 0, kind: "", seed: 0 };
    app.go({ ...app.state, tab: "cell", cell } satisfies State);
  }

  /** One of each class of cycles under the rotations, by length. */
  private cycles(): HTMLElement {
    const { tables } = this.app;
    const lengths = [...new Set(tables.cycles.map((one) => one.polygon.length))];
    const middles = tables.edges.map(([a, b]) => mean([tables.corners[a], tables.corners[b]]));
    const parts = lengths.map((length) => {
      const thumbs = tables.cycles.filter((one) => one.polygon.length === length).map((one) => {
        const [signs, decisions] = [one.example & 255, one.example >> 8];
        const loop = nodes(one.polygon).map((e) => middles[e]);
        const made = element("button", { type: "button", class: "thumb" }, cube(tables, signs, [], [loop]), element("span", {}, `${one.members} turned, in ${one.cells} cells`));
        made.addEventListener("click", () => this.openCell(signs, decisions));
        return made;
      });
      return element("section", { class: "configuration" }, element("h3", {}, `Cycles of ${length}`), element("div", { class: "thumbs" }, ...thumbs));
    });
    return element("div", {}, element("h2", {}, "All cycles"), element("p", { class: "quiet" }, "The closed polygons that a surface can leave on a cell's skin, over all signs and all decisions: one of each class under the rotations."), ...parts);
  }

  update(): void {}
}
