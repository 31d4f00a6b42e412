/* What all tabs share. */

import { type Panel, type Stage } from "./stage.ts";
import { type State } from "./state.ts";
import { type Rule, type Tables } from "./tables.ts";

export interface App {
  tables: Tables;
  stage: Stage;
  state: State;
  /** The column of controls and facts. */
  side: HTMLElement;
  /** What a tab shows that is no picture in space. */
  sheet: HTMLElement;
  /** Something changed: draw, and put it in the link. */
  changed(): void;
  /** Show this state; another tab where it says so. */
  go(state: State): void;
}

export interface Tab {
  /** Called after each change, inside of a frame. */
  update(): void;
}

/** The rules that are shown, in the order of the tables. */
export function chosen(app: App): Rule[] {
  return [...app.tables.rules.values()].filter((rule) => app.state.rules.includes(rule.name));
}

/** A panel for each rule that is shown. */
export function rulePanels(app: App): [Rule, Panel][] {
  return chosen(app).map((rule) => [rule, app.stage.panel(rule.title)]);
}

export const FACES = ["axis 0 at 0", "axis 0 at 1", "axis 1 at 0", "axis 1 at 1", "axis 2 at 0", "axis 2 at 1"];
