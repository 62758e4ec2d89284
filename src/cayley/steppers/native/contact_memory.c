/* Contacts between calls: how they begin and end, what is remembered of them, and a view of all. */
#include <stdlib.h>
#include <string.h>
#include "contact.h"
#include "contact_laws.h"

enum { HEAD = 2, RECORD = 14, TOLD = 7 }; /* numbers in front, of each contact, and told of all */

/* Write down what is told at a frame, without what depends on where calls end, candidates and searches, and forces. */
void tell_contacts(struct contacts *c, i64 frame, double *told, double *force)
{
    i64 size = c->nodes * c->dofs;
    double *out = told + TOLD * frame;
    memcpy(out, c->told, TOLD * sizeof(double));
    out[4] = out[5] = c->told[6] = 0.0;
    memcpy(force + frame * size, c->force, (size_t)size * sizeof(double));
}

/* Put contacts that touch into memory; returns whether there is room. */
i64 remember_contacts(struct contacts *c, i64 state)
{
    struct scene *x = (struct scene *)state;
    i64 count = 0;
    for (i64 n = 0; n < x->count; n++) {
        const struct touch *t = x->touch + n;
        if (!t->touching) continue;
        if (count == c->capacity) return 0;
        double *out = c->memory + HEAD + RECORD * count++;
        out[0] = (double)t->a, out[1] = (double)t->b, out[2] = (double)t->slot;
        memcpy(out + 3, t->slip, sizeof t->slip);
        memcpy(out + 6, t->push, sizeof t->push);
        memcpy(out + 9, t->normal, sizeof t->normal);
        out[12] = t->allowed, out[13] = t->depth;
    }
    memset(c->memory + HEAD + RECORD * count, 0, (size_t)(RECORD * (c->capacity - count)) * sizeof(double));
    c->memory[0] = (double)count, c->memory[1] = x->stride;
    return 1;
}

static void recall(struct contacts *c, struct scene *x)
{
    i64 k = 0, count = (i64)c->memory[0];
    for (i64 n = 0; n < x->count && k < count; n++) {
        const double *in = c->memory + HEAD + RECORD * k;
        struct touch *t = x->touch + n;
        if (t->a != (i64)in[0] || t->b != (i64)in[1] || t->slot != (i64)in[2]) continue;
        t->touching = 1;
        memcpy(t->slip, in + 3, sizeof t->slip);
        memcpy(t->push, in + 6, sizeof t->push);
        memcpy(t->normal, in + 9, sizeof t->normal);
        t->allowed = in[12], t->depth = in[13];
        k++;
    }
}

/* Overlaps at the start are let be, and go away bit by bit. */
static void allow(struct contacts *c, struct scene *x)
{
    struct seen seen;
    for (i64 n = 0; n < x->count; n++)
        if (look(c, x, x->touch + n, &seen) && seen.depth > 0.0) x->touch[n].allowed = seen.depth;
}

/* Begin at values; with a memory of contacts forces are those that ``force`` has. Returns the state. */
i64 begin_contacts(struct contacts *c, const double *values, i64 recalled)
{
    struct scene *x = calloc(1, sizeof *x);
    size_t points = (size_t)(3 * c->points + 1) * sizeof(double), all = (size_t)((c->nodes + 1) * c->rows) * sizeof(double);
    x->point = malloc(points), x->old_point = malloc(points), x->listed_point = malloc(points);
    x->values = malloc(all), x->old_values = malloc(all), x->listed_values = malloc(all);
    x->pose = malloc((size_t)(12 * c->solids + 1) * sizeof(double));
    x->between_point = malloc(points), x->between_values = malloc(all);
    x->between_pose = malloc((size_t)(12 * c->solids + 1) * sizeof(double));
    x->crowd = calloc((size_t)(c->nodes + 1), sizeof *x->crowd);
    x->crowding = calloc((size_t)(c->nodes + 1), sizeof *x->crowding);
    x->turn = calloc((size_t)(c->nodes + 1), sizeof *x->turn);
    x->push = calloc((size_t)(6 * (c->nodes + 1)), sizeof *x->push);
    x->margin = c->clearance;
    take(c, x, values);
    list_near(c, x);
    keep_places(c, x);
    if (recalled) recall(c, x), count_crowd(c, x), x->stride = c->memory[1];
    else {
        if (c->relax > 0.0) allow(c, x);
        touch_all(c, (i64)x, values, 1.0);
    }
    return (i64)x;
}

void end_contacts(i64 state)
{
    struct scene *x = (struct scene *)state;
    free(x->point), free(x->old_point), free(x->listed_point);
    free(x->values), free(x->old_values), free(x->listed_values);
    free(x->between_point), free(x->between_values), free(x->between_pose);
    end_grid(&x->grid);
    free(x->pose), free(x->touch), free(x->before), free(x->held), free(x->crowd), free(x->crowding), free(x->turn), free(x->push), free(x);
}

/* Write all contacts at values: a, b, slot, depth, its unit, normal, place, force along the normal, [most][12]. */
i64 view_contacts(struct contacts *c, const double *values, i64 most, double *out)
{
    i64 count = 0, state = begin_contacts(c, values, 1);
    struct scene *x = (struct scene *)state;
    struct seen seen;
    struct law law;
    for (i64 n = 0; n < x->count; n++) {
        const struct touch *t = x->touch + n;
        if (!look(c, x, t, &seen) || seen.depth <= 0.0) continue;
        if (count < most) {
            double *row = out + 12 * count;
            law_of(t->stiffness, c->soft * t->unit, seen.depth, &law);
            row[0] = (double)t->a, row[1] = (double)t->b, row[2] = (double)t->slot, row[3] = seen.depth, row[4] = t->unit;
            memcpy(row + 5, seen.normal, sizeof seen.normal);
            memcpy(row + 8, seen.place, sizeof seen.place);
            row[11] = law.force;
        }
        count++;
    }
    end_contacts(state);
    return count;
}
