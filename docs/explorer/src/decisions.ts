/*
The numbers that a rule compares, as isoref compares them: exactly.

Values g at the corners are relative, minus the isovalue; inside is g >= 0. The asymptotic decider
and the tunnel are signs of polynomials in the eight values. They are worked out in whole numbers of
any length, so that nothing is rounded; the mean of VESTA is a sum of floats, in isoref's order.

References: isoref.asymptotic_decider, isoref.trilinear_cubes, isoref.marching_vesta.
*/

import { type Compares, type Tables } from "./tables.ts";

export const INSIDE_TUNNEL = 64;
export const OUTSIDE_TUNNEL = 128;

const view = new DataView(new ArrayBuffer(8));

/** Finite numbers exactly, all times one power of two. */
export function integers(values: readonly number[]): bigint[] {
  const parts = values.map((value) => {
    view.setFloat64(0, value);
    const bits = view.getBigUint64(0);
    const exponent = Number((bits >> 52n) & 0x7ffn);
    const fraction = bits & 0xfffffffffffffn;
    const mantissa = exponent ? fraction | (1n << 52n) : fraction;
    return { mantissa: value < 0 ? -mantissa : mantissa, exponent: Math.max(exponent, 1) };
  });
  const least = Math.min(...parts.map((part) => (part.mantissa ? part.exponent : 2047)));
  return parts.map((part) => (part.mantissa ? part.mantissa << BigInt(part.exponent - least) : 0n));
}

export function sign(x: bigint): number {
  return x > 0n ? 1 : x < 0n ? -1 : 0;
}

/** The signs of a cell. */
export function signsOf(g: readonly number[]): number {
  return g.reduce((signs, value, c) => signs | (value >= 0 ? 1 << c : 0), 0);
}

/** The decisions of a rule on a cell; 0 where its signs leave nothing open. */
export function decide(tables: Tables, compares: Compares, g: readonly number[]): number {
  const signs = signsOf(g);
  const open = tables.ambiguous[signs].length > 0;
  if (compares === "faces" && open) return faceBits(tables, g);
  if (compares === "mean" && open) return meanBits(tables, g);
  if (compares === "trilinear" && (open || tables.configurations[signs][0] === 4))
    return faceBits(tables, g) | tunnelBit(g);
  return 0;
}

/** Bit f is set where face f is ambiguous and its saddle is below the isovalue. */
export function faceBits(tables: Tables, g: readonly number[]): number {
  let bits = 0;
  for (const f of tables.ambiguous[signsOf(g)]) {
    const walk = tables.faceCorners[f].map((corner) => g[corner]);
    const [a, b, c, d] = integers(walk);
    if (walk[0] >= 0 ? a * c < b * d : b * d < a * c) bits |= 1 << f;
  }
  return bits;
}

/** Bit f is set where face f is ambiguous and the mean of its values is below the isovalue. */
export function meanBits(tables: Tables, g: readonly number[]): number {
  let bits = 0;
  for (const f of tables.ambiguous[signsOf(g)]) {
    const [a, b, c, d] = tables.faceCorners[f].map((corner) => g[corner]);
    if (!(a + c + (b + d) >= 0)) bits |= 1 << f;
  }
  return bits;
}

/** The corners w00, w10, w01, w11 at one end of an axis. */
export function sliceCorners(axis: number, side: number): number[] {
  const [u, v] = [0, 1, 2].filter((a) => a !== axis);
  return [0, 1, 2, 3].map((k) => (side << axis) | ((k & 1) << u) | ((k >> 1) << v));
}

/** c0, c1, c2 of q(t) = w00 w11 - w10 w01 on slices across an axis, in Bernstein's form. */
export function quadratic(g: readonly bigint[], axis: number): [bigint, bigint, bigint] {
  const w = sliceCorners(axis, 0).map((c) => g[c]);
  const z = sliceCorners(axis, 1).map((c) => g[c]);
  const c0 = w[0] * w[3] - w[1] * w[2];
  const c2 = z[0] * z[3] - z[1] * z[2];
  const c1 = w[0] * z[3] + z[0] * w[3] - (w[1] * z[2] + z[1] * w[2]);
  return [c0, c1, c2];
}

/** 64 where a tunnel joins two inside parts, 128 where it joins two outside parts, else 0. */
export function tunnelBit(values: readonly number[]): number {
  const g = integers(values);
  const quadratics = [0, 1, 2].map((axis) => quadratic(g, axis));
  // All six roots are in the cell, and A B < 0.
  let product = 1;
  for (const [c0, c1, c2] of quadratics) {
    const s0 = sign(c0);
    const both = s0 * sign(c2) > 0 && s0 * sign(c1) < 0 && c1 * c1 - 4n * c0 * c2 > 0n;
    if (!both) return 0;
    product *= s0;
  }
  if (product > 0) return 0;
  return sign(atMiddle(g, quadratics)) > 0 ? INSIDE_TUNNEL : OUTSIDE_TUNNEL;
}

/** F at the middle of the roots, times a positive number. */
function atMiddle(g: readonly bigint[], quadratics: [bigint, bigint, bigint][]): bigint {
  let values = [...g];
  for (const axis of [2, 1, 0]) {
    const [c0, c1, c2] = quadratics[axis];
    const n = 2n * c0 - c1;
    const d = 2n * (c0 - c1 + c2);
    const side = BigInt(sign(d));
    const half = values.length / 2;
    values = values.slice(0, half).map((low, i) => low * (d - n) * side + values[half + i] * n * side);
  }
  return values[0];
}
