// surface-nets: a dual method in any dimension.
import ndarray from "ndarray";
import surfaceNets from "surface-nets";
import { number } from "./isograde.mjs";

/** The mesh in samples. */
export function surface(values, shape, isovalue) {
  const samples = Float64Array.from(values, number);
  const { positions, cells } = surfaceNets(ndarray(samples, shape), isovalue);
  return { vertices: positions, triangles: cells };
}
