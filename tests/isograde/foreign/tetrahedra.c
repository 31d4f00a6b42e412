/* Marching tetrahedra in C, behind the adapter exec: -- each cell is cut into the six tetrahedra
 * round its main diagonal. `isograde explain exec` has the protocol. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int n[3], (*faces)[3];
static double *f, iso, h[3], (*points)[3];
static long V, F, *seen; /* seen: number of the vertex on an edge, by its lower end and direction */

static long at(const int *p) { return ((long)p[0] * n[1] + p[1]) * n[2] + p[2]; }
/* The vertex where the edge a-b crosses the isovalue, made when it is met first. */
static int crossing(const int *a, const int *b) {
    if (at(a) > at(b)) return crossing(b, a);
    long *id = seen + 8 * at(a) + 4 * (b[0] - a[0]) + 2 * (b[1] - a[1]) + b[2] - a[2];
    double t = (iso - f[at(a)]) / (f[at(b)] - f[at(a)]);
    if (*id) return *id - 1;
    for (int k = 0; k < 3; k++) points[V][k] = (a[k] + t * (b[k] - a[k])) * h[k];
    return (*id = ++V) - 1;
}
static void face(int odd, int a, int b, int c) {
    faces[F][0] = a, faces[F][1] = odd ? c : b, faces[F++][2] = odd ? b : c;
}
static void tetrahedron(int *v[4], int odd) {
    int *in[4], *out[4], i = 0, o = 0;
    for (int k = 0; k < 4; k++) /* a permutation: insiders first; count its inversions */
        if (f[at(v[k])] >= iso) in[i++] = v[k], odd += o; else out[o++] = v[k];
#define X(p, q) crossing(in[p], out[q])
    if (i == 1) face(odd & 1, X(0, 0), X(0, 1), X(0, 2));
    if (i == 3) face(odd & 1, X(0, 0), X(1, 0), X(2, 0));
    if (i == 2) face(odd & 1, X(0, 0), X(0, 1), X(1, 1)), face(odd & 1, X(0, 0), X(1, 1), X(1, 0));
}
static void cell(int x, int y, int z) {
    for (int a = 0; a < 3; a++) for (int b = 0; b < 3; b++) if (a != b) {
        int c[4][3] = {{x, y, z}, {x, y, z}, {x, y, z}, {x + 1, y + 1, z + 1}};
        c[1][a]++, c[2][a]++, c[2][b]++;
        tetrahedron((int *[]){c[0], c[1], c[2], c[3]}, (b - a + 3) % 3 != 1);
    }
}
/* Why the request cannot be met, or nothing once its samples are read. */
static const char *samples(const char *line, long *id) {
    char path[4096]; long offset;
    if (sscanf(line, "{\"command\": \"run\", \"id\": %ld, \"dtype\": \"<f8\", \"shape\": [%d, %d, %d],"
               " \"components\": 1, \"spacing\": [%lf, %lf, %lf], \"isovalues\": [%lf],"
               " \"offset\": %ld, \"values\": \"%4095[^\"]",
               id, n, n + 1, n + 2, h, h + 1, h + 2, &iso, &offset, path) < 10)
        return "\"unsupported\": \"reads float64 in three dimensions only\"";
    size_t size = (size_t)n[0] * n[1] * n[2];
    FILE *file = fopen(path, "rb");
    free(seen), seen = calloc(size, 8 * sizeof *seen), f = realloc(f, size * sizeof *f);
    points = realloc(points, 7 * size * sizeof *points);
    faces = realloc(faces, 12 * size * sizeof *faces);
    if (!file || fseek(file, offset, SEEK_SET) || fread(f, sizeof *f, size, file) != size)
        return "\"error\": \"the file of samples is too short\"";
    fclose(file);
    for (size_t k = 0; k < size; k++) if (f[k] != f[k]) return "\"error\": \"a sample is NaN\"";
    return size && iso == iso ? NULL : "\"error\": \"no samples, or the isovalue is NaN\"";
}
int main(void) {
    static char line[1 << 16];
    while (fgets(line, sizeof line, stdin) && !strstr(line, "\"stop\"")) {
        const char *why; long id = V = F = 0;
        if (strstr(line, "\"start\"")) printf("{\"protocol\": 3, \"declaration\": {\"name\": "
            "\"tetrahedra in C\", \"interpolant\": \"kuhn\"}}\n");
        else if ((why = samples(line, &id))) printf("{\"id\": %ld, %s}\n", id, why);
        else {
            for (int x = 0; x + 1 < n[0]; x++) for (int y = 0; y + 1 < n[1]; y++)
                for (int z = 0; z + 1 < n[2]; z++) cell(x, y, z);
            printf("{\"id\": %ld, \"vertices\": [", id);
            for (long k = 0; k < V; k++) printf("%s[%.17g, %.17g, %.17g]", k ? ", " : "",
                                                points[k][0], points[k][1], points[k][2]);
            printf("], \"simplices\": [");
            for (long k = 0; k < F; k++) printf("%s[%d, %d, %d]", k ? ", " : "",
                                                faces[k][0], faces[k][1], faces[k][2]);
            printf("]}\n");
        }
        fflush(stdout);
    }
}
