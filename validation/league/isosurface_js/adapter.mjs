// isosurface: three methods that ask a function for the samples; negative is inside.
import isosurface from "isosurface";
import { number } from "./isograde.mjs";

/** The mesh in samples; cells or faces of more than three corners are polygons. */
export function surface(values, shape, isovalue, spacing, { method }) {
  const sample = (x, y, z) => isovalue - number(values[(x * shape[1] + y) * shape[2] + z]);
  const { positions, cells } = isosurface[method](shape, sample);
  return { vertices: positions, triangles: cells };
}
