/* Constraints: their values, their forces on the nodes, and their part of the saddle point of a step.
 *
 * With multipliers l_i at the control times 0 ... r - 1,
 *
 *     mu + D_0 L_d + h sum W G(q_0)' l_0 = 0,   D_i L_d + h sum W G(q_i)' l_i = 0 (0 < i < r),   g(q_i) = 0 (0 < i <= r)
 */
#include <string.h>
#include "lanes.h"

/* Drives at a control time of a step, [driven][drives]. */
static const double *drives(struct problem *p, const struct coupling *c, i64 number, i64 i)
{
    return c->drive + (number * (p->stages + 1) + i) * c->driven * c->drives;
}

/* Evaluate the constraints of a block of cells at control i; full: with the Hessian of the multipliers. */
static void evaluate(struct problem *p, struct coupling *c, i64 block, i64 i, const double *drive, const vec *q, i64 full)
{
    i64 rows = ROWS, r = p->stages, height = full ? c->rows : c->light_rows, together = c->gauss * c->count;
    double *start = c->data + i * c->gauss * c->rows * LANES;
    for (i64 g = 0; g < c->gauss; g++) {
        vec *data = (vec *)(start + g * height * LANES);
        for (i64 s = 0; s < c->slots; s++)
            for (i64 row = 0; row < rows; row++) {
                vec sum = {0.0};
                for (i64 a = 0; a < c->width; a++) {
                    int zero;
                    vec factor = SHAPE(c, block, s, g, a, &zero);
                    if (!zero) sum += factor * q[(i * c->width + a) * rows + row];
                }
                data[s * rows + row] = sum;
            }
        memcpy(data + c->constant_row, c->constant + (block * c->gauss + g) * c->constants * LANES,
               (size_t)(c->constants * LANES) * sizeof(double));
        for (i64 lane = 0; lane < LANES; lane++) {
            i64 cell = block * LANES + lane, driver = c->driver[cell];
            if (cell >= c->cells) continue;
            for (i64 k = 0; k < c->drives && driver >= 0; k++)
                data[c->constant_row + c->constants - c->drives + k][lane] = drive[driver * c->drives + k];
            const double *multiplier = c->multiplier + (cell * r + (i < r ? i : r - 1)) * together + g * c->count;
            for (i64 k = 0; k < c->count; k++) data[c->multiplier_row + k][lane] = multiplier[k];
        }
    }
    double *uniforms = full ? c->uniforms + i * c->uniform_width : c->light_uniforms + i * c->light_width;
    ((kernel)(full ? c->run : c->light_run))(start, uniforms, 0, c->gauss);
}

/* Left-trivialized derivative of constraint k of point g along node a. */
static void derivative(struct problem *p, struct coupling *c, i64 block, i64 g, i64 k, i64 a, const vec *data,
                       const vec *point, vec *embedded, vec *out)
{
    memset(embedded, 0, (size_t)ROWS * sizeof(vec));
    for (i64 s = 0; s < c->slots; s++) {
        int zero;
        vec factor = SHAPE(c, block, s, g, a, &zero);
        if (zero) continue;
        const vec *slope = data + c->gradient + (k * c->slots + s) * ROWS;
        for (i64 row = 0; row < ROWS; row++) embedded[row] += factor * slope[row];
    }
    trivialize_lanes(p, embedded, point, out);
}

/* Values, forces and derivatives of one constraint along one node at control i. */
static void scatter(struct problem *p, struct coupling *c, i64 block, i64 g, i64 k, i64 a, i64 i, double h,
                    const vec *slope, i64 tangent)
{
    i64 dofs = DOFS, r = p->stages, together = c->gauss * c->count, at = g * c->count + k;
    i64 e = i - p->still; /* the equations that forces at this control are in */
    for (i64 lane = 0; lane < LANES && block * LANES + lane < c->cells; lane++) {
        i64 cell = block * LANES + lane, node = c->nodes[cell * c->width + a];
        const double *free = p->free + node * dofs;
        double weight = h * c->weight[(block * c->gauss + g) * LANES + lane];
        if (e < r) {
            double push = weight * c->multiplier[(cell * r + e) * together + at];
            double *sum = p->residual + (node * r + e) * dofs;
            for (i64 d = 0; d < dofs; d++) sum[d] += push * slope[d][lane];
        }
        const i64 *across = c->across + (cell * c->width + a) * 2, *along = c->along + (cell * c->width + a) * 2;
        if (!tangent || across[0] < 0) continue;
        if (e < r)
            for (i64 d = 0; d < dofs; d++)
                p->matrix[across[0] + (e * dofs + d) * across[1] + e * together + at] = weight * slope[d][lane] * free[d];
        if (i > 0)
            for (i64 d = 0; d < dofs; d++)
                p->matrix[along[0] + ((i - 1) * together + at) * along[1] + (i - 1) * dofs + d] =
                    (p->still ? weight : 1.0) * slope[d][lane] * free[d];
    }
}

