/* Block-sparse LU: blocks are eliminated in an order of small fill, with row pivots inside a block.
 *
 * Eliminating block k leaves its pivot D (factored), R = D^-1 (what stands right of it) and C (what stands below); the
 * product C R is subtracted from the blocks of its neighbors. Where everything stands is found once, by order_blocks.
 */
#include <stdlib.h>
#include <string.h>
#include "engine.h"

struct front {
    i64 size, pad;             /* unknowns; the same padded to whole vectors */
    i64 pivot, right, below;   /* offsets of D, R and C */
    i64 width;                 /* padded columns of R */
    i64 height;                /* rows of C */
    i64 first, neighbors;      /* its neighbors among all */
    i64 update;                /* first of its neighbors^2 targets */
    i64 unknown, pivots;       /* first unknown, first pivot */
};

struct fronts {
    i64 count, total, unknowns;
    i64 *order, *position;
    struct front *front;       /* in the order of elimination */
    i64 *neighbor, *column, *row;   /* of every neighbor: block, its columns in R, its rows in C */
    i64 *target;               /* (offset, stride) of every update */
    i64 *start;                /* first unknown of every block */
};

static i64 padded(i64 n) { return (n + LANES - 1) / LANES * LANES; }

struct set { i64 count, room; i64 *item; };

static void add(struct set *s, i64 value)
{
    for (i64 i = 0; i < s->count; i++)
        if (s->item[i] == value) return;
    if (s->count == s->room) {
        s->room = s->room ? 2 * s->room : 4;
        s->item = realloc(s->item, (size_t)s->room * sizeof(i64));
    }
    s->item[s->count++] = value;
}

static void drop(struct set *s, i64 value)
{
    for (i64 i = 0; i < s->count; i++)
        if (s->item[i] == value) {
            s->item[i] = s->item[--s->count];
            return;
        }
}

/* Minimum degree, the last one that became small first, so that chains are followed from an end.
 *
 * waiting[b] counts the blocks that must go before b. heads and links are lists of blocks by degree. */
static void eliminate(i64 count, const i64 *size, struct set *near, i64 *waiting, const i64 *before_start,
                      const i64 *before, i64 *order, struct set *found)
{
    i64 most = 1;
    for (i64 b = 0; b < count; b++) most += size[b];
    if (most > 4096) most = 4096;
    i64 *head = malloc((size_t)most * sizeof(i64)), *next = malloc((size_t)count * sizeof(i64));
    i64 *previous = malloc((size_t)count * sizeof(i64)), *degree = malloc((size_t)count * sizeof(i64));
    char *listed = calloc((size_t)count, 1);
    for (i64 d = 0; d < most; d++) head[d] = -1;
#define LIST(b)                                                             \
    do {                                                                    \
        i64 total_ = 0;                                                     \
        for (i64 i_ = 0; i_ < near[b].count; i_++) total_ += size[near[b].item[i_]]; \
        degree[b] = total_ < most ? total_ : most - 1;                      \
        previous[b] = -1;                                                   \
        next[b] = head[degree[b]];                                          \
        if (next[b] >= 0) previous[next[b]] = b;                            \
        head[degree[b]] = b;                                                \
        listed[b] = 1;                                                      \
    } while (0)
#define UNLIST(b)                                                           \
    do {                                                                    \
        if (previous[b] >= 0) next[previous[b]] = next[b];                  \
        else head[degree[b]] = next[b];                                     \
        if (next[b] >= 0) previous[next[b]] = previous[b];                  \
        listed[b] = 0;                                                      \
    } while (0)
    for (i64 b = count - 1; b >= 0; b--)
        if (!waiting[b]) LIST(b);
    for (i64 step = 0; step < count; step++) {
        i64 d = 0;
        while (head[d] < 0) d++;
        i64 k = head[d];
        UNLIST(k);
        order[step] = k;
        found[step] = near[k];
        for (i64 i = 0; i < found[step].count; i++) {
            i64 a = found[step].item[i];
            drop(&near[a], k);
            for (i64 j = 0; j < found[step].count; j++)
                if (j != i) add(&near[a], found[step].item[j]);
        }
        for (i64 i = before_start[k]; i < before_start[k + 1]; i++)
            if (--waiting[before[i]] == 0) LIST(before[i]);
        for (i64 i = found[step].count - 1; i >= 0; i--) {
            i64 a = found[step].item[i];
            if (listed[a]) {
                UNLIST(a);
                LIST(a);
            }
        }
    }
    free(head), free(next), free(previous), free(degree), free(listed);
}

