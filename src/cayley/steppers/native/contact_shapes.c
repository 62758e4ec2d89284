/* Where segments come nearest, and how deep they overlap; solids are in contact_solids.c. */
#include <math.h>
#include <string.h>
#include "contact.h"

/* Of a unit quaternion. */
void rotation_matrix(const double *q, double *m)
{
    double size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], f = size > 0.0 ? 2.0 / size : 0.0;
    double w = q[0], x = q[1], y = q[2], z = q[3];
    m[0] = 1.0 - f * (y * y + z * z), m[1] = f * (x * y - w * z), m[2] = f * (x * z + w * y);
    m[3] = f * (x * y + w * z), m[4] = 1.0 - f * (x * x + z * z), m[5] = f * (y * z - w * x);
    m[6] = f * (x * z - w * y), m[7] = f * (y * z + w * x), m[8] = 1.0 - f * (x * x + y * y);
}

/* Where the segments a + s u and b + t v come nearest (Ericson 2005, section 5.1.9); parallel ones in the middle of where
 * they lie beside each other. */
void closest(const double *a, const double *u, const double *b, const double *v, double *s, double *t)
{
    double r[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    double uu = DOT(u, u), vv = DOT(v, v), uv = DOT(u, v), ur = DOT(u, r), vr = DOT(v, r);
    if (uu == 0.0 && vv == 0.0) {
        *s = *t = 0.0;
        return;
    }
    if (uu == 0.0) {
        *s = 0.0, *t = clamp(vr / vv, 0.0, 1.0);
        return;
    }
    if (vv == 0.0) {
        *t = 0.0, *s = clamp(-ur / uu, 0.0, 1.0);
        return;
    }
    double determinant = uu * vv - uv * uv;
    if (determinant > 1e-12 * uu * vv) *s = clamp((uv * vr - ur * vv) / determinant, 0.0, 1.0);
    else { /* the middle of the common part */
        double first = -ur / uu, second = (uv - ur) / uu, low = first < second ? first : second, high = first + second - low;
        *s = 0.5 * (clamp(low, 0.0, 1.0) + clamp(high, 0.0, 1.0));
    }
    *t = (uv * *s + vr) / vv;
    if (*t < 0.0) *t = 0.0, *s = clamp(-ur / uu, 0.0, 1.0);
    else if (*t > 1.0) *t = 1.0, *s = clamp((uv - ur) / uu, 0.0, 1.0);
}

/* The four points about a segment of a rod; a rod goes on straight beyond its ends. */
static void about(const struct contacts *c, const struct scene *x, i64 segment, double out[4][3])
{
    const i64 *ends = c->ends + 2 * segment, *beyond = c->beyond + 2 * segment;
    const double *p = x->point + 3 * ends[0], *q = x->point + 3 * ends[1];
    for (i64 k = 0; k < 3; k++) {
        out[1][k] = p[k], out[2][k] = q[k];
        out[0][k] = beyond[0] < 0 ? 2.0 * p[k] - q[k] : x->point[3 * beyond[0] + k];
        out[3][k] = beyond[1] < 0 ? 2.0 * q[k] - p[k] : x->point[3 * beyond[1] + k];
    }
}

/* How far the curve of a segment is from its chord at most. */
static double sagging(double p[4][3])
{
    double first[3], second[3];
    for (i64 k = 0; k < 3; k++) first[k] = p[0][k] - 2.0 * p[1][k] + p[2][k], second[k] = p[1][k] - 2.0 * p[2][k] + p[3][k];
    double a = DOT(first, first), b = DOT(second, second);
    return 0.125 * sqrt(a > b ? a : b);
}

/* How far the curve of a segment is beyond its chord at most, along part times a way. */
static double hollow(double p[4][3], const double *way, double part)
{
    double first = 0.0, second = 0.0;
    for (i64 k = 0; k < 3; k++) {
        first += part * way[k] * (p[0][k] - 2.0 * p[1][k] + p[2][k]);
        second += part * way[k] * (p[1][k] - 2.0 * p[2][k] + p[3][k]);
    }
    double most = first > second ? first : second;
    return most > 0.0 ? 0.125 * most : 0.0;
}

/* The quadratic B-spline of a rod's points along a segment, which touches every segment in its middle: the first of three
 * points about a place, and their weights. */
static inline i64 spline(double s, double *u, double *w)
{
    i64 late = s > 0.5;
    *u = late ? s - 0.5 : s + 0.5;
    w[0] = 0.5 * (1.0 - *u) * (1.0 - *u), w[1] = 0.5 + *u * (1.0 - *u), w[2] = 0.5 * *u * *u;
    return late;
}

/* The curve at a place, its slope and second derivative. */
static inline void on_curve(double p[4][3], double s, double *at, double *slope, double *second)
{
    double u, w[3];
    double(*q)[3] = p + spline(s, &u, w);
    for (i64 k = 0; k < 3; k++) {
        at[k] = w[0] * q[0][k] + w[1] * q[1][k] + w[2] * q[2][k];
        second[k] = q[0][k] - 2.0 * q[1][k] + q[2][k], slope[k] = q[1][k] - q[0][k] + u * second[k];
    }
}

/* Where the curves of two segments come nearest, by Newton's method from (s, t); returns the squared distance. */
static double nearest(double p[4][3], double q[4][3], double *s, double *t, double *gap)
{
    double a[3], b[3], u[3], v[3], over[3], under[3];
    for (i64 pass = 0; pass < 8; pass++) {
        on_curve(p, *s, a, u, over), on_curve(q, *t, b, v, under);
        for (i64 k = 0; k < 3; k++) gap[k] = a[k] - b[k];
        double g = DOT(gap, u), h = -DOT(gap, v), uu = DOT(u, u), vv = DOT(v, v), uv = DOT(u, v);
        double aa = uu + DOT(gap, over), bb = vv - DOT(gap, under);
        if (aa < 0.1 * uu) aa = 0.1 * uu;
        if (bb < 0.1 * vv) bb = 0.1 * vv;
        /* what is at an end and would leave stays there */
        i64 fixed_s = (*s <= 0.0 && g > 0.0) || (*s >= 1.0 && g < 0.0), fixed_t = (*t <= 0.0 && h > 0.0) || (*t >= 1.0 && h < 0.0);
        double determinant = aa * bb - uv * uv, ds = 0.0, dt = 0.0;
        if (fixed_s && fixed_t) break;
        if (fixed_s || determinant < 1e-6 * aa * bb) dt = fixed_t ? 0.0 : -h / bb;
        if (fixed_t || determinant < 1e-6 * aa * bb) ds = fixed_s ? 0.0 : -g / aa;
        if (!fixed_s && !fixed_t && determinant >= 1e-6 * aa * bb)
            ds = -(bb * g + uv * h) / determinant, dt = -(aa * h + uv * g) / determinant;
        double before[2] = {*s, *t};
        *s = clamp(*s + ds, 0.0, 1.0), *t = clamp(*t + dt, 0.0, 1.0);
        if (fabs(*s - before[0]) + fabs(*t - before[1]) < 1e-13) break;
    }
    on_curve(p, *s, a, u, over), on_curve(q, *t, b, v, under); /* it may have been stopped: forces go along the gap as it is */
    for (i64 k = 0; k < 3; k++) gap[k] = a[k] - b[k];
    return DOT(gap, gap);
}

/* A point of the curve of a segment as a mean of the points about it. */
static void stand_curved(const struct contacts *c, i64 segment, double s, i64 *count, i64 *point, double *weight)
{
    const i64 *ends = c->ends + 2 * segment, *beyond = c->beyond + 2 * segment;
    double w[4] = {0.0, 0.0, 0.0, 0.0}, three[3], u;
    memcpy(w + spline(s, &u, three), three, sizeof three);
    if (beyond[0] < 0) w[1] += 2.0 * w[0], w[2] -= w[0], w[0] = 0.0;
    if (beyond[1] < 0) w[2] += 2.0 * w[3], w[1] -= w[3], w[3] = 0.0;
    i64 all[4] = {beyond[0], ends[0], ends[1], beyond[1]};
    *count = 0;
    for (i64 k = 0; k < 4; k++)
        if (w[k] != 0.0) point[*count] = all[k], weight[(*count)++] = w[k];
}

static i64 allowed(const struct contacts *c, i64 a, i64 b)
{
    return a < b ? segments_may(c, a, b) : segments_may(c, b, a);
}

/* Whether the rod that goes on behind the end at s of its segment p touches another instead: where it is nearer there, and of
 * two that are alike the one before the point. Both would push off along the rod, and roll off what should hold them. */
static i64 hands_on(const struct contacts *c, i64 segment, i64 other, double p[4][3], double s, const double *gap, double sign)
{
    if (s <= 0.0) return c->beyond[2 * segment] >= 0 && allowed(c, segment - 1, other);
    if (s < 1.0 || c->beyond[2 * segment + 1] < 0) return 0;
    double way[3] = {p[3][0] - p[2][0], p[3][1] - p[2][1], p[3][2] - p[2][2]};
    double nearer = -sign * DOT(gap, way); /* more than by round-off: that one may say the same of this one */
    return nearer > 1e-9 * sqrt(DOT(gap, gap) * DOT(way, way)) && allowed(c, segment + 1, other);
}

/* Where two segments come nearest: as capsules; in the hollow of a bend, where the corner of two capsules would be a notch, the
 * curve that rounds it does. Returns whether they touch; any: tell the place whatever. */
static i64 meet(const struct contacts *c, const struct scene *x, const struct touch *t, i64 any, struct seen *seen)
{
    double p[4][3], q[4][3], u[3], v[3], gap[3], s, r;
    about(c, x, t->a, p), about(c, x, t->b, q);
    for (i64 k = 0; k < 3; k++) u[k] = p[2][k] - p[1][k], v[k] = q[2][k] - q[1][k];
    closest(p[1], u, q[1], v, &s, &r);
    for (i64 k = 0; k < 3; k++) seen->gap[k] = p[1][k] + s * u[k] - q[1][k] - r * v[k];
    double sum = c->radius[t->a] + c->radius[t->b], square = DOT(seen->gap, seen->gap), distance = sqrt(square);
    double round = distance > 0.0 ? hollow(p, seen->gap, -1.0 / distance) + hollow(q, seen->gap, 1.0 / distance) : sagging(p) + sagging(q);
    if (distance >= sum + round) {
        double most = sagging(p) + sagging(q); /* however it turns */
        seen->apart = distance > sum + most ? distance - sum - most : 0.0, seen->depth = sum - distance;
        if (!any) return 0;
    }
    double on_a = s, on_b = r, curved = round > 0.0 ? nearest(p, q, &on_a, &on_b, gap) : INFINITY;
    i64 rounds = curved < square;
    if (rounds) {
        square = curved, s = on_a, r = on_b;
        memcpy(seen->gap, gap, sizeof gap);
    }
    seen->depth = sum - sqrt(square);
    if (!any && seen->depth <= 0.0) return 0;
    (rounds ? stand_curved : stand)(c, t->a, s, &seen->count_a, seen->point_a, seen->weight_a);
    (rounds ? stand_curved : stand)(c, t->b, r, &seen->count_b, seen->point_b, seen->weight_b);
    seen->on_a = s, seen->on_b = r, seen->inside = s > 0.0 && s < 1.0 && r > 0.0 && r < 1.0;
    /* with friction both stay: what sticks to one, or may overlap, is not to be forgotten when the other is nearer by a hair */
    i64 other = hands_on(c, t->a, t->b, p, s, seen->gap, 1.0) || hands_on(c, t->b, t->a, q, r, seen->gap, -1.0);
    seen->elsewhere = t->friction == 0.0 && c->relax == 0.0 && other;
    return 1;
}

/* What follows from the centers and the gap between them. */
static i64 show(const struct contacts *c, const struct scene *x, const struct touch *t, struct seen *seen)
{
    double center[3] = {0.0, 0.0, 0.0}, distance = sqrt(DOT(seen->gap, seen->gap));
    seen->depth = c->radius[t->a] + c->radius[t->b] - distance, seen->distance = distance;
    if (seen->depth <= 0.0 || seen->elsewhere) return 0;
    for (i64 k = 0; k < 3; k++) seen->normal[k] = distance > 0.0 ? seen->gap[k] / distance : t->normal[k];
    seen->arm_a = c->radius[t->a] - 0.5 * seen->depth, seen->arm_b = c->radius[t->b] - 0.5 * seen->depth;
    for (i64 n = 0; n < seen->count_a; n++)
        for (i64 k = 0; k < 3; k++) center[k] += seen->weight_a[n] * x->point[3 * seen->point_a[n] + k];
    for (i64 k = 0; k < 3; k++) seen->place[k] = center[k] - seen->normal[k] * seen->arm_a;
    seen->bend = distance > 0.0 ? 1.0 / distance : 0.0;
    memset(seen->axis, 0, sizeof seen->axis);
    return 1;
}

/* Hold the places where all pairs of segments come nearest; returns how far those that touch were from the places held
 * before, in radii. */
double hold_meetings(const struct contacts *c, const struct scene *x, struct seen *held)
{
    double most = 0.0;
    for (i64 n = 0; n < x->count; n++) {
        const struct touch *t = x->touch + n;
        struct seen now;
        if (t->b >= c->segments) continue;
        meet(c, x, t, 1, &now);
        if (now.depth > 0.0) {
            double a = fabs(now.on_a - held[n].on_a) * c->length[t->a], b = fabs(now.on_b - held[n].on_b) * c->length[t->b];
            double far = now.elsewhere != held[n].elsewhere ? INFINITY : (a > b ? a : b) / t->unit;
            most = far > most ? far : most;
        }
        held[n] = now;
    }
    return most;
}

/* How two segments touch at the places that are held. */
i64 look_at_held(const struct contacts *c, const struct scene *x, const struct touch *t, const struct seen *held, struct seen *seen)
{
    *seen = *held;
    for (i64 k = 0; k < 3; k++) {
        seen->gap[k] = 0.0;
        for (i64 n = 0; n < seen->count_a; n++) seen->gap[k] += seen->weight_a[n] * x->point[3 * seen->point_a[n] + k];
        for (i64 n = 0; n < seen->count_b; n++) seen->gap[k] -= seen->weight_b[n] * x->point[3 * seen->point_b[n] + k];
    }
    return show(c, x, t, seen);
}

/* How two partners touch; returns whether there is anything to be seen: depth may be negative then. */
i64 look(const struct contacts *c, const struct scene *x, const struct touch *t, struct seen *seen)
{
    seen->apart = 0.0;
    if (t->b >= c->segments) return look_at_solid(c, x, t, seen);
    return meet(c, x, t, 0, seen) && show(c, x, t, seen);
}