/* The Hessian of the multipliers' part of the action at an inner control. */
static void curvature(struct problem *p, struct coupling *c, i64 block, i64 i, double h, const vec *q, vec *room)
{
    i64 rows = ROWS, dofs = DOFS, width = c->width;
    i64 active = c->cells - block * LANES < LANES ? c->cells - block * LANES : LANES;
    vec *over = room, *half = over + rows * rows, *out = half + rows * dofs, *force = out + dofs * dofs;
    for (i64 a = 0; a < width; a++)
        for (i64 b = 0; b < width; b++) {
            memset(over, 0, (size_t)(rows * rows) * sizeof(vec));
            memset(force, 0, (size_t)rows * sizeof(vec));
            for (i64 g = 0; g < c->gauss; g++) {
                const vec *data = (const vec *)(c->data + (i * c->gauss + g) * c->rows * LANES);
                vec weight = h * ((const vec *)c->weight)[block * c->gauss + g];
                for (i64 s = 0; s < c->slots; s++) {
                    int none, zero;
                    vec left = SHAPE(c, block, s, g, a, &none) * weight;
                    if (none) continue;
                    for (i64 k = 0; k < c->count; k++)
                        for (i64 row = 0; row < rows; row++)
                            force[row] += left * data[c->multiplier_row + k] *
                                          data[c->gradient + (k * c->slots + s) * rows + row];
                    for (i64 u = 0; u < c->slots; u++) {
                        vec factor = left * SHAPE(c, block, u, g, b, &zero);
                        if (zero) continue;
                        for (i64 e = c->starts[s * c->slots + u]; e < c->starts[s * c->slots + u + 1]; e++)
                            over[c->entries[2 * e]] += factor * data[c->entries[2 * e + 1]];
                    }
                }
            }
            const vec *left = q + (i * width + a) * rows, *right = q + (i * width + b) * rows;
            pair_tangent(p, over, left, right, half, out);
            if (a == b) turned(p, force, left, out);
            mask(p, c->nodes + block * LANES * width, width, a, b, out);
            scatter_pair(p, c->places + ((block * LANES * width + a) * width + b) * 2, 2 * width * width, active,
                         i - p->still, i - 1, out);
        }
}

/* Of an equilibrium: subtract s W G' g from the forces and s W G' G from their derivative.
 *
 * The corrections stay what they are, with other multipliers; but nodes that only constraints hold have pivots. */
static void stiffen(struct problem *p, struct coupling *c, i64 block, i64 g, const vec *slopes, vec value, i64 tangent)
{
    i64 dofs = DOFS, width = c->width;
    vec sum = {0.0};
    for (i64 a = 0; a < width; a++)
        for (i64 d = 0; d < dofs; d++) sum += slopes[a * dofs + d] * slopes[a * dofs + d] / p->penalty[d];
    for (i64 lane = 0; lane < LANES && block * LANES + lane < c->cells; lane++) {
        i64 cell = block * LANES + lane;
        double s = sum[lane] > 0.0 ? c->weight[(block * c->gauss + g) * LANES + lane] / sum[lane] : 0.0;
        for (i64 a = 0; a < width; a++) {
            i64 node = c->nodes[cell * width + a];
            const double *free = p->free + node * dofs;
            for (i64 d = 0; d < dofs; d++) p->residual[node * dofs + d] -= s * value[lane] * slopes[a * dofs + d][lane];
            for (i64 b = 0; b < width && tangent; b++) {
                const i64 *place = c->places + ((cell * width + a) * width + b) * 2;
                const double *other = p->free + c->nodes[cell * width + b] * dofs;
                if (place[0] < 0) continue;
                for (i64 d = 0; d < dofs; d++)
                    for (i64 e = 0; e < dofs; e++)
                        p->matrix[place[0] + d * place[1] + e] -=
                            s * free[d] * other[e] * slopes[a * dofs + d][lane] * slopes[b * dofs + e][lane];
            }
        }
    }
}

