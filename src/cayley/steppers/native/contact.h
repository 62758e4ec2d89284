/* What the files of contact share: the state of a scene between evaluations, and what is seen of one contact. */
#ifndef CAYLEY_CONTACT_H
#define CAYLEY_CONTACT_H

#include "engine.h"

static const double SWEEP = 0.25;  /* part of a radius: ways in a step that are looked at from place to place */
static const double QUICKER = 1.5; /* growth of a way from step to step that is reckoned with */

enum solid { PLANE, CYLINDER, BOX, TRIANGLE };
enum slot { START, END, INSIDE }; /* of a segment on a solid; with a triangle INSIDE + k is along its edge k */

/* Two partners that are near. What is known of those that do not touch is in the first line of a cache. */
struct touch {
    i64 a;            /* segment */
    i64 b;            /* segment, or segments + solid */
    i64 slot;         /* where on a solid; 0 for segments */
    i64 touching;
    double free;      /* way of all points, see gone in struct scene, up to which it can't touch */
    double stiffness, friction, unit, mass; /* unit: the radius that depths are measured by */
    double slip[3];   /* elongation of the tangential spring */
    double push[3];   /* force on a that is no gradient: of friction and damping */
    double normal[3];
    double depth;
    double allowed;   /* what is left of an overlap at the start */
    double most, most_along; /* of the forces of dampers, across and along, for a way in a step that explicit steps take [N/m] */
};

/* A contact as it is seen. */
struct seen {
    double depth;
    double normal[3]; /* from b to a */
    i64 count_a, count_b;
    i64 point_a[4], point_b[4]; /* points that the two centers are means of, [count_a], [count_b] */
    double weight_a[4], weight_b[4];
    double on_a, on_b; /* where the centers are along their segments, 0 to 1 */
    i64 inside;       /* whether both are between the ends */
    i64 elsewhere;    /* whether a rod touches with another segment instead */
    double gap[3];    /* from the point of b to that of a, centers of segments */
    double distance;  /* its length, with its sign */
    double apart;     /* how far two segments that do not touch are from it, else 0 */
    double arm_a, arm_b; /* from the centers to the contact along the normal */
    double place[3];  /* of the contact */
    double bend;      /* 1/distance from the feature that is touched, and */
    double axis[3];   /* its direction if it is an edge, else zero */
};

/* A grid of cells, see contact_search.c. Items are segments, then solids that are not planes. */
struct entry {
    i64 cell[3];
    i64 item;
};

struct grid {
    double *low, *high; /* boxes, [items][3] */
    i64 items;
    i64 *large;         /* whether an item is in no cell, [items] */
    double cell;        /* size of one */
    struct entry *entry, *unsorted; /* sorted by bucket, and as found, [count], with room for more */
    i64 count, room;
    i64 *start, *next;  /* first entry of each bucket and the next that is free, [buckets + 1] */
    i64 buckets, bucket_room; /* a power of two */
};

/* Rotation of a node since the evaluation before, as a Cayley vector 2 tan(angle/2) axis. */
struct turn {
    double vector[3], share; /* 1/(1 + vector^2/4) */
    i64 places;              /* the places that it is of */
};

struct scene {
    double *point, *old_point, *listed_point; /* [points][3], now, at the evaluation before, at the search */
    double *values, *old_values, *listed_values; /* of nodes, [nodes + 1][rows] */
    double *pose;     /* origin and rotation matrix, [solids][12] */
    struct turn *turn; /* of nodes, as far as they were asked for, [nodes + 1] */
    i64 places;       /* counts how often places were taken */
    double *push;     /* forces and moments on nodes, in space, [nodes + 1][6] */
    struct touch *touch, *before; /* those listed, and at the search before */
    i64 count, room, before_room;
    struct grid grid;
    double *between_point, *between_values, *between_pose; /* as point, values, pose, on the way in a step */
    i64 *crowd;       /* contacts on each node at the evaluation before, [nodes + 1], */
    i64 *crowding;    /* and at this one */
    double unit;      /* the smallest of those listed */
    double margin;
    double stride;    /* largest way of a point since the evaluation before */
    double gone;      /* sum of these */
    double loss;      /* by friction and damping in a step of an implicit rule */
    i64 listed;       /* 1: as explicit rules want it, 2: as implicit ones do */
    struct seen *held; /* where segments come nearest, [stages][count], if that is held while a step is solved */
    i64 held_room, holding;
};

#define DOT(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])
#define CROSS(a, b, c)                                                                                              \
    ((c)[0] = (a)[1] * (b)[2] - (a)[2] * (b)[1], (c)[1] = (a)[2] * (b)[0] - (a)[0] * (b)[2],                        \
     (c)[2] = (a)[0] * (b)[1] - (a)[1] * (b)[0])

static inline void times(const double *m, const double *v, double *out)
{
    for (i64 k = 0; k < 3; k++) out[k] = DOT(m + 3 * k, v);
}

static inline void times_transposed(const double *m, const double *v, double *out)
{
    for (i64 k = 0; k < 3; k++) out[k] = m[k] * v[0] + m[3 + k] * v[1] + m[6 + k] * v[2];
}

static inline double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/* A point between the ends of a segment as a mean of them. */
static inline void stand(const struct contacts *c, i64 segment, double s, i64 *count, i64 *point, double *weight)
{
    *count = 0;
    if (s < 1.0) point[*count] = c->ends[2 * segment], weight[(*count)++] = 1.0 - s;
    if (s > 0.0) point[*count] = c->ends[2 * segment + 1], weight[(*count)++] = s;
}

/* contact_solids.c */
void place_solids(const struct contacts *c, const double *values, double *pose);
i64 look_at_solid(const struct contacts *c, const struct scene *x, const struct touch *t, struct seen *seen);

/* contact_shapes.c */
void rotation_matrix(const double *quaternion, double *matrix);
void closest(const double *a, const double *u, const double *b, const double *v, double *s, double *t);
i64 look(const struct contacts *c, const struct scene *x, const struct touch *t, struct seen *seen);
double hold_meetings(const struct contacts *c, const struct scene *x, struct seen *held);
i64 look_at_held(const struct contacts *c, const struct scene *x, const struct touch *t, const struct seen *held, struct seen *seen);

/* contact_search.c */
i64 segments_may(const struct contacts *c, i64 a, i64 b);
i64 search(struct contacts *c, struct scene *x);
void end_grid(struct grid *g);
double touch_mass(const struct contacts *c, i64 a, i64 b, i64 slot);

/* A node on which a contact acts. */
struct foot {
    i64 node;
    double weight, lever[3]; /* from the node to the contact */
};

/* contact.c: the rest is in engine.h */
double longest(const struct contacts *c, const double *p, const double *q, const double *values, const double *others);
void take(struct contacts *c, struct scene *x, const double *values);
void take_places(const struct contacts *c, struct scene *x);
void keep_places(const struct contacts *c, struct scene *x);
void press_nodes(struct contacts *c, struct scene *x);
void count_crowd(const struct contacts *c, struct scene *x);
void list_near(struct contacts *c, struct scene *x);
i64 swept(struct contacts *c, struct scene *x, double unit);
i64 feet(const struct contacts *c, const struct scene *x, const struct touch *t, const struct seen *seen, double reach,
         struct foot *foot);
void way_of(const struct contacts *c, const struct scene *x, i64 node, const double *lever, double part, double *way,
            double *turned);
void take_contact(struct contacts *c, struct scene *x, struct touch *t, const struct seen *seen, double h);
void part_from(struct contacts *c, struct touch *t);

#endif
