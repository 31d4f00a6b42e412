/* One cell: its true surface, and what each algorithm makes of it. */

import { type App, chosen, FACES, rulePanels, type Tab } from "../app.ts";
import { draw, saddlePoint } from "../cell.ts";
import { Isovalue, paste, rangeOf, ruleChoice, Typed } from "../controls.ts";
import { faceBits, meanBits, signsOf } from "../decisions.ts";
import { button, choice, element, tick, written } from "../dom.ts";
import { random } from "../fields.ts";
import { Handles } from "../handles.ts";
import { flat, lattice, type Panel } from "../stage.ts";
import { type Lattice, reordered } from "../state.ts";
import { key, type Point, type Rule, type Tables, type Tile } from "../tables.ts";
import { asymptotes, bodySaddles, contour, events, faceSaddle, isInside, Tessellator } from "../trilinear.ts";

type Segment = [Point, Point];

/** The sides of a row of points, closed or not. */
function sides(points: readonly Point[], closed: boolean): Segment[] {
  return points.flatMap((p, i) =>
    i + 1 < points.length || closed ? [[p, points[(i + 1) % points.length]] as Segment] : [],
  );
}

/** The edges of triangles, each once. */
export function meshLines(points: readonly Point[], triangles: readonly (readonly number[])[]): Segment[] {
  const seen = new Set<number>();
  const found: Segment[] = [];
  for (const row of triangles)
    for (let i = 0; i < 3; i++) {
      const [a, b] = [row[i], row[(i + 1) % 3]].sort((p, q) => p - q);
      if (seen.has(a * 65536 + b)) continue;
      seen.add(a * 65536 + b);
      found.push([points[a], points[b]]);
    }
  return found;
}

/** Triangles as rows of three. */
export function rows(list: readonly number[]): number[][] {
  return Array.from({ length: list.length / 3 }, (_, n) => list.slice(3 * n, 3 * n + 3));
}

/** The words for what a tile shows. */
export function inWords(tables: Tables, signs: number, tile: Tile): string {
  const lengths = tables.polygons[key(signs, tile.separated)].map((word) => word.length);
  const count = tile.triangles.length / 3;
  const cycles = lengths.length ? `cycles ${lengths.join(" + ")}` : "no cycles";
  return `${cycles}${tile.tunnel > 0 ? ", joined by a tunnel" : ""}; ${count} ${count === 1 ? "triangle" : "triangles"}`;
}

/** Whether a rule's tile has the polygons and the tunnel of the interpolant; in words. */
export function judged(mine: Tile, truth: Tile): ["good" | "bad", string] {
  if (mine.separated !== truth.separated) return ["bad", "wrong on a face"];
  if (mine.tunnel === truth.tunnel) return ["good", "right"];
  return ["bad", truth.tunnel ? "a tunnel is missing" : "a tunnel that is not there"];
}

/** The sides of triangles that no other has in reverse: where a tile meets the cell's faces. */
function border(points: readonly Point[], triangles: readonly (readonly number[])[]): Segment[] {
  const directed = new Set<number>();
  for (const row of triangles) for (let i = 0; i < 3; i++) directed.add(row[i] * 64 + row[(i + 1) % 3]);
  return [...directed]
    .map((side) => [Math.floor(side / 64), side % 64])
    .filter(([a, b]) => !directed.has(b * 64 + a))
    .map(([a, b]) => [points[a], points[b]]);
}

/** Draw a rule's tile in a panel, with its border on the faces. */
export function showTile(tables: Tables, panel: Panel, rule: Rule, g: readonly number[], edges = true): Tile {
  const { tile, points } = draw(tables, rule, g);
  const triangles = rows(tile.triangles);
  panel.surface("tile", flat(points, triangles));
  panel.lines("mesh", edges ? meshLines(points, triangles) : []);
  panel.marks("inside", tables.corners.filter((_, c) => g[c] >= 0));
  panel.marks("outside", tables.corners.filter((_, c) => g[c] < 0));
  panel.lines("polygon", border(points, triangles));
  return tile;
}

export class CellTab implements Tab {
  private readonly truth: Panel;
  private readonly panels: [Rule, Panel][];
  private readonly tessellator: Tessellator;
  private readonly handles: Handles;
  private readonly typed: Typed;
  private readonly isovalue: Isovalue;
  private readonly names = element("table", { class: "facts" });
  private readonly faces = element("table", { class: "facts" });
  private readonly rule: Rule;
  private readonly shows = { hyperbolas: true, saddles: true, edges: true };