/* Sort blocks by their place in the order of elimination. */
static void sort(i64 *item, i64 count, const i64 *position)
{
    for (i64 i = 1; i < count; i++) {
        i64 one = item[i], j = i;
        for (; j > 0 && position[item[j - 1]] > position[one]; j--) item[j] = item[j - 1];
        item[j] = one;
    }
}

/* Plan the elimination of blocks of the given sizes. Neighbors of b: neighbor[start[b] ... start[b + 1]]; those in
 * after[after_start[b] ...] may go only after b. Returns the address of the plan. */
i64 order_blocks(i64 count, const i64 *size, const i64 *start, const i64 *neighbor, const i64 *after_start,
                 const i64 *after)
{
    struct set *near = calloc((size_t)count, sizeof *near), *found = calloc((size_t)count, sizeof *found);
    i64 *waiting = calloc((size_t)count, sizeof(i64));
    for (i64 b = 0; b < count; b++) {
        for (i64 i = start[b]; i < start[b + 1]; i++)
            if (neighbor[i] != b) add(&near[b], neighbor[i]);
        for (i64 i = after_start[b]; i < after_start[b + 1]; i++) waiting[after[i]]++;
    }
    struct fronts *f = calloc(1, sizeof *f);
    f->count = count;
    f->order = malloc((size_t)count * sizeof(i64));
    f->position = malloc((size_t)count * sizeof(i64));
    f->start = malloc((size_t)(count + 1) * sizeof(i64));
    f->front = calloc((size_t)count, sizeof *f->front);
    eliminate(count, size, near, waiting, after_start, after, f->order, found);
    i64 pairs = 0, links = 0;
    for (i64 k = 0; k < count; k++) {
        f->position[f->order[k]] = k;
        links += found[k].count;
        pairs += found[k].count * found[k].count;
    }
    f->neighbor = malloc((size_t)(links + 1) * sizeof(i64));
    f->column = malloc((size_t)(links + 1) * sizeof(i64));
    f->row = malloc((size_t)(links + 1) * sizeof(i64));
    f->target = malloc((size_t)(2 * pairs + 1) * sizeof(i64));
    i64 link = 0, update = 0, offset = 0, unknown = 0;
    for (i64 k = 0; k < count; k++) {
        struct front *t = &f->front[k];
        i64 b = f->order[k];
        sort(found[k].item, found[k].count, f->position);
        t->size = size[b], t->pad = padded(size[b]);
        t->first = link, t->neighbors = found[k].count, t->update = update;
        t->unknown = t->pivots = unknown;
        f->start[b] = unknown;
        unknown += t->size;
        for (i64 i = 0; i < found[k].count; i++, link++) {
            i64 a = found[k].item[i];
            f->neighbor[link] = a, f->column[link] = t->width, f->row[link] = t->height;
            t->width += padded(size[a]), t->height += size[a];
        }
        t->pivot = offset, t->right = offset + t->size * t->pad, t->below = t->right + t->size * t->width;
        offset = t->below + t->height * t->pad;
        update += t->neighbors * t->neighbors;
        free(found[k].item);
    }
    f->total = offset, f->unknowns = unknown, f->start[count] = unknown;
    for (i64 k = 0; k < count; k++) {
        struct front *t = &f->front[k];
        i64 at = t->update;
        for (i64 i = 0; i < t->neighbors; i++)
            for (i64 j = 0; j < t->neighbors; j++, at++)
                locate((i64)f, 1, &f->neighbor[t->first + i], &f->neighbor[t->first + j], &f->target[2 * at]);
    }
    free(near), free(found), free(waiting);
    return (i64)f;
}

void release_blocks(i64 fronts)
{
    struct fronts *f = (struct fronts *)fronts;
    free(f->order), free(f->position), free(f->start), free(f->front), free(f->neighbor), free(f->column);
    free(f->row), free(f->target), free(f);
}

i64 matrix_size(i64 fronts) { return ((struct fronts *)fronts)->total; }

void unknown_starts(i64 fronts, i64 *start)
{
    struct fronts *f = (struct fronts *)fronts;
    memcpy(start, f->start, (size_t)f->count * sizeof(i64));
}