static void add_coupling(struct problem *p, struct coupling *c, i64 number, double begin, double h, i64 tangent)
{
    i64 r = p->stages, rows = ROWS, width = c->width, together = c->gauss * c->count;
    vec *q = (vec *)p->cells, *room = q + (r + 1) * width * rows, slopes[width * DOFS], embedded[rows];
    for (i64 i = 0; i <= r; i++) {
        c->uniforms[i * c->uniform_width] = c->light_uniforms[i * c->light_width] = begin + p->ends[i] * h;
        ((prepare)c->setup)(c->uniforms + i * c->uniform_width);
        ((prepare)c->light_setup)(c->light_uniforms + i * c->light_width);
    }
    for (i64 block = 0; block * LANES < c->cells; block++) {
        gather(p, c->nodes + block * LANES * width, width, r + 1, q);
        for (i64 i = p->still; i <= r; i++) {
            i64 full = tangent && i > 0 && i - p->still < r, height = full ? c->rows : c->light_rows;
            evaluate(p, c, block, i, drives(p, c, number, i), q, full);
            for (i64 g = 0; g < c->gauss; g++) {
                const vec *data = (const vec *)(c->data + (i * c->gauss * c->rows + g * height) * LANES);
                for (i64 k = 0; k < c->count; k++) {
                    for (i64 a = 0; a < width; a++) {
                        vec *slope = slopes + a * DOFS;
                        derivative(p, c, block, g, k, a, data, q + (i * width + a) * rows, embedded, slope);
                        scatter(p, c, block, g, k, a, i, h, slope, tangent);
                    }
                    if (p->penalty) stiffen(p, c, block, g, slopes, data[c->value + k], tangent);
                    const double *weight = c->weight + (block * c->gauss + g) * LANES;
                    for (i64 lane = 0; i > 0 && lane < LANES && block * LANES + lane < c->cells; lane++)
                        p->unknown[c->spot[block * LANES + lane] + (i - 1) * together + g * c->count + k] =
                            (p->still ? -weight[lane] : -1.0) * data[c->value + k][lane];
                }
            }
            if (full) curvature(p, c, block, i, h, q, room);
        }
    }
}

/* What the rows of the multipliers are at least once their nodes are eliminated: by the diagonal alone. */
static void expect(struct problem *p)
{
    i64 dofs = DOFS;
    for (i64 u = 0; u < 2 * p->unknowns; u++) p->watch[u] = 0.0;
    for (i64 n = 0; n < p->couplings; n++) {
        const struct coupling *c = &p->coupling[n];
        i64 together = c->gauss * c->count;
        for (i64 cell = 0; cell < c->cells; cell++)
            for (i64 a = 0; a < c->width; a++) {
                const i64 *across = c->across + (cell * c->width + a) * 2, *along = c->along + (cell * c->width + a) * 2;
                if (across[0] < 0) continue;
                i64 place = p->place[c->nodes[cell * c->width + a]];
                for (i64 at = 0; at < together; at++)
                    for (i64 d = 0; d < dofs; d++) {
                        double product = p->matrix[across[0] + d * across[1] + at] * p->matrix[along[0] + at * along[1] + d];
                        double diagonal = p->matrix[p->diagonal[place + d]];
                        double *own = p->watch + 2 * (c->spot[cell] + at) + c->inside[cell * c->width + a];
                        if (product != 0.0) *own += __builtin_fabs(product / diagonal);
                    }
            }
    }
}

/* Forces of all multipliers, violations (in the rows of the multipliers) and, if wanted, their tangent. */
void add_couplings(struct problem *p, i64 number, double begin, double h, i64 tangent)
{
    for (i64 n = 0; n < p->couplings; n++) add_coupling(p, &p->coupling[n], number, begin, h, tangent);
    if (tangent && p->couplings && p->watch) expect(p);
}

