/*
One cell: where the nodes of a tile stand, and what a rule makes of eight values.

References: isoref.sweep (crossings), isoref.asymptotic_decider (e0), isoref.trilinear_cubes (the
waist, points on the level set), isoref.rule (averages).
*/

import { decide, integers, quadratic, sign, signsOf } from "./decisions.ts";
import { nodes, type Placement, type Point, type Rule, type Tables, type Tile } from "./tables.ts";

const HALVINGS = 60;

export interface Drawn {
  signs: number;
  decisions: number;
  tile: Tile;
  /** By node; nodes of edges that are not crossed are missing. */
  points: Point[];
}

/** What a rule makes of a cell, in its own coordinates, 0 to 1 on each axis. */
export function draw(tables: Tables, rule: Rule, g: readonly number[]): Drawn {
  const signs = signsOf(g);
  const decisions = decide(tables, rule.compares, g);
  const tile = rule.tile(signs, decisions);
  const points: Point[] = [];
  tables.edges.forEach(([a, b], e) => {
    if (g[a] >= 0 !== g[b] >= 0) points[e] = crossing(tables, g, a, b);
  });
  tile.interior.forEach((one, i) => (points[12 + i] = place(tables, one, g, points)));
  return { signs, decisions, tile, points };
}

/** Where on an edge the linear interpolant vanishes, from its first end to its second. */
export function parameter(low: number, high: number): number {
  const gap = low - high;
  if (gap === 0) return 0;
  return Number.isFinite(gap) ? low / gap : (low * 0.5) / (low * 0.5 - high * 0.5);
}

/** The crossing of the segment between two corners. */
function crossing(tables: Tables, g: readonly number[], a: number, b: number): Point {
  const t = parameter(g[a], g[b]);
  return tables.corners[a].map((x, axis) => x + t * (tables.corners[b][axis] - x)) as Point;
}

/** Where an interior point stands. */
function place(tables: Tables, one: Placement, g: readonly number[], points: Point[]): Point {
  switch (one[0]) {
    case "average":
      return mean(nodes(one[1]).map((node) => points[node]));
    case "surface":
      return onSurface(tables, g, mean(nodes(one[1]).map((node) => points[node])));
    case "saddles":
      return betweenSaddles(tables, g, one[1], one[2]);
    case "diagonal":
      return onDiagonal(tables, g, one[1]);
    case "waist":
      return onWaist(g, one[1], one[2]);
    case "pair":
      return crossing(tables, g, one[1], one[2]);
  }
}

export function mean(points: Point[]): Point {
  const sum = [0, 0, 0];
  for (const point of points) point.forEach((x, axis) => (sum[axis] += x));
  return sum.map((x) => x / points.length) as Point;
}

/** F at a point, for values at the corners. */
export function interpolate(g: readonly number[], p: Point): number {
  let values = [...g];
  for (const axis of [2, 1, 0]) {
    const half = values.length / 2;
    values = values.slice(0, half).map((low, i) => low * (1 - p[axis]) + values[half + i] * p[axis]);
  }
  return values[0];
}

/** The saddle of an ambiguous face in the cell's coordinates, and F there. */
export function saddlePoint(tables: Tables, g: readonly number[], f: number): [Point, number] {
  const walk = tables.faceCorners[f];
  // Scale, so that no sum or product overflows or vanishes.
  const size = Math.max(...walk.map((corner) => Math.abs(g[corner]))) || 1;
  const [a, b, c, d] = walk.map((corner) => g[corner] / size);
  const D = a - d + (c - b);
  const [S, T] = [(a - d) / D, (a - b) / D];
  const [origin, alongS, , alongT] = walk.map((corner) => tables.corners[corner]);
  const point = origin.map((x, axis) => x + S * (alongS[axis] - x) + T * (alongT[axis] - x));
  return [point as Point, ((a * c - b * d) / D) * size];
}

/** e0 of 10B and 10D: on the line that joins the saddles of two faces. */
function betweenSaddles(tables: Tables, g: readonly number[], top: number, bottom: number): Point {
  const [p, high] = saddlePoint(tables, g, top);
  const [q, low] = saddlePoint(tables, g, bottom);
  const u = high === low ? 0.5 : Math.min(1, Math.max(0, high / (high - low)));
  return p.map((x, axis) => (1 - u) * x + u * q[axis]) as Point;
}

/** e0 of the other variants: where the body diagonal from corner v is crossed. */
function onDiagonal(tables: Tables, g: readonly number[], v: number): Point {
  const u = g[v] / 2 / (g[v] / 2 - g[7 - v] / 2);
  const [from, to] = [tables.corners[v], tables.corners[7 - v]];
  return from.map((x, axis) => (1 - u) * x + u * to[axis]) as Point;
}

/** x / y of whole numbers, rounded once or twice. */
function ratio(x: bigint, y: bigint): number {
  if (y < 0n) return ratio(-x, -y);
  const shift = 64 - x.toString(2).length + y.toString(2).length;
  return Number(shift > 0 ? (x << BigInt(shift)) / y : x / (y << BigInt(-shift))) * 2 ** -shift;
}

/** The lesser and the greater root of q along an axis of a tunnel cell, in [0, 1]. */
export function roots(g: readonly bigint[], axis: number): [number, number] {
  const [c0, c1, c2] = quadratic(g, axis);
  // Scale to about 1, and no further digit is lost: c0 and c2 have one sign, c1 the other.
  const size = [c0, c1, c2].reduce((most, c) => (c < 0n ? -c : c) > most ? (c < 0n ? -c : c) : most, 1n);
  const D = Math.max(0, ratio(c1 * c1 - 4n * c0 * c2, size * size));
  const [a, b, c] = [c0, c1, c2].map((x) => ratio(x, size));
  const half = (2 * a - b + Math.sqrt(D) * (a < 0 ? -1 : 1)) / 2;
  const found = [half / (a - b + c), a / half].map((t) => Math.min(1, Math.max(0, t)));
  return [Math.min(...found), Math.max(...found)];
}

/** One corner of the hexagon, of the box between the roots; `swap` is flipped at a pole. */
export function onWaist(values: readonly number[], corner: number, swap: number): Point {
  const g = integers(values);
  // The signs of c0 on axes 1 and 2 tell on which diagonal of the box the poles are.
  const pole = (sign(quadratic(g, 2)[0]) > 0 ? 2 : 0) | (sign(quadratic(g, 1)[0]) > 0 ? 4 : 0);
  const at = pole === corner || pole === 7 - corner ? corner ^ swap : corner;
  return [0, 1, 2].map((axis) => roots(g, axis)[(at >> axis) & 1]) as Point;
}

/** A point on the level set near this one, on the way to a corner of the other side. */
function onSurface(tables: Tables, g: readonly number[], from: Point): Point {
  const here = interpolate(g, from) >= 0;
  let best = from;
  let least = Infinity;
  tables.corners.forEach((corner, c) => {
    if (g[c] >= 0 === here) return;
    const way = corner.map((x, axis) => x - from[axis]);
    const at = (t: number) => from.map((x, axis) => x + t * way[axis]) as Point;
    let [near, far] = [0, 1];
    for (let step = 0; step < HALVINGS; step++) {
      const half = (near + far) / 2;
      if (interpolate(g, at(half)) >= 0 === here) near = half;
      else far = half;
    }
    const found = at(near);
    const distance = found.reduce((sum, x, axis) => sum + (x - from[axis]) ** 2, 0);
    if (distance < least) [best, least] = [found, distance];
  });
  return best;
}