/* Offset and row stride of the matrix block (row, column), -1 where there is none. */
void locate(i64 fronts, i64 count, const i64 *row, const i64 *column, i64 *found)
{
    const struct fronts *f = (const struct fronts *)fronts;
    for (i64 n = 0; n < count; n++) {
        i64 a = row[n], b = column[n];
        found[2 * n] = found[2 * n + 1] = -1;
        if (a < 0 || b < 0) continue;
        i64 i = f->position[a], j = f->position[b];
        const struct front *t = &f->front[i < j ? i : j];
        if (i == j) {
            found[2 * n] = t->pivot, found[2 * n + 1] = t->pad;
            continue;
        }
        i64 other = i < j ? b : a, low = 0, high = t->neighbors - 1;
        while (low < high) { /* neighbors stand in the order of elimination */
            i64 middle = (low + high) / 2;
            if (f->position[f->neighbor[t->first + middle]] < f->position[other]) low = middle + 1;
            else high = middle;
        }
        if (t->neighbors == 0 || f->neighbor[t->first + low] != other) continue;
        found[2 * n] = i < j ? t->right + f->column[t->first + low] : t->below + f->row[t->first + low] * t->pad;
        found[2 * n + 1] = i < j ? t->width : t->pad;
    }
}

/* y -= factor x over whole vectors. */
static inline void subtract(double *y, const double *x, double factor, i64 n)
{
    vec *a = (vec *)y;
    const vec *b = (const vec *)x;
    for (i64 i = 0; i < n / LANES; i++) a[i] -= factor * b[i];
}

/* A row that is so much less than what it should be at least counts as zero; a pivot, too. */
static const double CANCELLED = 1e-10, ROUNDED = 1e-14;

/* Whether an unknown is a multiplier: something is expected of its row. */
#define OF_MULTIPLIER(watch, i) ((watch)[2 * (i)] + (watch)[2 * (i) + 1] > 0.0)

/* Factors of columns and rows that make the largest entry of every row one: columns of multipliers and of their nodes are
 * brought to one size first, so that light nodes or short steps look like others. Returns 0, or 1 + a row that is zero up
 * to rounding (watch, see struct problem). */
static i64 scales(const double *a, i64 n, i64 stride, const double *watch, double *column, double *row)
{
    for (i64 j = 0; j < n; j++) column[j] = 1.0;
    for (i64 i = 0; i < n && watch; i++) { /* nodes: 1 over the root of their own part */
        double most = 0.0;
        if (OF_MULTIPLIER(watch, i)) continue;
        for (i64 k = 0; k < n; k++) {
            double size = OF_MULTIPLIER(watch, k) ? 0.0 : __builtin_fabs(a[i * stride + k]);
            most = size > most ? size : most;
        }
        if (most > 0.0) column[i] = 1.0 / __builtin_sqrt(most);
    }
    for (i64 j = 0; j < n && watch; j++) { /* multipliers: by their largest force on these */
        double most = 0.0;
        if (!OF_MULTIPLIER(watch, j)) continue;
        for (i64 i = 0; i < n; i++) {
            double size = OF_MULTIPLIER(watch, i) ? 0.0 : __builtin_fabs(a[i * stride + j]) * column[i];
            most = size > most ? size : most;
        }
        column[j] = 1.0 / (most > 0.0 ? most : __builtin_sqrt(watch[2 * j]));
    }
    for (i64 i = 0; i < n; i++) {
        double most = 0.0, plain = 0.0;
        for (i64 k = 0; k < n; k++) {
            double size = __builtin_fabs(a[i * stride + k]), scaled = size * column[k];
            plain = size > plain ? size : plain;
            most = scaled > most ? scaled : most;
        }
        if (!(plain > (watch ? CANCELLED * watch[2 * i] : 0.0))) return i + 1;
        row[i] = 1.0 / most;
    }
    return 0;
}

/* Row of the pivot of a column: where its entry is largest relative to the row it stands in; -1 where there is none. */
static inline i64 find_pivot(const double *a, i64 n, i64 stride, const double *column, const double *row, i64 c)
{
    i64 best = c;
    double most = -1.0;
    for (i64 i = c; i < n; i++) {
        double size = __builtin_fabs(a[i * stride + c]) * row[i];
        if (size > most) most = size, best = i;
    }
    return most * column[c] > ROUNDED ? best : -1;
}

