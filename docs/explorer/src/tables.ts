/*
The tables that `tables.py` makes of isoref, and their words.

corner c        0 .. 7; bit a is its coordinate along axis a
edge e, node    0 .. 11 the crossing on edge e; 12, 13, .. interior points of a tile
face f          2 axis + side
signs           bit c is set where corner c is inside: value >= isovalue
decisions       bits 0 .. 5: inside corners of ambiguous face f are separated; 64, 128: a tunnel
                joins two inside, or two outside, parts
key             signs | decisions << 8
word            nodes or edges in a row, one character each
*/

export type Point = [number, number, number];

export type Placement =
  | ["average" | "surface", string]
  | ["saddles", number, number]
  | ["diagonal", number]
  | ["waist", number, number]
  | ["pair", number, number];

export type Compares = "none" | "faces" | "mean" | "trilinear";

/** The JSON file. */
export interface Raw {
  corners: Point[];
  edges: [number, number][];
  faceCorners: number[][];
  faceEdges: number[][];
  rules: Record<string, { title: string; compares: Compares; says: string; rows: number[][] }>;
  tiles: [string, Placement[]][];
  polygons: Record<string, string[]>;
  configurations: [number, number][];
  variants: Record<string, string>;
  cases: Record<string, string>;
  cells: Record<string, number[]>;
  cycles: { polygon: string; members: number; cells: number; example: number }[];
  squares: [number, number][][];
  kuhn4: number[][];
  kuhn4signs: number[];
  sections4: [number, number][][][];
}

export interface Tile {
  triangles: number[];
  interior: Placement[];
  /** The face bits that the tile shows, whatever was decided. */
  separated: number;
  /** 0 discs, 64 or 128 a tunnel, -1 neither. */
  tunnel: number;
}

export interface Rule {
  name: string;
  title: string;
  says: string;
  compares: Compares;
  tile(signs: number, decisions: number): Tile;
}

export interface Tables extends Omit<Raw, "rules" | "tiles"> {
  rules: Map<string, Rule>;
  /** For each signs, its ambiguous faces. */
  ambiguous: number[][];
}

/** The nodes of a word. */
export function nodes(word: string): number[] {
  return [...word].map((letter) => parseInt(letter, 36));
}

export function key(signs: number, decisions: number): number {
  return signs | (decisions << 8);
}

/** Whether corner c is inside. */
export function inside(signs: number, c: number): boolean {
  return ((signs >> c) & 1) === 1;
}

/** The tables, ready to be asked. */
export function load(raw: Raw): Tables {
  const ambiguous = Array.from({ length: 256 }, (_, signs) =>
    raw.faceCorners.flatMap((walk, f) => {
      const [a, b, c, d] = walk.map((corner) => inside(signs, corner));
      return a === c && b === d && a !== b ? [f] : [];
    }),
  );
  const rules = new Map<string, Rule>();
  for (const [name, { title, says, compares, rows }] of Object.entries(raw.rules)) {
    const tiles = new Map<number, Tile>();
    for (const [at, number, separated, tunnel] of rows) {
      const [word, interior] = raw.tiles[number];
      tiles.set(at, { triangles: nodes(word), interior, separated, tunnel });
    }
    const tile = (signs: number, decisions: number): Tile => {
      const found = tiles.get(key(signs, compares === "none" ? 0 : decisions));
      if (!found) throw new Error(`${name} has no tile for signs ${signs}, decisions ${decisions}`);
      return found;
    };
    rules.set(name, { name, title, says, compares, tile });
  }
  return { ...raw, rules, ambiguous };
}