  constructor(private readonly app: App) {
    const { tables, stage, side } = app;
    this.rule = tables.rules.get("trilinear-cubes")!;
    this.tessellator = new Tessellator(tables);
    this.truth = stage.panel("The trilinear surface itself", true);
    this.panels = rulePanels(app);
    for (const panel of [this.truth, ...this.panels.map(([, one]) => one)]) {
      panel.fit([2, 2, 2]);
      panel.lines("lattice", lattice([2, 2, 2]));
    }
    const named = (corner: Point) => corner.join("");
    const names = reordered(tables.corners.map((_, c) => c)).map((c) => named(tables.corners[c]));
    const set = (n: number, value: number) => this.set(n, value);
    this.typed = new Typed(names, () => this.lattice.values, set, 4);
    const points = reordered(tables.corners.map((_, c) => c)).map((c) => tables.corners[c]);
    this.handles = new Handles(stage, this.truth, points, names, () => this.lattice.values, set, (n) => this.typed.focus(n));
    stage.placed = () => this.handles.show(this.lattice.isovalue);
    this.isovalue = new Isovalue("isovalue", () => this.lattice.isovalue, (isovalue) => this.put({ isovalue }));
    side.append(
      this.presets(),
      element("section", {}, element("h3", {}, "Eight samples"), this.typed.root,
        element("p", { class: "hint" }, "Drag a sample's number up or down in the large picture, or type it here."),
        paste(() => this.lattice, (values) => this.put({ values }))),
      element("section", { class: "pinned" }, element("h3", {}, "Isovalue"), this.isovalue.root,
        element("p", { class: "hint" }, "Marks: where the topology can change, at samples (grey), saddles of faces (blue) and saddles inside the cell (violet).")),
      element("section", {}, element("h3", {}, "Its name"), this.names),
      element("section", {}, element("h3", {}, "Its ambiguous faces"), this.faces),
      element("section", {}, ...this.ticks(), ruleChoice(tables, () => app.state.rules, (rules) => app.go({ ...app.state, rules }))),
    );
  }

  private get lattice(): Lattice {
    return this.app.state.cell;
  }

  private put(change: Partial<Lattice>): void {
    Object.assign(this.lattice, change, { kind: "", seed: 0 });
    this.app.changed();
  }

  private set(n: number, value: number): void {
    this.put({ values: this.lattice.values.map((old, i) => (i === n ? value : old)) });
  }

  private ticks(): HTMLElement[] {
    const one = (label: string, name: keyof CellTab["shows"]) =>
      tick(label, this.shows[name], (on) => {
        this.shows[name] = on;
        this.app.changed();
      });
    return [one("contours on the faces", "hyperbolas"), one("saddles and waist", "saddles"), one("edges of triangles", "edges")];
  }

  /** One cell of each of Chernyaev's cases, and a random one. */
  private presets(): HTMLElement {
    const { cases, cells } = this.app.tables;
    const first = new Map<string, string>();
    for (const [at, name] of Object.entries(cases)) if (!first.has(name)) first.set(name, at);
    const order = [...first.keys()].sort((a, b) => {
      const [p, q] = [a, b].map((name) => name.split(".").map(Number));
      return p[0] - q[0] || (p[1] ?? 0) - (q[1] ?? 0) || (p[2] ?? 0) - (q[2] ?? 0);
    });
    const tunnel = (name: string) => Number(first.get(name)) >> 14 > 0;
    const options = [
      ["", "choose a case"] as const,
      ...order.map((name) => [name, `case ${name}${tunnel(name) ? ", a tunnel" : ""}`] as const),
    ];
    const select = choice("Begin with", options, "", (name) => {
      if (name) this.put({ values: reordered(cells[first.get(name)!].map((x) => x / 1024)), isovalue: 0 });
    });
    let seed = 0;
    const chance = button("random cell", () => {
      const next = random(Date.now() + seed++);
      this.put({ values: Array.from({ length: 8 }, () => Number((2 * next() - 1).toFixed(2))), isovalue: 0 });
    });
    const through = button("through a tunnel", () => {
      this.put({ values: [1, -0.4, -0.4, -0.4, -0.4, -0.4, -0.4, 1], isovalue: -0.35 });
      this.isovalue.root.querySelector<HTMLButtonElement>(".play")?.click();
    });
    through.title = "two opposite corners are high: slide the isovalue through the cell";
    return element("section", { class: "presets" }, select, chance, through);
  }

  update(): void {
    const { tables } = this.app;
    const { values, isovalue } = this.lattice;
    const plain = reordered(values);
    const g = plain.map((value) => value - isovalue);
    this.showTruth(g);
    const truth = draw(tables, this.rule, g);
    for (const [rule, panel] of this.panels) {
      const tile = showTile(tables, panel, rule, g, this.shows.edges);
      const [verdict, words] = judged(tile, truth.tile);
      panel.say(`${words}: ${inWords(tables, truth.signs, tile)}`, verdict);
    }
    this.typed.show(values);
    const kinds = { corner: "at-corner", "face saddle": "at-face", "body saddle": "at-body" };
    this.isovalue.show(
      rangeOf(this.lattice),
      events(tables, plain).map((one) => ({ value: one.isovalue, kind: kinds[one.kind], words: `${one.kind}: ${written(one.isovalue, 5)}` })),
    );
    this.showNames(truth.signs, truth.decisions, g);
    this.showFaces(truth.signs, g);
  }

