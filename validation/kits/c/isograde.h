/* isograde.h: lets isograde grade a program in C.
 *
 *     static const char *extract(const isograde_values *values, const size_t shape[3],
 *                                double isovalue, const double spacing[3], isograde_mesh *mesh);
 *     int main(void) { return isograde_serve("{\"name\": \"mine\"}", extract); }
 *
 * `isograde_serve` reads requests from standard input until there are no more, calls `extract` for
 * each, and answers. Samples keep their type, but float16 comes as float. `extract` fills the mesh
 * and returns NULL, or returns what is wrong. The declaration is JSON. Answers go to descriptor 3,
 * so that whoever prints does no harm: `run` sees to it. For POSIX systems, little-endian. */
#pragma once
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Samples in C order, the last axis fastest: kind 'b', 'i', 'u' or 'f', size bytes each. */
typedef struct { char kind; size_t size, count; void *data; } isograde_values;
/* Points: three coordinates a vertex, index * spacing. Corners: three vertices a triangle, from 0,
 * counterclockwise seen from where values are low. Grown by the two functions below. */
typedef struct { size_t vertices, triangles; double *points; int64_t *corners; } isograde_mesh;
typedef const char *isograde_extract(const isograde_values *, const size_t shape[3],
                                     double isovalue, const double spacing[3], isograde_mesh *);

/* Sample i as a double. A 64-bit integer that no double holds is rounded down, so that the double
 * is at least the isovalue exactly where the sample is. */
static inline double isograde_at(const isograde_values *v, size_t i) {
    double wide;
    switch (v->kind << 8 | (int)v->size) {
    case 'i' << 8 | 1: return ((int8_t *)v->data)[i];
    case 'i' << 8 | 2: return ((int16_t *)v->data)[i];
    case 'i' << 8 | 4: return ((int32_t *)v->data)[i];
    case 'b' << 8 | 1:
    case 'u' << 8 | 1: return ((uint8_t *)v->data)[i];
    case 'u' << 8 | 2: return ((uint16_t *)v->data)[i];
    case 'u' << 8 | 4: return ((uint32_t *)v->data)[i];
    case 'f' << 8 | 4: return ((float *)v->data)[i];
    case 'f' << 8 | 8: return ((double *)v->data)[i];
    case 'i' << 8 | 8:
        wide = (double)((int64_t *)v->data)[i];
        if (wide < 0x1p63 && (int64_t)wide <= ((int64_t *)v->data)[i]) return wide;
        return nextafter(wide, -INFINITY);
    default:
        wide = (double)((uint64_t *)v->data)[i];
        if (wide < 0x1p64 && (uint64_t)wide <= ((uint64_t *)v->data)[i]) return wide;
        return nextafter(wide, -INFINITY);
    }
}

/* The rows, with room for one more of 24 bytes: they double when their number is a power of two. */
static inline void *isograde_room(void *rows, size_t count) {
    if (count & (count - 1)) return rows;
    if (!(rows = realloc(rows, 48 * count + 24))) fputs("out of memory\n", stderr), exit(1);
    return rows;
}
/* The number of a new vertex. */
static inline int64_t isograde_vertex(isograde_mesh *m, double x, double y, double z) {
    m->points = isograde_room(m->points, m->vertices);
    memcpy(m->points + 3 * m->vertices, (double[]){x, y, z}, 24);
    return (int64_t)m->vertices++;
}
static inline void isograde_triangle(isograde_mesh *m, int64_t a, int64_t b, int64_t c) {
    m->corners = isograde_room(m->corners, m->triangles);
    memcpy(m->corners + 3 * m->triangles++, (int64_t[]){a, b, c}, 24);
}

/* What stands after this key of the request, a line of JSON. */
static inline const char *isograde_after(const char *line, const char *key) {
    const char *at = strstr(line, key);
    return at ? at + strlen(key) : "";
}
/* How long a list is; the first three numbers of it, texts such as "Infinity" among them. */
static inline int isograde_list(const char *at, double numbers[3]) {
    int count = 0;
    for (; *at && *at != ']'; at += strcspn(at, ",]"), at += *at == ',', count++)
        if (count < 3 && sscanf(at + strspn(at, " \""), "%lf", numbers + count) < 1) numbers[count] = NAN;
    return count;
}

