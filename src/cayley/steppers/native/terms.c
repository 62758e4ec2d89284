/* The parts of the action at their quadrature points, contracted with the interpolation: residual, momenta and tangent.
 *
 * Up to those points everything is linear in the control nodes, so gradients y and Hessians J of a part contract as
 *
 *     D_(a,i) L = sum over stages k and points g of w_k h W_g P_a' (l_ki y + l'_ki/h y'),     P_a = (phi_ga, psi_ga)
 *
 * and are left-trivialized then, LANES cells at a time.
 */
#include <string.h>
#include "lanes.h"

static void evaluate(struct term *t, double *data, double *uniforms, i64 tangent)
{
    ((kernel)(tangent ? t->run : t->light_run))(data, uniforms, 0, t->gauss);
}

/* Rates of still nodes: those of the turning frame, or zero. */
static void turn_with(struct problem *p, const vec *value, i64 width, vec *slope)
{
    i64 rows = ROWS;
    memset(slope, 0, (size_t)(width * rows) * sizeof(vec));
    if (!p->spin) return;
    for (i64 a = 0; a < width; a++)
        for (i64 row = 0; row < rows; row++)
            for (i64 e = 0; e < rows; e++) slope[a * rows + row] += p->spin[row * rows + e] * value[a * rows + e];
}

/* Inputs of the kernel at all points of a block of cells, at one stage. */
static void interpolate(struct problem *p, struct term *t, i64 block, i64 k, double h, const vec *q, double *out,
                        i64 rows_of_block)
{
    i64 rows = ROWS, width = t->width, controls = p->stages + 1;
    vec value[width * rows], slope[width * rows];
    for (i64 e = 0; e < width * rows; e++) {
        vec sum = p->ell[k * controls] * q[e];
        for (i64 i = 1; i < controls; i++) sum += p->ell[k * controls + i] * q[i * width * rows + e];
        value[e] = sum;
        if (!t->rates || p->still) continue;
        sum = p->dell[k * controls] * q[e];
        for (i64 i = 1; i < controls; i++) sum += p->dell[k * controls + i] * q[i * width * rows + e];
        slope[e] = sum / h;
    }
    if (t->rates && p->still) turn_with(p, value, width, slope);
    for (i64 g = 0; g < t->gauss; g++) {
        vec *data = (vec *)(out + g * rows_of_block * LANES);
        for (i64 s = 0; s < t->slots; s++)
            for (i64 row = 0; row < rows; row++) {
                vec sum = {0.0}, rate = {0.0};
                for (i64 a = 0; a < width; a++) {
                    int zero;
                    vec factor = SHAPE(t, block, s, g, a, &zero);
                    if (zero) continue;
                    sum += factor * value[a * rows + row];
                    if (t->rates) rate += factor * slope[a * rows + row];
                }
                data[s * rows + row] = sum;
                if (t->rates) data[(t->slots + s) * rows + row] = rate;
            }
        memcpy(data + t->constant_row, t->constant + (block * t->gauss + g) * t->constants * LANES,
               (size_t)(t->constants * LANES) * sizeof(double));
    }
}

/* Add the gradients of a block of cells at one stage to y[i][a][row]. */
static void pull(struct problem *p, struct term *t, i64 block, i64 k, double h, const double *at, i64 rows_of_block,
                 vec *y)
{
    i64 rows = ROWS, width = t->width, controls = p->stages + 1;
    for (i64 a = 0; a < width; a++) {
        vec value[rows], slope[rows];
        memset(value, 0, sizeof value);
        memset(slope, 0, sizeof slope);
        for (i64 g = 0; g < t->gauss; g++) {
            const vec *data = (const vec *)(at + g * rows_of_block * LANES) + t->gradient;
            for (i64 s = 0; s < t->slots; s++) {
                int zero;
                vec factor = SHAPE(t, block, s, g, a, &zero) * ((const vec *)t->weight)[block * t->gauss + g];
                if (zero) continue;
                for (i64 row = 0; row < rows; row++) value[row] += factor * data[s * rows + row];
                if (t->rated)
                    for (i64 row = 0; row < rows; row++) slope[row] += factor * data[(t->slots + s) * rows + row];
            }
        }
        if (t->rated && p->spin)
            for (i64 row = 0; row < rows; row++)
                for (i64 e = 0; e < rows; e++) value[row] += p->spin[e * rows + row] * slope[e];
        for (i64 i = p->still; i < controls; i++) {
            double c = p->weights[k] * h * p->ell[k * controls + i], d = p->weights[k] * p->dell[k * controls + i];
            vec *out = y + (i * width + a) * rows;
            for (i64 row = 0; row < rows; row++) out[row] += c * value[row];
            if (t->rated)
                for (i64 row = 0; row < rows; row++) out[row] += d * slope[row];
        }
    }
}

