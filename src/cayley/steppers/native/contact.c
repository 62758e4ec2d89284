/* Contact: a potential of the depth of every contact, Coulomb friction with sticking, and damping.
 *
 * With depth d of two partners (in part e of a radius the stiffness sets in, so that forces are smooth)
 *
 *     V(d) = k d^3/(6 e) for 0 < d < e,   k (d^2/2 - e d/2 + e^2/6) beyond;   N = V'(d),   friction |T| <= mu N
 *
 * sticks by a spring: T = -k_t s - c_t ds/dt, where s grows with the tangential motion of the two material points and
 * keeps to |k_t s| <= mu N by slipping (Cundall, Strack 1979). What friction and damping take is told as loss.
 */
#include <math.h>
#include <string.h>
#include "contact.h"
#include "contact_laws.h"

static const double FASTEST = 0.2;   /* part of a radius by which partners that touch may come nearer in a step */
static const double SLOWER = 3.5;    /* ways of points that bring two segments with their curves nearer by one, less round-off */
static const double LATE = 0.5;      /* part of the momentum that all dampers on a node may take in a step */
static const double LEVER = 0.2;     /* part of the mass that a node has at the surface, where it turns: m r^2/J is up to 4 */
static const double STEPS = 20.0;    /* steps that a list is to last */

static void place_points(const struct contacts *c, const double *values, double *point)
{
    i64 last = -1;
    double m[9];
    for (i64 k = 0; k < c->points; k++) {
        const double *node = values + c->node[k] * c->rows, *x = node + c->place_row, *o = c->offset + 3 * k;
        memcpy(point + 3 * k, x, 3 * sizeof(double));
        if (o[0] == 0.0 && o[1] == 0.0 && o[2] == 0.0) continue;
        if (c->node[k] != last) rotation_matrix(node + c->turn_row, m), last = c->node[k];
        for (i64 d = 0; d < 3; d++) point[3 * k + d] += DOT(m + 3 * d, o);
    }
}

/* Longest way of points and of surfaces of solids between two sets of places. */
double longest(const struct contacts *c, const double *p, const double *q, const double *values, const double *others)
{
    double most = 0.0, far = 0.0;
    for (i64 k = 0; k < 3 * c->points; k += 3) {
        double d[3] = {p[k] - q[k], p[k + 1] - q[k + 1], p[k + 2] - q[k + 2]}, square = DOT(d, d);
        most = square <= most ? most : square; /* also for NaN */
    }
    most = sqrt(most);
    for (i64 k = 0; k < c->solids; k++) {
        if (c->carrier[k] == c->nodes) continue;
        const double *a = values + c->carrier[k] * c->rows, *b = others + c->carrier[k] * c->rows;
        double way = 0.0, turn = 0.0;
        for (i64 d = 0; d < 3; d++) way += pow(a[c->place_row + d] - b[c->place_row + d], 2.0);
        for (i64 d = 0; d < 4; d++) turn += pow(a[c->turn_row + d] - b[c->turn_row + d], 2.0);
        far = sqrt(way) + 2.0 * sqrt(turn) * c->bound[k];
        most = far <= most ? most : far;
    }
    return most;
}

static void swap(double **a, double **b)
{
    double *own = *a;
    *a = *b, *b = own;
}

void list_near(struct contacts *c, struct scene *x)
{
    search(c, x);
    memcpy(x->listed_point, x->point, (size_t)(3 * c->points) * sizeof(double));
    memcpy(x->listed_values, x->values, (size_t)((c->nodes + 1) * c->rows) * sizeof(double));
    x->listed = 1, x->unit = INFINITY;
    for (i64 n = 0; n < x->count; n++) x->unit = x->touch[n].unit < x->unit ? x->touch[n].unit : x->unit;
    c->told[4] = (double)x->count, c->told[5] += 1.0;
}

/* Let the list know all that can touch between the places before and now. */
static void renew(struct contacts *c, struct scene *x)
{
    double moved = longest(c, x->point, x->listed_point, x->values, x->listed_values);
    x->stride = longest(c, x->point, x->old_point, x->values, x->old_values);
    x->gone += x->stride;
    if (!isfinite(moved)) return;
    if (2.0 * moved > x->margin) { /* faster than foreseen: from where they came */
        x->margin = 4.0 * QUICKER * x->stride + c->clearance;
        swap(&x->point, &x->old_point), swap(&x->values, &x->old_values);
        place_solids(c, x->values, x->pose);
        list_near(c, x);
        swap(&x->point, &x->old_point), swap(&x->values, &x->old_values);
        place_solids(c, x->values, x->pose);
    }
}

