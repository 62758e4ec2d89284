/* Rules with corners in time and constraints: SHAKE between saved frames, RATTLE at them.
 *
 * With P the momentum after the inertia of a step, F the forces at a time node and i the impulses of the multipliers,
 *
 *     P + h F(q_j) + G'(q_j) i = -D_0 T_d(q_j, q_j+1),   g(q_j+1) = 0   ->   q_j+1, i;      P = D_1 T_d(q_j, q_j+1)
 *
 * by Newton's method with the matrix of q_j: M v + G' n = 0, h G v = -g.
 *
 * Source: Ryckaert, Ciccotti, Berendsen (1977); Andersen (1983); Hairer, Lubich, Wanner (2006), section VII.1.4.
 */
#include <math.h>
#include <string.h>
#include "engine.h"

static const i64 MOST_PASSES = 50;

static double *row_of(struct explicit_group *g, i64 block, i64 row)
{
    return g->data + (block * g->rows + row) * LANES;
}

/* A row of a node: the block of its slot. */
static double *part_of(struct explicit_run *e, const i64 *slot, i64 row)
{
    return row_of(e->group + slot[0], slot[1], row) + slot[2];
}

/* Give a kernel its step and times. */
static double *times(struct problem *p, struct explicit_group *g, i64 which, i64 setup, double h, i64 number,
                     i64 following)
{
    double *u = g->uniforms + which * g->width;
    u[0] = h, u[1] = p->origin + (p->first + (double)number) * p->h;
    u[2] = p->origin + (p->first + (double)following) * p->h;
    ((prepare)setup)(u);
    return u;
}

/* Add part times the time-dependent loads to their rows. */
static void load(struct explicit_run *e, i64 number, double part)
{
    for (i64 n = 0; n < e->entry_count; n++) {
        const i64 *entry = e->entries + 7 * n, form = entry[5];
        const double *given = e->table + number * e->columns + entry[6];
        const double *scale = e->scales + 4 * n, *lever = scale + 1;
        double s = part * scale[0], u = s * given[0], v = s * given[1], w = s * given[2];
        if (form) {
            const double *p = part_of(e, entry, entry[4]);
            double r = 2.0 * p[0] * (form == 2 ? 1.0 : -1.0), x = p[LANES], y = p[2 * LANES], z = p[3 * LANES];
            double a = y * w - z * v, b = z * u - x * w, c = x * v - y * u;
            u += r * a + 2.0 * (y * c - z * b), v += r * b + 2.0 * (z * a - x * c), w += r * c + 2.0 * (x * b - y * a);
        }
        if (lever[0] != 0.0 || lever[1] != 0.0 || lever[2] != 0.0) { /* the moment of a force off the node */
            double a = lever[1] * w - lever[2] * v, b = lever[2] * u - lever[0] * w;
            w = lever[0] * v - lever[1] * u, u = a, v = b;
        }
        double *out = part_of(e, entry, entry[3]);
        out[0] += u, out[LANES] += v, out[2 * LANES] += w;
    }
}

/* Evaluate contacts where the nodes are, a step after they were evaluated last. */
static i64 meet(struct explicit_run *e)
{
    struct contacts *c = e->contacts;
    for (i64 n = 0; n < c->nodes; n++) {
        const i64 *slot = e->contact_slot + 7 * n;
        const double *value = part_of(e, slot, slot[3]);
        double *out = e->contact_values + n * c->rows;
        for (i64 k = 0; k < c->rows; k++) out[k] = value[k * LANES];
    }
    return touch_all(c, c->state, e->contact_values, e->problem->h);
}

/* Add part times the forces of contacts to their rows. */
static void press(struct explicit_run *e, double part)
{
    struct contacts *c = e->contacts;
    for (i64 n = 0; n < c->nodes; n++) {
        const i64 *slot = e->contact_slot + 7 * n;
        const double *force = c->force + n * c->dofs;
        double *out = part_of(e, slot, slot[6]);
        for (i64 d = 0; d < c->dofs; d++) out[d * LANES] += part * force[d];
    }
}