/* LU in place, rows of ``stride`` doubles (whole vectors), pivots by find_pivot. Returns 0, or 1 + the column that has none. */
i64 factorize_dense(double *a, i64 n, i64 stride, i64 *pivots, const double *watch)
{
    double column[n], row[n];
    i64 zero = scales(a, n, stride, watch, column, row);
    if (zero) return zero;
    for (i64 c = 0; c < n; c++) {
        i64 best = pivots[c] = find_pivot(a, n, stride, column, row, c);
        if (best < 0) return c + 1;
        if (best != c) {
            vec *x = (vec *)(a + c * stride), *y = (vec *)(a + best * stride);
            for (i64 k = 0; k < stride / LANES; k++) {
                vec t = x[k];
                x[k] = y[k], y[k] = t;
            }
            row[best] = row[c];
        }
        double inverse = 1.0 / a[c * stride + c];
        i64 from = (c + 1) / LANES * LANES; /* columns before c + 1 of its vector are kept below */
        for (i64 i = c + 1; i < n; i++) {
            double factor = a[i * stride + c] * inverse;
            if (factor == 0.0) {
                a[i * stride + c] = 0.0;
                continue;
            }
            double kept[LANES];
            memcpy(kept, a + i * stride + from, sizeof kept);
            subtract(a + i * stride + from, a + c * stride + from, factor, stride - from);
            for (i64 k = from; k <= c && k < from + LANES; k++) a[i * stride + k] = kept[k - from];
            a[i * stride + c] = factor;
        }
    }
    return 0;
}

/* X = A^-1 X for whole rows of ``width`` doubles. */
static void solve_rows(const double *a, i64 n, i64 stride, const i64 *pivots, double *x, i64 width)
{
    for (i64 c = 0; c < n; c++)
        if (pivots[c] != c) {
            vec *u = (vec *)(x + c * width), *v = (vec *)(x + pivots[c] * width);
            for (i64 k = 0; k < width / LANES; k++) {
                vec t = u[k];
                u[k] = v[k], v[k] = t;
            }
        }
    for (i64 from = 0; from < width; from += LANES) {
        vec *column = (vec *)(x + from);
        i64 step = width / LANES;
        for (i64 i = 0; i < n; i++) {
            vec sum = column[i * step];
            for (i64 k = 0; k < i; k++) sum -= a[i * stride + k] * column[k * step];
            column[i * step] = sum;
        }
        for (i64 i = n - 1; i >= 0; i--) {
            vec sum = column[i * step];
            for (i64 k = i + 1; k < n; k++) sum -= a[i * stride + k] * column[k * step];
            column[i * step] = sum / a[i * stride + i];
        }
    }
}

void solve_dense(const double *a, i64 n, i64 stride, const i64 *pivots, double *x)
{
    for (i64 c = 0; c < n; c++) {
        double t = x[c];
        x[c] = x[pivots[c]], x[pivots[c]] = t;
    }
    for (i64 i = 0; i < n; i++)
        for (i64 k = 0; k < i; k++) x[i] -= a[i * stride + k] * x[k];
    for (i64 i = n - 1; i >= 0; i--) {
        for (i64 k = i + 1; k < n; k++) x[i] -= a[i * stride + k] * x[k];
        x[i] /= a[i * stride + i];
    }
}

/* Pivots up to this size are inverted: with so few rows one product is quicker than two substitutions. */
#define SMALL (2 * LANES)

/* Inverse in place by Gauss-Jordan elimination with the pivots of find_pivot. */
static inline i64 invert(double *a, i64 n, i64 stride, const double *watch)
{
    double column[SMALL], row[SMALL];
    i64 swapped[SMALL], zero = scales(a, n, stride, watch, column, row);
    if (zero) return zero;
    for (i64 c = 0; c < n; c++) {
        i64 best = swapped[c] = find_pivot(a, n, stride, column, row, c);
        if (best < 0) return c + 1;
        vec *own = (vec *)(a + c * stride), *other = (vec *)(a + best * stride);
        row[best] = row[c];
        double inverse = 1.0 / a[best * stride + c];
        for (i64 k = 0; k < stride / LANES; k++) {
            vec t = own[k];
            own[k] = other[k] * inverse;
            if (best != c) other[k] = t;
        }
        a[c * stride + c] = inverse;
        for (i64 i = 0; i < n; i++) {
            if (i == c) continue;
            double factor = a[i * stride + c];
            a[i * stride + c] = 0.0;
            for (i64 k = 0; k < stride / LANES; k++) ((vec *)(a + i * stride))[k] -= factor * own[k];
        }
    }
    for (i64 c = n - 1; c >= 0; c--) {
        if (swapped[c] == c) continue;
        for (i64 i = 0; i < n; i++) {
            double t = a[i * stride + c];
            a[i * stride + c] = a[i * stride + swapped[c]], a[i * stride + swapped[c]] = t;
        }
    }
    return 0;
}

