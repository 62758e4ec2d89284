/* Equilibria: the last control of a "step" of one stage with ell = (0, 1), weight 1 and h = 1, all rates those of a frame
 * that turns (spin) or zero, so that
 *
 *     f(q) = dL/dq + S' dL/du' + forces + G(q)' l = 0,   g(q) = 0
 *
 * has the residuals of a step in the places they have there; see p->still in the other files.
 */
#include <string.h>
#include "lanes.h"

/* b = Lambda(z) a, or its transpose, for a quaternion of any length. */
static void rotate(const double *z, double sign, const double *a, double *b)
{
    double size = z[0] * z[0] + z[1] * z[1] + z[2] * z[2] + z[3] * z[3];
    double w = z[0], i = sign * z[1], j = sign * z[2], l = sign * z[3];
    double x = j * a[2] - l * a[1], y = l * a[0] - i * a[2], v = i * a[1] - j * a[0];
    b[0] = a[0] + 2.0 * (w * x + j * v - l * y) / size;
    b[1] = a[1] + 2.0 * (w * y + l * x - i * v) / size;
    b[2] = a[2] + 2.0 * (w * v + i * y - j * x) / size;
}

static void cross(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Number of the first degree of freedom of the rotation that stands at a row. */
static i64 turn_dof(struct problem *p, i64 row)
{
    for (i64 f = 0; f < p->fields; f++)
        if (p->field[4 * f] && p->field[4 * f + 1] == row) return p->field[4 * f + 2];
    return -1;
}

/* Loads that are functions of time alone, and their derivative along the rotation of their node by a body vector. */
void add_still_loads(struct problem *p, i64 tangent)
{
    i64 rows = ROWS, dofs = DOFS;
    for (i64 e = 0; e < p->entry_count && !p->order; e++) {
        const i64 *entry = p->entries + 7 * e, node = entry[0], form = entry[3], dof = entry[6];
        const double *given = p->table + entry[4], *lever = p->scales + 4 * e + 1;
        const double *z = p->control + ((p->nodes + 1) + node) * rows + entry[2];
        double load[3] = {p->scales[4 * e] * given[0], p->scales[4 * e] * given[1], p->scales[4 * e] * given[2]}, push[3];
        i64 off = lever[0] != 0.0 || lever[1] != 0.0 || lever[2] != 0.0, turn = turn_dof(p, entry[2]);
        if (form) rotate(z, form == 2 ? 1.0 : -1.0, load, push);
        else memcpy(push, load, sizeof push);
        for (i64 k = 0; k < 3 && tangent && form && turn >= 0; k++) { /* along a turn by e_k */
            double axis[3] = {k == 0, k == 1, k == 2}, body[3], slope[3];
            if (form == 1) cross(push, axis, slope); /* transpose(Lambda) F */
            else cross(axis, load, body), rotate(z, 1.0, body, slope);
            if (off) memcpy(body, slope, sizeof body), cross(lever, body, slope);
            const double *free = p->free + node * dofs;
            for (i64 d = 0; d < 3; d++)
                p->matrix[p->diagonal[p->place[node] + dof + d] + turn + k - dof - d] +=
                    free[dof + d] * free[turn + k] * slope[d];
        }
        if (off) memcpy(load, push, sizeof load), cross(lever, load, push);
        for (i64 d = 0; d < 3; d++) p->residual[node * dofs + dof + d] += push[d];
    }
}

/* Add factor times the mass matrices of the first control to the matrix: they keep down motions that nothing resists. */
void add_inertia(struct problem *p, double time, double factor)
{
    i64 dofs = DOFS, stride = (dofs + LANES - 1) / LANES * LANES;
    mass_matrices(p, time, p->mass);
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 d = 0; d < dofs; d++) {
            if (!p->free[n * dofs + d]) continue;
            double *out = p->matrix + p->diagonal[p->place[n] + d] - d;
            for (i64 e = 0; e < dofs; e++)
                out[e] += factor * p->free[n * dofs + e] * p->mass[(n * dofs + d) * stride + e];
        }
}
