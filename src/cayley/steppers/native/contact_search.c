/* Which segments and solids are near: a grid of cells of about the size of a segment, so that the cost is that of what is
 * there. A pair is found in the cell where the overlap of its boxes begins, so only once. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "contact.h"

static const double LARGE = 4.0;     /* what is so many cells long is compared with everything instead */
static const double CHORD = 0.25;    /* part of a radius that is left to chords on a cylinder */
static const double CELL = 1.5;      /* size of a cell in mean sizes of boxes */

static i64 found(const i64 *keys, i64 count, i64 key)
{
    i64 low = 0, high = count;
    while (low < high) {
        i64 middle = (low + high) / 2;
        if (keys[middle] < key) low = middle + 1;
        else high = middle;
    }
    return low < count && keys[low] == key;
}

static i64 strangers(const struct contacts *c, i64 a, i64 b)
{
    if (c->together[a] == c->together[b]) return 0;
    i64 low = a < b ? a : b, high = a + b - low;
    return !found(c->apart, c->apart_count, low * c->owners + high);
}

/* Whether two segments, a < b, may touch. */
i64 segments_may(const struct contacts *c, i64 a, i64 b)
{
    if (!c->round[a] || !c->round[b]) return 0;
    if (c->owner[a] == c->owner[b]) {
        i64 apart = c->along[a] - c->along[b];
        if (!c->reach[a] || (apart < 0 ? -apart : apart) < c->reach[a]) return 0;
    } else if (!strangers(c, c->owner[a], c->owner[b])) return 0;
    return !c->tied_count || !found(c->tied, c->tied_count, a * (c->segments + c->solids) + b);
}

double touch_mass(const struct contacts *c, i64 a, i64 b, i64 slot)
{
    const double *m = c->inverse;
    const i64 *e = c->ends + 2 * a, *f = c->ends + 2 * b;
    double first = m[e[0]] > m[e[1]] ? m[e[0]] : m[e[1]];
    if (b >= c->segments && slot <= END) first = m[e[slot == END]];
    double second = b >= c->segments ? c->yield[b - c->segments] : m[f[0]] > m[f[1]] ? m[f[0]] : m[f[1]];
    return first + second > 0.0 ? 1.0 / (first + second) : 0.0;
}

static void add(struct contacts *c, struct scene *x, i64 a, i64 b, i64 slot)
{
    double mass = touch_mass(c, a, b, slot);
    if (mass == 0.0) return; /* neither can move */
    if (x->count == x->room) {
        x->room = 2 * x->room + 64;
        x->touch = realloc(x->touch, (size_t)x->room * sizeof *x->touch);
    }
    struct touch *t = x->touch + x->count++;
    memset(t, 0, sizeof *t);
    i64 first = c->owner[a], second = b < c->segments ? c->owner[b] : c->possessor[b - c->segments];
    double other = b < c->segments ? c->radius[b] : 0.0, own = c->radius[a];
    t->a = a, t->b = b, t->slot = slot, t->mass = mass, t->most = t->most_along = INFINITY;
    t->unit = own > 0.0 && (other == 0.0 || own < other) ? own : other > 0.0 ? other : c->clearance;
    t->friction = c->rough[first] > c->rough[second] ? c->rough[first] : c->rough[second];
    t->stiffness = c->per_mass * mass > c->least ? c->per_mass * mass : c->least;
}

/* Whether segments of a rod around a cylinder are so short that their nodes alone touch it: chords of a rod that bends around
 * it would lie in it no deeper than a part of its radius. */
static i64 bends_around(const struct contacts *c, i64 segment, i64 solid)
{
    double length = c->length[segment], radius = c->radius[segment];
    return length * length <= 8.0 * CHORD * radius * (c->size[18 * solid] + radius);
}

static void add_on_solid(struct contacts *c, struct scene *x, i64 a, i64 solid)
{
    i64 kind = c->kind[solid], b = c->segments + solid;
    if (!strangers(c, c->owner[a], c->possessor[solid])) return;
    if (c->tied_count && found(c->tied, c->tied_count, a * (c->segments + c->solids) + b)) return;
    if (c->tail[a] & 1) add(c, x, a, b, START);
    if (c->tail[a] & 2) add(c, x, a, b, END);
    if (kind == PLANE || c->ends[2 * a] == c->ends[2 * a + 1]) return;
    if (kind == CYLINDER && c->along[a] >= 0 && bends_around(c, a, solid)) return;
    for (i64 k = 0; k < (kind == TRIANGLE ? 3 : 1); k++)
        if (kind != TRIANGLE || c->size[18 * solid + 12 + k] != 0.0) add(c, x, a, b, INSIDE + k);
}

