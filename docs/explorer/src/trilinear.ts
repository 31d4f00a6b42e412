/*
The trilinear interpolant of a cell itself: its saddles, its contours on the faces, its surface.

F = k0 + k1 x + k2 y + k4 z + k3 xy + k5 xz + k6 yz + k7 xyz, the coefficients numbered by the bits
of their variables. Values are relative, minus the isovalue.

    body saddles    where all three derivatives vanish: with x = X - k6/k7 and so on,
                    F = k7 XYZ + a X + b Y + c Z + d, and k7 XYZ = P k7 = -a X = -b Y = -c Z,
                    so that P^2 = -a b c / k7^3: two saddles, or none
    events          isovalues at which the topology in the cell can change: corners, saddles of
                    faces and of the body that lie in them
*/

import { interpolate } from "./cell.ts";
import { type Point, type Tables } from "./tables.ts";

/** k0 .. k7 of values at the corners. */
export function coefficients(g: readonly number[]): number[] {
  const k = [...g];
  for (const axis of [0, 1, 2])
    for (let c = 0; c < 8; c++) if ((c >> axis) & 1) k[c] -= k[c ^ (1 << axis)];
  return k;
}

export interface Saddle {
  point: Point;
  value: number;
}

/** The two critical points of F, wherever they are; none where there are not two. */
export function bodySaddles(g: readonly number[]): Saddle[] {
  const k = coefficients(g);
  const size = Math.max(...k.map(Math.abs));
  if (Math.abs(k[7]) <= 1e-9 * size) return [];
  const [dx, dy, dz] = [k[6] / k[7], k[5] / k[7], k[3] / k[7]];
  const a = k[1] - (k[3] * k[5]) / k[7];
  const b = k[2] - (k[3] * k[6]) / k[7];
  const c = k[4] - (k[5] * k[6]) / k[7];
  const square = (-a * b * c) / k[7] ** 3;
  if (!(square > 0)) return [];
  return [1, -1].map((side) => {
    const P = side * Math.sqrt(square);
    const [X, Y, Z] = [a, b, c].map((slope) => (-k[7] * P) / slope);
    const point: Point = [X - dx, Y - dy, Z - dz];
    return { point, value: interpolate(g, point) };
  });
}

export function isInside(point: Point): boolean {
  return point.every((x) => x > 0 && x < 1);
}

/** Which corners make a face's bilinear interpolant: along s, along t. */
function frame(tables: Tables, f: number): { origin: Point; s: Point; t: Point } {
  const [a, b, , d] = tables.faceCorners[f].map((corner) => tables.corners[corner]);
  const less = (p: Point, q: Point) => p.map((x, axis) => x - q[axis]) as Point;
  return { origin: a, s: less(b, a), t: less(d, a) };
}

/** A point of a face. */
function onFace({ origin, s, t }: ReturnType<typeof frame>, u: number, v: number): Point {
  return origin.map((x, axis) => x + u * s[axis] + v * t[axis]) as Point;
}

/** The saddle of a face's bilinear interpolant, where it has one in the face. */
export function faceSaddle(tables: Tables, g: readonly number[], f: number): (Saddle & { s: number; t: number }) | null {
  const [a, b, c, d] = tables.faceCorners[f].map((corner) => g[corner]);
  const D = a - d + (c - b);
  const [s, t] = [(a - d) / D, (a - b) / D];
  if (!(s > 0 && s < 1 && t > 0 && t < 1)) return null;
  return { s, t, point: onFace(frame(tables, f), s, t), value: (a * c - b * d) / D };
}

/** The asymptotes of a face with a saddle: two segments across the face. */
export function asymptotes(tables: Tables, g: readonly number[], f: number): [Point, Point][] {
  const saddle = faceSaddle(tables, g, f);
  if (!saddle) return [];
  const of = frame(tables, f);
  return [
    [onFace(of, saddle.s, 0), onFace(of, saddle.s, 1)],
    [onFace(of, 0, saddle.t), onFace(of, 1, saddle.t)],
  ];
}

/** The contour F = 0 on a face: pieces of hyperbolas, each a row of points. */
export function contour(tables: Tables, g: readonly number[], f: number, steps = 24): Point[][] {
  const [a, b, c, d] = tables.faceCorners[f].map((corner) => g[corner]);
  const of = frame(tables, f);
  const pieces: Point[][] = [];
  // t as a function of s between the places where it leaves the face or has its pole.
  const low = (s: number) => a + s * (b - a);
  const high = (s: number) => d + s * (c - d);
  const breaks = [0, 1, a / (a - b), d / (d - c), (a - d) / (a - d + (c - b))];
  const cuts = [...new Set(breaks.filter((s) => s >= 0 && s <= 1))].sort((p, q) => p - q);
  for (let i = 0; i + 1 < cuts.length; i++) {
    const [from, to] = [cuts[i], cuts[i + 1]];
    const middle = (from + to) / 2;
    if (low(middle) >= 0 === high(middle) >= 0) continue;
    const piece: Point[] = [];
    for (let n = 0; n <= steps; n++) {
      // Nearer steps at both ends, where a hyperbola is steep.
      const s = from + ((1 - Math.cos((Math.PI * n) / steps)) / 2) * (to - from);
      const gap = low(s) - high(s);
      const t = gap === 0 ? 0.5 : Math.min(1, Math.max(0, low(s) / gap));
      piece.push(onFace(of, s, t));
    }
    const last = pieces.at(-1);
    // Two rows that meet are one.
    if (last && last.at(-1)!.every((x, axis) => Math.abs(x - piece[0][axis]) < 1e-9)) last.push(...piece.slice(1));
    else pieces.push(piece);
  }
  return pieces;
}

