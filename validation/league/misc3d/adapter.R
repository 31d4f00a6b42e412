# misc3d: contour surfaces of an array; it counts from 1.
suppressPackageStartupMessages(library(misc3d))

# Triangles that each have their own three vertices.
surface <- function(values, isovalue, spacing) {
  if (!is.finite(isovalue) || max(values) <= isovalue || min(values) > isovalue)
    return(list(vertices = matrix(0, 0, 3), triangles = matrix(0L, 0, 3)))
  axes <- lapply(1:3, function(a) (seq_len(dim(values)[a]) - 1) * spacing[a])
  corners <- computeContour3d(values, max(values), isovalue, axes[[1]], axes[[2]], axes[[3]])
  list(vertices = corners,
       triangles = matrix(seq_len(nrow(corners)) - 1L, ncol = 3, byrow = TRUE))
}
