/* Contact in implicit rules and equilibria: forces at the stages of a step and their derivatives.
 *
 * At a stage q_k = sum ell_ki q_i a contact is seen as if the step ended there, tau_k h after its start: depth and slip grow
 * from those at the start. What is remembered changes once the step is solved.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "contact_laws.h"

static const double STEPS = 3.0; /* steps that a list is to last */

/* A contact at a stage: force on the first partner, and its derivative by the way of the centers and of the surfaces. */
struct answer {
    double normal[3], tangential[3];
    double by_center[9], by_surface[9];
};

static void outer(const double *a, const double *b, double factor, double *sum)
{
    for (i64 i = 0; i < 3; i++)
        for (i64 j = 0; j < 3; j++) sum[3 * i + j] += factor * a[i] * b[j];
}

/* Force and derivative; grown: of the depth since the start; way: of the surfaces since then, in the time h. */
static void answer_of(const struct contacts *c, const struct touch *t, const struct seen *seen, const struct law *law,
                      const double *way, const double *slip, double grown, double h, struct answer *out)
{
    const double *n = seen->normal, one[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double rate = 2.0 * c->damping * law->grip * sqrt(t->stiffness * t->mass) / h, resist = rate * grown, push[3];
    double spring = c->shear * t->stiffness, damper = 2.0 * STICKING * law->grip * sqrt(spring * t->mass) / h;
    double most = t->friction * law->force, along = DOT(way, n);
    memset(out, 0, sizeof *out);
    if (resist < -law->force) resist = -law->force, rate = -law->rate;
    for (i64 k = 0; k < 3; k++) out->normal[k] = (law->force + resist) * n[k];
    outer(n, n, -law->rate - rate, out->by_center);
    for (i64 k = 0; k < 3; k++) outer(one[k], one[k], law->force * seen->bend, out->by_center);
    outer(n, n, -law->force * seen->bend, out->by_center);
    outer(seen->axis, seen->axis, -law->force * seen->bend, out->by_center);
    if (most == 0.0) return;
    for (i64 k = 0; k < 3; k++) {
        double tangential = way[k] - along * n[k];
        push[k] = -spring * (slip[k] + tangential) - damper * tangential;
    }
    double size = sqrt(DOT(push, push)), part = size > most ? most / size : 1.0, stiff = -(spring + damper) * part;
    for (i64 k = 0; k < 3; k++) out->tangential[k] = part * push[k];
    for (i64 k = 0; k < 3; k++) outer(one[k], one[k], stiff, out->by_surface);
    outer(n, n, -stiff, out->by_surface);
    if (size <= most) return;
    outer(push, push, -stiff / (size * size), out->by_surface);
    outer(push, n, -t->friction * law->rate / size, out->by_center); /* friction grows with the depth */
}

/* [-lever x Lambda | 1]: the way of a point at a lever from a node, by turn (body frame) and place. */
static void lever_matrix(const double *lever, const double *rotation, double out[3][6])
{
    for (i64 j = 0; j < 3; j++) {
        double column[3] = {rotation[j], rotation[3 + j], rotation[6 + j]}, moved[3];
        CROSS(column, lever, moved);
        for (i64 i = 0; i < 3; i++) out[i][j] = moved[i], out[i][3 + j] = i == j;
    }
}

/* Add factor * J_i' M J_j to a block of the matrix, by turns and places. */
static void add_block(double left[3][6], double right[3][6], const double *m, double factor, double out[6][6])
{
    double half[3][6];
    for (i64 i = 0; i < 3; i++)
        for (i64 j = 0; j < 6; j++)
            half[i][j] = m[3 * i] * right[0][j] + m[3 * i + 1] * right[1][j] + m[3 * i + 2] * right[2][j];
    for (i64 i = 0; i < 6; i++)
        for (i64 j = 0; j < 6; j++)
            out[i][j] += factor * (left[0][i] * half[0][j] + left[1][i] * half[1][j] + left[2][i] * half[2][j]);
}

/* Where the block of two nodes stands: that of the candidate's nodes, see contact_nodes. */
static const i64 *place_of(const struct problem *p, i64 touch, const i64 *nodes, i64 a, i64 b)
{
    i64 i = 0, j = 0;
    while (i < 8 && nodes[i] != a) i++;
    while (j < 8 && nodes[j] != b) j++;
    return i < 8 && j < 8 ? p->contact_places + ((touch * 8 + i) * 8 + j) * 2 : 0;
}

static void add_tangent(struct problem *p, i64 touch, const struct foot *foot, const struct foot *surface, i64 count,
                        const struct answer *answer, i64 k, double weight)
{
    const struct contacts *c = p->contacts;
    struct scene *x = (struct scene *)c->state;
    i64 dofs = p->dofs, r = p->stages, controls = r + 1, dof[6];
    double centers[8][3][6], surfaces[8][3][6];
    for (i64 d = 0; d < 3; d++) dof[d] = c->turn_dof + d, dof[3 + d] = c->place_dof + d;
    for (i64 n = 0; n < count; n++) {
        double m[9];
        rotation_matrix(x->values + foot[n].node * c->rows + c->turn_row, m);
        lever_matrix(foot[n].lever, m, centers[n]);
        lever_matrix(surface[n].lever, m, surfaces[n]);
    }
    for (i64 a = 0; a < count; a++)
        for (i64 b = 0; b < count; b++) {
            if (foot[a].node == c->nodes || foot[b].node == c->nodes) continue;
            const i64 *place = place_of(p, touch, p->contact_nodes + 8 * touch, foot[a].node, foot[b].node);
            double block[6][6] = {{0.0}}, factor = weight * foot[a].weight * foot[b].weight;
            if (!place || place[0] < 0) continue;
            add_block(centers[a], centers[b], answer->by_center, factor, block);
            add_block(surfaces[a], surfaces[b], answer->by_surface, factor, block);
            const double *left = p->free + foot[a].node * dofs, *right = p->free + foot[b].node * dofs;
            for (i64 i = p->still; i < (p->still ? 2 : r); i++)
                for (i64 j = 1; j < controls; j++) {
                    double both = p->ell[k * controls + i] * p->ell[k * controls + j];
                    double *out = p->matrix + place[0] + (i - p->still) * dofs * place[1] + (j - 1) * dofs;
                    for (i64 d = 0; d < 6; d++)
                        for (i64 e = 0; e < 6; e++)
                            out[dof[d] * place[1] + dof[e]] += both * left[dof[d]] * right[dof[e]] * block[d][e];
                }
        }
}

/* Add a force on the nodes of a contact to the equations, as that of loads in terms.c. */
static void add_force(struct problem *p, const struct foot *foot, i64 count, const double *force, i64 k, double weight)
{
    const struct contacts *c = p->contacts;
    struct scene *x = (struct scene *)c->state;
    i64 rows = p->rows, dofs = p->dofs, r = p->stages, controls = r + 1, values = (p->nodes + 1) * rows;
    for (i64 n = 0; n < count; n++) {
        i64 node = foot[n].node;
        if (node == c->nodes) continue;
        const double *z = x->values + node * rows + c->turn_row;
        double push[rows], out[dofs], f[3], moment[3], body[3], m[9];
        memset(push, 0, sizeof push);
        for (i64 d = 0; d < 3; d++) f[d] = foot[n].weight * force[d];
        CROSS(foot[n].lever, f, moment);
        rotation_matrix(z, m);
        times_transposed(m, moment, body);
        push_turn(z, body, push + c->turn_row);
        memcpy(push + c->place_row, f, sizeof f);
        for (i64 i = p->still; i <= r; i++) {
            i64 equation = i - p->still;
            trivialize(p, push, p->control + i * values + node * rows, out);
            double *sum = equation < r ? p->residual + (node * r + equation) * dofs : p->after + node * dofs;
            for (i64 d = 0; d < dofs; d++) sum[d] += weight * p->ell[k * controls + i] * out[d];
        }
    }
}

static void at_stage(struct problem *p, i64 k, double *values)
{
    i64 size = (p->nodes + 1) * p->rows, controls = p->stages + 1;
    for (i64 n = 0; n < size; n++) {
        values[n] = 0.0;
        for (i64 i = 0; i < controls; i++) values[n] += p->ell[k * controls + i] * p->control[i * size + n];
    }
}

/* Forces of contacts at all stages, their loss, and, if wanted, their derivatives. */
void add_contacts(struct problem *p, double h, i64 tangent)
{
    struct contacts *c = p->contacts;
    struct scene *x = (struct scene *)c->state;
    struct seen seen;
    struct law law;
    struct answer answer;
    x->loss = 0.0;
    for (i64 k = 0; k < p->stages; k++) {
        double weight = h * p->weights[k], part = p->still ? 1.0 : p->at[k];
        at_stage(p, k, x->values);
        take_places(c, x);
        for (i64 n = 0; n < x->count; n++) {
            struct touch *t = x->touch + n;
            struct foot foot[8], surface[8];
            double way[3] = {0.0, 0.0, 0.0}, turned[3] = {0.0, 0.0, 0.0}, slip[3];
            i64 held = x->holding && t->b < c->segments;
            i64 near = held ? look_at_held(c, x, t, x->held + k * x->count + n, &seen) : look(c, x, t, &seen);
            if (!near || seen.depth <= t->allowed) continue;
            i64 count = feet(c, x, t, &seen, 0.0, foot);
            feet(c, x, t, &seen, 1.0, surface);
            for (i64 m = 0; m < count; m++) way_of(c, x, surface[m].node, surface[m].lever, surface[m].weight, way, turned);
            double along = DOT(way, seen.normal), grown = seen.depth - (t->touching ? t->depth : 0.0);
            if (!t->touching && grown > -along) grown = -along; /* another segment of the rod was that deep before */
            law_of(t->stiffness, c->soft * t->unit, seen.depth - t->allowed, &law);
            carry(t->slip, turned, seen.normal, slip);
            answer_of(c, t, &seen, &law, way, slip, grown, part * h, &answer);
            add_force(p, foot, count, answer.normal, k, weight);
            if (t->friction > 0.0) add_force(p, surface, count, answer.tangential, k, weight);
            if (tangent) add_tangent(p, n, foot, surface, count, &answer, k, weight);
            double resist = DOT(answer.normal, seen.normal) - law.force;
            x->loss += p->weights[k] / part * (resist * grown - DOT(answer.tangential, way) + along * DOT(answer.tangential, seen.normal));
        }
    }
}

/* Hold where segments come nearest at the stages; returns how far those that touch have moved since it was done last, in
 * radii. */
double hold_contacts(struct problem *p)
{
    struct contacts *c = p->contacts;
    struct scene *x = (struct scene *)c->state;
    double most = 0.0;
    if (p->stages * x->count > x->held_room) {
        x->held_room = p->stages * x->count;
        x->held = realloc(x->held, (size_t)x->held_room * sizeof *x->held);
    }
    if (!x->holding) memset(x->held, 0, (size_t)(p->stages * x->count) * sizeof *x->held);
    x->holding = 1;
    for (i64 k = 0; k < p->stages; k++) {
        at_stage(p, k, x->values);
        take_places(c, x);
        double far = hold_meetings(c, x, x->held + k * x->count);
        most = far > most ? far : most;
    }
    return most;
}

void release_contacts(struct problem *p)
{
    ((struct scene *)p->contacts->state)->holding = 0;
}

/* Let the list know all that may touch in the next step from the first control; returns whether it changed. */
i64 list_contacts(struct problem *p, i64 again)
{
    struct contacts *c = p->contacts;
    struct scene *x = (struct scene *)c->state;
    memcpy(x->values, p->control, (size_t)((p->nodes + 1) * p->rows) * sizeof(double));
    take_places(c, x);
    double moved = longest(c, x->point, x->listed_point, x->values, x->listed_values);
    double least = c->clearance + 4.0 * QUICKER * x->stride, wanted = 2.0 * STEPS * x->stride, most = 5.0 * least;
    keep_places(c, x);
    if (!again && x->listed == 2 && 2.0 * (moved + QUICKER * x->stride) <= x->margin) return 0;
    x->margin = wanted < least ? least : wanted > most ? most : wanted;
    list_near(c, x);
    x->listed = 2;
    return 1;
}

/* Nodes of every candidate, -1 behind them and for the ground, [candidates][8]. */
void contact_nodes(struct contacts *c, i64 *out)
{
    struct scene *x = (struct scene *)c->state;
    for (i64 n = 0; n < x->count; n++, out += 8) {
        const struct touch *t = x->touch + n;
        i64 count = 0;
        for (i64 side = 0; side < 2; side++) {
            i64 item = side ? t->b : t->a;
            if (item >= c->segments) {
                out[count++] = c->carrier[item - c->segments];
                continue;
            }
            const i64 *ends = c->ends + 2 * item, *beyond = c->beyond + 2 * item;
            i64 points[4] = {ends[0], ends[1], t->b < c->segments ? beyond[0] : -1, t->b < c->segments ? beyond[1] : -1};
            for (i64 e = 0; e < 4; e++)
                if (points[e] >= 0) out[count++] = c->node[points[e]];
        }
        for (i64 e = 0; e < 8; e++)
            if (e >= count || out[e] == c->nodes) out[e] = -1;
    }
}

i64 contact_count(const struct contacts *c)
{
    return ((struct scene *)c->state)->count;
}

/* After a step that is solved: 0 if the list knew all that could touch, 1 if it was too short. */
i64 outran(struct problem *p)
{
    struct contacts *c = p->contacts;
    struct scene *x = (struct scene *)c->state;
    i64 size = (p->nodes + 1) * p->rows;
    memcpy(x->values, p->control + p->stages * size, (size_t)size * sizeof(double));
    take_places(c, x);
    x->stride = longest(c, x->point, x->old_point, x->values, x->old_values);
    return 2.0 * longest(c, x->point, x->listed_point, x->values, x->listed_values) > x->margin;
}

/* Whether something passed through something in the step. */
static i64 passed(struct contacts *c, struct scene *x)
{
    struct seen seen, before;
    if (2.0 * x->stride > SWEEP * x->unit && swept(c, x, x->unit)) return 1;
    struct scene old = *x;
    old.point = x->old_point, old.values = x->old_values;
    for (i64 n = 0; n < x->count && x->stride > SWEEP * x->unit; n++) {
        const struct touch *t = x->touch + n;
        if (t->b >= c->segments || !look(c, x, t, &seen) || seen.depth <= 0.0) continue;
        look(c, &old, t, &before);
        if (DOT(seen.normal, before.gap) < 0.0 && seen.inside) {
            c->blame[0] = t->a, c->blame[1] = t->b;
            return 1;
        }
    }
    return 0;
}

/* Take contacts over at the end of a step that is solved; returns whether something passed through. */
i64 accept_contacts(struct problem *p, double h)
{
    struct contacts *c = p->contacts;
    struct scene *x = (struct scene *)c->state;
    struct seen seen;
    if (passed(c, x)) return 1;
    p->energy[2] += x->loss;
    c->told[0] = c->told[2] = c->told[3] = 0.0;
    for (i64 n = 0; n < x->count; n++) {
        struct touch *t = x->touch + n;
        double stored = 0.5 * c->shear * t->stiffness * DOT(t->slip, t->slip), told = c->told[1];
        if (look(c, x, t, &seen) && seen.depth > 0.0) {
            if (!t->touching) t->depth = 0.0, t->touching = 1;
            take_contact(c, x, t, &seen, h);
        } else if (t->touching) part_from(c, t);
        c->told[1] = told; /* what it took was told by the stages, */
        p->energy[2] -= 0.5 * c->shear * t->stiffness * DOT(t->slip, t->slip) - stored; /* but for what is stored */
    }
    press_nodes(c, x);
    if (c->told[2] > c->told[6]) c->told[6] = c->told[2];
    return 0;
}