/* How far the curve of a rod is from its chord, see contact_shapes.c, at most. */
static double sag(const struct contacts *c, const struct scene *x, i64 segment)
{
    const i64 *e = c->ends + 2 * segment, *beyond = c->beyond + 2 * segment;
    double most = 0.0;
    for (i64 k = 0; k < 2; k++) {
        if (beyond[k] < 0) continue;
        const double *p = x->point + 3 * beyond[k], *q = x->point + 3 * e[k], *r = x->point + 3 * e[1 - k];
        double d[3] = {p[0] - 2.0 * q[0] + r[0], p[1] - 2.0 * q[1] + r[1], p[2] - 2.0 * q[2] + r[2]}, size = DOT(d, d);
        most = size > most ? size : most;
    }
    return 0.125 * sqrt(most);
}

static void pair(struct contacts *c, struct scene *x, i64 a, i64 b)
{
    if (a >= c->segments) return; /* solids have edges for each other */
    if (b >= c->segments) {
        add_on_solid(c, x, a, b - c->segments);
        return;
    }
    if (!segments_may(c, a, b)) return;
    const double *p = x->point + 3 * c->ends[2 * a], *q = x->point + 3 * c->ends[2 * b];
    const double *p1 = x->point + 3 * c->ends[2 * a + 1], *q1 = x->point + 3 * c->ends[2 * b + 1];
    double u[3], v[3], gap[3], s, t;
    for (i64 k = 0; k < 3; k++) u[k] = p1[k] - p[k], v[k] = q1[k] - q[k];
    closest(p, u, q, v, &s, &t);
    for (i64 k = 0; k < 3; k++) gap[k] = p[k] + s * u[k] - q[k] - t * v[k];
    double reach = c->radius[a] + c->radius[b] + x->margin + sag(c, x, a) + sag(c, x, b);
    if (DOT(gap, gap) < reach * reach) add(c, x, a, b, 0);
}

/* Box of a finite solid. */
static void box_of(const struct contacts *c, const struct scene *x, i64 solid, double *low, double *high)
{
    const double *pose = x->pose + 12 * solid, *size = c->size + 18 * solid, *m = pose + 3;
    double half[3] = {size[0], size[0], size[1]};
    if (c->kind[solid] == BOX) memcpy(half, size, sizeof half);
    for (i64 k = 0; k < 3; k++) {
        if (c->kind[solid] == TRIANGLE) {
            low[k] = INFINITY, high[k] = -INFINITY;
            for (i64 i = 0; i < 3; i++) {
                double at = pose[k] + DOT(m + 3 * k, size + 3 * i);
                low[k] = at < low[k] ? at : low[k], high[k] = at > high[k] ? at : high[k];
            }
            continue;
        }
        double reach = fabs(m[3 * k]) * half[0] + fabs(m[3 * k + 1]) * half[1] + fabs(m[3 * k + 2]) * half[2];
        low[k] = pose[k] - reach, high[k] = pose[k] + reach;
    }
}

static void boxes(const struct contacts *c, const struct scene *x, struct grid *g)
{
    for (i64 a = 0; a < c->segments; a++) {
        const double *p = x->point + 3 * c->ends[2 * a], *q = x->point + 3 * c->ends[2 * a + 1];
        double out = c->radius[a] + 0.5 * x->margin + sag(c, x, a);
        for (i64 k = 0; k < 3; k++) {
            g->low[3 * a + k] = (p[k] < q[k] ? p[k] : q[k]) - out;
            g->high[3 * a + k] = (p[k] < q[k] ? q[k] : p[k]) + out;
        }
    }
    for (i64 k = 0; k < c->solids; k++) {
        double *low = g->low + 3 * (c->segments + k), *high = g->high + 3 * (c->segments + k);
        if (c->kind[k] != PLANE) box_of(c, x, k, low, high);
        for (i64 d = 0; d < 3; d++) low[d] -= 0.5 * x->margin, high[d] += 0.5 * x->margin;
    }
}

