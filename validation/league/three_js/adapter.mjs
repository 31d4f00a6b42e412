// three.js: MarchingCubes of its examples, made for metaballs; it leaves out the outer layer.
import { MeshBasicMaterial } from "three";
import { MarchingCubes } from "three/examples/jsm/objects/MarchingCubes.js";
import { number } from "./isograde.mjs";

/** Triangles that each have their own three vertices, in samples. */
export function surface(values, shape, isovalue) {
  const n = shape[0];
  const cubes = new MarchingCubes(n, new MeshBasicMaterial(), false, false, 5 * n ** 3);
  for (let x = 0; x < n; x++)
    for (let y = 0; y < n; y++)
      for (let z = 0; z < n; z++) cubes.setCell(x, y, z, number(values[(x * n + y) * n + z]));
  cubes.isolation = isovalue;
  cubes.update();
  const vertices = [];
  const triangles = [];
  for (let at = 0; at < cubes.count; at++) {
    const place = Array.from(cubes.positionArray.slice(3 * at, 3 * at + 3));
    vertices.push(place.map((p) => ((p + 1) * n) / 2));
    if (at % 3 === 2) triangles.push([at - 2, at - 1, at]);
  }
  return { vertices, triangles };
}