/* Why the samples cannot be read, or NULL once they are, halves widened. */
static inline const char *isograde_read(const char *line, isograde_values *v) {
    char path[4096] = "", order;
    sscanf(isograde_after(line, "\"values\": \""), "%4095[^\"]", path);
    if (sscanf(isograde_after(line, "\"dtype\": \""), "%c%c%zu", &order, &v->kind, &v->size) != 3
        || !strchr("biuf", v->kind) || v->size > 8) return "samples of an unknown type";
    FILE *file = fopen(path, "rb");
    char *bytes = v->data = malloc((v->size < 4 ? 4 : v->size) * v->count + 1);
    int whole = file && bytes && !fseek(file, atol(isograde_after(line, "\"offset\": ")), SEEK_SET)
                && fread(bytes, v->size, v->count, file) == v->count;
    if (file) fclose(file);
    if (!whole) return "the file of samples cannot be read";
    for (size_t i = 0; order == '>' && i < v->count; i++)
        for (char *low = bytes + i * v->size, *high = low + v->size - 1; low < high; low++, high--)
            *low ^= *high, *high ^= *low, *low ^= *high; /* They change places. */
    if (v->kind != 'f' || v->size != 2) return NULL;
    for (size_t i = v->count; i-- > 0;) { /* Backwards: a float takes the place of two halves. */
        int half = ((uint16_t *)bytes)[i], power = half >> 10 & 31, part = half & 1023;
        float wide = power == 31 ? (part ? NAN : INFINITY)
            : ldexpf((float)(power ? part + 1024 : part), (power ? power : 1) - 25);
        ((float *)bytes)[i] = half >> 15 ? -wide : wide;
    }
    v->size = 4;
    return NULL;
}

/* Rows of three numbers under this name: points, null where not finite, or else corners. */
static inline void isograde_rows(FILE *out, const char *name, const isograde_mesh *m) {
    size_t rows = *name == 'v' ? m->vertices : m->triangles;
    fprintf(out, ", \"%s\": [", name);
    for (size_t i = 0; i < 3 * rows; i++) {
        fputs(i % 3 ? ", " : i ? "], [" : "[", out);
        if (*name == 's') fprintf(out, "%lld", (long long)m->corners[i]);
        else fprintf(out, isfinite(m->points[i]) ? "%.17g" : "null", m->points[i]);
    }
    fputs(rows ? "]]" : "]", out);
}
/* The answer to a request for a mesh. */
static inline void isograde_answer(FILE *out, const char *line, isograde_extract *extract) {
    isograde_values values = {0};
    isograde_mesh mesh = {0};
    double lengths[3], spacing[3], isovalues[3];
    const char *wrong = "it takes one field with three axes";
    isograde_list(isograde_after(line, "\"spacing\": ["), spacing);
    if (isograde_list(isograde_after(line, "\"shape\": ["), lengths) == 3
        && isograde_list(isograde_after(line, "\"isovalues\": ["), isovalues) == 1) {
        const size_t shape[3] = {lengths[0], lengths[1], lengths[2]};
        values.count = shape[0] * shape[1] * shape[2];
        wrong = isograde_read(line, &values);
        if (!wrong) wrong = extract(&values, shape, *isovalues, spacing, &mesh);
    }
    fprintf(out, "{\"id\": %ld", atol(isograde_after(line, "\"id\": ")));
    if (!wrong) isograde_rows(out, "vertices", &mesh), isograde_rows(out, "simplices", &mesh);
    else for (fputs(", \"error\": \"", out); *wrong; wrong++)
        fputc(strchr("\"\\\n", *wrong) ? '\'' : *wrong, out);
    fputs(wrong ? "\"}\n" : "}\n", out);
    free(values.data), free(mesh.points), free(mesh.corners);
}
/* Every request answered with a line; the status for `main`. */
static inline int isograde_serve(const char *declaration, isograde_extract *extract) {
    FILE *out = fdopen(3, "w");
    static char *line; static size_t room;
    if (!out) return fputs("answers go to descriptor 3: run it with 3>&1 1>&2\n", stderr), 1;
    while (getline(&line, &room, stdin) > 0 && !strstr(line, "\"command\": \"stop\"")) {
        if (!strstr(line, "\"command\": \"start\"")) isograde_answer(out, line, extract);
        else fprintf(out, "{\"protocol\": 3, \"declaration\": %s}\n", declaration);
        fflush(out);
    }
    return 0;
}
