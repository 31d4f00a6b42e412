/*
A rule carried over a small lattice, and what is wrong in its cells.

References: isoref.sweep; isoref.trilinear_cubes for what a cell should be. A cell is wrong where
the polygons that a rule draws on its faces, or the discs or tunnel it hangs in them, are not those
of the trilinear interpolant.
*/

import { draw } from "./cell.ts";
import { decide, signsOf } from "./decisions.ts";
import { type Point, type Rule, type Tables } from "./tables.ts";

export interface Grid {
  shape: Point;
  /** In C order: the last index is the fastest. */
  values: number[];
}

export interface Swept {
  points: Point[];
  triangles: [number, number, number][];
  /** For each triangle the cell it lies in, by its number in C order. */
  cells: number[];
}

export function cellShape(shape: Point): Point {
  return shape.map((n) => n - 1) as Point;
}

/** The lowest corner of a cell, from its number in C order. */
export function cellAt(number: number, shape: Point): Point {
  const [, m, n] = cellShape(shape);
  return [Math.floor(number / (m * n)), Math.floor(number / n) % m, number % n];
}

export function sampleAt(shape: Point, [i, j, k]: Point): number {
  return (i * shape[1] + j) * shape[2] + k;
}

/** The values at a cell's corners minus the isovalue. */
export function corners(tables: Tables, grid: Grid, isovalue: number, cell: Point): number[] {
  return tables.corners.map((corner) => {
    const at = corner.map((x, axis) => x + cell[axis]) as Point;
    return grid.values[sampleAt(grid.shape, at)] - isovalue;
  });
}

export function cellCount(grid: Grid): number {
  return cellShape(grid.shape).reduce((product, n) => product * Math.max(0, n), 1);
}

/** The surface of a rule; two triangles share a vertex where they cross the same lattice edge. */
export function sweep(tables: Tables, rule: Rule, grid: Grid, isovalue: number): Swept {
  const swept: Swept = { points: [], triangles: [], cells: [] };
  const names = new Map<string, number>();
  for (let n = 0; n < cellCount(grid); n++) {
    const cell = cellAt(n, grid.shape);
    const drawn = draw(tables, rule, corners(tables, grid, isovalue, cell));
    const number = (node: number): number => {
      const name = nameOf(tables, drawn.tile.interior, cell, node);
      let found = names.get(name);
      if (found === undefined) {
        found = swept.points.push(drawn.points[node].map((x, axis) => x + cell[axis]) as Point) - 1;
        names.set(name, found);
      }
      return found;
    };
    const { triangles } = drawn.tile;
    for (let i = 0; i < triangles.length; i += 3) {
      swept.triangles.push([number(triangles[i]), number(triangles[i + 1]), number(triangles[i + 2])]);
      swept.cells.push(n);
    }
  }
  return swept;
}

/** A name that all cells at an edge, or at the diagonal of a face, give to the crossing there. */
function nameOf(tables: Tables, interior: readonly unknown[][], cell: Point, node: number): string {
  const one = node < 12 ? ["pair", ...tables.edges[node]] : interior[node - 12];
  if (one[0] !== "pair") return `${cell} ${node}`;
  const [a, b] = [one[1], one[2]].map((c) => tables.corners[c as number].map((x, axis) => x + cell[axis]));
  return `${a}-${b}`;
}

/** The edges that one triangle has and no other in reverse, off the lattice's border. */
export function openEdges(swept: Swept, shape: Point): [Point, Point][] {
  const seen = new Map<number, number>();
  const size = swept.points.length;
  for (const triangle of swept.triangles)
    for (let i = 0; i < 3; i++) {
      const [a, b] = [triangle[i], triangle[(i + 1) % 3]];
      const name = Math.min(a, b) * size + Math.max(a, b);
      seen.set(name, (seen.get(name) ?? 0) + 1);
    }
  const open: [Point, Point][] = [];
  for (const [name, count] of seen) {
    const [p, q] = [swept.points[Math.floor(name / size)], swept.points[name % size]];
    const border = [0, 1, 2].some((axis) => p[axis] === q[axis] && (p[axis] === 0 || p[axis] === shape[axis] - 1));
    if (count % 2 === 1 && !border) open.push([p, q]);
  }
  return open;
}

/** The numbers of the cells that a rule gets wrong, and how many the surface passes. */
export function wrongCells(tables: Tables, rule: Rule, grid: Grid, isovalue: number): { wrong: number[]; active: number } {
  const truth = tables.rules.get("trilinear-cubes")!;
  const wrong: number[] = [];
  let active = 0;
  for (let n = 0; n < cellCount(grid); n++) {
    const g = corners(tables, grid, isovalue, cellAt(n, grid.shape));
    if (g.every((x) => x >= 0) || g.every((x) => x < 0)) continue;
    active++;
    const signs = signsOf(g);
    const [mine, right] = [rule, truth].map((one) => one.tile(signs, decide(tables, one.compares, g)));
    if (mine.separated !== right.separated || mine.tunnel !== right.tunnel) wrong.push(n);
  }
  return { wrong, active };
}
