// Marching cubes in JavaScript, the example of the kit: put your own extractor in its place.
//
// A sample is inside where it is at least the isovalue. Each pattern of inside corners has its
// triangles in TRIANGLES (table.mjs), which cuts the inside corners of an ambiguous face apart, on
// every face alike: so the surface is closed. A vertex belongs to a lattice edge, named by the
// sample at its lower end and its axis, and is made by the first cell that asks for it.
import { number, serve } from "./isograde.mjs";
import { LOWER, TRIANGLES } from "./table.mjs";

/**
 * Where between two samples, one inside, the line through both takes the isovalue: 0 to 1.
 * @param {number} low the sample at the lower end minus the isovalue
 * @param {number} high the sample at the upper end minus the isovalue
 */
function crossing(low, high) {
  return low === 0 ? 0 : 1 / (1 - high / low);
}

/** @type {import("./isograde.mjs").Extract} */
function extract(values, shape, isovalue, spacing) {
  if (values.length === 0) throw new Error("there are no samples");
  for (const value of values)
    if (!Number.isFinite(number(value) - isovalue))
      throw new Error("a sample minus the isovalue is no finite number");

  /** @type {import("./isograde.mjs").Mesh} */
  const { vertices, triangles } = { vertices: [], triangles: [] };
  const stride = [shape[1] * shape[2], shape[2], 1];
  // The vertex on each lattice edge, counted from 1; 0 where there is none.
  const vertex = new Uint32Array(3 * values.length);
  const corner = new Array(8);
  const level = new Array(8);
  for (let x = 0; x + 1 < shape[0]; x++)
    for (let y = 0; y + 1 < shape[1]; y++)
      for (let z = 0; z + 1 < shape[2]; z++) {
        // Read the samples at the corners; bit a of c is a step along axis a.
        /** @param {number} c */
        const place = (c) => [x + (c & 1), y + ((c >> 1) & 1), z + ((c >> 2) & 1)];
        let signs = 0;
        for (let c = 0; c < 8; c++) {
          corner[c] = place(c).reduce((sum, i, a) => sum + i * stride[a], 0);
          level[c] = number(values[corner[c]]) - isovalue;
          if (level[c] >= 0) signs |= 1 << c;
        }

        // Copy the triangles of these signs; make the vertices that are not there yet.
        const letters = TRIANGLES[signs];
        for (let start = 0; start < letters.length; start += 3) {
          const corners = [0, 1, 2].map((k) => {
            const edge = letters.charCodeAt(start + k) - "a".charCodeAt(0);
            const low = LOWER[edge];
            const axis = edge >> 2;
            const name = 3 * corner[low] + axis;
            if (vertex[name] === 0) {
              const at = place(low);
              at[axis] += crossing(level[low], level[low | (1 << axis)]);
              const [i, j, k] = at.map((step, a) => step * spacing[a]);
              vertex[name] = vertices.push([i, j, k]);
            }
            return vertex[name] - 1;
          });
          triangles.push([corners[0], corners[1], corners[2]]);
        }
      }
  return { vertices, triangles };
}

serve({ name: "marching cubes in JavaScript", version: "1" }, extract);