/* The four parts of J for a pair of nodes at one stage: u u, u u', u' u, u' u'. */
static void pair(struct problem *p, const struct term *t, i64 block, const double *at, i64 a, i64 b, vec *parts)
{
    (void)p;
    i64 square = ROWS * ROWS;
    memset(parts, 0, (size_t)(4 * square) * sizeof(vec));
    for (i64 g = 0; g < t->gauss; g++) {
        const vec *data = (const vec *)(at + g * t->rows * LANES);
        vec weight = ((const vec *)t->weight)[block * t->gauss + g];
        for (i64 s = 0; s < t->slots; s++) {
            int none, zero;
            vec left = SHAPE(t, block, s, g, a, &none) * weight;
            for (i64 u = 0; u < t->slots && !none; u++) {
                vec factor = left * SHAPE(t, block, u, g, b, &zero);
                if (zero) continue;
                for (i64 part = 0; part < 4; part++) {
                    i64 out = part / 2, in = part % 2;
                    if ((out && !t->rated) || (in && !t->rates)) continue;
                    i64 which = (out * t->slots + s) * t->slots * (1 + t->rates) + in * t->slots + u;
                    vec *sum = parts + part * square;
                    for (i64 e = t->starts[which]; e < t->starts[which + 1]; e++)
                        sum[t->entries[2 * e]] += factor * data[t->entries[2 * e + 1]];
                }
            }
        }
    }
}

/* out += left A right, with A and a factor from either side: the spin or, transposed, from the left; or nothing. */
static void spun(struct problem *p, const vec *part, i64 left, i64 right, double factor, vec *room, vec *out)
{
    i64 rows = ROWS;
    if ((left || right) && !p->spin) return;
    for (i64 i = 0; i < rows; i++)
        for (i64 j = 0; j < rows; j++) {
            vec sum = right ? part[0] * 0.0 : part[i * rows + j];
            for (i64 e = 0; e < rows && right; e++) sum += part[i * rows + e] * p->spin[e * rows + j];
            room[i * rows + j] = sum;
        }
    for (i64 i = 0; i < rows; i++)
        for (i64 j = 0; j < rows; j++) {
            vec sum = left ? part[0] * 0.0 : room[i * rows + j];
            for (i64 e = 0; e < rows && left; e++) sum += p->spin[e * rows + i] * room[e * rows + j];
            out[i * rows + j] += factor * sum;
        }
}

/* With u' = S u + du/dt about an equilibrium, the derivative of dL/du + S' dL/du' - d/dt dL/du' along u, du/dt or
 * d2u/dt2, from the four parts of J. */
static void still_tangent(struct problem *p, const struct term *t, const vec *parts, vec *room, vec *over)
{
    i64 square = ROWS * ROWS;
    const vec *uu = parts, *ur = parts + square, *ru = parts + 2 * square, *rr = parts + 3 * square;
    if (p->order == 0) {
        spun(p, uu, 0, 0, 1.0, room, over);
        if (t->rates) spun(p, ur, 0, 1, 1.0, room, over);
        if (t->rated) spun(p, ru, 1, 0, 1.0, room, over), spun(p, rr, 1, 1, 1.0, room, over);
    } else if (p->order == 1) {
        if (t->rates) spun(p, ur, 0, 0, 1.0, room, over);
        if (t->rated) {
            spun(p, ru, 0, 0, -1.0, room, over);
            spun(p, rr, 1, 0, 1.0, room, over), spun(p, rr, 0, 1, -1.0, room, over);
        }
    } else if (t->rated) spun(p, rr, 0, 0, -1.0, room, over);
}

