/* Marching tetrahedra in C, behind the door exec: -- each cell is cut into the six tetrahedra
 * round its main diagonal. Reads requests line by line, answers with a mesh in .off. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int n[3];
static double *f, iso, h[3], points[1 << 20][3];
static long count;

static const char *after(const char *line, const char *key) {
    const char *at = strstr(line, key);
    return at ? at + strlen(key) : "";
}
static double value(const int *p) { return f[((long)p[0] * n[1] + p[1]) * n[2] + p[2]]; }
/* Append the crossing of edge a-b, always computed from its lower end. */
static void cross(const int *a, const int *b) {
    if (memcmp(a, b, sizeof(int[3])) > 0) { const int *c = a; a = b; b = c; }
    double t = (iso - value(a)) / (value(b) - value(a));
    for (int k = 0; k < 3; k++) points[count][k] = (a[k] + t * (b[k] - a[k])) * h[k];
    count++;
}
/* Triangle on three edges inside-outside; `odd` turns it over. */
static void triangle(int odd, int *a, int *b, int *c, int *d, int *e, int *g) {
    cross(a, b);
    if (odd) { cross(e, g); cross(c, d); } else { cross(c, d); cross(e, g); }
}
static void tetrahedron(int *v[4], int odd) {
    int *in[4], *out[4], i = 0, o = 0;
    for (int k = 0; k < 4; k++)  /* a permutation: insiders first; count its inversions */
        if (value(v[k]) >= iso) { in[i++] = v[k]; odd += o; } else out[o++] = v[k];
    odd &= 1;
    if (i == 1) triangle(odd, in[0], out[0], in[0], out[1], in[0], out[2]);
    if (i == 3) triangle(odd, in[0], out[0], in[1], out[0], in[2], out[0]);
    if (i == 2) {
        triangle(odd, in[0], out[0], in[0], out[1], in[1], out[1]);
        triangle(odd, in[0], out[0], in[1], out[1], in[1], out[0]);
    }
}
static void cell(int *low) {
    for (int a = 0; a < 3; a++) for (int b = 0; b < 3; b++) if (a != b) {
        int c[4][3], *v[4] = {c[0], c[1], c[2], c[3]};
        for (int k = 0; k < 12; k++) c[k / 3][k % 3] = low[k % 3] + (k > 8);
        c[1][a]++, c[2][a]++, c[2][b]++;
        tetrahedron(v, (b - a + 3) % 3 != 1);
    }
}
int main(void) {
    static char line[1 << 16], path[4096];
    while (fgets(line, sizeof line, stdin) && !strstr(line, "\"stop\"")) {
        if (strstr(line, "\"start\"")) {
            puts("{\"protocol\": 1, \"declaration\": {\"name\": \"tetrahedra in C\", \"level\": 1,"
                 " \"without\": [\"welded\", \"on-edges\"]}}");
        } else if (strncmp(after(line, "\"dtype\": "), "\"<f8\"", 5)) {
            puts("{\"unsupported\": \"reads float64 only\"}");
        } else {
            sscanf(after(line, "\"shape\": ["), "%d, %d, %d", &n[0], &n[1], &n[2]);
            sscanf(after(line, "\"spacing\": ["), "%lf, %lf, %lf", &h[0], &h[1], &h[2]);
            iso = atof(after(line, "\"isovalue\": "));
            sscanf(after(line, "\"values\": \""), "%4095[^\"]", path);
            FILE *file = fopen(path, "rb");
            long size = (long)n[0] * n[1] * n[2];
            f = realloc(f, size * sizeof *f);
            fseek(file, atol(after(line, "\"offset\": ")), SEEK_SET);
            if ((long)fread(f, sizeof *f, size, file) != size) return 1;
            fclose(file);
            count = 0;
            for (int p[3] = {0}; p[0] < n[0] - 1; p[0]++)
                for (p[1] = 0; p[1] < n[1] - 1; p[1]++)
                    for (p[2] = 0; p[2] < n[2] - 1; p[2]++) cell(p);
            strcpy(strrchr(path, '/'), "/mesh.off");
            file = fopen(path, "w");
            fprintf(file, "OFF\n%ld %ld 0\n", count, count / 3);
            for (long k = 0; k < count; k++)
                fprintf(file, "%.17g %.17g %.17g\n", points[k][0], points[k][1], points[k][2]);
            for (long k = 0; k < count; k += 3) fprintf(file, "3 %ld %ld %ld\n", k, k + 1, k + 2);
            fclose(file);
            puts("{\"mesh\": \"mesh.off\"}");
        }
        fflush(stdout);
    }
    return 0;
}
