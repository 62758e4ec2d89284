/* Steps: Newton's method on the equations of the control nodes of a step,
 *
 *     mu_a + D_(a,0) L_d = 0,   D_(a,i) L_d = 0 (0 < i < r)   -> q_(a,1) ... q_(a,r),      mu_a+ = D_(a,r) L_d
 *
 * with the constraints of couplings.c.
 */
#include <math.h>
#include <string.h>
#include "engine.h"

#ifndef SOURCES
#error "compile with hatch_build.py, which defines SOURCES"
#endif

const char *sources(void)
{
    return SOURCES;
}

static const i64 QUICK_ITERATIONS = 20;
static const i64 ITERATIONS = 60; /* most iterations of the first try of a step, and of the careful ones */
static const double STEP_TOLERANCE = 1e-9;  /* with a new tangent the next correction would be about the square */
static const double LEFT_TOLERANCE = 1e-16; /* what corrections with one tangent may leave in all */
static const double SLOW = 0.15;            /* a rate of corrections that asks for a new tangent whatever it costs */
static const double SMALL_CORRECTION = 1e-5; /* with a new tangent one more correction is enough */
static const double FLOOR = 1e-6;           /* below, a correction that no longer shrinks by this is rounding */
static const double IDLE = 0.3, IDLE_TOUCHING = 0.9; /* (tangents of contacts are not exact) */
static const double LARGEST_TURN = 1.0;     /* longest correction of a rotation [rad] */
static const double LARGEST_GROWTH = 2.0;   /* a correction so many times the one before is too long */
static const double WILD_GROWTH = 10.0;     /* the quick try is given up when a correction is so much longer */
static const double SMALLEST_PART = 0.02;   /* smallest part of a correction that is tried */
static const double FIRST_PART = 1.0 / 16.0; /* the solution is followed from that of a step so much shorter, */
static const double SHORTEST_PART = 1e-4;    /* if need be down to this, */
static const double SMALLEST_GROWTH = 1.0002;  /* by factors that fall from 2 to this */

static const i64 ROUNDS = 5;       /* times that places of contacts are held while a step is solved, */
static const double HELD = 1e-3;   /* unless they stay within so much of a radius */
static const i64 LONGER = 8; /* tries with longer lists of contacts */

static const i64 SINGULAR = -1; /* what newton returns where there is no first correction */

/* Residual (in the right-hand side), momenta and, if wanted, the matrix. */
void assemble(struct problem *p, i64 number, double begin, double h, i64 tangent)
{
    i64 dofs = p->dofs, r = p->stages;
    memset(p->residual, 0, (size_t)((p->nodes + 1) * r * dofs) * sizeof(double));
    memset(p->after, 0, (size_t)((p->nodes + 1) * dofs) * sizeof(double));
    if (tangent) memset(p->matrix, 0, (size_t)p->matrix_size * sizeof(double));
    add_terms(p, begin, h, tangent);
    if (p->still) add_still_loads(p, tangent);
    else add_loads(p, number, h);
    if (!p->order) add_couplings(p, number, begin, h, tangent);
    if (p->contacts && !p->order) add_contacts(p, h, tangent);
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 i = 0; i < r; i++)
            for (i64 d = 0; d < dofs; d++) {
                double *out = p->unknown + p->place[n] + i * dofs + d;
                double sum = p->residual[(n * r + i) * dofs + d] + (i ? 0.0 : p->momenta[n * dofs + d]);
                *out = p->free[n * dofs + d] ? -sum : 0.0;
                if (tangent && !p->free[n * dofs + d]) p->matrix[p->diagonal[p->place[n] + i * dofs + d]] = 1.0;
            }
}

/* Write the last iterations down: the latest in the last row, NaN where there was none. */
static void note(struct problem *p, i64 iteration, double size, double residual)
{
    i64 last = p->history_size - 1;
    for (i64 k = 0; k < 2 * p->history_size && iteration == 0; k++) p->history[k] = NAN;
    memmove(p->history, p->history + 2, (size_t)(2 * last) * sizeof(double));
    p->history[2 * last] = size, p->history[2 * last + 1] = residual;
}

static void move_multipliers(struct problem *p, const double *x, double part)
{
    for (i64 n = 0; n < p->couplings; n++) {
        struct coupling *c = &p->coupling[n];
        i64 size = p->stages * c->gauss * c->count;
        for (i64 cell = 0; cell < c->cells; cell++)
            for (i64 k = 0; k < size; k++)
                c->multiplier[cell * size + k] = c->kept[cell * size + k] + part * x[c->spot[cell] + k];
    }
}