static void tangents(struct problem *p, struct term *t, i64 block, double h, const vec *q, const vec *y, vec *room)
{
    i64 rows = ROWS, dofs = DOFS, r = p->stages, controls = r + 1, width = t->width, square = rows * rows;
    const i64 *nodes = t->nodes + block * LANES * width;
    i64 active = t->cells - block * LANES < LANES ? t->cells - block * LANES : LANES;
    vec *over = room, *parts = over + r * r * square, *half = parts + 4 * square, *out = half + rows * dofs;
    for (i64 a = 0; a < width; a++)
        for (i64 b = 0; b < width; b++) {
            memset(over, 0, (size_t)(r * r * square) * sizeof(vec));
            for (i64 k = 0; k < p->stages; k++) {
                pair(p, t, block, t->data + k * t->gauss * t->rows * LANES, a, b, parts);
                if (p->still) {
                    still_tangent(p, t, parts, half, over);
                    continue;
                }
                const double *ell = p->ell + k * controls, *dell = p->dell + k * controls;
                double w = p->weights[k];
                for (i64 i = 0; i < r; i++)
                    for (i64 j = 1; j < controls; j++) {
                        vec *sum = over + (i * r + j - 1) * square;
                        double c[4] = {w * h * ell[i] * ell[j], w * ell[i] * dell[j], w * dell[i] * ell[j],
                                       w * dell[i] * dell[j] / h};
                        for (i64 part = 0; part < 4; part++) {
                            if ((part / 2 && !t->rated) || (part % 2 && !t->rates)) continue;
                            for (i64 e = 0; e < square; e++) sum[e] += c[part] * parts[part * square + e];
                        }
                    }
            }
            const i64 *places = t->places + ((block * LANES * width + a) * width + b) * 2;
            for (i64 i = 0; i < r; i++)
                for (i64 j = 1; j < controls; j++) {
                    i64 at = i + p->still; /* the control whose equation this is */
                    const vec *left = q + (at * width + a) * rows, *right = q + (j * width + b) * rows;
                    pair_tangent(p, over + (i * r + j - 1) * square, left, right, half, out);
                    if (at == j && a == b && !p->order) turned(p, y + (at * width + a) * rows, left, out);
                    if (t->held[block]) mask(p, nodes, width, a, b, out);
                    scatter_pair(p, places, 2 * width * width, active, i, j - 1, out);
                }
        }
}

/* Add residuals and momenta of a block of cells. */
static void scatter(struct problem *p, struct term *t, i64 block, const vec *q, const vec *y)
{
    i64 rows = ROWS, dofs = DOFS, r = p->stages, width = t->width;
    i64 active = t->cells - block * LANES < LANES ? t->cells - block * LANES : LANES;
    vec out[dofs];
    for (i64 i = p->still; i <= r; i++)
        for (i64 a = 0; a < width; a++) {
            i64 equation = i - p->still;
            trivialize_lanes(p, y + (i * width + a) * rows, q + (i * width + a) * rows, out);
            for (i64 lane = 0; lane < active; lane++) {
                i64 node = t->nodes[(block * LANES + lane) * width + a];
                double *sum = equation < r ? p->residual + (node * r + equation) * dofs : p->after + node * dofs;
                for (i64 d = 0; d < dofs; d++) sum[d] += out[d][lane];
            }
        }
}

/* Add work and loss of a force at one stage to its account. */
static void book(struct problem *p, struct term *t, i64 block, i64 k, double h, const double *at, i64 rows_of_block)
{
    i64 size = t->slots * ROWS;
    vec work = {0.0}, loss = {0.0};
    for (i64 g = 0; g < t->gauss; g++) {
        const vec *data = (const vec *)(at + g * rows_of_block * LANES);
        vec weight = ((const vec *)t->weight)[block * t->gauss + g];
        if (t->account >= 0) {
            work += weight * data[t->account], loss += weight * data[t->account + 1];
            continue;
        }
        for (i64 e = 0; e < size; e++) loss -= weight * data[t->gradient + e] * data[size + e];
    }
    for (i64 lane = 0; lane < LANES; lane++) {
        t->work[0] += p->weights[k] * h * work[lane];
        t->work[1] += p->weights[k] * h * loss[lane];
    }
}

/* Rate of a node in the embedding from a left-trivialized velocity, in one lane. */
static void embed(struct problem *p, const double *v, const vec *point, i64 lane, vec *out)
{
    for (i64 f = 0; f < p->fields; f++) {
        const i64 *field = p->field + 4 * f, row = field[1];
        const double *w = v + field[2];
        if (!field[0]) {
            for (i64 k = 0; k < field[3]; k++) out[row + k][lane] = w[k];
            continue;
        }
        double a = point[row][lane], x = point[row + 1][lane], y = point[row + 2][lane], z = point[row + 3][lane];
        out[row][lane] = -0.5 * (x * w[0] + y * w[1] + z * w[2]);
        out[row + 1][lane] = 0.5 * (a * w[0] + y * w[2] - z * w[1]);
        out[row + 2][lane] = 0.5 * (a * w[1] + z * w[0] - x * w[2]);
        out[row + 3][lane] = 0.5 * (a * w[2] + x * w[1] - y * w[0]);
    }
}