/* Values of all constraints at control i, in the rows of the multipliers; returns the largest. */
double violations(struct problem *p, i64 number, i64 i, double time)
{
    double most = 0.0;
    for (i64 n = 0; n < p->couplings; n++) {
        struct coupling *c = &p->coupling[n];
        vec *q = (vec *)p->cells;
        c->light_uniforms[i * c->light_width] = time;
        ((prepare)c->light_setup)(c->light_uniforms + i * c->light_width);
        for (i64 block = 0; block * LANES < c->cells; block++) {
            gather(p, c->nodes + block * LANES * c->width, c->width, i + 1, q);
            evaluate(p, c, block, i, drives(p, c, number, i), q, 0);
            for (i64 g = 0; g < c->gauss; g++) {
                const vec *data = (const vec *)(c->data + (i * c->gauss * c->rows + g * c->light_rows) * LANES);
                for (i64 k = 0; k < c->count; k++)
                    for (i64 lane = 0; lane < LANES && block * LANES + lane < c->cells; lane++) {
                        double value = data[c->value + k][lane], size = __builtin_fabs(value);
                        p->unknown[c->spot[block * LANES + lane] + g * c->count + k] = value;
                        most = size <= most ? most : size; /* also for NaN */
                    }
            }
        }
    }
    return most;
}

/* Mass matrices and derivatives of the constraints at the first controls, kept in ``mass`` and ``slopes``, and the matrix
 *
 *     M v + G' n = f,   G v = s
 *
 * factorized: that of a step with the other controls set to one. Returns 0, or 1 + the block of redundant constraints. */
i64 saddle_point(struct problem *p, i64 number, i64 i, double time)
{
    i64 dofs = DOFS, stride = (dofs + LANES - 1) / LANES * LANES;
    mass_matrices(p, time, p->mass);
    memset(p->matrix, 0, (size_t)p->matrix_size * sizeof(double));
    for (i64 u = 0; u < p->unknowns; u++) p->matrix[p->diagonal[u]] = 1.0;
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 d = 0; d < dofs; d++) {
            if (!p->free[n * dofs + d]) continue;
            double *out = p->matrix + p->diagonal[p->place[n] + d] - d;
            for (i64 e = 0; e < dofs; e++) out[e] = p->free[n * dofs + e] * p->mass[(n * dofs + d) * stride + e];
        }
    for (i64 m = 0; m < p->couplings; m++) {
        struct coupling *c = &p->coupling[m];
        i64 width = c->width;
        vec *q = (vec *)p->cells, embedded[ROWS];
        c->light_uniforms[0] = time;
        ((prepare)c->light_setup)(c->light_uniforms);
        for (i64 block = 0; block * LANES < c->cells; block++) {
            gather(p, c->nodes + block * LANES * width, width, 1, q);
            evaluate(p, c, block, 0, drives(p, c, number, i), q, 0);
            for (i64 at = 0; at < c->gauss * c->count; at++) {
                i64 g = at / c->count, k = at % c->count;
                const vec *data = (const vec *)(c->data + g * c->light_rows * LANES);
                for (i64 lane = 0; lane < LANES && block * LANES + lane < c->cells; lane++)
                    p->matrix[p->diagonal[c->spot[block * LANES + lane] + at]] = 0.0;
                for (i64 a = 0; a < width; a++) {
                    vec *slope = (vec *)c->slopes + ((block * c->gauss * c->count + at) * width + a) * dofs;
                    derivative(p, c, block, g, k, a, data, q + a * ROWS, embedded, slope);
                    for (i64 lane = 0; lane < LANES && block * LANES + lane < c->cells; lane++) {
                        i64 cell = block * LANES + lane;
                        const double *free = p->free + c->nodes[cell * width + a] * dofs;
                        const i64 *across = c->across + (cell * width + a) * 2, *along = c->along + (cell * width + a) * 2;
                        if (across[0] < 0) continue;
                        for (i64 d = 0; d < dofs; d++) {
                            double value = slope[d][lane] * free[d];
                            p->matrix[across[0] + d * across[1] + at] = p->matrix[along[0] + at * along[1] + d] = value;
                        }
                    }
                }
            }
        }
    }
    if (p->couplings && p->watch) expect(p);
    return factorize(p->fronts, p->matrix, p->pivots, p->watch);
}

