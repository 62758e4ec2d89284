/* Solids that are not round: their places, signed distances, and where segments touch them. */
#include <math.h>
#include <string.h>
#include "contact.h"

static const double BORDER = 1e-6; /* of a face, in parts of it: what is on it is above it */

/* Origins and rotation matrices of all solids in space. */
void place_solids(const struct contacts *c, const double *values, double *pose)
{
    for (i64 k = 0; k < c->solids; k++) {
        const double *node = values + c->carrier[k] * c->rows, *frame = c->frame + 7 * k, *p = frame + 3;
        const double *q = node + c->turn_row, *x = node + c->place_row;
        double own[9], turned[4], shift[3];
        rotation_matrix(q, own);
        times(own, frame, shift);
        turned[0] = q[0] * p[0] - q[1] * p[1] - q[2] * p[2] - q[3] * p[3];
        turned[1] = q[0] * p[1] + q[1] * p[0] + q[2] * p[3] - q[3] * p[2];
        turned[2] = q[0] * p[2] - q[1] * p[3] + q[2] * p[0] + q[3] * p[1];
        turned[3] = q[0] * p[3] + q[1] * p[2] - q[2] * p[1] + q[3] * p[0];
        for (i64 d = 0; d < 3; d++) pose[12 * k + d] = x[d] + shift[d];
        rotation_matrix(turned, pose + 12 * k + 3);
    }
}

/* Signed distance of a point from a solid in its frame, its gradient, and the feature that is touched. */
struct field {
    double value, slope[3], bend, axis[3];
};

/* size: radius, half length; the axis is that of z. */
static void cylinder(const double *size, const double *x, struct field *f)
{
    double across = sqrt(x[0] * x[0] + x[1] * x[1]), sign = x[2] < 0.0 ? -1.0 : 1.0;
    double radial[2] = {across > 0.0 ? x[0] / across : 1.0, across > 0.0 ? x[1] / across : 0.0};
    double side = across - size[0], end = fabs(x[2]) - size[1];
    memset(f, 0, sizeof *f);
    if (side > 0.0 && end > 0.0) { /* the rim */
        f->value = sqrt(side * side + end * end);
        f->slope[0] = side / f->value * radial[0], f->slope[1] = side / f->value * radial[1];
        f->slope[2] = sign * end / f->value, f->bend = 1.0 / f->value;
        f->axis[0] = -radial[1], f->axis[1] = radial[0];
    } else if (side >= end) {
        f->value = side, f->slope[0] = radial[0], f->slope[1] = radial[1];
        f->bend = across > 0.0 ? 1.0 / across : 0.0, f->axis[2] = 1.0;
    } else f->value = end, f->slope[2] = sign;
}

/* size: half of the edges. */
static void box(const double *size, const double *x, struct field *f)
{
    double out[3], sum = 0.0, most = -INFINITY;
    i64 outside = 0, which = 0, inside = 0;
    memset(f, 0, sizeof *f);
    for (i64 k = 0; k < 3; k++) {
        double beyond = fabs(x[k]) - size[k];
        if (beyond > most) most = beyond, which = k;
        out[k] = beyond > 0.0 ? beyond : 0.0;
        if (beyond > 0.0) outside++;
        else inside = k;
        sum += out[k] * out[k];
    }
    if (outside <= 1) {
        f->value = most, f->slope[which] = x[which] < 0.0 ? -1.0 : 1.0;
        return;
    }
    f->value = sqrt(sum);
    for (i64 k = 0; k < 3; k++) f->slope[k] = (x[k] < 0.0 ? -1.0 : 1.0) * out[k] / f->value;
    f->bend = 1.0 / f->value;
    if (outside == 2) f->axis[inside] = 1.0;
}

/* size: three corners, normal, whether it owns the edge behind each corner, whether the corners. A feature that another
 * triangle owns is not touched here. Returns whether it is. */
static i64 triangle(const double *size, const double *x, struct field *f)
{
    const double *n = size + 9;
    double best = INFINITY, at[3] = {0.0, 0.0, 0.0}, from[3] = {x[0] - size[0], x[1] - size[1], x[2] - size[2]};
    double height = DOT(n, from);
    i64 inside = 1, owned = 0;
    memset(f, 0, sizeof *f);
    for (i64 k = 0; k < 3; k++) {
        const double *a = size + 3 * k, *b = size + 3 * ((k + 1) % 3);
        double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, r[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]}, out[3];
        CROSS(n, e, out); /* into the triangle */
        if (DOT(out, r) >= 0.0) continue;
        inside = 0;
        double t = clamp(DOT(e, r) / DOT(e, e), 0.0, 1.0), d[3];
        for (i64 i = 0; i < 3; i++) d[i] = r[i] - t * e[i];
        if (DOT(d, d) >= best) continue;
        best = DOT(d, d);
        memcpy(at, d, sizeof at);
        owned = t <= 0.0 ? size[15 + k] != 0.0 : t >= 1.0 ? size[15 + (k + 1) % 3] != 0.0 : size[12 + k] != 0.0;
        for (i64 i = 0; i < 3; i++) f->axis[i] = t > 0.0 && t < 1.0 ? e[i] / sqrt(DOT(e, e)) : 0.0;
    }
    if (inside) {
        f->value = height;
        memcpy(f->slope, n, sizeof f->slope);
        return 1;
    }
    double distance = sqrt(best);
    if (!owned || height <= 0.0 || distance == 0.0) return 0; /* below its face another one is touched */
    f->value = distance, f->bend = 1.0 / distance;
    for (i64 i = 0; i < 3; i++) f->slope[i] = at[i] / distance;
    return 1;
}