static void add_term(struct problem *p, struct term *t, double begin, double h, i64 tangent)
{
    i64 rows = ROWS, width = t->width, controls = p->stages + 1;
    double *uniforms = tangent ? t->uniforms : t->light_uniforms;
    i64 uniform_width = tangent ? t->uniform_width : t->light_width, block_rows = tangent ? t->rows : t->light_rows;
    vec *q = (vec *)p->cells, *y = q + controls * width * rows, *room = y + controls * width * rows;
    t->work[0] = t->work[1] = 0.0;
    for (i64 k = 0; k < p->stages; k++) {
        uniforms[k * uniform_width] = begin + p->at[k] * h;
        ((prepare)(tangent ? t->setup : t->light_setup))(uniforms + k * uniform_width);
    }
    for (i64 block = 0; block * LANES < t->cells; block++) {
        gather(p, t->nodes + block * LANES * width, width, controls, q);
        memset(y, 0, (size_t)(controls * width * rows) * sizeof(vec));
        for (i64 k = 0; k < p->stages; k++) {
            double *data = t->data + k * t->gauss * block_rows * LANES;
            interpolate(p, t, block, k, h, q, data, block_rows);
            evaluate(t, data, uniforms + k * uniform_width, tangent);
            pull(p, t, block, k, h, data, block_rows, y);
            if (t->force) book(p, t, block, k, h, data, block_rows);
        }
        scatter(p, t, block, q, y);
        if (tangent) tangents(p, t, block, h, q, y, room);
    }
}

/* Residual and momenta of all terms, and their tangent. */
void add_terms(struct problem *p, double begin, double h, i64 tangent)
{
    for (i64 i = 0; i < p->terms; i++) add_term(p, &p->term[i], begin, h, tangent);
}

/* Bias, and mass matrices of all nodes, at the first control, [nodes + 1][dofs][dofs padded to whole vectors]. */
void mass_matrices(struct problem *p, double time, double *mass)
{
    i64 rows = ROWS, dofs = DOFS, square = rows * rows, stride = (dofs + LANES - 1) / LANES * LANES;
    vec *q = (vec *)p->cells, *parts = q + rows, *half = parts + 4 * square, *out = half + rows * dofs;
    vec slope[rows], still[dofs];
    memset(p->bias, 0, (size_t)((p->nodes + 1) * dofs) * sizeof(double));
    memset(mass, 0, (size_t)((p->nodes + 1) * dofs * stride) * sizeof(double));
    for (i64 n = 0; n < p->inertia; n++) {
        struct term *t = &p->term[n];
        t->uniforms[0] = time;
        ((prepare)t->setup)(t->uniforms);
        for (i64 block = 0; block * LANES < t->cells; block++) {
            gather(p, t->nodes + block * LANES, 1, 1, q);
            vec *data = (vec *)t->data;
            for (i64 row = 0; row < rows; row++) data[row] = q[row], data[rows + row] = q[row] * 0.0;
            memcpy(data + t->constant_row, t->constant + block * t->constants * LANES,
                   (size_t)(t->constants * LANES) * sizeof(double));
            evaluate(t, t->data, t->uniforms, 1);
            pair(p, t, block, t->data, 0, 0, parts);
            pair_tangent(p, parts + 3 * square, q, q, half, out);
            vec weight = ((const vec *)t->weight)[block];
            for (i64 row = 0; row < rows; row++) slope[row] = data[t->gradient + rows + row] * weight;
            trivialize_lanes(p, slope, q, still);
            for (i64 lane = 0; lane < LANES && block * LANES + lane < t->cells; lane++) {
                i64 node = t->nodes[block * LANES + lane];
                double *m = mass + node * dofs * stride;
                for (i64 d = 0; d < dofs; d++) p->bias[node * dofs + d] += still[d][lane];
                for (i64 d = 0; d < dofs; d++)
                    for (i64 e = 0; e < dofs; e++) m[d * stride + e] += out[d * dofs + e][lane];
            }
        }
    }
}

/* Add part times the forces of springs (or, with rates, of dampers) at the first controls to out, [nodes + 1][dofs].
 *
 * Velocities are left-trivialized, [nodes + 1][dofs]; dp/dt = 1/2 p w. */