/* out[node] += h W G' l, with the derivatives of saddle_point. */
void push_multipliers(struct problem *p, double h, double *out)
{
    i64 dofs = DOFS;
    for (i64 m = 0; m < p->couplings; m++) {
        const struct coupling *c = &p->coupling[m];
        i64 together = c->gauss * c->count;
        for (i64 cell = 0; cell < c->cells; cell++)
            for (i64 at = 0; at < together; at++) {
                i64 block = cell / LANES, lane = cell % LANES, g = at / c->count;
                double push = h * c->weight[(block * c->gauss + g) * LANES + lane] * c->multiplier[cell * together + at];
                for (i64 a = 0; a < c->width; a++) {
                    const vec *slope = (const vec *)c->slopes + ((block * together + at) * c->width + a) * dofs;
                    double *sum = out + c->nodes[cell * c->width + a] * dofs;
                    for (i64 d = 0; d < dofs; d++) sum[d] += push * slope[d][lane];
                }
            }
    }
}

/* Rates of the constraints by their drives alone, negative, at a control, in the rows of the multipliers, by central
 * differences: exact where they are at most quadratic in the drives, which all are but those of a driven link (1/length);
 * there the error is that of the square of the relative change of its length in a step. */
static void driven_rates(struct problem *p, i64 number, i64 i, i64 at, double h)
{
    for (i64 m = 0; m < p->couplings; m++) {
        struct coupling *c = &p->coupling[m];
        if (!c->driven) continue;
        vec *q = (vec *)p->cells;
        const double *now = drives(p, c, number, i), *rate = c->drive_rate + (number * (p->stages + 1) + i) * c->driven * c->drives;
        double moved[c->driven * c->drives];
        for (i64 side = -1; side <= 1; side += 2)
            for (i64 block = 0; block * LANES < c->cells; block++) {
                for (i64 k = 0; k < c->driven * c->drives; k++) moved[k] = now[k] + (double)side * h * rate[k];
                gather(p, c->nodes + block * LANES * c->width, c->width, at + 1, q);
                evaluate(p, c, block, at, moved, q, 0);
                for (i64 k = 0; k < c->gauss * c->count; k++) {
                    const vec *data = (const vec *)(c->data + (at * c->gauss * c->rows + k / c->count * c->light_rows) * LANES);
                    for (i64 lane = 0; lane < LANES && block * LANES + lane < c->cells; lane++)
                        p->unknown[c->spot[block * LANES + lane] + k] -=
                            (double)side * data[c->value + k % c->count][lane] / (2.0 * h);
                }
            }
    }
}

/* Velocities of momenta that satisfy the constraints: M v + G' n = mu, G v = rate of the drives of control i of a step,
 * with the matrix of saddle_point; [nodes + 1][dofs] both. */
void velocities(struct problem *p, i64 number, i64 i, double h, const double *momenta, double *out)
{
    i64 dofs = DOFS;
    memset(p->unknown, 0, (size_t)p->unknowns * sizeof(double));
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 d = 0; d < dofs; d++)
            p->unknown[p->place[n] + d] = p->free[n * dofs + d] * momenta[n * dofs + d];
    driven_rates(p, number, i, 0, h);
    memcpy(p->taken, p->unknown, (size_t)p->unknowns * sizeof(double));
    solve(p->fronts, p->matrix, p->pivots, p->unknown);
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 d = 0; d < dofs; d++) out[n * dofs + d] = p->free[n * dofs + d] * p->unknown[p->place[n] + d];
}

/* Work of the drives by the multipliers of a step: h W l G v with G v = -dg/dt. */
double drive_work(struct problem *p, i64 number, double h)
{
    i64 driven = 0;
    double work = 0.0;
    for (i64 n = 0; n < p->couplings; n++) driven += p->coupling[n].driven;
    for (i64 i = 0; i < p->stages && driven; i++) {
        memset(p->unknown, 0, (size_t)p->unknowns * sizeof(double));
        driven_rates(p, number, i, i, p->h);
        for (i64 n = 0; n < p->couplings; n++) {
            const struct coupling *c = &p->coupling[n];
            i64 together = c->gauss * c->count;
            for (i64 cell = 0; cell < c->cells && c->driven; cell++)
                for (i64 k = 0; k < together; k++)
                    work += h * c->weight[(cell / LANES * c->gauss + k / c->count) * LANES + cell % LANES] *
                            c->multiplier[(cell * p->stages + i) * together + k] * p->unknown[c->spot[cell] + k];
        }
    }
    return work;
}

