/* Small words for elements of the page. */

type Attributes = Record<string, string>;

/** An element with attributes and children. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** A button that does this. */
export function button(words: string, act: () => void, attributes: Attributes = {}): HTMLButtonElement {
  const made = element("button", { type: "button", ...attributes }, words);
  made.addEventListener("click", act);
  return made;
}

/** A choice of one of several, each a value with its words; groups by a heading. */
export function choice(
  label: string,
  options: readonly (readonly [string, string])[],
  value: string,
  act: (value: string) => void,
): HTMLLabelElement {
  const made = element("select", {}, ...options.map(([key, words]) => element("option", { value: key }, words)));
  made.value = value;
  made.addEventListener("change", () => act(made.value));
  return element("label", { class: "field" }, element("span", {}, label), made);
}

/** A box to tick. */
export function tick(label: string, value: boolean, act: (value: boolean) => void): HTMLLabelElement {
  const box = element("input", { type: "checkbox" });
  box.checked = value;
  box.addEventListener("change", () => act(box.checked));
  return element("label", { class: "tick" }, box, label);
}

const NAMESPACE = "http://www.w3.org/2000/svg";

/** An element of SVG. */
export function svg(tag: string, attributes: Attributes = {}, ...children: (Node | string)[]): SVGElement {
  const made = document.createElementNS(NAMESPACE, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** A number as it is read: few digits, a true minus sign. */
export function written(x: number, digits = 3): string {
  if (!Number.isFinite(x)) return "–";
  return String(Number(x.toPrecision(digits))).replace("-", "−");
}
