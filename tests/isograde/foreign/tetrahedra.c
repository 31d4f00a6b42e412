/* Marching tetrahedra in C, behind the door exec: -- each cell is cut into the six tetrahedra
 * round its main diagonal. Reads requests line by line, answers with a mesh in .off. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int n[3], (*faces)[3];
static double *f, iso, h[3], (*points)[3];
static long V, F, *seen; /* seen: vertex of the edge from a sample, by its direction 1 .. 7 */

static const char *after(const char *line, const char *key) {
    const char *at = strstr(line, key);
    return at ? at + strlen(key) : "";
}
static long at(const int *p) { return ((long)p[0] * n[1] + p[1]) * n[2] + p[2]; }
static int inside(const int *p) { return f[at(p)] >= iso; }
/* The vertex on the edge a-b, made when it is met first. */
static int crossing(const int *a, const int *b) {
    if (at(a) > at(b)) { const int *c = a; a = b; b = c; }
    long *id = seen + 8 * at(a) + 4 * (b[0] - a[0]) + 2 * (b[1] - a[1]) + b[2] - a[2];
    double t = (iso - f[at(a)]) / (f[at(b)] - f[at(a)]);
    if (*id < 0) {
        for (int k = 0; k < 3; k++) points[V][k] = (a[k] + t * (b[k] - a[k])) * h[k];
        *id = V++;
    }
    return *id;
}
static void face(int odd, int a, int b, int c) {
    faces[F][0] = a, faces[F][1] = odd ? c : b, faces[F++][2] = odd ? b : c;
}
static void tetrahedron(int *v[4], int odd) {
    int *in[4], *out[4], i = 0, o = 0;
    for (int k = 0; k < 4; k++) /* a permutation: insiders first; count its inversions */
        if (inside(v[k])) in[i++] = v[k], odd += o; else out[o++] = v[k];
    odd &= 1;
#define X(p, q) crossing(in[p], out[q])
    if (i == 1) face(odd, X(0, 0), X(0, 1), X(0, 2));
    if (i == 3) face(odd, X(0, 0), X(1, 0), X(2, 0));
    if (i == 2) face(odd, X(0, 0), X(0, 1), X(1, 1)), face(odd, X(0, 0), X(1, 1), X(1, 0));
}
static void cell(const int *low) {
    for (int a = 0; a < 3; a++) for (int b = 0; b < 3; b++) if (a != b) {
        int c[4][3], *v[4] = {c[0], c[1], c[2], c[3]};
        for (int k = 0; k < 12; k++) c[k / 3][k % 3] = low[k % 3] + (k > 8);
        c[1][a]++, c[2][a]++, c[2][b]++;
        tetrahedron(v, (b - a + 3) % 3 != 1);
    }
}
/* Why the request cannot be met, or nothing once its samples are read. */
static const char *read_samples(const char *line) {
    char path[4096];
    const char *shape = after(line, "\"shape\": ["), *spacing = after(line, "\"spacing\": [");
    if (strncmp(after(line, "\"dtype\": "), "\"<f8\"", 5)) return "\"unsupported\": \"not float64\"";
    if (sscanf(shape, "%d, %d, %d", &n[0], &n[1], &n[2]) != 3) return "\"error\": \"not 3-D\"";
    if (sscanf(spacing, "%lf, %lf, %lf", &h[0], &h[1], &h[2]) != 3) return "\"error\": \"spacing\"";
    if (sscanf(after(line, "\"values\": \""), "%4095[^\"]", path) != 1) return "\"error\": \"path\"";
    size_t size = (size_t)n[0] * n[1] * n[2];
    iso = atof(after(line, "\"isovalue\": "));
    if (!size || isnan(iso)) return "\"error\": \"no samples, or the isovalue is no number\"";
    f = realloc(f, size * sizeof *f), seen = realloc(seen, 8 * size * sizeof *seen);
    points = realloc(points, 7 * size * sizeof *points), faces = realloc(faces, 12 * size * sizeof *faces);
    FILE *file = fopen(path, "rb");
    fseek(file, atol(after(line, "\"offset\": ")), SEEK_SET);
    if (fread(f, sizeof *f, size, file) != size) return "\"error\": \"the file is too short\"";
    fclose(file);
    for (size_t k = 0; k < size; k++) if (isnan(f[k])) return "\"error\": \"a sample is NaN\"";
    memset(seen, -1, 8 * size * sizeof *seen);
    return NULL;
}
int main(void) {
    static char line[1 << 16];
    while (fgets(line, sizeof line, stdin) && !strstr(line, "\"stop\"")) {
        const char *refused = "\"protocol\": 1, \"declaration\": {\"name\": \"tetrahedra in C\","
                              " \"level\": 1, \"without\": [\"on-edges\"]}";
        if (!strstr(line, "\"start\"") && !(refused = read_samples(line))) {
            V = F = 0;
            for (int p[3] = {0}; p[0] < n[0] - 1; p[0]++)
                for (p[1] = 0; p[1] < n[1] - 1; p[1]++)
                    for (p[2] = 0; p[2] < n[2] - 1; p[2]++) cell(p);
            char path[4096];
            sscanf(after(line, "\"directory\": \""), "%4000[^\"]", path);
            FILE *file = fopen(strcat(path, "/mesh.off"), "w");
            fprintf(file, "OFF\n%ld %ld 0\n", V, F);
            for (long k = 0; k < V; k++)
                fprintf(file, "%.17g %.17g %.17g\n", points[k][0], points[k][1], points[k][2]);
            for (long k = 0; k < F; k++)
                fprintf(file, "3 %d %d %d\n", faces[k][0], faces[k][1], faces[k][2]);
            fclose(file);
        }
        printf("{%s}\n", refused ? refused : "\"mesh\": \"mesh.off\"");
        fflush(stdout);
    }
    return 0;
}