static i64 field_at(i64 kind, const double *size, const double *x, struct field *f)
{
    if (kind == TRIANGLE) return triangle(size, x, f);
    if (kind == CYLINDER) cylinder(size, x, f);
    else if (kind == BOX) box(size, x, f);
    else {
        memset(f, 0, sizeof *f);
        f->value = x[2], f->slope[2] = 1.0;
    }
    return 1;
}

/* Distance of the segment from an edge of a triangle, in its frame. */
static i64 edge(const double *size, i64 k, const double *x, struct field *f)
{
    const double *a = size + 3 * k, *b = size + 3 * ((k + 1) % 3), *n = size + 9;
    double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, r[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]}, out[3];
    double t = DOT(e, r) / DOT(e, e), length = sqrt(DOT(e, e));
    for (i64 i = 0; i < 3; i++) r[i] -= t * e[i], f->axis[i] = e[i] / length;
    f->value = sqrt(DOT(r, r));
    CROSS(n, e, out);
    if (f->value == 0.0 || DOT(n, r) < -1e-9 * f->value || DOT(out, r) > 1e-9 * f->value * length) return 0;
    for (i64 i = 0; i < 3; i++) f->slope[i] = r[i] / f->value;
    f->bend = 1.0 / f->value;
    return 1;
}

/* Inside a solid between two faces, where the one field falls along u and the other rises, the edge between them is touched:
 * the distance is that of two lines. Returns how far along u they come nearest. */
static double between(const struct field *before, const struct field *behind, const double *u, struct field *f)
{
    const double *m = before->slope, *n = behind->slope;
    double falling = -DOT(m, u), rising = DOT(n, u), e[3], both[3], square = 0.0;
    for (i64 k = 0; k < 3; k++) {
        f->slope[k] = (rising * m[k] + falling * n[k]) / (falling + rising), both[k] = m[k] + n[k];
        square += f->slope[k] * f->slope[k];
    }
    CROSS(m, n, e);
    double ee = DOT(e, e), on = DOT(u, e), apart = DOT(u, u) - (ee > 0.0 ? on * on / ee : 0.0);
    if (ee < 1e-12 || square == 0.0 || apart <= 0.0) return 0.0;
    double nearer = -f->value * DOT(u, both) / (1.0 + DOT(m, n)) / apart;
    f->value /= sqrt(square);
    for (i64 k = 0; k < 3; k++) f->slope[k] /= sqrt(square);
    return nearer;
}

/* Where an edge that is deepest at an end leaves a box by another face, before its other end: it lies over that edge of the
 * box however it is tilted. Else that end. */
static double leaves(i64 kind, const double *size, const double *a, const double *u, double end, struct field *f)
{
    struct field first, last;
    double in = end, out = 1.0 - end, x[3];
    for (i64 k = 0; k < 3; k++) x[k] = a[k] + in * u[k];
    field_at(kind, size, x, &first);
    for (i64 k = 0; k < 3; k++) x[k] = a[k] + out * u[k];
    field_at(kind, size, x, &last);
    if (kind != BOX || first.value >= 0.0 || last.value <= 0.0) return end;
    for (i64 pass = 0; pass < 40; pass++) {
        double s = 0.5 * (in + out);
        for (i64 k = 0; k < 3; k++) x[k] = a[k] + s * u[k];
        field_at(kind, size, x, f);
        if (DOT(f->slope, first.slope) > 1.0 - 1e-12) in = s;
        else out = s, last = *f;
    }
    if (f->value >= 0.0 || in == end) return end;
    double more = end == 0.0 ? between(&first, &last, u, f) : between(&last, &first, u, f);
    return clamp(0.5 * (in + out) + more, 1e-8, 1.0 - 1e-8);
}

/* Where along a + s u the distance from a convex solid is least: its rate rises. Along a face ends are as near. */
static double lowest(i64 kind, const double *size, const double *a, const double *u, i64 edge_of_solid, struct field *f)
{
    double low = 0.0, high = 1.0;
    struct field before, behind;
    for (i64 k = 0; k < 40; k++) {
        double s = 0.5 * (low + high), x[3] = {a[0] + s * u[0], a[1] + s * u[1], a[2] + s * u[2]};
        field_at(kind, size, x, f);
        double rate = DOT(f->slope, u);
        if (rate == 0.0 && f->bend > 0.0) return s;
        if (rate < 0.0) low = s, before = *f;
        else high = s, behind = *f;
        if (high - low < 1e-12) break;
    }
    if (low == 0.0 || high == 1.0) {
        double end = low == 0.0 ? 0.0 : 1.0;
        return edge_of_solid ? leaves(kind, size, a, u, end, f) : end;
    }
    if (f->value >= 0.0) return 0.5 * (low + high);
    return clamp(0.5 * (low + high) + between(&before, &behind, u, f), 1e-8, 1.0 - 1e-8);
}