/* Power of the forces of contacts at the predicted velocities: kernels book it as work of loads, but it is none. */
static double pressing_power(struct explicit_run *e)
{
    struct contacts *c = e->contacts;
    double power = 0.0;
    for (i64 n = 0; n < c->nodes; n++) {
        const i64 *slot = e->contact_slot + 7 * n;
        const double *v = part_of(e, slot, slot[5]), *force = c->force + n * c->dofs;
        for (i64 d = 0; d < c->dofs; d++) power += force[d] * v[d * LANES];
    }
    return power;
}

/* Copy values (to control i) and, if wanted, momenta out of the blocks. */
static void collect(struct explicit_run *e, i64 i, double *momenta)
{
    struct problem *p = e->problem;
    for (i64 n = 0; n < p->nodes; n++) {
        const i64 *slot = e->slot + 6 * n;
        const double *value = part_of(e, slot, slot[3]), *mu = part_of(e, slot, slot[4]);
        double *out = p->control + (i * (p->nodes + 1) + n) * p->rows;
        for (i64 k = 0; k < p->rows; k++) out[k] = value[k * LANES];
        for (i64 d = 0; d < p->dofs && momenta; d++) momenta[n * p->dofs + d] = mu[d * LANES];
    }
}

static void put_momenta(struct explicit_run *e, const double *momenta)
{
    struct problem *p = e->problem;
    for (i64 n = 0; n < p->nodes; n++) {
        const i64 *slot = e->slot + 6 * n;
        double *mu = part_of(e, slot, slot[4]);
        for (i64 d = 0; d < p->dofs; d++) mu[d * LANES] = momenta[n * p->dofs + d];
    }
}

/* Whether any constraint, spring or damper, or prediction for them, wants mass matrices. */
static i64 tied(struct problem *p)
{
    return p->couplings || p->terms > p->inertia;
}

/* Let the predicted velocities know springs and dampers, whose forces f act for ``half`` a step as the others the kernel
 * knows, and satisfy the constraints: M v + G' n = M v* + half f, G v = rate. */
static void complete_predicted(struct explicit_run *e, i64 number, i64 i, double half)
{
    struct problem *p = e->problem;
    if (!tied(p)) return;
    for (i64 n = 0; n < p->nodes; n++) {
        const i64 *slot = e->slot + 6 * n;
        const double *v = part_of(e, slot, slot[5]);
        for (i64 d = 0; d < p->dofs; d++) p->velocity[n * p->dofs + d] = v[d * LANES];
    }
    multiply_mass(p, p->velocity, p->momenta);
    if (half > 0.0 && p->terms > p->inertia) {
        add_ties(p, 0, 0, half, p->momenta);
        velocities(p, number, i, p->h, p->momenta, p->velocity);
        add_ties(p, 1, p->velocity, half, p->momenta);
    }
    velocities(p, number, i, p->h, p->momenta, p->velocity);
    for (i64 n = 0; n < p->nodes; n++) {
        const i64 *slot = e->slot + 6 * n;
        double *v = part_of(e, slot, slot[5]);
        for (i64 d = 0; d < p->dofs; d++) v[d * LANES] = p->velocity[n * p->dofs + d];
    }
}

/* Add part times all forces to the momenta; those after the kick are in ``given``, too.
 *
 * known: whether velocities are those of a saved frame; the drives are those of control i of step ``number_of``. Forces of
 * dampers take the velocities in the middle of the kick, predicted twice so that order 2 is kept (discrete/forced.py). */
