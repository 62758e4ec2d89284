/* Values, gradients and matrices of LANES cells side by side.
 *
 * Compiled with POSE everything is for nodes of a rotation and a position, in this order: ROWS and DOFS are constants.
 */
#ifndef CAYLEY_LANES_H
#define CAYLEY_LANES_H

#include "engine.h"

#ifdef POSE
#define ROWS 7
#define DOFS 6
#else
#define ROWS (p->rows)
#define DOFS (p->dofs)
#endif

/* q[i][a][row] = control i of node a of every cell; nodes is [LANES][width]. */
static inline void gather(struct problem *p, const i64 *nodes, i64 width, i64 controls, vec *q)
{
    for (i64 i = 0; i < controls; i++) {
        const double *control = p->control + i * (p->nodes + 1) * ROWS;
        for (i64 a = 0; a < width; a++)
            for (i64 lane = 0; lane < LANES; lane++) {
                const double *value = control + nodes[lane * width + a] * ROWS;
                for (i64 row = 0; row < ROWS; row++) q[(i * width + a) * ROWS + row][lane] = value[row];
            }
    }
}

/* Left-trivialized gradient: 1/2 Im(conj(p) g) for rotations. */
static inline void trivialize_rotation(const vec *gradient, const vec *point, vec *out)
{
    vec w = point[0], x = point[1], y = point[2], z = point[3];
    vec a = gradient[0], b = gradient[1], c = gradient[2], d = gradient[3];
    out[0] = 0.5 * (w * b - x * a - y * d + z * c);
    out[1] = 0.5 * (w * c - y * a - z * b + x * d);
    out[2] = 0.5 * (w * d - z * a - x * c + y * b);
}

static inline void trivialize_lanes(struct problem *p, const vec *gradient, const vec *point, vec *out)
{
#ifdef POSE
    (void)p;
    trivialize_rotation(gradient, point, out);
    for (i64 k = 0; k < 3; k++) out[3 + k] = gradient[4 + k];
#else
    for (i64 f = 0; f < p->fields; f++) {
        const i64 *field = p->field + 4 * f, row = field[1], dof = field[2];
        if (field[0]) trivialize_rotation(gradient + row, point + row, out + dof);
        else
            for (i64 k = 0; k < field[3]; k++) out[dof + k] = gradient[row + k];
    }
#endif
}

/* out = Tl' M Tr, with T the tangents 1/2 p e_i of rotations; half is room. */
static inline void pair_tangent(struct problem *p, const vec *over, const vec *left, const vec *right, vec *half, vec *out)
{
    i64 rows = ROWS, dofs = DOFS;
    vec column[rows], moved[dofs];
    for (i64 i = 0; i < rows; i++) trivialize_lanes(p, over + i * rows, right, half + i * dofs);
    for (i64 d = 0; d < dofs; d++) {
        for (i64 i = 0; i < rows; i++) column[i] = half[i * dofs + d];
        trivialize_lanes(p, column, left, moved);
        for (i64 k = 0; k < dofs; k++) out[k * dofs + d] = moved[k];
    }
}

/* Add one block of a pair of nodes to the matrix. */
static inline void scatter_pair(struct problem *p, const i64 *places, i64 stride, i64 active, i64 i, i64 j, const vec *block)
{
    i64 dofs = DOFS;
    for (i64 lane = 0; lane < active; lane++) {
        i64 offset = places[lane * stride], row = places[lane * stride + 1];
        if (offset < 0) continue;
        double *out = p->matrix + offset + i * dofs * row + j * dofs;
        for (i64 d = 0; d < dofs; d++)
            for (i64 e = 0; e < dofs; e++) out[d * row + e] += block[d * dofs + e][lane];
    }
}

/* Zero in rows and columns of held components. */
static inline void mask(struct problem *p, const i64 *nodes, i64 width, i64 a, i64 b, vec *block)
{
    i64 dofs = DOFS;
    for (i64 lane = 0; lane < LANES; lane++) {
        const double *left = p->free + nodes[lane * width + a] * dofs, *right = p->free + nodes[lane * width + b] * dofs;
        for (i64 d = 0; d < dofs; d++)
            for (i64 e = 0; e < dofs; e++) block[d * dofs + e][lane] *= left[d] * right[e];
    }
}

/* Derivative of the trivialization itself, -1/4 (y0 - Y x) with y = conj(p) g, on the diagonal of an inner control. */
static inline void turned(struct problem *p, const vec *gradient, const vec *point, vec *out)
{
    for (i64 f = 0; f < p->fields; f++) {
        const i64 *field = p->field + 4 * f, r = field[1], n = field[2], m = DOFS;
        if (!field[0]) continue;
        vec w = point[r], x = point[r + 1], y = point[r + 2], z = point[r + 3];
        vec a = gradient[r], b = gradient[r + 1], c = gradient[r + 2], d = gradient[r + 3];
        vec real = 0.25 * (w * a + x * b + y * c + z * d), i = 0.25 * (w * b - x * a - y * d + z * c);
        vec j = 0.25 * (w * c - y * a - z * b + x * d), l = 0.25 * (w * d - z * a - x * c + y * b);
        for (i64 k = 0; k < 3; k++) out[(n + k) * m + n + k] -= real;
        out[n * m + n + 1] -= l, out[(n + 1) * m + n] += l;
        out[(n + 1) * m + n + 2] -= i, out[(n + 2) * m + n + 1] += i;
        out[(n + 2) * m + n] -= j, out[n * m + n + 2] += j;
    }
}

/* phi (slot 0) or psi of a point and node, in lanes; zero tells whether it vanishes. */
static inline vec shape(const double *phi, const double *psi, const double *inverse, i64 width, i64 block, i64 slot, i64 g,
                        i64 a, int *zero)
{
    double value = (slot ? psi : phi)[g * width + a];
    *zero = value == 0.0;
    vec one = {0.0};
    one = one + value;
    return slot ? one * ((const vec *)inverse)[block] : one;
}

#define SHAPE(t, block, slot, g, a, zero) \
    shape((t)->phi, (t)->psi, (t)->inverse, (t)->width, block, slot, g, a, zero)

#endif
