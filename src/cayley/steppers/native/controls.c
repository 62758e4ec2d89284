/* Control nodes of a step: corrections, first guesses, what is held, and the momenta handed on. */
#include <math.h>
#include <string.h>
#include "engine.h"

/* A moment in the body frame as a force on a quaternion z, which need not be unit: 2 z moment/|z|^2. */
void push_turn(const double *z, const double *moment, double *out)
{
    double x = moment[0], y = moment[1], v = moment[2];
    double f = 2.0 / (z[0] * z[0] + z[1] * z[1] + z[2] * z[2] + z[3] * z[3]);
    out[0] = -f * (z[1] * x + z[2] * y + z[3] * v), out[1] = f * (z[0] * x + z[2] * v - z[3] * y);
    out[2] = f * (z[0] * y + z[3] * x - z[1] * v), out[3] = f * (z[0] * v + z[1] * y - z[2] * x);
}

/* Left-trivialized gradient of one node. */
void trivialize(struct problem *p, const double *gradient, const double *point, double *out)
{
    for (i64 f = 0; f < p->fields; f++) {
        const i64 *field = p->field + 4 * f, row = field[1], dof = field[2];
        if (!field[0]) {
            for (i64 k = 0; k < field[3]; k++) out[dof + k] = gradient[row + k];
            continue;
        }
        double w = point[row], x = point[row + 1], y = point[row + 2], z = point[row + 3];
        double a = gradient[row], b = gradient[row + 1], c = gradient[row + 2], d = gradient[row + 3];
        out[dof] = 0.5 * (w * b - x * a - y * d + z * c);
        out[dof + 1] = 0.5 * (w * c - y * a - z * b + x * d);
        out[dof + 2] = 0.5 * (w * d - z * a - x * c + y * b);
    }
}

/* p Cay(factor eta), as an increment, so that rounding stays unbiased. */
static void turn(double *p, const double *eta, double factor)
{
    double x = factor * eta[0], y = factor * eta[1], z = factor * eta[2];
    double square = x * x + y * y + z * z, cosine = 1.0 / __builtin_sqrt(1.0 + square);
    double small = -square * cosine * cosine / (1.0 + cosine);
    x *= cosine, y *= cosine, z *= cosine;
    double w = p[0], a = p[1], b = p[2], c = p[3];
    p[0] = w + (w * small - a * x - b * y - c * z);
    p[1] = a + (a * small + w * x + b * z - c * y);
    p[2] = b + (b * small + w * y + c * x - a * z);
    p[3] = c + (c * small + w * z + a * y - b * x);
}

/* Bring the rotations of the controls after the first to length one. */
void normalize(struct problem *p)
{
    i64 nodes = p->nodes + 1;
    for (i64 n = nodes; n < (p->stages + 1) * nodes; n++)
        for (i64 f = 0; f < p->fields; f++) {
            const i64 *field = p->field + 4 * f;
            if (!field[0]) continue;
            double *q = p->control + n * p->rows + field[1];
            double size = 1.0 / __builtin_sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
            for (i64 k = 0; k < 4; k++) q[k] *= size;
        }
}

/* Take held components out of the Cayley vector f of a turn, point = start Cay f. */
static void hold_turn(const double *start, double *point, const double *free)
{
    if (free[0] && free[1] && free[2]) return;
    double w = start[0], x = start[1], y = start[2], z = start[3];
    double a = point[0], b = point[1], c = point[2], d = point[3];
    memcpy(point, start, 4 * sizeof(double));
    if (!free[0] && !free[1] && !free[2]) return;
    double s = w * a + x * b + y * c + z * d;
    double f[3] = {free[0] * (w * b - x * a - y * d + z * c) / s, free[1] * (w * c - y * a - z * b + x * d) / s,
                   free[2] * (w * d - z * a - x * c + y * b) / s};
    turn(point, f, 1.0);
}

