/* Marching cubes in C, the example of the kit: put your own extractor in its place.
 *
 * A sample is inside where it is at least the isovalue. Each pattern of inside corners has its
 * triangles in TRIANGLES (table.h), which cuts the inside corners of an ambiguous face apart, on
 * every face alike: so the surface is closed. A vertex belongs to a lattice edge, named by the
 * sample at its lower end and its axis, and is made by the first cell that asks for it. */
#include "isograde.h"
#include "table.h"

/* Where between two samples, one inside, the line through both takes the isovalue: 0 to 1. Low and
 * high are the samples minus the isovalue. */
static double crossing(double low, double high) {
    return low == 0 ? 0 : 1 / (1 - high / low);
}

static const char *extract(const isograde_values *values, const size_t shape[3], double isovalue,
                           const double spacing[3], isograde_mesh *mesh) {
    const size_t stride[3] = {shape[1] * shape[2], shape[2], 1};
    if (values->count == 0) return "there are no samples";
    for (size_t i = 0; i < values->count; i++)
        if (!isfinite(isograde_at(values, i) - isovalue))
            return "a sample minus the isovalue is no finite number";

    /* The vertex on each lattice edge, counted from 1; 0 where there is none. */
    int64_t *vertex = calloc(3 * values->count, sizeof *vertex);
    if (!vertex) return "out of memory";
    size_t cell[3];
    for (cell[0] = 0; cell[0] + 1 < shape[0]; cell[0]++)
        for (cell[1] = 0; cell[1] + 1 < shape[1]; cell[1]++)
            for (cell[2] = 0; cell[2] + 1 < shape[2]; cell[2]++) {
                /* Read the samples at the corners; bit a of c is a step along axis a. */
                size_t corner[8];
                double level[8];
                int signs = 0;
                for (int c = 0; c < 8; c++) {
                    corner[c] = 0;
                    for (int a = 0; a < 3; a++) corner[c] += (cell[a] + (c >> a & 1)) * stride[a];
                    level[c] = isograde_at(values, corner[c]) - isovalue;
                    signs |= (level[c] >= 0) << c;
                }

                /* Copy the triangles of these signs; make the vertices that are not there yet. */
                for (const char *letter = TRIANGLES[signs]; *letter; letter += 3) {
                    int64_t triangle[3];
                    for (int k = 0; k < 3; k++) {
                        const int edge = letter[k] - 'a', axis = edge / 4;
                        const int low = LOWER[edge], high = low | 1 << axis;
                        int64_t *name = &vertex[3 * corner[low] + (size_t)axis];
                        if (!*name) {
                            double at[3];
                            for (int a = 0; a < 3; a++) at[a] = (double)(cell[a] + (low >> a & 1));
                            at[axis] += crossing(level[low], level[high]);
                            for (int a = 0; a < 3; a++) at[a] *= spacing[a];
                            *name = 1 + isograde_vertex(mesh, at[0], at[1], at[2]);
                        }
                        triangle[k] = *name - 1;
                    }
                    isograde_triangle(mesh, triangle[0], triangle[1], triangle[2]);
                }
            }
    free(vertex);
    return NULL;
}

int main(void) {
    return isograde_serve("{\"name\": \"marching cubes in C\", \"version\": \"1\"}", extract);
}
