/* What a contact answers: its potential, and friction with damping. */
#ifndef CAYLEY_CONTACT_LAWS_H
#define CAYLEY_CONTACT_LAWS_H

#include <math.h>
#include "contact.h"

/* Part of critical damping of what sticks, so that it comes to rest there. */
static const double STICKING = 0.7;

struct law {
    double energy, force, rate; /* V, V', V'' */
    double grip;                /* rate in parts of the stiffness */
};

static inline void law_of(double stiffness, double soft, double depth, struct law *law)
{
    double d = depth > 0.0 ? depth : 0.0;
    if (d < soft) {
        law->energy = stiffness * d * d * d / (6.0 * soft);
        law->force = 0.5 * stiffness * d * d / soft, law->rate = stiffness * d / soft;
    } else {
        law->energy = stiffness * (0.5 * d * (d - soft) + soft * soft / 6.0);
        law->force = stiffness * (d - 0.5 * soft), law->rate = stiffness;
    }
    law->grip = law->rate / stiffness;
}

/* A spring in the tangential plane goes with the partners as they turn, keeping its length. */
static inline void carry(const double *slip, const double *turned, const double *normal, double *out)
{
    double over[3], size = sqrt(DOT(slip, slip)), left;
    CROSS(turned, slip, over);
    for (i64 k = 0; k < 3; k++) out[k] = slip[k] + over[k];
    double along = DOT(out, normal);
    for (i64 k = 0; k < 3; k++) out[k] -= along * normal[k];
    left = sqrt(DOT(out, out));
    for (i64 k = 0; k < 3; k++) out[k] *= left > 0.0 ? size / left : 0.0;
}

static inline void shorten(double *v, double most)
{
    double size = sqrt(DOT(v, v));
    for (i64 k = 0; k < 3 && size > most; k++) v[k] *= most / size;
}

/* Friction and damping: slip grows by the tangential part of a way in a step h. */
static inline void friction_of(const struct contacts *c, const struct touch *t, const struct law *law,
                               const double *normal, const double *way, double h, double *slip, double *push)
{
    double along = DOT(way, normal), rate = c->damping * law->grip / h;
    double spring = c->shear * t->stiffness, damper = 2.0 * STICKING * law->grip * sqrt(spring * t->mass) / h;
    double across = 2.0 * rate * sqrt(t->stiffness * t->mass), most = t->friction * law->force;
    if (damper > t->most_along) damper = t->most_along;
    if (across > t->most) across = t->most;
    double resist = -across * along;
    if (resist < -law->force) resist = -law->force; /* nothing sticks to each other */
    for (i64 k = 0; k < 3; k++) slip[k] += way[k] - along * normal[k];
    shorten(slip, spring > 0.0 ? most / spring : 0.0);
    for (i64 k = 0; k < 3; k++) push[k] = -spring * slip[k] - damper * (way[k] - along * normal[k]);
    shorten(push, most);
    for (i64 k = 0; k < 3; k++) push[k] += resist * normal[k];
}

#endif
