% Octave: isosurface, whose first coordinate is the second axis; given the coordinates it needs.
function [vertices, triangles] = adapter (values, isovalue, spacing)
  n = size (values);
  n(end+1:3) = 1;
  [x, y, z] = meshgrid ((0:n(2)-1) * spacing(2), (0:n(1)-1) * spacing(1), (0:n(3)-1) * spacing(3));
  if (islogical (values))
    values = uint8 (values);
  endif
  surface = isosurface (x, y, z, values, isovalue);
  vertices = zeros (0, 3);
  triangles = zeros (0, 3);
  if (! isempty (surface.vertices))
    vertices = surface.vertices(:, [2 1 3]);
    triangles = surface.faces;
  endif
endfunction