/* Held components of all controls are those at the start of the step; of rotations, those of the turn. */
void hold(struct problem *p)
{
    i64 values = (p->nodes + 1) * p->rows;
    for (i64 n = 0; n < p->nodes; n++) {
        const double *free = p->free + n * p->dofs;
        int any = 0;
        for (i64 d = 0; d < p->dofs; d++) any |= free[d] == 0.0;
        if (!any) continue;
        for (i64 f = 0; f < p->fields; f++) {
            const i64 *field = p->field + 4 * f, row = n * p->rows + field[1], dof = field[2];
            for (i64 i = 1; i <= p->stages; i++) {
                double *q = p->control + i * values + row;
                if (field[0]) hold_turn(p->control + row, q, free + dof);
                else
                    for (i64 k = 0; k < field[3]; k++)
                        if (!free[dof + k]) q[k] = p->control[row + k];
            }
        }
    }
}

/* Move the controls by part of a correction: x + part eta, p Cay(part eta/2). */
void move(struct problem *p, const double *x, double part)
{
    i64 values = (p->nodes + 1) * p->rows;
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 i = 0; i < p->stages; i++) {
            const double *eta = x + p->place[n] + i * p->dofs;
            double *q = p->control + (i + 1) * values + n * p->rows;
            for (i64 f = 0; f < p->fields; f++) {
                const i64 *field = p->field + 4 * f;
                if (field[0]) turn(q + field[1], eta + field[2], 0.5 * part);
                else
                    for (i64 k = 0; k < field[3]; k++) q[field[1] + k] += part * eta[field[2] + k];
            }
        }
}

/* The polynomial of a step (in ``reached``) read at times so many times as late. */
void stretch(struct problem *p, double factor)
{
    i64 values = (p->nodes + 1) * p->rows, controls = p->stages + 1;
    for (i64 i = 1; i < controls; i++)
        for (i64 v = 0; v < values; v++) {
            double sum = 0.0;
            for (i64 k = 0; k < controls; k++) {
                double value = 1.0;
                for (i64 j = 0; j < controls; j++)
                    if (j != k) value *= (factor * p->ends[i] - p->ends[j]) / (p->ends[k] - p->ends[j]);
                sum += value * p->reached[k * values + v];
            }
            p->control[i * values + v] = sum;
        }
    normalize(p);
}

/* Start from the polynomial of the step before, continued. */
void extrapolate(struct problem *p)
{
    i64 values = (p->nodes + 1) * p->rows, r = p->stages;
    for (i64 i = 1; i <= r; i++)
        for (i64 v = 0; v < values; v++) {
            double sum = p->onward[i * (r + 1) + r] * p->control[v];
            for (i64 k = 0; k < r; k++) sum += p->onward[i * (r + 1) + k] * p->memory[k * values + v];
            p->control[i * values + v] = sum;
        }
    normalize(p);
}

/* Size of a correction: turns in radians, vectors relative to the extent; NaN counts as largest. */
double measure(struct problem *p, const double *x, double *turn_size, i64 *worst)
{
    double size = 0.0, most = 0.0;
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 i = 0; i < p->stages; i++)
            for (i64 f = 0; f < p->fields; f++) {
                const i64 *field = p->field + 4 * f;
                for (i64 k = 0; k < field[3]; k++) {
                    double one = __builtin_fabs(x[p->place[n] + i * p->dofs + field[2] + k]);
                    if (field[0]) most = one > most ? one : most;
                    else one *= p->extent;
                    if (!(one <= size)) size = one, *worst = n;
                }
            }
    *turn_size = most;
    return size;
}