/* A corner of a body above the face of a box touches that face, even at its very border, where another face is nearer. */
static i64 above_face(const struct contacts *c, const struct scene *x, const struct touch *t, const double *corner, struct field *f)
{
    i64 solid = t->b - c->segments, node = c->node[c->ends[2 * t->a]], which = -1;
    const double *size = c->size + 18 * solid, *pose = x->pose + 12 * solid, *place = x->values + node * c->rows + c->place_row;
    double middle[3], way[3];
    for (i64 k = 0; k < 3; k++) way[k] = place[k] - pose[k];
    times_transposed(pose + 3, way, middle);
    for (i64 k = 0; k < 3; k++)
        if (fabs(middle[k]) > size[k]) {
            if (which >= 0) return 0; /* it is beyond an edge */
            which = k;
        }
    if (which < 0) return 0;
    double sign = middle[which] < 0.0 ? -1.0 : 1.0, height = sign * corner[which] - size[which];
    for (i64 k = 0; k < 3; k++)
        if (k != which && fabs(corner[k]) > size[k] * (1.0 + BORDER)) return 0;
    if (height < -0.5 * size[which]) return 0;
    memset(f, 0, sizeof *f);
    f->value = height, f->slope[which] = sign;
    return 1;
}

/* The point of a segment that a slot means, in the frame of the solid, and its distance. Returns whether there is
 * one. */
static i64 where_on(const struct contacts *c, const struct scene *x, const struct touch *t, const double *a, const double *u,
                    double *s, struct field *f)
{
    i64 solid = t->b - c->segments, kind = c->kind[solid], known = 0;
    const double *size = c->size + 18 * solid;
    if (t->slot == START || t->slot == END) {
        *s = t->slot == END ? 1.0 : 0.0;
    } else if (kind == TRIANGLE) { /* (s, along) inside both */
        i64 k = t->slot - INSIDE;
        const double *p = size + 3 * k, *q = size + 3 * ((k + 1) % 3);
        double e[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, along;
        closest(a, u, p, e, s, &along);
        if (along <= 0.0 || along >= 1.0) return 0;
    } else if (kind == CYLINDER && c->radius[t->a] > 0.0 && fabs(a[2]) <= size[1] && fabs(a[2] + u[2]) <= size[1]) {
        double uu = u[0] * u[0] + u[1] * u[1];
        if (uu == 0.0) return 0;
        *s = -(a[0] * u[0] + a[1] * u[1]) / uu; /* beside it */
    } else *s = lowest(kind, size, a, u, c->radius[t->a] == 0.0, f), known = 1;
    if (t->slot >= INSIDE && (*s <= 1e-9 || *s >= 1.0 - 1e-9)) return 0;
    if (known) return 1;
    double at[3] = {a[0] + *s * u[0], a[1] + *s * u[1], a[2] + *s * u[2]};
    if (kind == BOX && c->radius[t->a] == 0.0 && t->slot < INSIDE && above_face(c, x, t, at, f)) return 1;
    return kind == TRIANGLE && t->slot >= INSIDE ? edge(size, t->slot - INSIDE, at, f) : field_at(kind, size, at, f);
}

i64 look_at_solid(const struct contacts *c, const struct scene *x, const struct touch *t, struct seen *seen)
{
    i64 solid = t->b - c->segments, kind = c->kind[solid];
    const double *pose = x->pose + 12 * solid, radius = c->radius[t->a];
    const double *first = x->point + 3 * c->ends[2 * t->a], *second = x->point + 3 * c->ends[2 * t->a + 1];
    double a[3], u[3], local[3], way[3], s;
    for (i64 k = 0; k < 3; k++) a[k] = first[k] - pose[k], u[k] = second[k] - first[k];
    times_transposed(pose + 3, a, local);
    times_transposed(pose + 3, u, way);
    struct field f;
    if (!where_on(c, x, t, local, way, &s, &f)) return 0;
    seen->depth = radius - f.value;
    if (kind == TRIANGLE) { /* what was not in contact comes from its outer side: else it is the back, or what is behind it */
        double most = t->touching ? 2.0 * radius + t->unit : radius > 0.0 ? radius : 0.5 * t->unit;
        if (seen->depth > most) return 0;
    }
    times(pose + 3, f.slope, seen->normal);
    times(pose + 3, f.axis, seen->axis);
    seen->bend = f.bend, seen->count_b = 0, seen->inside = 0;
    stand(c, t->a, s, &seen->count_a, seen->point_a, seen->weight_a);
    seen->distance = f.value, seen->arm_a = f.value, seen->arm_b = 0.0;
    for (i64 k = 0; k < 3; k++) {
        seen->gap[k] = seen->normal[k] * f.value;
        seen->place[k] = first[k] + s * u[k] - seen->normal[k] * seen->arm_a;
    }
    return 1;
}
