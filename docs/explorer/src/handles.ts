/*
Samples that can be dragged: a small slider on each, which says its value.

Up and down change the value, by mouse, finger or keys; Enter goes to where it is typed.
*/

import { element, written } from "./dom.ts";
import { type Panel, type Stage } from "./stage.ts";
import { type Point } from "./tables.ts";

/** A step that suits these values: about a fortieth of their range, with one digit. */
export function stepFor(values: readonly number[]): number {
  const range = Math.max(...values) - Math.min(...values) || Math.abs(values[0]) || 1;
  return 10 ** Math.floor(Math.log10(range / 15));
}

/** A value rounded to a tenth of a step, without the digits that floats leave. */
export function rounded(value: number, step: number): number {
  const unit = step / 10;
  return Number((Math.round(value / unit) * unit).toPrecision(12));
}

export class Handles {
  private readonly handles: HTMLElement[];

  constructor(
    private readonly stage: Stage,
    private readonly panel: Panel,
    private readonly points: readonly Point[],
    private readonly names: readonly string[],
    private readonly get: () => readonly number[],
    private readonly set: (n: number, value: number) => void,
    private readonly type: (n: number) => void,
  ) {
    this.handles = points.map((_, n) => this.make(n));
    panel.place.append(...this.handles);
  }

  private make(n: number): HTMLElement {
    const handle = element("div", { class: "handle", role: "slider", tabindex: "0" });
    handle.setAttribute("aria-label", `sample ${this.names[n]}`);
    let held: { y: number; value: number; step: number } | null = null;
    handle.addEventListener("pointerdown", (event) => {
      handle.setPointerCapture(event.pointerId);
      handle.focus({ preventScroll: true });
      held = { y: event.clientY, value: this.get()[n], step: stepFor(this.get()) };
      event.preventDefault();
      event.stopPropagation();
    });
    handle.addEventListener("pointermove", (event) => {
      if (held) this.set(n, rounded(held.value + ((held.y - event.clientY) / 4) * held.step, held.step));
    });
    for (const name of ["pointerup", "pointercancel"]) handle.addEventListener(name, () => (held = null));
    handle.addEventListener("keydown", (event) => {
      const step = stepFor(this.get());
      const moves: Record<string, number> = {
        ArrowUp: step, ArrowRight: step, ArrowDown: -step, ArrowLeft: -step, PageUp: 5 * step, PageDown: -5 * step,
      };
      if (event.key === "Enter") this.type(n);
      else if (event.key in moves) this.set(n, rounded(this.get()[n] + moves[event.key], step));
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
    return handle;
  }

  /** Put the handles over their samples, and say their values. */
  show(isovalue: number): void {
    const values = this.get();
    const places = this.points.map((point) => this.stage.project(this.panel, point));
    const depths = places.map((place) => place[2]);
    const [near, far] = [Math.min(...depths), Math.max(...depths)];
    this.handles.forEach((handle, n) => {
      const [x, y, depth] = places[n];
      const text = written(values[n]);
      if (handle.textContent !== text) handle.textContent = text;
      handle.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      handle.style.zIndex = String(Math.round(10 + (20 * (far - depth)) / (far - near || 1)));
      handle.classList.toggle("in", values[n] >= isovalue);
      handle.setAttribute("aria-valuenow", String(values[n]));
      handle.setAttribute("aria-valuetext", `${values[n]}, ${values[n] >= isovalue ? "inside" : "outside"}`);
    });
  }
}