void add_ties(struct problem *p, i64 rates, const double *velocity, double part, double *out)
{
    i64 rows = ROWS, dofs = DOFS;
    vec *q = (vec *)p->cells, *slope = q + 2 * rows, embedded[rows], moved[dofs];
    for (i64 n = p->inertia; n < p->terms; n++) {
        struct term *t = &p->term[n];
        if (t->rates != rates) continue;
        t->work[0] = t->work[1] = 0.0;
        t->light_uniforms[0] = 0.0;
        ((prepare)t->light_setup)(t->light_uniforms);
        for (i64 block = 0; block * LANES < t->cells; block++) {
            const i64 *nodes = t->nodes + block * LANES * t->width;
            gather(p, nodes, t->width, 1, q);
            vec *data = (vec *)t->data;
            memcpy(data, q, (size_t)(2 * rows) * sizeof(vec));
            if (rates) {
                for (i64 a = 0; a < 2; a++)
                    for (i64 lane = 0; lane < LANES; lane++)
                        embed(p, velocity + nodes[lane * 2 + a] * dofs, q + a * rows, lane, slope + a * rows);
                memcpy(data + 2 * rows, slope, (size_t)(2 * rows) * sizeof(vec));
            }
            memcpy(data + t->constant_row, t->constant + block * t->constants * LANES,
                   (size_t)(t->constants * LANES) * sizeof(double));
            evaluate(t, t->data, t->light_uniforms, 0);
            if (t->force) book(p, t, block, 0, part / p->weights[0], t->data, t->light_rows);
            for (i64 a = 0; a < 2; a++) {
                for (i64 row = 0; row < rows; row++)
                    embedded[row] = data[t->gradient + a * rows + row] * ((const vec *)t->weight)[block];
                trivialize_lanes(p, embedded, q + a * rows, moved);
                for (i64 lane = 0; lane < LANES && block * LANES + lane < t->cells; lane++)
                    for (i64 d = 0; d < dofs; d++) out[nodes[lane * 2 + a] * dofs + d] += part * moved[d][lane];
            }
        }
    }
}

/* Loads that depend on time alone, at the stages. A body moment m does the work m e with e = 2 Im(conj(z) dz)/|z|^2, so
 * its force on z is 2 z m/|z|^2. */
void add_loads(struct problem *p, i64 number, double h)
{
    i64 rows = ROWS, dofs = DOFS, r = p->stages, controls = r + 1, values = (p->nodes + 1) * rows;
    p->energy[0] = 0.0;
    for (i64 e = 0; e < p->entry_count; e++) {
        const i64 *entry = p->entries + 7 * e, node = entry[0], row = entry[1], turn = entry[2], form = entry[3];
        for (i64 k = 0; k < p->stages; k++) {
            const double *given = p->table + (number * p->stages + k) * p->columns + entry[4];
            const double *lever = p->scales + 4 * e + 1;
            double s = h * p->weights[k] * p->scales[4 * e], z[rows], dz[rows], push[rows], out[dofs];
            double x = s * given[0], y = s * given[1], v = s * given[2];
            if (x == 0.0 && y == 0.0 && v == 0.0) continue;
            for (i64 c = 0; c < rows; c++) {
                z[c] = dz[c] = push[c] = 0.0;
                for (i64 i = 0; i < controls; i++) {
                    double q = p->control[i * values + node * rows + c];
                    z[c] += p->ell[k * controls + i] * q, dz[c] += p->dell[k * controls + i] * q / h;
                }
            }
            if (form) {
                double size = z[turn] * z[turn] + z[turn + 1] * z[turn + 1] + z[turn + 2] * z[turn + 2] +
                              z[turn + 3] * z[turn + 3];
                double sign = form == 2 ? 1.0 : -1.0;
                double w = z[turn], i = sign * z[turn + 1], j = sign * z[turn + 2], l = sign * z[turn + 3];
                double a = j * v - l * y, b = l * x - i * v, c = i * y - j * x;
                x += 2.0 * (w * a + j * c - l * b) / size, y += 2.0 * (w * b + l * a - i * c) / size;
                v += 2.0 * (w * c + i * b - j * a) / size;
            }
            if (lever[0] != 0.0 || lever[1] != 0.0 || lever[2] != 0.0) { /* the moment of a force off the node */
                double a = lever[1] * v - lever[2] * y, b = lever[2] * x - lever[0] * v;
                v = lever[0] * y - lever[1] * x, x = a, y = b;
            }
            double vector[3] = {x, y, v};
            if (entry[5]) push_turn(z + row, vector, push + row);
            else memcpy(push + row, vector, sizeof vector);
            for (i64 c = 0; c < rows; c++) p->energy[0] += push[c] * dz[c];
            for (i64 i = 0; i < controls; i++) {
                trivialize(p, push, p->control + i * values + node * rows, out);
                double *sum = i < r ? p->residual + (node * r + i) * dofs : p->after + node * dofs;
                for (i64 d = 0; d < dofs; d++) sum[d] += p->ell[k * controls + i] * out[d];
            }
        }
    }
}