  private showTruth(g: readonly number[]): void {
    const { tables } = this.app;
    const panel = this.truth;
    panel.surface("truth", this.tessellator.draw(g), true);
    const faces = this.shows.hyperbolas ? [0, 1, 2, 3, 4, 5] : [];
    panel.lines("hyperbola", faces.flatMap((f) => contour(tables, g, f).flatMap((piece) => sides(piece, false))));
    const ambiguous = tables.ambiguous[signsOf(g)];
    panel.lines("asymptote", this.shows.saddles ? ambiguous.flatMap((f) => asymptotes(tables, g, f)) : []);
    const saddles = this.shows.saddles ? ambiguous.flatMap((f) => faceSaddle(tables, g, f) ?? []) : [];
    panel.marks("high", saddles.filter((one) => one.value >= 0).map((one) => one.point));
    panel.marks("low", saddles.filter((one) => one.value < 0).map((one) => one.point));
    const body = this.shows.saddles ? bodySaddles(g).filter((one) => isInside(one.point)) : [];
    panel.marks("body", body.map((one) => one.point));
    const { tile, points } = draw(tables, this.rule, g);
    const waist = this.shows.saddles && tile.tunnel > 0 ? tile.interior.flatMap((one, i) => (one[0] === "waist" ? [points[12 + i]] : [])) : [];
    panel.lines("waist", sides(waist, true));
    const inside = body.map((one) => written(one.value)).join(" and ");
    panel.say(
      [
        tile.tunnel === 64 ? "a tunnel joins inside parts" : tile.tunnel === 128 ? "a tunnel joins outside parts" : "no tunnel",
        body.length
          ? `body ${body.length === 1 ? "saddle" : "saddles"} at ${inside} from the isovalue`
          : "no body saddle in the cell",
      ].join("; "),
    );
  }

  private showNames(signs: number, decisions: number, g: readonly number[]): void {
    const { tables } = this.app;
    const [configuration, exchanged] = tables.configurations[signs];
    const at = key(signs, decisions & 63);
    const mean = key(signs, meanBits(tables, g));
    const lengths = (name: number) => tables.polygons[name].map((word) => word.length).join(" + ") || "none";
    const list: [string, string][] = [
      ["Lorensen & Cline 1987", `one of 15 drawings, configuration ${configuration}${exchanged ? ", inside and outside exchanged" : ""}`],
      ["Nielson & Hamann 1991", tables.variants[at] + (tables.variants[at] === "13K" ? " (the letter is ours)" : "")],
      ["Chernyaev 1995", tables.cases[key(signs, decisions)] ?? "–"],
      ["Schlei 2010, mixed", `cycles ${lengths(mean)}`],
      ["isoref", `signs ${signs} = 0b${signs.toString(2).padStart(8, "0")}, decisions ${decisions}`],
    ];
    fill(this.names, list.map(([name, text]) => [name, text]));
  }

  private showFaces(signs: number, g: readonly number[]): void {
    const { tables } = this.app;
    const faces = tables.ambiguous[signs];
    if (!faces.length) return fill(this.faces, [["none: the signs alone decide", ""]]);
    const bits = { saddle: faceBits(tables, g), mean: meanBits(tables, g) };
    const way = (on: number, f: number) => ((on >> f) & 1 ? "separated" : "joined");
    const shown = chosen(this.app);
    fill(
      this.faces,
      faces.map((f) => {
        const average = tables.faceCorners[f].reduce((sum, c) => sum + g[c] / 4, 0);
        const [, value] = saddlePoint(tables, g, f);
        const others = shown
          .filter((rule) => rule.compares === "none")
          .map((rule) => `${rule.title}: ${way(rule.tile(signs, 0).separated, f)}`);
        return [
          FACES[f],
          `saddle ${written(value)}: ${way(bits.saddle, f)}; mean ${written(average)}: ${way(bits.mean, f)}`,
          others.join("; "),
        ];
      }),
    );
  }
}

/** Fill a table with rows of a heading and texts. */
export function fill(table: HTMLTableElement, list: readonly (readonly string[])[]): void {
  const text = JSON.stringify(list);
  if (table.dataset.text === text) return;
  table.dataset.text = text;
  table.replaceChildren(
    ...list.map(([name, ...texts]) =>
      element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, ...texts.filter(Boolean).map((one, i) => element("span", i ? { class: "quiet" } : {}, one)))),
    ),
  );
}
