/* A small field, and the cells that each algorithm gets wrong. */

import { type App, rulePanels, type Tab } from "../app.ts";
import { Isovalue, paste, rangeOf, ruleChoice } from "../controls.ts";
import { button, choice, element, tick } from "../dom.ts";
import { KINDS, made } from "../fields.ts";
import { cellAt, cellCount, corners, openEdges, sweep, wrongCells } from "../grid.ts";
import { flat, lattice, type Panel } from "../stage.ts";
import { type Lattice } from "../state.ts";
import { type Point, type Rule } from "../tables.ts";
import { meshLines } from "./cell.ts";

export class FieldTab implements Tab {
  private readonly panels: [Rule, Panel][];
  private readonly isovalue: Isovalue;
  private readonly wrong = element("div", { class: "wrong" });
  private edges = false;

  constructor(private readonly app: App) {
    const { tables, side } = app;
    this.panels = rulePanels(app);
    const shape = this.lattice.shape as Point;
    for (const [, panel] of this.panels) {
      panel.fit(shape);
      panel.lines("lattice", lattice(shape, false));
    }
    this.isovalue = new Isovalue("isovalue", () => this.lattice.isovalue, (isovalue) => {
      this.lattice.isovalue = isovalue;
      app.changed();
    });
    const again = (kind: string, seed: number) => {
      Object.assign(this.lattice, { kind, seed, values: made(kind, seed, this.lattice.shape)! });
      app.changed();
    };
    const kinds: [string, string][] = this.lattice.kind ? KINDS : [["", "as it came"], ...KINDS];
    side.append(
      element("section", { class: "presets" },
        choice("Field", kinds, this.lattice.kind, (kind) => kind && again(kind, this.lattice.seed)),
        button("another one", () => again(this.lattice.kind || "noise", this.lattice.seed + 1)),
        button("8 × 8 × 8", () => this.fresh())),
      element("p", {}, `${shape.join(" × ")} samples. Lit cells have another topology than the trilinear interpolant; red edges are open. Choose one below to look into it.`),
      element("section", { class: "pinned" }, element("h3", {}, "Isovalue"), this.isovalue.root),
      element("section", {}, element("h3", {}, "Wrong cells"), this.wrong),
      element("section", {},
        tick("edges of triangles", this.edges, (on) => {
          this.edges = on;
          app.changed();
        }),
        ruleChoice(tables, () => app.state.rules, (rules) => app.go({ ...app.state, rules })),
        paste(() => this.lattice, (values) => {
          Object.assign(this.lattice, { values, kind: "", seed: 0 });
          app.changed();
        })),
    );
  }

  private get lattice(): Lattice {
    return this.app.state.field;
  }

  private fresh(): void {
    const shape = [8, 8, 8];
    const field: Lattice = { shape, kind: "noise", seed: 1, isovalue: 0, values: made("noise", 1, shape)! };
    this.app.go({ ...this.app.state, field });
  }

  update(): void {
    const { tables } = this.app;
    const { shape, values, isovalue } = this.lattice;
    const grid = { shape: shape as Point, values };
    const lists: HTMLElement[] = [];
    for (const [rule, panel] of this.panels) {
      const swept = sweep(tables, rule, grid, isovalue);
      panel.surface("mesh", flat(swept.points, swept.triangles));
      panel.lines("mesh", this.edges || cellCount(grid) <= 12 ? meshLines(swept.points, swept.triangles) : []);
      const open = openEdges(swept, grid.shape);
      panel.lines("open", open);
      const { wrong, active } = wrongCells(tables, rule, grid, isovalue);
      panel.boxes(wrong.map((n) => cellAt(n, grid.shape)));
      const torn = open.length ? `; ${open.length} open edges` : "";
      panel.say(`${wrong.length} of ${active} cells wrong${torn}`, wrong.length || torn ? "bad" : "good");
      lists.push(this.list(rule, wrong));
    }
    this.wrong.replaceChildren(...lists);
    this.isovalue.show(rangeOf(this.lattice));
  }

  /** Buttons that open the wrong cells of a rule in the first tab. */
  private list(rule: Rule, wrong: number[]): HTMLElement {
    const { app } = this;
    const { shape, isovalue } = this.lattice;
    const open = (n: number) => {
      const at = cellAt(n, shape as Point);
      const g = corners(app.tables, { shape: shape as Point, values: this.lattice.values }, 0, at);
      const values = Array.from({ length: 8 }, (_, i) => g[((i >> 2) & 1) | (i & 2) | ((i & 1) << 2)]);
      app.go({ ...app.state, tab: "cell", cell: { shape: [2, 2, 2], values, isovalue, kind: "", seed: 0 } });
    };
    const few = wrong.slice(0, 12).map((n) => button(cellAt(n, shape as Point).join(" "), () => open(n), { class: "small" }));
    const more = wrong.length > 12 ? [` and ${wrong.length - 12} more`] : [];
    return element("p", {}, element("b", {}, `${rule.title}: `), ...(wrong.length ? [...few, ...more] : ["none"]));
  }
}
