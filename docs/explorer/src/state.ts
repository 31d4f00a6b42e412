/*
What the explorer shows, and the link that carries it.

A link's part after # holds: tab; n, the shape; v, the samples in C order (the last index fastest),
or kind and seed of a made field; i, the isovalue; w, where the 4-D cell is cut; r, the rules, by
their names in isoref; tiles, the rule whose tiles the gallery shows; at, the view: turn, tilt, zoom. What is missing keeps what it was. A link that
cannot be read says why, and changes nothing.
*/

import { START, type View } from "./stage.ts";

export const TABS = ["cell", "gallery", "pair", "field", "plane", "four"] as const;
export type TabName = (typeof TABS)[number];

/** A field on a lattice with its isovalue. */
export interface Lattice {
  shape: number[];
  /** In C order. */
  values: number[];
  isovalue: number;
  /** How it was made, where it was: a kind and a seed. */
  kind: string;
  seed: number;
}

export interface State {
  tab: TabName;
  cell: Lattice;
  pair: Lattice;
  field: Lattice;
  plane: Lattice;
  four: Lattice & { w: number };
  rules: string[];
  /** The rule whose tiles the gallery shows. */
  tiles: string;
  view: View;
}

/** The most samples that a link may hold. */
export const MOST = 1331;

/** The samples of a lattice whose corner c stands at bit a of c along axis a, in C order, and back. */
export function reordered(values: readonly number[]): number[] {
  const bits = Math.log2(values.length);
  return values.map((_, number) => {
    let corner = 0;
    for (let axis = 0; axis < bits; axis++) corner |= ((number >> (bits - 1 - axis)) & 1) << axis;
    return values[corner];
  });
}

/** The part of a link after #. */
export function written(state: State): string {
  const parts = new URLSearchParams({ tab: state.tab });
  if (state.tab !== "gallery") {
    const lattice = state[state.tab];
    parts.set("n", lattice.shape.join(","));
    if (lattice.kind) {
      parts.set("kind", lattice.kind);
      parts.set("seed", String(lattice.seed));
    } else parts.set("v", lattice.values.join(","));
    parts.set("i", String(lattice.isovalue));
  }
  if (state.tab === "four") parts.set("w", String(state.four.w));
  parts.set("r", state.rules.join(","));
  if (state.tab === "gallery") parts.set("tiles", state.tiles);
  const { turn, tilt, zoom } = state.view;
  if (turn !== START.turn || tilt !== START.tilt || zoom !== START.zoom)
    parts.set("at", [turn, tilt, zoom].map((x) => Number(x.toFixed(2))).join(","));
  return parts.toString().replaceAll("%2C", ",");
}

export class LinkError extends Error {}

function numbers(text: string, name: string): number[] {
  return text.split(",").map((part) => {
    const x = part.trim() === "" ? NaN : Number(part);
    if (!Number.isFinite(x)) throw new LinkError(`${name} holds ${JSON.stringify(part)}, which is no finite number`);
    return x;
  });
}

/** Which shapes a tab can show, in words, or nothing where this one will do. */
function refusal(tab: TabName, shape: readonly number[]): string {
  const size = shape.reduce((product, n) => product * n, 1);
  const wanted: Record<TabName, [boolean, string]> = {
    cell: [shape.join() === "2,2,2", "2,2,2"],
    pair: [shape.join() === "3,2,2", "3,2,2"],
    field: [shape.length === 3 && size <= MOST, `three lengths, at most ${MOST} samples`],
    plane: [shape.length === 2 && size <= MOST, `two lengths, at most ${MOST} samples`],
    four: [shape.join() === "2,2,2,2", "2,2,2,2"],
    gallery: [true, ""],
  };
  const whole = shape.every((n) => Number.isInteger(n) && n >= 2);
  const [will, words] = wanted[tab];
  return will && whole ? "" : `n is ${shape.join(",")}; this tab shows ${words}, each at least 2`;
}

/** A field of a kind, from a seed; null for an unknown kind. */
type Maker = (kind: string, seed: number, shape: number[]) => number[] | null;

/** The state that a link asks for, on top of this one. Raises LinkError. */
export function read(hash: string, state: State, known: readonly string[], made: Maker): State {
  const parts = new URLSearchParams(hash.replace(/^#/, ""));
  const tab = (parts.get("tab") ?? state.tab) as TabName;
  if (!TABS.includes(tab)) throw new LinkError(`there is no tab ${JSON.stringify(tab)}; there are ${TABS.join(", ")}`);
  const next: State = { ...state, tab, view: { ...state.view } };
  const [r, at] = [parts.get("r"), parts.get("at")];
  if (r !== null) next.rules = r ? r.split(",") : [];
  next.tiles = parts.get("tiles") ?? state.tiles;
  const unknown = [...next.rules, next.tiles].find((name) => !known.includes(name));
  if (unknown !== undefined) throw new LinkError(`there is no algorithm ${JSON.stringify(unknown)}; there are ${known.join(", ")}`);
  if (at !== null) {
    const [turn, tilt, zoom] = numbers(at, "at");
    Object.assign(next.view, { turn, tilt: Math.max(-89.9, Math.min(89.9, tilt ?? START.tilt)), zoom: Math.max(0.5, Math.min(8, zoom ?? 1)) });
  }
  if (tab === "gallery") return next;

  const lattice = { ...state[tab] };
  const [n, v, i, w, kind] = ["n", "v", "i", "w", "kind"].map((name) => parts.get(name));
  if (n !== null) lattice.shape = numbers(n, "n");
  if (n !== null || v !== null) {
    const said = refusal(tab, lattice.shape);
    if (said) throw new LinkError(said);
  }
  if (kind) {
    const seed = Number(parts.get("seed") ?? 0);
    const values = made(kind, seed, lattice.shape);
    if (!values) throw new LinkError(`there is no kind of field ${JSON.stringify(kind)}`);
    Object.assign(lattice, { kind, seed, values });
  }
  if (v !== null) {
    Object.assign(lattice, { values: numbers(v, "v"), kind: "", seed: 0 });
    const wanted = lattice.shape.reduce((product, m) => product * m, 1);
    if (lattice.values.length !== wanted)
      throw new LinkError(`v holds ${lattice.values.length} samples, and shape ${lattice.shape.join(" x ")} has ${wanted}`);
  }
  if (i !== null) lattice.isovalue = numbers(i, "i")[0];
  if (w !== null && tab === "four") (lattice as State["four"]).w = Math.min(1, Math.max(0, numbers(w, "w")[0]));
  return { ...next, [tab]: lattice };
}
