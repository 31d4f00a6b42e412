/* Two cells that share a face: the hole of 1987. */

import { type App, rulePanels, type Tab } from "../app.ts";
import { Isovalue, paste, rangeOf, ruleChoice, Typed } from "../controls.ts";
import { button, element } from "../dom.ts";
import { random } from "../fields.ts";
import { corners, openEdges, sweep, wrongCells } from "../grid.ts";
import { Handles } from "../handles.ts";
import { flat, lattice, type Panel } from "../stage.ts";
import { type Lattice, reordered } from "../state.ts";
import { type Point, type Rule, type Tables } from "../tables.ts";
import { contour, Tessellator } from "../trilinear.ts";
import { meshLines } from "./cell.ts";

const SHAPE: Point = [3, 2, 2];
/** The hole: on the shared face two diagonal corners are inside, one cell has few inside, one many. */
export const HOLE = [1, -1, -1, -1, 1, -1, -1, 1, 1, 1, 1, 1];

/** A cell with a tunnel, case 10.1.2, and its mirror image across a face. */
function twoTunnels(tables: Tables): number[] {
  const at = Object.keys(tables.cases).find((name) => tables.cases[name] === "10.1.2")!;
  const cell = reordered(tables.cells[at].map((x) => x / 1024));
  const [outer, shared] = [cell.slice(0, 4), cell.slice(4)];
  return [...outer, ...shared, ...outer];
}

export class PairTab implements Tab {
  private readonly panels: [Rule, Panel][];
  private readonly truth: Panel;
  private readonly tessellators: Tessellator[];
  private readonly handles: Handles;
  private readonly typed: Typed;
  private readonly isovalue: Isovalue;

  constructor(private readonly app: App) {
    const { tables, stage, side } = app;
    this.truth = stage.panel("The trilinear surface itself", true);
    this.tessellators = [new Tessellator(tables), new Tessellator(tables)];
    this.panels = rulePanels(app);
    for (const panel of [this.truth, ...this.panels.map(([, one]) => one)]) {
      panel.fit(SHAPE);
      panel.lines("lattice", lattice(SHAPE));
    }
    const points = HOLE.map((_, n) => [Math.floor(n / 4), (n >> 1) & 1, n & 1] as Point);
    const names = points.map((point) => point.join(""));
    const set = (n: number, value: number) => this.put({ values: this.lattice.values.map((old, i) => (i === n ? value : old)) });
    this.typed = new Typed(names, () => this.lattice.values, set, 4);
    this.handles = new Handles(stage, this.truth, points, names, () => this.lattice.values, set, (n) => this.typed.focus(n));
    stage.placed = () => this.handles.show(this.lattice.isovalue);
    this.isovalue = new Isovalue("isovalue", () => this.lattice.isovalue, (isovalue) => this.put({ isovalue }));
    let seed = 0;
    side.append(
      element("section", { class: "presets" },
        button("the hole of 1987", () => this.put({ values: [...HOLE], isovalue: 0 })),
        button("two tunnels meet", () => this.put({ values: twoTunnels(tables), isovalue: 0 })),
        button("random cells", () => {
          const next = random(Date.now() + seed++);
          this.put({ values: HOLE.map(() => Number((2 * next() - 1).toFixed(2))), isovalue: 0 });
        })),
      element("p", {}, "Two cells share the face in the middle. Where a rule looks at its own cell only, the two may disagree there: red edges belong to one triangle, and the surface has a hole. A rule that asks the face itself gets one answer on both sides."),
      element("section", {}, element("h3", {}, "Twelve samples"), this.typed.root, paste(() => this.lattice, (values) => this.put({ values }))),
      element("section", { class: "pinned" }, element("h3", {}, "Isovalue"), this.isovalue.root),
      element("section", {}, ruleChoice(tables, () => app.state.rules, (rules) => app.go({ ...app.state, rules }))),
    );
  }

  private get lattice(): Lattice {
    return this.app.state.pair;
  }

  private put(change: Partial<Lattice>): void {
    Object.assign(this.lattice, change, { kind: "", seed: 0 });
    this.app.changed();
  }

  update(): void {
    const { tables } = this.app;
    const { values, isovalue } = this.lattice;
    const grid = { shape: SHAPE, values };
    const lines: [Point, Point][] = [];
    [0, 1].forEach((i) => {
      const g = corners(tables, grid, isovalue, [i, 0, 0]);
      const moved = this.tessellators[i].draw(g);
      for (let n = 0; n < 3 * moved.vertices; n += 3) moved.positions[n] += i;
      this.truth.surface(`cell ${i}`, moved, true);
      for (let f = i; f < 6; f++)
        for (const piece of contour(tables, g, f))
          for (let n = 1; n < piece.length; n++) {
            const [a, b] = [piece[n - 1], piece[n]].map((p) => [p[0] + i, p[1], p[2]] as Point);
            lines.push([a, b]);
          }
    });
    this.truth.lines("hyperbola", lines);
    this.truth.say("on the face in the middle both cells have one contour");
    for (const [rule, panel] of this.panels) {
      const swept = sweep(tables, rule, grid, isovalue);
      panel.surface("mesh", flat(swept.points, swept.triangles));
      panel.lines("mesh", meshLines(swept.points, swept.triangles));
      const open = openEdges(swept, SHAPE);
      panel.lines("open", open);
      const { wrong } = wrongCells(tables, rule, grid, isovalue);
      const hole = open.length ? `a hole: ${open.length} open edges` : "closed";
      panel.say(`${hole}; ${wrong.length} of 2 cells unlike the interpolant`, open.length || wrong.length ? "bad" : "good");
    }
    this.typed.show(values);
    this.isovalue.show(rangeOf(this.lattice));
  }
}