static i64 overlap(const struct grid *g, i64 a, i64 b)
{
    const double *p = g->low + 3 * a, *q = g->high + 3 * a, *r = g->low + 3 * b, *s = g->high + 3 * b;
    return p[0] <= s[0] && r[0] <= q[0] && p[1] <= s[1] && r[1] <= q[1] && p[2] <= s[2] && r[2] <= q[2];
}

static double extent(const struct grid *g, i64 item)
{
    double most = 0.0;
    for (i64 k = 0; k < 3; k++) {
        double size = g->high[3 * item + k] - g->low[3 * item + k];
        most = size > most ? size : most;
    }
    return most;
}

static i64 bucket(const struct grid *g, const i64 *cell)
{
    uint64_t hash = (uint64_t)cell[0] * 0x9E3779B97F4A7C15u ^ (uint64_t)cell[1] * 0xC2B2AE3D27D4EB4Fu ^
                    (uint64_t)cell[2] * 0x165667B19E3779F9u;
    return (i64)((hash ^ hash >> 29) & (uint64_t)(g->buckets - 1));
}

/* Put items into the cells of their boxes, sorted by bucket. */
static void fill_cells(struct grid *g)
{
    g->count = 0;
    for (i64 item = 0; item < g->items; item++) {
        if (g->large[item]) continue;
        i64 from[3], to[3];
        for (i64 k = 0; k < 3; k++) {
            from[k] = (i64)floor(g->low[3 * item + k] / g->cell);
            to[k] = (i64)floor(g->high[3 * item + k] / g->cell);
        }
        for (i64 i = from[0]; i <= to[0]; i++)
            for (i64 j = from[1]; j <= to[1]; j++)
                for (i64 k = from[2]; k <= to[2]; k++) {
                    if (g->count == g->room) {
                        g->room = 2 * g->room + 256;
                        g->unsorted = realloc(g->unsorted, (size_t)g->room * sizeof *g->unsorted);
                        g->entry = realloc(g->entry, (size_t)g->room * sizeof *g->entry);
                    }
                    g->unsorted[g->count++] = (struct entry){{i, j, k}, item};
                }
    }
    for (g->buckets = 64; g->buckets < g->count; g->buckets *= 2) {}
    if (g->buckets > g->bucket_room) {
        g->bucket_room = g->buckets;
        g->start = realloc(g->start, (size_t)(g->buckets + 1) * sizeof *g->start);
        g->next = realloc(g->next, (size_t)(g->buckets + 1) * sizeof *g->next);
    }
    memset(g->start, 0, (size_t)(g->buckets + 1) * sizeof *g->start);
    for (i64 e = 0; e < g->count; e++) g->start[bucket(g, g->unsorted[e].cell)]++;
    for (i64 b = 0, sum = 0; b <= g->buckets; b++) {
        i64 own = b < g->buckets ? g->start[b] : 0;
        g->start[b] = sum, sum += own;
    }
    memcpy(g->next, g->start, (size_t)g->buckets * sizeof *g->next);
    for (i64 e = 0; e < g->count; e++) g->entry[g->next[bucket(g, g->unsorted[e].cell)]++] = g->unsorted[e];
}

/* Whether the overlap of two boxes begins in a cell. */
static i64 begins(const struct grid *g, i64 a, i64 b, const i64 *cell)
{
    for (i64 k = 0; k < 3; k++) {
        double p = g->low[3 * a + k], q = g->low[3 * b + k];
        if ((i64)floor((p > q ? p : q) / g->cell) != cell[k]) return 0;
    }
    return 1;
}

static void in_cells(struct contacts *c, struct scene *x, struct grid *g)
{
    for (i64 b = 0; b < g->buckets; b++)
        for (i64 e = g->start[b]; e < g->start[b + 1]; e++)
            for (i64 f = e + 1; f < g->start[b + 1]; f++) {
                const struct entry *one = g->entry + e, *two = g->entry + f;
                if (memcmp(one->cell, two->cell, sizeof one->cell)) continue;
                i64 low = one->item < two->item ? one->item : two->item, high = one->item + two->item - low;
                if (overlap(g, low, high) && begins(g, low, high, one->cell)) pair(c, x, low, high);
            }
}