static void kick(struct explicit_run *e, i64 number, double part, i64 known, i64 number_of, i64 i)
{
    struct problem *p = e->problem;
    i64 size = (p->nodes + 1) * p->dofs;
    collect(e, 0, e->before);
    i64 predicted = e->group->predict != 0;
    if (predicted) {
        load(e, number, 1.0);
        if (e->contacts) press(e, 1.0);
        for (struct explicit_group *g = e->group; g < e->group + e->groups; g++) {
            double *u = times(p, g, 2, g->predict_setup, known ? 0.0 : p->h, number, number + 1);
            ((kernel)g->predict)(g->data, u, 1, g->blocks + 1);
        }
        complete_predicted(e, number_of, i, known ? 0.0 : 0.5 * p->h);
        if (e->contacts) p->energy[1] -= part * pressing_power(e);
    }
    for (struct explicit_group *g = e->group; g < e->group + e->groups; g++) {
        double *u = times(p, g, 0, g->kick_setup, part, number, number);
        ((kernel)g->kick)(g->data, u, 1, g->blocks + 1);
    }
    if (!predicted) load(e, number, part);
    if (!predicted && e->contacts) press(e, part);
    collect(e, 0, e->given);
    if (p->terms == p->inertia) return;
    add_ties(p, 0, 0, part, e->given);
    i64 damped = 0;
    for (i64 n = p->inertia; n < p->terms; n++) damped |= p->term[n].rates;
    if (damped) {
        double half = known ? 0.0 : 0.5 * p->h / part;
        for (i64 k = 0; k < size; k++) p->momenta[k] = e->before[k] + half * (e->given[k] - e->before[k]);
        velocities(p, number_of, i, p->h, p->momenta, p->velocity);
        if (!known) {
            add_ties(p, 1, p->velocity, 0.5 * p->h, p->momenta);
            velocities(p, number_of, i, p->h, p->momenta, p->velocity);
        }
        add_ties(p, 1, p->velocity, part, e->given);
        for (i64 n = p->inertia; n < p->terms; n++) p->energy[2] += p->term[n].work[1];
    }
    put_momenta(e, e->given);
}

/* Copy the blocks that constraints know out of the data, or back. */
static void copy_known(struct explicit_run *e, i64 back)
{
    for (struct explicit_group *g = e->group; g < e->group + e->groups; g++)
        for (i64 n = 0; n < g->span_count; n++) {
            const i64 *span = g->spans + 3 * n;
            i64 offset = span[0] * g->rows * LANES, size = (span[1] - span[0]) * g->rows * LANES;
            double *data = g->data + offset, *saved = g->saved + offset;
            if (span[2]) memcpy(back ? data : saved, back ? saved : data, (size_t)size * sizeof(double));
        }
}

static i64 drift(struct explicit_run *e, i64 number, i64 first)
{
    i64 bad = 0;
    for (struct explicit_group *g = e->group; g < e->group + e->groups; g++) {
        double *u = times(e->problem, g, 1, g->drift_setup, e->problem->h, number, number + 1);
        for (i64 n = 0; n < g->span_count; n++) {
            const i64 *span = g->spans + 3 * n;
            if (first || span[2]) bad += ((kernel)g->drift)(g->data, u, span[0], span[1]);
        }
    }
    return bad;
}

/* What rounding leaves of g. */
static double rounding(struct problem *p)
{
    double most = 1.0;
    for (i64 k = 0; k < p->nodes * p->rows; k++) {
        double size = __builtin_fabs(p->control[k]);
        most = size > most ? size : most;
    }
    return 1e-15 * (1.0 + p->extent * most);
}

/* Multipliers as forces: the last ones carried on; the first step after a frame takes them as they are. */
static void guess(struct problem *p, i64 onward)
{
    for (i64 n = 0; n < p->couplings; n++) {
        struct coupling *c = &p->coupling[n];
        for (i64 k = 0; k < c->cells * c->gauss * c->count; k++) {
            c->multiplier[k] = onward ? 2.0 * c->start[k] - c->kept[k] : c->start[k];
            c->kept[k] = c->start[k];
        }
    }
}

/* Correct the multipliers by the solution of the saddle point. */
static void correct(struct problem *p, double part)
{
    for (i64 n = 0; n < p->couplings; n++) {
        struct coupling *c = &p->coupling[n];
        i64 together = c->gauss * c->count;
        for (i64 cell = 0; cell < c->cells; cell++)
            for (i64 at = 0; at < together; at++) {
                double weight = c->weight[(cell / LANES * c->gauss + at / c->count) * LANES + cell % LANES];
                c->multiplier[cell * together + at] -= p->unknown[c->spot[cell] + at] / (part * weight);
            }
    }
}