/* Work of the drives by what velocities() took from the momenta, -G' n. */
double projection_work(struct problem *p)
{
    double work = 0.0;
    for (i64 n = 0; n < p->couplings; n++) {
        const struct coupling *c = &p->coupling[n];
        for (i64 cell = 0; cell < c->cells && c->driven; cell++)
            for (i64 k = 0; k < c->gauss * c->count; k++)
                work -= p->unknown[c->spot[cell] + k] * p->taken[c->spot[cell] + k];
    }
    return work;
}

/* out = M v, [nodes + 1][dofs] both. */
void multiply_mass(struct problem *p, const double *v, double *out)
{
    i64 dofs = DOFS, stride = (dofs + LANES - 1) / LANES * LANES;
    for (i64 n = 0; n < p->nodes; n++)
        for (i64 d = 0; d < dofs; d++) {
            double sum = 0.0;
            for (i64 e = 0; e < dofs; e++) sum += p->mass[(n * dofs + d) * stride + e] * v[n * dofs + e];
            out[n * dofs + d] = p->free[n * dofs + d] * sum;
        }
}

/* Project the momenta at the first controls so that velocities satisfy the constraints (RATTLE), mu = M v; drives are
 * those of control i of a step. Returns 0, or 1 + the block of redundant constraints. */
i64 project(struct problem *p, i64 number, i64 i, double time, double h)
{
    i64 failed = saddle_point(p, number, i, time);
    if (failed) return failed;
    velocities(p, number, i, h, p->momenta, p->velocity);
    p->energy[1] += projection_work(p);
    multiply_mass(p, p->velocity, p->momenta);
    return 0;
}

/* First node, plus 1, of a cell whose multipliers make rotations that alternate from node to node unstable, or 0.
 *
 * The screw strain of an element depends on such rotations, and forces of multipliers act as explicit ones do: they need
 * h^2 K/4 < M with K = -l d2g along (eta, -eta) and M the inertia, both by axis and per length. */
i64 overstrained(struct problem *p, double time, double h)
{
    i64 rows = ROWS, dofs = DOFS, stride = (dofs + LANES - 1) / LANES * LANES, known = 0;
    vec stiffness[dofs * dofs], over[rows * rows], half[rows * dofs], out[dofs * dofs];
    for (i64 n = 0; n < p->couplings; n++) {
        struct coupling *c = &p->coupling[n];
        if (!c->alternating) continue;
        if (!known) mass_matrices(p, time, p->mass);
        known = 1;
        vec *q = (vec *)p->cells;
        c->uniforms[0] = time;
        ((prepare)c->setup)(c->uniforms);
        for (i64 block = 0; block * LANES < c->cells; block++) {
            gather(p, c->nodes + block * LANES * 2, 2, 1, q);
            evaluate(p, c, block, 0, drives(p, c, 0, 0), q, 1);
            memset(stiffness, 0, sizeof stiffness);
            for (i64 pair = 0; pair < 4; pair++) {
                i64 a = pair / 2, b = pair % 2;
                memset(over, 0, sizeof over);
                for (i64 e = c->starts[pair]; e < c->starts[pair + 1]; e++)
                    over[c->entries[2 * e]] += ((vec *)c->data)[c->entries[2 * e + 1]];
                pair_tangent(p, over, q + a * rows, q + b * rows, half, out);
                for (i64 e = 0; e < dofs * dofs; e++) stiffness[e] += a == b ? out[e] : -out[e];
            }
            for (i64 lane = 0; lane < LANES && block * LANES + lane < c->cells; lane++) {
                i64 node = c->nodes[(block * LANES + lane) * 2];
                double weight = ((const vec *)p->term[0].weight)[node / LANES][node % LANES];
                for (i64 f = 0; f < p->fields; f++)
                    for (i64 d = p->field[4 * f + 2]; p->field[4 * f] && d < p->field[4 * f + 2] + 3; d++)
                        if (-0.25 * h * h * stiffness[d * dofs + d][lane] * weight >
                            p->mass[(node * dofs + d) * stride + d])
                            return node + 1;
            }
        }
    }
    return 0;
}