export interface Event {
  isovalue: number;
  kind: "corner" | "face saddle" | "body saddle";
  where: number;
}

/** The isovalues at which the topology in the cell can change, in order; for plain values. */
export function events(tables: Tables, values: readonly number[]): Event[] {
  const found: Event[] = values.map((isovalue, where) => ({ isovalue, kind: "corner", where }));
  tables.faceCorners.forEach((_, where) => {
    const saddle = faceSaddle(tables, values, where);
    if (saddle) found.push({ isovalue: saddle.value, kind: "face saddle", where });
  });
  bodySaddles(values).forEach(({ point, value }, where) => {
    if (isInside(point)) found.push({ isovalue: value, kind: "body saddle", where });
  });
  return found.sort((p, q) => p.isovalue - q.isovalue);
}

/** Triangles with normals, in arrays that are used again. */
export interface Surface {
  positions: Float32Array;
  normals: Float32Array;
  index: Uint32Array;
  vertices: number;
  indices: number;
}

/*
The fine surface: the cell in n^3 small cells, each drawn by VESTA's tiles (disconnect, L), which
need no decisions and no interior points. Along an axis F is linear, so all vertices are on the
surface exactly; normals are gradients.
*/
export class Tessellator {
  readonly surface: Surface;
  private readonly values: Float64Array;
  private readonly vertex: Int32Array;
  private readonly tiles: number[][];
  private readonly offsets: number[];
  private readonly edges: [number, number][];

  constructor(tables: Tables, readonly n = 24) {
    const side = n + 1;
    this.values = new Float64Array(side ** 3);
    this.vertex = new Int32Array(3 * side ** 3);
    const rule = tables.rules.get("marching-vesta-disconnect-L")!;
    this.tiles = Array.from({ length: 256 }, (_, signs) => rule.tile(signs, 0).triangles);
    this.offsets = tables.corners.map(([i, j, k]) => (i * side + j) * side + k);
    this.edges = tables.edges.map(([low], e) => [this.offsets[low], Math.floor(e / 4)]);
    const most = 12 * n * n;
    this.surface = {
      positions: new Float32Array(9 * most),
      normals: new Float32Array(9 * most),
      index: new Uint32Array(18 * most),
      vertices: 0,
      indices: 0,
    };
  }

  /** The level set F = 0 in the cell. */
  draw(g: readonly number[]): Surface {
    const { n, values, vertex, surface, offsets, tiles, edges } = this;
    const side = n + 1;
    const k = coefficients(g);
    surface.vertices = surface.indices = 0;
    vertex.fill(-1);
    for (let i = 0, at = 0; i < side; i++)
      for (let j = 0; j < side; j++) {
        const x = i / n;
        const y = j / n;
        const constant = k[0] + k[1] * x + k[2] * y + k[3] * x * y;
        const slope = (k[4] + k[5] * x + k[6] * y + k[7] * x * y) / n;
        for (let l = 0; l < side; l++) values[at++] = constant + slope * l;
      }
    for (let i = 0; i < n; i++)
      for (let j = 0; j < n; j++)
        for (let l = 0; l < n; l++) {
          const base = (i * side + j) * side + l;
          let signs = 0;
          for (let c = 0; c < 8; c++) if (values[base + offsets[c]] >= 0) signs |= 1 << c;
          if (signs === 0 || signs === 255) continue;
          for (const e of tiles[signs]) {
            const [offset, axis] = edges[e];
            surface.index[surface.indices++] = this.vertexOn(base + offset, axis, k);
          }
        }
    return surface;
  }

  /** The number of the vertex on an edge of the small lattice. */
  private vertexOn(from: number, axis: number, k: number[]): number {
    const at = 3 * from + axis;
    if (this.vertex[at] >= 0) return this.vertex[at];
    const { n, values, surface } = this;
    const side = n + 1;
    const step = axis === 0 ? side * side : axis === 1 ? side : 1;
    const t = values[from] / (values[from] - values[from + step]);
    const p = [Math.floor(from / (side * side)) / n, (Math.floor(from / side) % side) / n, (from % side) / n];
    p[axis] += t / n;
    const [x, y, z] = p;
    const gradient = [
      k[1] + k[3] * y + k[5] * z + k[7] * y * z,
      k[2] + k[3] * x + k[6] * z + k[7] * x * z,
      k[4] + k[5] * x + k[6] * y + k[7] * x * y,
    ];
    const length = Math.hypot(...gradient) || 1;
    const place = 3 * surface.vertices;
    for (let a = 0; a < 3; a++) {
      surface.positions[place + a] = p[a];
      surface.normals[place + a] = -gradient[a] / length;
    }
    return (this.vertex[at] = surface.vertices++);
  }
}