/* List again where the next step might leave what the list knows. */
static void look_ahead(struct contacts *c, struct scene *x)
{
    double moved = longest(c, x->point, x->listed_point, x->values, x->listed_values);
    if (!isfinite(moved) || 2.0 * (moved + QUICKER * x->stride) <= x->margin) return;
    double wanted = 2.0 * STEPS * x->stride, least = c->clearance + 4.0 * QUICKER * x->stride;
    double most = 10.0 * least;
    x->margin = wanted < least ? least : wanted > most ? most : wanted;
    list_near(c, x);
}

/* Whether partners that touch neither before nor now touched in between. A graze of two rods, which may as well be one that
 * hands its contact on from element to element, is no passage. */
i64 swept(struct contacts *c, struct scene *x, double unit)
{
    i64 parts = (i64)ceil(2.0 * x->stride / (SWEEP * unit));
    struct scene y = *x;
    struct seen seen, now;
    parts = parts < 200 ? parts : 200;
    y.point = x->between_point, y.values = x->between_values, y.pose = x->between_pose;
    i64 hit = 0;
    for (i64 k = 1; k < parts && !hit; k++) {
        double f = (double)k / (double)parts;
        for (i64 i = 0; i < (c->nodes + 1) * c->rows; i++) y.values[i] = x->old_values[i] + f * (x->values[i] - x->old_values[i]);
        place_points(c, y.values, y.point);
        place_solids(c, y.values, y.pose);
        for (i64 n = 0; n < x->count && !hit; n++) {
            struct touch *t = x->touch + n;
            i64 both = t->b < c->segments;
            if (t->touching || !look(c, &y, t, &seen) || seen.depth <= (both ? FASTEST * t->unit : 0.0)) continue;
            if ((look(c, x, t, &now) || both) && now.depth > 0.0) continue; /* they touch now, too, or others of the two rods */
            c->blame[0] = t->a, c->blame[1] = t->b;
            hit = 1;
        }
    }
    return hit;
}

/* Turn of a node from the places before to those now: several contacts ask for it. */
static const struct turn *turn_of(const struct contacts *c, const struct scene *x, i64 node)
{
    struct turn *t = x->turn + node;
    if (t->places == x->places) return t;
    const double *p = x->values + node * c->rows + c->turn_row, *q = x->old_values + node * c->rows + c->turn_row;
    double w = DOT(p + 1, q + 1) + p[0] * q[0], f = w == 0.0 ? 0.0 : 2.0 / w, *turn = t->vector;
    CROSS(q + 1, p + 1, turn);
    for (i64 k = 0; k < 3; k++) turn[k] = f * (p[1 + k] * q[0] - p[0] * q[1 + k] + turn[k]);
    t->share = 1.0 / (1.0 + 0.25 * DOT(turn, turn)), t->places = x->places;
    return t;
}

/* The way of the material point of a node that is at a lever from it now: with l half way, turn x l is added. */
void way_of(const struct contacts *c, const struct scene *x, i64 node, const double *lever, double part, double *way,
            double *turned)
{
    const double *p = x->values + node * c->rows + c->place_row, *q = x->old_values + node * c->rows + c->place_row;
    double over[3], twice[3];
    if (node == c->nodes) return;
    const struct turn *t = turn_of(c, x, node);
    const double *turn = t->vector, share = t->share;
    CROSS(turn, lever, over);
    CROSS(turn, over, twice);
    for (i64 k = 0; k < 3; k++) {
        way[k] += part * (p[k] - q[k] + share * (over[k] - 0.5 * twice[k]));
        turned[k] += 0.5 * fabs(part) * turn[k];
    }
}

/* Nodes, levers and weights of the two partners: at most eight, weights of the second negative. Levers go so far from the
 * centers (reach 0) to the contact (1). */
i64 feet(const struct contacts *c, const struct scene *x, const struct touch *t, const struct seen *seen, double reach,
         struct foot *foot)
{
    i64 count = 0;
    for (i64 side = 0; side < 2; side++) {
        const i64 *points = side ? seen->point_b : seen->point_a;
        const double *weights = side ? seen->weight_b : seen->weight_a;
        double arm = reach * (side ? seen->arm_b : -seen->arm_a);
        for (i64 n = 0; n < (side ? seen->count_b : seen->count_a); n++) {
            struct foot *f = foot + count++;
            f->node = c->node[points[n]], f->weight = side ? -weights[n] : weights[n];
            const double *place = x->values + f->node * c->rows + c->place_row;
            for (i64 k = 0; k < 3; k++) f->lever[k] = x->point[3 * points[n] + k] - place[k] + arm * seen->normal[k];
        }
    }
    if (t->b >= c->segments) {
        struct foot *f = foot + count++;
        f->node = c->carrier[t->b - c->segments], f->weight = -1.0;
        const double *place = x->values + f->node * c->rows + c->place_row;
        for (i64 k = 0; k < 3; k++) f->lever[k] = seen->place[k] - place[k];
    }
    return count;
}

