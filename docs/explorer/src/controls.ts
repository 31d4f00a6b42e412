/* The controls that several tabs share: samples to type, the isovalue, rules to choose. */

import { button, element, svg, tick, written } from "./dom.ts";
import { type Lattice } from "./state.ts";
import { type Tables } from "./tables.ts";

/** Inputs for the samples of a small lattice, in C order, with their indices. */
export class Typed {
  readonly root: HTMLElement;
  private readonly inputs: HTMLInputElement[];

  constructor(names: readonly string[], get: () => readonly number[], set: (n: number, value: number) => void, columns = 2) {
    this.inputs = names.map((name, n) => {
      const input = element("input", { type: "number", step: "any", "aria-label": `sample ${name}` });
      input.addEventListener("input", () => {
        const value = input.valueAsNumber;
        input.setCustomValidity(Number.isFinite(value) ? "" : "a finite number");
        if (Number.isFinite(value)) set(n, value);
      });
      input.addEventListener("blur", () => {
        input.setCustomValidity("");
        this.show(get(), true);
      });
      return input;
    });
    const fields = names.map((name, n) => element("label", {}, element("span", {}, name), this.inputs[n]));
    this.root = element("div", { class: "typed", style: `--columns:${columns}` }, ...fields);
  }

  focus(n: number): void {
    this.inputs[n].focus();
    this.inputs[n].select();
  }

  show(values: readonly number[], all = false): void {
    this.inputs.forEach((input, n) => {
      if ((all || input !== document.activeElement) && input.valueAsNumber !== values[n]) input.value = String(values[n]);
    });
  }
}

/** A slider for the isovalue with marks where something happens, a box to type it, and a button that moves it. */
export class Isovalue {
  readonly root: HTMLElement;
  private readonly slider = element("input", { type: "range", min: "0", max: "1000", step: "1" });
  private readonly box = element("input", { type: "number", step: "any" });
  private readonly marks = svg("svg", { class: "marks", viewBox: "0 0 1000 14", preserveAspectRatio: "none", "aria-hidden": "true" });
  private readonly player: HTMLButtonElement;
  private range: [number, number] = [-1, 1];
  private playing = 0;

  constructor(label: string, private readonly get: () => number, private readonly set: (value: number) => void) {
    this.slider.setAttribute("aria-label", label);
    this.box.setAttribute("aria-label", `${label}, typed`);
    this.slider.addEventListener("input", () => {
      const [low, high] = this.range;
      this.put(low + (this.slider.valueAsNumber / 1000) * (high - low));
    });
    this.box.addEventListener("input", () => {
      if (Number.isFinite(this.box.valueAsNumber)) this.set(this.box.valueAsNumber);
    });
    this.player = button("▶", () => this.play(), { "aria-label": `move the ${label} through its range`, class: "play" });
    const rail = element("div", { class: "rail" }, this.slider, this.marks);
    this.root = element("div", { class: "isovalue" }, element("span", { class: "name" }, label), this.player, rail, this.box);
  }

  private put(value: number): void {
    const step = 10 ** Math.floor(Math.log10((this.range[1] - this.range[0]) / 200 || 1));
    this.set(Number((Math.round(value / step) * step).toPrecision(12)));
  }

  /** Move through the range once; again to stop. Who wants less motion gets ten still steps. */
  private play(): void {
    if (this.playing) return this.stop();
    const [low, high] = this.range;
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const start = performance.now();
    const from = this.get() < high - 1e-3 * (high - low) ? this.get() : low;
    const seconds = (7 * (high - from)) / (high - low);
    const move = (now: number) => {
      const share = Math.max(0, Math.min(1, (now - start) / 1000 / seconds));
      const shown = calm ? Math.floor(share * 10) / 10 : share;
      this.put(from + shown * (high - from));
      if (share < 1 && this.root.isConnected) this.playing = requestAnimationFrame(move);
      else this.stop();
    };
    this.player.textContent = "❚❚";
    this.playing = requestAnimationFrame(move);
  }

  private stop(): void {
    cancelAnimationFrame(this.playing);
    this.playing = 0;
    this.player.textContent = "▶";
  }

  /** Show the isovalue in this range, with marks: a value, a class, and words. */
  show(range: readonly [number, number], marks: readonly { value: number; kind: string; words: string }[] = []): void {
    const value = this.get();
    this.range = [Math.min(range[0], value), Math.max(range[1], value)];
    const [low, high] = this.range;
    const at = (x: number) => (1000 * (x - low)) / (high - low || 1);
    if (document.activeElement !== this.slider || this.slider.valueAsNumber !== Math.round(at(value)))
      this.slider.value = String(Math.round(at(value)));
    if (this.box !== document.activeElement) this.box.value = String(value);
    this.slider.setAttribute("aria-valuetext", String(value));
    this.marks.replaceChildren(
      ...marks.map((mark) =>
        svg("rect", { class: mark.kind, x: (at(mark.value) - 3).toFixed(0), width: "6", y: "0", height: "14" }, svg("title", {}, mark.words)),
      ),
    );
  }
}

/** The range of a lattice's values, a little wider. */
export function rangeOf(lattice: Lattice): [number, number] {
  const [low, high] = [Math.min(...lattice.values), Math.max(...lattice.values)];
  const more = 0.02 * (high - low) || 1;
  return [low - more, high + more];
}

/** Boxes to choose which rules are shown. */
export function ruleChoice(tables: Tables, chosen: () => string[], choose: (rules: string[]) => void): HTMLElement {
  const boxes = [...tables.rules.values()].map((rule) => {
    const box = tick(rule.title, chosen().includes(rule.name), (on) => {
      const all = [...tables.rules.keys()];
      choose(all.filter((name) => (name === rule.name ? on : chosen().includes(name))));
    });
    box.title = rule.says;
    return box;
  });
  return element("details", { class: "rules" }, element("summary", {}, "Algorithms side by side"), ...boxes);
}

/** A place to paste samples into, as any list of numbers. */
export function paste(lattice: () => Lattice, set: (values: number[]) => void): HTMLElement {
  const area = element("textarea", { rows: "4", spellcheck: "false", "aria-label": "samples, as a list of numbers" });
  const said = element("p", { class: "quiet", role: "status" });
  const take = () => {
    const found = area.value.match(/[-+−]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?/gi)?.map((text) => Number(text.replace("−", "-"))) ?? [];
    const { shape } = lattice();
    const wanted = shape.reduce((product, n) => product * n, 1);
    said.textContent =
      found.length === wanted && found.every(Number.isFinite)
        ? ""
        : `${found.length} numbers; a lattice of ${shape.join(" × ")} has ${wanted}.`;
    if (!said.textContent) set(found);
  };
  const details = element("details", {}, element("summary", {}, "All samples as a list"), area, button("take these", take), said);
  details.addEventListener("toggle", () => {
    if (details.open) area.value = lattice().values.join(", ");
  });
  return details;
}

export { written };