/* Subtract a body vector of one frame, given in another. */
static void hand_turned(const double *before, const double *after, const double *unsolved, double *out)
{
    double w = before[0], x = before[1], y = before[2], z = before[3];
    double a = after[0], b = after[1], c = after[2], d = after[3];
    double s = a * w + b * x + c * y + d * z; /* conj(after) before = (s, u) */
    double u0 = a * x - b * w - c * z + d * y, u1 = a * y - c * w - d * x + b * z, u2 = a * z - d * w - b * y + c * x;
    double t0 = u1 * unsolved[2] - u2 * unsolved[1], t1 = u2 * unsolved[0] - u0 * unsolved[2];
    double t2 = u0 * unsolved[1] - u1 * unsolved[0];
    out[0] -= unsolved[0] + 2.0 * (s * t0 + u1 * t2 - u2 * t1);
    out[1] -= unsolved[1] + 2.0 * (s * t1 + u2 * t0 - u0 * t2);
    out[2] -= unsolved[2] + 2.0 * (s * t2 + u0 * t1 - u1 * t0);
}

/* Momenta at the end of the step, and what its equations leave unsolved.
 *
 * The sum of D_i L_d over all nodes of a symmetric system vanishes, so with the residuals handed on the momentum maps do
 * not depend on how well the equations are solved. That of a rotation is turned into the frame of the new momentum. */
void hand_on(struct problem *p)
{
    i64 values = (p->nodes + 1) * p->rows, r = p->stages;
    for (i64 n = 0; n < p->nodes; n++) {
        double *mu = p->momenta + n * p->dofs;
        const double *last = p->control + r * values + n * p->rows;
        memcpy(mu, p->after + n * p->dofs, (size_t)p->dofs * sizeof(double));
        for (i64 f = 0; f < p->fields; f++) {
            const i64 *field = p->field + 4 * f;
            for (i64 i = 0; i < r; i++) {
                const double *unsolved = p->unknown + p->place[n] + i * p->dofs + field[2];
                if (field[0])
                    hand_turned(p->control + i * values + n * p->rows + field[1], last + field[1], unsolved,
                                mu + field[2]);
                else
                    for (i64 k = 0; k < field[3]; k++) mu[field[2] + k] -= unsolved[k];
            }
        }
        for (i64 d = 0; d < p->dofs; d++) mu[d] *= p->free[n * p->dofs + d];
    }
}

/* v h of a rotation from p to q: the rotation vector of conj(p) q, the same in both their frames. */
static void turn_between(const double *p, const double *q, double *out)
{
    double s = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    double x = p[0] * q[1] - p[1] * q[0] - p[2] * q[3] + p[3] * q[2];
    double y = p[0] * q[2] - p[2] * q[0] - p[3] * q[1] + p[1] * q[3];
    double z = p[0] * q[3] - p[3] * q[0] - p[1] * q[2] + p[2] * q[1];
    double sine = __builtin_sqrt(x * x + y * y + z * z), factor = sine > 0.0 ? 2.0 * atan2(sine, s) / sine : 2.0;
    out[0] = factor * x, out[1] = factor * y, out[2] = factor * z;
}

/* Keep v h of the step in front of those of the two before. */
void note_motion(struct problem *p)
{
    i64 size = (p->nodes + 1) * p->dofs, values = (p->nodes + 1) * p->rows;
    memmove(p->motion + size, p->motion, (size_t)(2 * size) * sizeof(double));
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 f = 0; f < p->fields; f++) {
            const i64 *field = p->field + 4 * f;
            const double *from = p->control + n * p->rows + field[1], *to = from + p->stages * values;
            double *out = p->motion + n * p->dofs + field[2];
            if (field[0]) turn_between(from, to, out);
            else
                for (i64 k = 0; k < field[3]; k++) out[k] = to[k] - from[k];
        }
}

/* The mean velocities u, w, v of three steps continued to the end of the last one, v + u'h/2 = v + w/2 - u/2.
 *
 * Of order 2, and blind to what changes sign from step to step, as do modes that decay fast under rules of odd degree. */
void write_rates(struct problem *p, i64 steps, double *out)
{
    i64 size = (p->nodes + 1) * p->dofs;
    for (i64 k = 0; k < p->nodes * p->dofs; k++)
        out[k] = steps < 3 ? NAN : (p->motion[k] + 0.5 * (p->motion[size + k] - p->motion[2 * size + k])) / p->h;
}