/* One step; returns an outcome. */
static i64 step(struct explicit_run *e, i64 number, i64 j)
{
    struct problem *p = e->problem;
    double part = j ? p->h : 0.5 * p->h, time = p->origin + (p->first + (double)number) * p->h, last = INFINITY;
    p->counts[2] = number;
    if (j && e->contacts) {
        i64 outcome = meet(e);
        if (outcome) return outcome;
    }
    collect(e, 0, 0);
    i64 failed = tied(p) ? saddle_point(p, number, 0, time) : 0;
    if (failed) {
        p->counts[3] = failed - 1;
        return REDUNDANT;
    }
    kick(e, number, part, j == 0, number, 0);
    guess(p, j > 1);
    double floor = rounding(p);
    copy_known(e, 0);
    for (i64 pass = 0; pass < MOST_PASSES; pass++) {
        if (pass) copy_known(e, 1);
        memcpy(p->momenta, e->given, (size_t)((p->nodes + 1) * p->dofs) * sizeof(double));
        push_multipliers(p, part, p->momenta);
        put_momenta(e, p->momenta);
        if (drift(e, number, pass == 0)) return NOT_CONVERGED;
        collect(e, 1, 0);
        memset(p->unknown, 0, (size_t)p->unknowns * sizeof(double));
        double size = violations(p, number, 1, time + p->h);
        p->counts[0]++;
        if (pass + 1 > p->counts[1]) p->counts[1] = pass + 1;
        if (size <= floor || (size <= 1e-11 && size > 0.5 * last)) {
            p->energy[1] += drive_work(p, number, part);
            for (i64 n = 0; n < p->couplings; n++) {
                struct coupling *c = &p->coupling[n];
                memcpy(c->start, c->multiplier, (size_t)(c->cells * c->gauss * c->count) * sizeof(double));
            }
            return FINISHED;
        }
        if (!(size < 1e3)) return NOT_CONVERGED;
        last = size;
        for (i64 n = 0; n < p->couplings; n++) {
            struct coupling *c = &p->coupling[n];
            for (i64 cell = 0; cell < c->cells; cell++)
                for (i64 at = 0; at < c->gauss * c->count; at++) p->unknown[c->spot[cell] + at] /= -p->h;
        }
        solve(p->fronts, p->matrix, p->pivots, p->unknown);
        correct(p, part);
    }
    return NOT_CONVERGED;
}

static void hold_momenta(struct explicit_run *e)
{
    for (struct explicit_group *g = e->group; g < e->group + e->groups; g++)
        for (i64 k = 0; k < g->fixed_count; k++) {
            const i64 *place = g->fixed + 3 * k;
            row_of(g, place[0], place[1])[place[2]] = 0.0;
        }
}

/* Advance through ``saves`` saves of ``stride`` steps each; ``reached`` is the number of saves written. */
i64 advance_explicit(struct explicit_run *e, i64 *reached)
{
    struct problem *p = e->problem;
    for (*reached = 0; *reached < p->saves; ++*reached) {
        for (i64 j = 0; j < p->stride; j++) {
            i64 outcome = step(e, *reached * p->stride + j, j);
            if (outcome) return outcome;
        }
        i64 number = (*reached + 1) * p->stride;
        if (e->contacts) {
            i64 outcome = meet(e);
            if (outcome) return outcome;
        }
        collect(e, 0, 0);
        double time = p->origin + (p->first + (double)number) * p->h;
        i64 failed = tied(p) ? saddle_point(p, number - 1, 1, time) : 0;
        if (failed) {
            p->counts[3] = failed - 1;
            return REDUNDANT;
        }
        kick(e, number, 0.5 * p->h, 0, number - 1, 1);
        hold_momenta(e);
        if (tied(p)) {
            collect(e, 0, p->momenta);
            velocities(p, number - 1, 1, p->h, p->momenta, p->velocity);
            p->energy[1] += projection_work(p);
            multiply_mass(p, p->velocity, p->momenta);
            put_momenta(e, p->momenta);
            hold_momenta(e);
        }
        if (e->contacts) {
            struct contacts *c = e->contacts;
            p->energy[2] += c->told[1], c->told[1] = 0.0;
            tell_contacts(c, *reached, e->contact_told, e->contact_force);
        }
        memcpy(p->works + 2 * *reached, p->energy + 1, 2 * sizeof(double));
        double check = 0.0;
        for (struct explicit_group *g = e->group; g < e->group + e->groups; g++)
            for (i64 block = 0; block < g->blocks; block++) {
                const double *from = row_of(g, block + 1, 0);
                double *to = g->frames + (*reached * g->blocks + block) * g->kept * LANES;
                memcpy(to, from, (size_t)(g->kept * LANES) * sizeof(double));
                for (i64 k = 0; k < g->kept * LANES; k++) check += 0.0 * to[k];
            }
        if (!isfinite(check)) return NOT_FINITE;
    }
    return FINISHED;
}