/* X = A X for whole rows of ``width`` doubles, A small. */
static inline void multiply_rows(const double *a, i64 n, i64 stride, double *x, i64 width)
{
    for (i64 from = 0; from < width; from += LANES) {
        vec kept[SMALL];
        for (i64 k = 0; k < n; k++) kept[k] = *(vec *)(x + k * width + from);
        for (i64 i = 0; i < n; i++) {
            vec sum = a[i * stride] * kept[0];
            for (i64 k = 1; k < n; k++) sum += a[i * stride + k] * kept[k];
            *(vec *)(x + i * width + from) = sum;
        }
    }
}

/* y -= A x */
static inline void subtract_product(double *y, const double *a, i64 rows, i64 columns, i64 stride, const double *x)
{
    for (i64 p = 0; p < rows; p++) {
        double sum = 0.0;
        for (i64 q = 0; q < columns; q++) sum += a[p * stride + q] * x[q];
        y[p] -= sum;
    }
}

/* OUT -= A B for whole rows of ``width`` doubles. */
static inline void update(double *out, i64 out_stride, const double *a, i64 rows, i64 inner, i64 stride, const double *b,
                          i64 b_stride, i64 width)
{
    for (i64 p = 0; p < rows; p++)
        for (i64 c = 0; c < width; c += LANES) {
            vec sum = *(vec *)(out + p * out_stride + c);
            for (i64 q = 0; q < inner; q++) sum -= a[p * stride + q] * *(const vec *)(b + q * b_stride + c);
            *(vec *)(out + p * out_stride + c) = sum;
        }
}

/* Inner loops with the sizes of nodes with six degrees of freedom known to the compiler. */
#define SIX ((6 + LANES - 1) / LANES * LANES)
/* Such a pivot, where it is small: never with two lanes, and the compiler is not to think of it. */
#define SMALL_SIX(size) (SMALL >= 6 && (size) == 6)

static void eliminate_pivot(const struct front *t, double *pivot, double *right)
{
    if (SMALL_SIX(t->size)) multiply_rows(pivot, 6, SIX, right, t->width);
    else multiply_rows(pivot, t->size, t->pad, right, t->width);
}

/* Number of negative eigenvalues of the symmetric part of a pivot: by Jacobi's rotations, rows and columns scaled first,
 * which changes no sign. */
static i64 count_negative(const double *a, i64 n, i64 stride)
{
    double s[n * n], scale[n];
    for (i64 i = 0; i < n; i++) {
        double most = 0.0;
        for (i64 k = 0; k < n; k++) {
            double size = 0.5 * __builtin_fabs(a[i * stride + k] + a[k * stride + i]);
            most = size > most ? size : most;
        }
        scale[i] = most > 0.0 ? 1.0 / __builtin_sqrt(most) : 1.0;
    }
    for (i64 i = 0; i < n; i++)
        for (i64 k = 0; k < n; k++) s[i * n + k] = 0.5 * scale[i] * scale[k] * (a[i * stride + k] + a[k * stride + i]);
    for (i64 sweep = 0; sweep < 30; sweep++) {
        double off = 0.0;
        for (i64 i = 0; i < n; i++)
            for (i64 k = 0; k < i; k++) off += s[i * n + k] * s[i * n + k];
        if (!(off > 1e-28)) break;
        for (i64 i = 0; i < n; i++)
            for (i64 k = i + 1; k < n; k++) {
                double b = s[i * n + k];
                if (b == 0.0) continue;
                double ratio = 0.5 * (s[k * n + k] - s[i * n + i]) / b;
                double t = (ratio < 0.0 ? -1.0 : 1.0) / (__builtin_fabs(ratio) + __builtin_sqrt(1.0 + ratio * ratio));
                double c = 1.0 / __builtin_sqrt(1.0 + t * t), d = c * t;
                for (i64 m = 0; m < n; m++) {
                    double x = s[m * n + i], y = s[m * n + k];
                    s[m * n + i] = c * x - d * y, s[m * n + k] = d * x + c * y;
                }
                for (i64 m = 0; m < n; m++) {
                    double x = s[i * n + m], y = s[k * n + m];
                    s[i * n + m] = c * x - d * y, s[k * n + m] = d * x + c * y;
                }
            }
    }
    i64 count = 0;
    for (i64 i = 0; i < n; i++) count += s[i * n + i] < 0.0;
    return count;
}