static void keep_multipliers(struct problem *p)
{
    for (i64 n = 0; n < p->couplings; n++) {
        struct coupling *c = &p->coupling[n];
        memcpy(c->kept, c->multiplier, (size_t)(c->cells * p->stages * c->gauss * c->count) * sizeof(double));
    }
}

/* Whether a new tangent is cheaper than the corrections that this one still needs: at its rate, or, where there is none
 * yet, at the rate of the nonlinearity, which is about the size of the correction. */
static i64 tangent_pays(struct problem *p, double size, double rate)
{
    double rate_to_come = rate > 0.0 ? rate : size < SLOW ? size : SLOW;
    double left = log(LEFT_TOLERANCE / size) / log(rate_to_come);
    return left > p->tangent_cost * (size > SMALL_CORRECTION ? 2.0 : 1.0);
}

/* Solve one step; returns whether it converged, or SINGULAR if there is no first correction.
 *
 * Stiff structures converge fast but not monotonically, so full corrections come first, with a new tangent only where the
 * last one no longer serves. The careful try takes a new tangent every time, takes a correction that makes the next
 * larger for too long (the natural monotonicity test of Deuflhard 2004, section 3.3), takes it back and halves it. */
static i64 newton(struct problem *p, i64 number, double begin, double h, i64 careful, i64 *passes, i64 *worst)
{
    i64 values = (p->stages + 1) * (p->nodes + 1) * p->rows, fresh = 1;
    double last = INFINITY, part = 1.0, turn;
    memcpy(p->accepted, p->control, (size_t)values * sizeof(double));
    keep_multipliers(p);
    for (i64 iteration = 0; iteration < (careful ? ITERATIONS : QUICK_ITERATIONS); iteration++) {
        *passes = iteration + 1;
        assemble(p, number, begin, h, fresh);
        if (fresh && factorize(p->fronts, p->matrix, p->pivots, p->watch)) return iteration ? 0 : SINGULAR;
        double residual = 0.0;
        for (i64 u = 0; u < p->unknowns; u++) {
            double one = __builtin_fabs(p->unknown[u]);
            residual = one > residual ? one : residual;
        }
        solve(p->fronts, p->matrix, p->pivots, p->unknown);
        double size = measure(p, p->unknown, &turn, worst);
        note(p, iteration, size, residual);
        double most = LARGEST_GROWTH * last > FLOOR ? LARGEST_GROWTH * last : FLOOR;
        if (careful && !(size <= most) && part > SMALLEST_PART) { /* also for NaN */
            part *= 0.5;
            memcpy(p->control, p->accepted, (size_t)values * sizeof(double));
            move(p, p->taken, part);
            move_multipliers(p, p->taken, part);
            hold(p);
            continue;
        }
        most = WILD_GROWTH * last > FLOOR ? WILD_GROWTH * last : FLOOR;
        if (!isfinite(size) || (!careful && size > most)) return 0;
        memcpy(p->accepted, p->control, (size_t)values * sizeof(double));
        memcpy(p->taken, p->unknown, (size_t)p->unknowns * sizeof(double));
        keep_multipliers(p);
        part = turn > LARGEST_TURN ? LARGEST_TURN / turn : 1.0;
        move(p, p->taken, part);
        move_multipliers(p, p->taken, part);
        hold(p);
        double rate = size / last; /* 0 at first */
        i64 settled = size <= STEP_TOLERANCE || (size <= FLOOR && rate > (p->contacts ? IDLE_TOUCHING : IDLE));
        if ((fresh && settled) || (rate > 0.0 && rate < SLOW && size * rate <= LEFT_TOLERANCE)) {
            assemble(p, number, begin, h, 0); /* momenta of the corrected nodes, and what is left */
            return 1;
        }
        fresh = careful || rate > SLOW || tangent_pays(p, size, rate);
        last = size;
    }
    return 0;
}

static void stand_still(struct problem *p)
{
    i64 values = (p->nodes + 1) * p->rows;
    for (i64 i = 1; i <= p->stages; i++) memcpy(p->control + i * values, p->control, (size_t)values * sizeof(double));
}

static void start_multipliers(struct problem *p)
{
    for (i64 n = 0; n < p->couplings; n++) {
        struct coupling *c = &p->coupling[n];
        memcpy(c->multiplier, c->start, (size_t)(c->cells * p->stages * c->gauss * c->count) * sizeof(double));
    }
}

