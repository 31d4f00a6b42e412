/* GTS: marching cubes, and three kinds of marching tetrahedra, of a grid given plane by plane. */
#include "league.h"
#include <gts.h>

typedef struct { const isograde_values *values; const size_t *shape; } samples;
typedef void contouring(GtsSurface *, GtsCartesianGrid, GtsIsoCartesianFunc, gpointer, gdouble);
static contouring *contour;

/* The samples of plane k. */
static void plane(gdouble **a, GtsCartesianGrid g, guint k, gpointer data) {
    const samples *s = data;
    for (guint i = 0; i < g.nx; i++)
        for (guint j = 0; j < g.ny; j++)
            a[i][j] = isograde_at(s->values, (i * s->shape[1] + j) * s->shape[2] + k);
}

/* Vertices that are counted as they are made: at one place only that tells them apart. */
typedef struct { GtsVertex vertex; gint64 made; } counted;
static gint64 made;
static void count(counted *it) { it->made = made++; }
static GtsVertexClass *counted_class(void) {
    static GtsVertexClass *class;
    GtsObjectClassInfo info = {"counted", sizeof(counted), sizeof(GtsVertexClass), NULL, (GtsObjectInitFunc)count, NULL, NULL};
    if (!class) class = gts_object_class_new(GTS_OBJECT_CLASS(gts_vertex_class()), &info);
    return class;
}

/* A vertex of the surface has its number where GTS leaves room for one. */
static int64_t *turns;
static gint vertex(gpointer item, gpointer mesh) {
    GtsPoint *p = item;
    size_t at = isograde_vertex(mesh, p->x, p->y, p->z);
    turns[at] = ((counted *)item)->made;
    GTS_OBJECT(item)->reserved = GSIZE_TO_POINTER(at);
    return 0;
}
static gint face(gpointer item, gpointer mesh) {
    GtsVertex *v[3];
    gts_triangle_vertices(GTS_TRIANGLE(item), v, v + 1, v + 2);
    int64_t at[3];
    for (int c = 0; c < 3; c++) at[c] = (int64_t)GPOINTER_TO_SIZE(GTS_OBJECT(v[c])->reserved);
    isograde_triangle(mesh, at[0], at[1], at[2]);
    return 0;
}

/* GTS keeps sets, in the order of addresses in memory: rows of three, sorted, are always the same. */
static double *points;
static int by_place(const void *a, const void *b) {
    const double *p = points + 3 * *(const int64_t *)a, *q = points + 3 * *(const int64_t *)b;
    int axis = p[0] != q[0] ? 0 : p[1] != q[1] ? 1 : 2;
    int64_t first = turns[*(const int64_t *)a], then = turns[*(const int64_t *)b];
    return p[axis] != q[axis] ? (p[axis] > q[axis]) - (p[axis] < q[axis]) : (first > then) - (first < then);
}
static int by_corners(const void *a, const void *b) {
    const int64_t *p = a, *q = b;
    int at = p[0] != q[0] ? 0 : p[1] != q[1] ? 1 : 2;
    return (p[at] > q[at]) - (p[at] < q[at]);
}
static void sorted(isograde_mesh *mesh) {
    size_t count = mesh->vertices;
    int64_t *order = malloc(8 * count + 1), *rank = malloc(8 * count + 1);
    points = malloc(24 * count + 1);
    memcpy(points, mesh->points, 24 * count);
    for (size_t i = 0; i < count; i++) order[i] = (int64_t)i;
    qsort(order, count, 8, by_place);
    for (size_t i = 0; i < count; i++) {
        rank[order[i]] = (int64_t)i;
        memcpy(mesh->points + 3 * i, points + 3 * order[i], 24);
    }
    for (size_t t = 0; t < mesh->triangles; t++) {
        int64_t *c = mesh->corners + 3 * t, low;
        for (int i = 0; i < 3; i++) c[i] = rank[c[i]];
        while (c[0] > c[1] || c[0] > c[2]) low = c[0], c[0] = c[1], c[1] = c[2], c[2] = low;
    }
    qsort(mesh->corners, mesh->triangles, 24, by_corners);
    free(order), free(rank), free(points);
}

static const char *extract(const isograde_values *values, const size_t shape[3], double isovalue,
                           const double spacing[3], isograde_mesh *mesh) {
    samples given = {values, shape};
    GtsCartesianGrid grid = {shape[0], shape[1], shape[2], 0, spacing[0], 0, spacing[1], 0, spacing[2]};
    GtsSurface *surface = gts_surface_new(gts_surface_class(), gts_face_class(), gts_edge_class(), counted_class());
    made = 0;
    contour(surface, grid, plane, &given, isovalue);
    turns = malloc(8 * made + 1);
    gts_surface_foreach_vertex(surface, vertex, mesh);
    gts_surface_foreach_face(surface, face, mesh);
    gts_object_destroy(GTS_OBJECT(surface));
    sorted(mesh);
    free(turns);
    return NULL;
}

int main(int count, char **words) {
    if (count < 3) return fputs("adapter DECLARATION FUNCTION\n", stderr), 2;
    contour = !strcmp(words[2], "tetra") ? gts_isosurface_tetra
        : !strcmp(words[2], "bcl") ? gts_isosurface_tetra_bcl
        : !strcmp(words[2], "bounded") ? gts_isosurface_tetra_bounded : gts_isosurface_cartesian;
    return league_serve(words[1], extract);
}