/* Add a force on the first partner, and its opposite on the second, to what presses on the nodes. */
static void push_nodes(struct scene *x, const struct foot *foot, i64 count, const double *force)
{
    for (i64 n = 0; n < count; n++) {
        const struct foot *f = foot + n;
        double push[3] = {f->weight * force[0], f->weight * force[1], f->weight * force[2]}, moment[3];
        double *to = x->push + 6 * f->node;
        CROSS(f->lever, push, moment);
        for (i64 k = 0; k < 3; k++) to[k] += push[k], to[3 + k] += moment[k];
    }
}

/* Hand what presses on the nodes over as forces on their degrees of freedom. */
void press_nodes(struct contacts *c, struct scene *x)
{
    double m[9];
    memset(c->force, 0, (size_t)((c->nodes + 1) * c->dofs) * sizeof(double));
    for (i64 node = 0; node < c->nodes; node++) {
        double *from = x->push + 6 * node, *to = c->force + node * c->dofs;
        if (from[0] == 0.0 && from[1] == 0.0 && from[2] == 0.0) continue;
        rotation_matrix(x->values + node * c->rows + c->turn_row, m);
        memcpy(to + c->place_dof, from, 3 * sizeof(double));
        times_transposed(m, from + 3, to + c->turn_dof);
    }
    memset(x->push, 0, (size_t)(6 * (c->nodes + 1)) * sizeof(double));
}

void part_from(struct contacts *c, struct touch *t)
{
    if (t->touching) c->told[1] += 0.5 * c->shear * t->stiffness * DOT(t->slip, t->slip);
    t->touching = 0, t->allowed = 0.0;
    for (i64 k = 0; k < 3; k++) t->slip[k] = t->push[k] = 0.0;
}

/* Whether partners come nearer by so much of a radius that they might pass. */
static i64 hasty(const struct contacts *c, const struct scene *x, const struct touch *t, const struct seen *seen)
{
    struct foot foot[8];
    double way[3] = {0.0, 0.0, 0.0}, turned[3];
    if (t->touching && seen->depth - t->depth > FASTEST * t->unit) return 1;
    if (t->touching && t->b < c->segments && seen->inside && DOT(seen->normal, t->normal) < 0.0) return 1;
    if (t->touching) return 0;
    i64 count = feet(c, x, t, seen, 1.0, foot);
    for (i64 n = 0; n < count; n++) way_of(c, x, foot[n].node, foot[n].lever, foot[n].weight, way, turned);
    return -DOT(way, seen->normal) > FASTEST * t->unit;
}

/* One contact of a step: its force, its memory and its account. */
void take_contact(struct contacts *c, struct scene *x, struct touch *t, const struct seen *seen, double h)
{
    struct foot foot[8];
    struct law law;
    double way[3] = {0.0, 0.0, 0.0}, turned[3] = {0.0, 0.0, 0.0}, before[3], slip[3];
    i64 count = feet(c, x, t, seen, 1.0, foot);
    for (i64 n = 0; n < count; n++) way_of(c, x, foot[n].node, foot[n].lever, foot[n].weight, way, turned);
    double nearer = t->touching ? seen->depth - t->depth : -DOT(way, seen->normal), along = DOT(way, seen->normal);
    /* points that roll in come nearer though the partners do not: what counts is the depth */
    for (i64 k = 0; k < 3; k++) way[k] -= (along + nearer) * seen->normal[k];
    double last = t->touching ? t->depth : seen->depth;
    t->depth = seen->depth;
    if (t->allowed > 0.0) { /* what goes away gives energy, by half at each end of the step */
        double soft = c->soft * t->unit, less = t->allowed * c->relax;
        struct law old, then;
        law_of(t->stiffness, soft, last - t->allowed, &old), law_of(t->stiffness, soft, last - less, &then);
        c->told[1] -= 0.5 * (then.energy - old.energy);
        law_of(t->stiffness, soft, seen->depth - t->allowed, &old), law_of(t->stiffness, soft, seen->depth - less, &law);
        c->told[1] -= 0.5 * (law.energy - old.energy);
        t->allowed = less;
    } else law_of(t->stiffness, c->soft * t->unit, seen->depth, &law);
    memcpy(before, t->push, sizeof before);
    double held = DOT(t->slip, t->slip);
    carry(t->slip, turned, seen->normal, slip);
    friction_of(c, t, &law, seen->normal, way, h, slip, t->push);
    memcpy(t->slip, slip, sizeof slip);
    memcpy(t->normal, seen->normal, sizeof t->normal);
    for (i64 k = 0; k < 3; k++) before[k] = 0.5 * (before[k] + t->push[k]);
    c->told[1] -= DOT(before, way) + 0.5 * c->shear * t->stiffness * (DOT(slip, slip) - held);
    c->told[0] += law.energy + 0.5 * c->shear * t->stiffness * DOT(slip, slip);
    c->told[3] += 1.0;
    t->touching = 1;
    double force[3];
    for (i64 k = 0; k < 3; k++) force[k] = law.force * seen->normal[k] + t->push[k];
    push_nodes(x, foot, count, force);
    double relative = (seen->depth - t->allowed) / t->unit;
    if (relative > c->told[2]) {
        c->told[2] = relative;
        c->blame[0] = t->a, c->blame[1] = t->b;
    }
}