/* Start with the velocities that the momenta say: x + c_i h v, p Cay(c_i h w / 2). */
static void start_from_momenta(struct problem *p, double time, double h)
{
    i64 dofs = p->dofs, stride = (dofs + LANES - 1) / LANES * LANES, pivots[dofs];
    double *mass = p->mass, *x = p->unknown;
    stand_still(p);
    mass_matrices(p, time, mass);
    for (i64 n = 0; n < p->nodes; n++) {
        double *m = mass + n * dofs * stride, v[dofs];
        for (i64 d = 0; d < dofs; d++) v[d] = p->momenta[n * dofs + d] - p->bias[n * dofs + d];
        if (factorize_dense(m, dofs, stride, pivots, 0)) memset(v, 0, sizeof v);
        else solve_dense(m, dofs, stride, pivots, v);
        for (i64 i = 0; i < p->stages; i++)
            for (i64 d = 0; d < dofs; d++) x[p->place[n] + i * dofs + d] = p->ends[i + 1] * h * v[d];
    }
    move(p, x, 1.0);
}

/* The polynomial of the step before, continued; where there is none, by the momenta; the safest: no motion. */
static void first_guess(struct problem *p, i64 onward, i64 safest, double begin, double h)
{
    if (safest) stand_still(p);
    else if (onward) extrapolate(p);
    else start_from_momenta(p, begin, h);
    start_multipliers(p);
    hold(p);
}

/* Follow the solution from that of a much shorter step; the step itself stays what it is. */
static i64 follow(struct problem *p, i64 number, double begin, double h, i64 *passes, i64 *worst)
{
    i64 values = (p->stages + 1) * (p->nodes + 1) * p->rows, count = 0;
    double size = FIRST_PART, good = 0.0, growth = 2.0;
    stand_still(p);
    start_multipliers(p);
    memcpy(p->reached, p->control, (size_t)values * sizeof(double));
    for (;;) {
        i64 solved = newton(p, number, begin, size * h, 0, passes, worst) == 1;
        count += *passes;
        if (solved && size == 1.0) break;
        if (solved) {
            good = size;
            growth = growth * growth < 2.0 ? growth * growth : 2.0;
            memcpy(p->reached, p->control, (size_t)values * sizeof(double));
        } else if (good == 0.0 && size > SHORTEST_PART) {
            size *= 0.25;
            stand_still(p);
            start_multipliers(p);
            continue;
        } else {
            growth = __builtin_sqrt(__builtin_sqrt(growth));
            if (good == 0.0 || growth < SMALLEST_GROWTH) {
                *passes = count;
                return 0;
            }
        }
        size = good * growth < 1.0 ? good * growth : 1.0;
        stretch(p, size / good);
        hold(p);
    }
    *passes = count;
    return 1;
}

/* List contacts about the first control, and plan the elimination with them. */
static i64 renew(struct problem *p, i64 again)
{
    return list_contacts(p, again) ? ((i64(*)(void))p->renew)() : 0;
}

/* Solve a step with the places held where rods come nearest to rods, and again from there until they stay. They jump where rods
 * lie along each other; then any is as good, for forces are opposite and along the same line wherever they act. */
static i64 solve_held(struct problem *p, i64 number, double begin, i64 *passes, i64 *worst)
{
    i64 size = (p->stages + 1) * (p->nodes + 1) * p->rows, count = 0, solved = 0;
    for (i64 safest = 0; safest < 2 && !solved; safest++) {
        first_guess(p, p->warm || number > 0, safest, begin, p->h);
        for (i64 round = 0; round < ROUNDS; round++) {
            if (hold_contacts(p) < HELD && round) break;
            i64 now = newton(p, number, begin, p->h, 1, passes, worst) == 1;
            count += *passes;
            if (!now && solved) { /* the last ones were good, too */
                memcpy(p->control, p->reached, (size_t)size * sizeof(double));
                hold_contacts(p);
                now = newton(p, number, begin, p->h, 1, passes, worst) == 1;
            }
            solved = now;
            if (!now) break;
            memcpy(p->reached, p->control, (size_t)size * sizeof(double));
        }
        release_contacts(p);
    }
    *passes = count;
    return solved;
}

/* Ways to solve the equations of a step, in the order in which they are tried; the second one is for contacts. */
enum way { QUICK, HOLDING, CAREFUL, SAFEST, FOLLOWING, WAYS };

