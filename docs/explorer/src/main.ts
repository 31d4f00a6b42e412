/* The page: tabs, the link, and the state that both change. */

import rawTables from "../build/tables.json";
import { type App, type Tab } from "./app.ts";
import * as cell from "./cell.ts";
import * as decisions from "./decisions.ts";
import { button, element } from "./dom.ts";
import { made } from "./fields.ts";
import * as grid from "./grid.ts";
import { Stage, START } from "./stage.ts";
import { LinkError, read, type State, type TabName, TABS, written } from "./state.ts";
import { load, type Raw } from "./tables.ts";
import { CellTab } from "./tabs/cell.ts";
import { FieldTab } from "./tabs/field.ts";
import { FourTab, simplicialSection } from "./tabs/four.ts";
import { GalleryTab } from "./tabs/gallery.ts";
import { HOLE, PairTab } from "./tabs/pair.ts";
import { PlaneTab, saddleJoins, segments, square } from "./tabs/plane.ts";
import * as trilinear from "./trilinear.ts";

const TITLES: Record<TabName, string> = {
  cell: "One cell",
  gallery: "Gallery",
  pair: "Two cells",
  field: "A field",
  plane: "Contours",
  four: "Four dimensions",
};
const MAKERS: Record<TabName, new (app: App) => Tab> = {
  cell: CellTab,
  gallery: GalleryTab,
  pair: PairTab,
  field: FieldTab,
  plane: PlaneTab,
  four: FourTab,
};
const RULES = ["lorensen-cline", "asymptotic-decider", "marching-vesta-mixed-L", "trilinear-cubes"];

const tables = load(rawTables as unknown as Raw);

/** What is shown at first: a cell with a tunnel, the hole of 1987, noise. */
function start(): State {
  const plain = { kind: "", seed: 0, isovalue: 0 };
  return {
    tab: "cell",
    cell: { ...plain, shape: [2, 2, 2], values: [0.9, -0.35, -0.5, -0.45, -0.3, -0.3, -0.4, 0.8], isovalue: -0.12 },
    pair: { ...plain, shape: [3, 2, 2], values: [...HOLE] },
    field: { shape: [8, 8, 8], values: made("noise", 1, [8, 8, 8])!, kind: "noise", seed: 1, isovalue: 0 },
    plane: square([0.8, -0.7, -0.5, 0.6]),
    four: { ...plain, shape: [2, 2, 2, 2], values: Array.from({ length: 16 }, (_, n) => (n % 15 ? -0.5 : 1.5)), w: 0.5 },
    rules: RULES,
    tiles: "trilinear-cubes",
    view: { ...START },
  };
}

function begin(): void {
  const main = document.querySelector("main")!;
  const bar = document.querySelector<HTMLElement>(".tabs")!;
  const said = document.querySelector<HTMLElement>("#said")!;
  const host = element("div", { class: "stage" });
  const sheet = element("div", { class: "sheet" });
  const side = element("aside", { class: "side", "aria-label": "controls and facts" });
  main.append(element("div", { class: "work" }, host, sheet), side);

  const stage = new Stage(host);
  const banner = element("p", { class: "banner", role: "alert" });
  main.prepend(banner);

  let tab: Tab | null = null;
  let timer = 0;
  const keep = (): void => {
    // Safari allows a hundred changes in half a minute: wait for a pause.
    clearTimeout(timer);
    timer = window.setTimeout(() => history.replaceState(null, "", `#${written(app.state)}`), 200);
  };
  const app: App = {
    tables, stage, side, sheet, state: start(),
    changed() {
      stage.ask(true);
      keep();
    },
    go(state) {
      app.state = state;
      stage.clear();
      side.replaceChildren();
      sheet.replaceChildren();
      Object.assign(stage.view, state.view);
      document.body.dataset.tab = state.tab;
      for (const one of bar.querySelectorAll("button")) one.setAttribute("aria-selected", String(one.dataset.tab === state.tab));
      for (const one of bar.querySelectorAll("button")) one.tabIndex = one.dataset.tab === state.tab ? 0 : -1;
      bar.querySelector("[aria-selected=true]")?.scrollIntoView({ block: "nearest", inline: "nearest" });
      tab = new MAKERS[state.tab](app);
      // Contours and the gallery are no pictures in space, and need none.
      banner.textContent = stage.failed && stage.panels.length ? `This browser draws no WebGL, which the pictures of this tab need (${stage.failed}). Turn on hardware acceleration, or try another browser.` : "";
      app.changed();
    },
  };
  stage.update = () => tab?.update();
  stage.turned = () => {
    app.state.view = { ...stage.view };
    keep();
  };

  for (const name of TABS) {
    const made = button(TITLES[name], () => app.go({ ...app.state, tab: name }), { role: "tab", "data-tab": name });
    bar.append(made);
  }
  bar.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const next = TABS[(TABS.indexOf(app.state.tab) + step + TABS.length) % TABS.length];
    app.go({ ...app.state, tab: next });
    bar.querySelector<HTMLElement>(`[data-tab=${next}]`)!.focus();
    event.preventDefault();
  });
  document.querySelector("#link")!.addEventListener("click", async () => {
    history.replaceState(null, "", `#${written(app.state)}`);
    try {
      await navigator.clipboard.writeText(location.href);
      said.textContent = "The link is copied: it opens what you see.";
    } catch {
      said.textContent = "Copy the address of this page: it opens what you see.";
    }
    setTimeout(() => (said.textContent = ""), 4000);
  });
  document.querySelector("#home")!.addEventListener("click", () => stage.home());

  const follow = (): void => {
    try {
      app.go(read(location.hash, app.state, [...tables.rules.keys()], made));
      said.textContent = "";
    } catch (error) {
      if (!(error instanceof LinkError)) throw error;
      said.textContent = `This link could not be read: ${error.message}.`;
      if (!tab) app.go(app.state);
    }
  };
  addEventListener("hashchange", follow);
  follow();
  Object.assign(window, {
    explorer: { START, tables, app, stage, ...decisions, ...cell, ...grid, ...trilinear, saddleJoins, segments, simplicialSection, made, read, written },
  });
}

begin();