/* Nodes of a contact, the ground's left out; returns how many, at most four. */
static i64 moved_by(const struct contacts *c, const struct touch *t, i64 *node)
{
    i64 count = 0;
    for (i64 side = 0; side < 2; side++) {
        i64 item = side ? t->b : t->a, solid = item >= c->segments;
        i64 first = solid ? c->carrier[item - c->segments] : c->node[c->ends[2 * item]];
        i64 second = solid ? first : c->node[c->ends[2 * item + 1]];
        if (first < c->nodes) node[count++] = first;
        if (second < c->nodes && second != first) node[count++] = second;
    }
    return count;
}

void count_crowd(const struct contacts *c, struct scene *x)
{
    i64 node[4];
    memset(x->crowd, 0, (size_t)(c->nodes + 1) * sizeof *x->crowd);
    for (i64 n = 0; n < x->count; n++)
        if (x->touch[n].touching)
            for (i64 k = moved_by(c, x->touch + n, node) - 1; k >= 0; k--) x->crowd[node[k]]++;
}

/* Dampers take velocities half a step late, so all on a node together may not be stronger than the mass there takes. */
static void restrain(const struct contacts *c, struct scene *x, struct touch *t, double h)
{
    i64 node[4], most = 1;
    for (i64 k = moved_by(c, t, node) - 1; k >= 0; k--) {
        most = x->crowd[node[k]] > most ? x->crowd[node[k]] : most;
        x->crowding[node[k]]++;
    }
    t->most = t->most_along = LATE * t->mass / ((double)most * h * h);
    if (c->radius[t->a] > 0.0) t->most_along *= LEVER;
}

/* Points and solids where the values are. */
void take_places(const struct contacts *c, struct scene *x)
{
    x->places++;
    place_points(c, x->values, x->point);
    place_solids(c, x->values, x->pose);
}

void take(struct contacts *c, struct scene *x, const double *values)
{
    memcpy(x->values, values, (size_t)((c->nodes + 1) * c->rows) * sizeof(double));
    take_places(c, x);
}

void keep_places(const struct contacts *c, struct scene *x)
{
    memcpy(x->old_point, x->point, (size_t)(3 * c->points) * sizeof(double));
    memcpy(x->old_values, x->values, (size_t)((c->nodes + 1) * c->rows) * sizeof(double));
}

/* Forces of all contacts at values, [nodes + 1][rows], that are a step h after those before. Returns an outcome. */
i64 touch_all(struct contacts *c, i64 state, const double *values, double h)
{
    struct scene *x = (struct scene *)state;
    struct seen seen;
    take(c, x, values);
    renew(c, x);
    c->told[0] = c->told[2] = c->told[3] = 0.0;
    if (2.0 * x->stride > SWEEP * x->unit && isfinite(x->stride) && swept(c, x, x->unit)) return FAST;
    for (i64 n = 0; n < x->count; n++) {
        struct touch *t = x->touch + n;
        if (!t->touching && x->gone < t->free) continue;
        if (!look(c, x, t, &seen) || seen.depth <= 0.0) {
            if (t->touching) part_from(c, t);
            t->free = x->gone + seen.apart / SLOWER;
            continue;
        }
        i64 deep = seen.depth - t->allowed > c->deepest * t->unit;
        if (deep || hasty(c, x, t, &seen)) {
            c->blame[0] = t->a, c->blame[1] = t->b;
            return deep ? DEEP : FAST;
        }
        restrain(c, x, t, h);
        take_contact(c, x, t, &seen, h);
    }
    press_nodes(c, x);
    i64 *crowd = x->crowd;
    x->crowd = x->crowding, x->crowding = crowd;
    memset(crowd, 0, (size_t)(c->nodes + 1) * sizeof *crowd);
    if (c->told[2] > c->told[6]) c->told[6] = c->told[2];
    look_ahead(c, x);
    keep_places(c, x);
    return FINISHED;
}
