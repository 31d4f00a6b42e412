// vtk.js: vtkImageMarchingCubes of an image whose first axis is fastest.
import "@kitware/vtk.js/Common/DataModel/PolyData.js";
import vtkDataArray from "@kitware/vtk.js/Common/Core/DataArray.js";
import vtkImageData from "@kitware/vtk.js/Common/DataModel/ImageData.js";
import vtkImageMarchingCubes from "@kitware/vtk.js/Filters/General/ImageMarchingCubes.js";
import { number } from "./isograde.mjs";

/** The mesh, merged by the filter or not. */
export function surface(values, shape, isovalue, spacing, { merge }) {
  const [nx, ny, nz] = shape;
  const samples = new Float64Array(values.length);
  for (let x = 0; x < nx; x++)
    for (let y = 0; y < ny; y++)
      for (let z = 0; z < nz; z++)
        samples[x + nx * (y + ny * z)] = number(values[(x * ny + y) * nz + z]);
  const image = vtkImageData.newInstance({ spacing });
  image.setDimensions(nx, ny, nz);
  const scalars = vtkDataArray.newInstance({ name: "values", values: samples });
  image.getPointData().setScalars(scalars);
  const filter = vtkImageMarchingCubes.newInstance({ contourValue: isovalue, mergePoints: merge });
  filter.setInputData(image);
  filter.update();
  const mesh = filter.getOutputData();
  return { vertices: rows(mesh.getPoints().getData(), 3), triangles: corners(mesh.getPolys().getData()) };
}

/** Rows of so many numbers. */
function rows(flat, width) {
  const found = [];
  for (let at = 0; at < flat.length; at += width) found.push(Array.from(flat.slice(at, at + width)));
  return found;
}

/** The corners of each polygon, which the list counts first. */
function corners(flat) {
  return rows(flat, 4).map(([, ...row]) => row);
}