static int in_order(const void *left, const void *right)
{
    const struct touch *p = left, *q = right;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    if (p->b != q->b) return p->b < q->b ? -1 : 1;
    return p->slot < q->slot ? -1 : p->slot > q->slot;
}

/* Hand on what is remembered of contacts; both lists are in order. */
static void hand_over(struct scene *x, const struct touch *old, i64 count)
{
    i64 k = 0;
    for (i64 n = 0; n < x->count; n++) {
        struct touch *t = x->touch + n;
        while (k < count && in_order(old + k, t) < 0) k++;
        if (k == count || in_order(old + k, t)) continue;
        t->touching = old[k].touching, t->allowed = old[k].allowed, t->depth = old[k].depth;
        memcpy(t->slip, old[k].slip, sizeof t->slip);
        memcpy(t->push, old[k].push, sizeof t->push);
        memcpy(t->normal, old[k].normal, sizeof t->normal);
    }
}

static i64 is_plane(const struct contacts *c, i64 item)
{
    return item >= c->segments && c->kind[item - c->segments] == PLANE;
}

/* Boxes of all items, the size of cells, and which items are too large for them. */
static void lay_grid(const struct contacts *c, const struct scene *x, struct grid *g)
{
    i64 items = c->segments + c->solids;
    if (!g->low) {
        g->low = malloc((size_t)(3 * items + 1) * sizeof *g->low);
        g->high = malloc((size_t)(3 * items + 1) * sizeof *g->high);
        g->large = malloc((size_t)(items + 1) * sizeof *g->large);
        g->items = items;
    }
    boxes(c, x, g);
    double sum = 0.0;
    for (i64 a = 0; a < c->segments; a++) sum += extent(g, a);
    g->cell = c->segments ? CELL * sum / (double)c->segments : 1.0;
    if (!isfinite(g->cell) || g->cell <= 0.0) g->cell = 1.0;
    for (i64 item = 0; item < items; item++) g->large[item] = is_plane(c, item) || !(extent(g, item) <= LARGE * g->cell);
}

void end_grid(struct grid *g)
{
    free(g->low), free(g->high), free(g->large), free(g->entry), free(g->unsorted), free(g->start), free(g->next);
}

/* Whether a segment is near a plane. */
static i64 over(const struct contacts *c, const struct scene *x, i64 segment, i64 plane)
{
    const double *pose = x->pose + 12 * plane;
    double n[3] = {pose[5], pose[8], pose[11]}, least = INFINITY;
    for (i64 e = 0; e < 2; e++) {
        const double *p = x->point + 3 * c->ends[2 * segment + e];
        double r[3] = {p[0] - pose[0], p[1] - pose[1], p[2] - pose[2]}, height = DOT(n, r);
        least = height < least ? height : least;
    }
    return least <= c->radius[segment] + x->margin;
}

/* Compare what is too large for cells with everything. */
static void with_large(struct contacts *c, struct scene *x, const struct grid *g)
{
    for (i64 item = 0; item < g->items; item++) {
        if (!g->large[item]) continue;
        i64 plane = is_plane(c, item);
        for (i64 other = 0; other < g->items; other++) {
            if (other == item || (g->large[other] && other < item) || (plane && other >= c->segments)) continue;
            i64 near = plane ? over(c, x, other, item - c->segments) : overlap(g, item, other);
            if (near) pair(c, x, item < other ? item : other, item < other ? other : item);
        }
    }
}

/* List what is nearer than the margin, in an order that depends on nothing else, so that sums do not. */
i64 search(struct contacts *c, struct scene *x)
{
    struct touch *old = x->touch;
    i64 before = x->count, room = x->room;
    x->touch = x->before, x->room = x->before_room, x->count = 0;
    x->before = old, x->before_room = room;
    lay_grid(c, x, &x->grid);
    fill_cells(&x->grid);
    in_cells(c, x, &x->grid);
    with_large(c, x, &x->grid);
    qsort(x->touch, (size_t)x->count, sizeof *x->touch, in_order);
    hand_over(x, old, before);
    return x->count;
}