static i64 solve_step(struct problem *p, i64 number, double begin)
{
    i64 passes = 0, worst = 0, solved = 0;
    for (enum way way = QUICK; way < WAYS && solved != 1; way++) {
        if ((way == HOLDING && !p->contacts) || (way == FOLLOWING && solved == SINGULAR)) continue;
        if (way == HOLDING) solved = solve_held(p, number, begin, &passes, &worst);
        else if (way == FOLLOWING) solved = follow(p, number, begin, p->h, &passes, &worst);
        else {
            first_guess(p, p->warm || number > 0, way == SAFEST, begin, p->h);
            solved = newton(p, number, begin, p->h, way != QUICK, &passes, &worst);
        }
        p->counts[0] += passes;
        if (way != FOLLOWING && passes > p->counts[1]) p->counts[1] = passes;
    }
    p->counts[3] = worst;
    return solved == 1;
}

/* One step; returns an outcome. */
static i64 step(struct problem *p, i64 number, double begin)
{
    i64 values = (p->nodes + 1) * p->rows, tries = 0;
    p->counts[2] = number;
    /* after a frame lists are new, so that a run that goes on from there has the same */
    if (p->contacts && renew(p, number % p->stride == 0)) return NOT_CONVERGED;
    if (!solve_step(p, number, begin)) return NOT_CONVERGED;
    while (p->contacts && outran(p)) /* the list was too short: once more, with a longer one */
        if (++tries > LONGER || renew(p, 1) || !solve_step(p, number, begin)) return NOT_CONVERGED;
    if (p->contacts && accept_contacts(p, p->h)) return FAST;
    hand_on(p);
    p->energy[1] += drive_work(p, number, p->h);
    for (i64 n = 0; n < p->couplings; n++) {
        struct coupling *c = &p->coupling[n];
        memcpy(c->start, c->multiplier, (size_t)(c->cells * p->stages * c->gauss * c->count) * sizeof(double));
    }
    if (p->motion) note_motion(p);
    memcpy(p->memory, p->control, (size_t)(p->stages * values) * sizeof(double));
    memcpy(p->control, p->control + p->stages * values, (size_t)values * sizeof(double));
    p->energy[1] += p->energy[0];
    for (i64 n = 0; n < p->terms; n++) p->energy[1] += p->term[n].work[0], p->energy[2] += p->term[n].work[1];
    return FINISHED;
}

/* Advance through ``saves`` saves of ``stride`` steps each; ``reached`` is the number of saves written. */
i64 advance(struct problem *p, i64 *reached)
{
    for (*reached = 0; *reached < p->saves; ++*reached) {
        for (i64 j = 0; j < p->stride; j++) {
            i64 number = *reached * p->stride + j;
            i64 outcome = step(p, number, p->origin + (p->first + (double)number) * p->h);
            if (outcome == FAST) return FAST;
            if (outcome) {
                i64 block = p->couplings ? saddle_point(p, number, 0, p->origin + p->h * (p->first + (double)number)) : 0;
                if (!block) return NOT_CONVERGED;
                p->counts[3] = block - 1;
                return REDUNDANT;
            }
            /* the first multipliers also take up a blow */
            i64 node = number ? overstrained(p, p->origin + p->h * (p->first + (double)number + 1.0), p->h) : 0;
            if (node) {
                p->counts[3] = node - 1;
                return TENSE;
            }
        }
        i64 number = (*reached + 1) * p->stride;
        if (p->couplings) {
            double time = p->origin + p->h * (p->first + (double)number);
            i64 block = project(p, number - 1, p->stages, time, p->h);
            if (block) {
                p->counts[3] = block - 1;
                return REDUNDANT;
            }
        }
        if (p->motion)
            write_rates(p, number + (p->warm ? (i64)p->first : 0), p->rates + *reached * p->nodes * p->dofs);
        memcpy(p->works + 2 * *reached, p->energy + 1, 2 * sizeof(double));
        if (p->contacts) tell_contacts(p->contacts, *reached, p->contact_told, p->contact_force);
        double check = 0.0, *frame = p->frames + *reached * p->nodes * (p->rows + p->dofs);
        for (i64 n = 0; n < p->nodes; n++, frame += p->rows + p->dofs) {
            memcpy(frame, p->control + n * p->rows, (size_t)p->rows * sizeof(double));
            memcpy(frame + p->rows, p->momenta + n * p->dofs, (size_t)p->dofs * sizeof(double));
            for (i64 k = 0; k < p->rows + p->dofs; k++) check += 0.0 * frame[k];
        }
        if (!isfinite(check)) return NOT_FINITE;
    }
    return FINISHED;
}