static i64 factorize_counting(i64 fronts, double *matrix, i64 *pivots, const double *watch, i64 *negative)
{
    const struct fronts *f = (const struct fronts *)fronts;
    for (i64 k = 0; k < f->count; k++) {
        const struct front *t = &f->front[k];
        double *pivot = matrix + t->pivot, *right = matrix + t->right, *below = matrix + t->below;
        const double *own = watch ? watch + 2 * t->unknown : 0;
        if (negative) *negative += count_negative(pivot, t->size, t->pad);
        i64 failed = t->size > SMALL  ? factorize_dense(pivot, t->size, t->pad, pivots + t->pivots, own)
                     : SMALL_SIX(t->size) ? invert(pivot, 6, SIX, own)
                                          : invert(pivot, t->size, t->pad, own);
        if (failed) return f->order[k] + 1;
        if (!t->neighbors) continue;
        if (t->size > SMALL) solve_rows(pivot, t->size, t->pad, pivots + t->pivots, right, t->width);
        else eliminate_pivot(t, pivot, right);
        const i64 *target = f->target + 2 * t->update;
        for (i64 i = 0; i < t->neighbors; i++) {
            const struct front *a = &f->front[f->position[f->neighbor[t->first + i]]];
            const double *rows = below + f->row[t->first + i] * t->pad;
            for (i64 j = 0; j < t->neighbors; j++, target += 2) {
                i64 from = f->column[t->first + j];
                i64 width = (j + 1 < t->neighbors ? f->column[t->first + j + 1] : t->width) - from;
                double *out = matrix + target[0];
                if (t->size == 6 && a->size == 6)
                    update(out, target[1], rows, 6, 6, SIX, right + from, t->width, width);
                else update(out, target[1], rows, a->size, t->size, t->pad, right + from, t->width, width);
            }
        }
    }
    return 0;
}

/* LU of all blocks; returns 0, or 1 + the block that is singular. */
i64 factorize(i64 fronts, double *matrix, i64 *pivots, const double *watch)
{
    return factorize_counting(fronts, matrix, pivots, watch, 0);
}

/* The same, and the number of negative eigenvalues of the matrix if it is symmetric (Sylvester's law of inertia). */
i64 negatives(i64 fronts, double *matrix, i64 *pivots, i64 *negative)
{
    *negative = 0;
    return factorize_counting(fronts, matrix, pivots, 0, negative);
}

/* The solution replaces the right-hand side; unknowns stand in the order of elimination (see unknown_starts). */
void solve(i64 fronts, const double *matrix, const i64 *pivots, double *x)
{
    const struct fronts *f = (const struct fronts *)fronts;
    for (i64 k = 0; k < f->count; k++) {
        const struct front *t = &f->front[k];
        double *own = x + t->unknown;
        if (t->size > SMALL) solve_dense(matrix + t->pivot, t->size, t->pad, pivots + t->pivots, own);
        else {
            double product[SMALL] = {0.0};
            if (SMALL_SIX(t->size)) subtract_product(product, matrix + t->pivot, 6, 6, SIX, own);
            else subtract_product(product, matrix + t->pivot, t->size, t->size, t->pad, own);
            for (i64 q = 0; q < t->size; q++) own[q] = -product[q];
        }
        for (i64 i = 0; i < t->neighbors; i++) {
            const struct front *a = &f->front[f->position[f->neighbor[t->first + i]]];
            const double *rows = matrix + t->below + f->row[t->first + i] * t->pad;
            if (a->size == 6 && t->size == 6) subtract_product(x + a->unknown, rows, 6, 6, SIX, own);
            else subtract_product(x + a->unknown, rows, a->size, t->size, t->pad, own);
        }
    }
    for (i64 k = f->count - 1; k >= 0; k--) {
        const struct front *t = &f->front[k];
        for (i64 j = 0; j < t->neighbors; j++) {
            const struct front *a = &f->front[f->position[f->neighbor[t->first + j]]];
            const double *right = matrix + t->right + f->column[t->first + j];
            if (a->size == 6 && t->size == 6) subtract_product(x + t->unknown, right, 6, 6, t->width, x + a->unknown);
            else subtract_product(x + t->unknown, right, t->size, a->size, t->width, x + a->unknown);
        }
    }
}
