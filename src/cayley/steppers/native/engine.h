/* The implicit stepper: one step is a system of nonlinear equations in the control nodes of all nodes, solved by Newton's
 * method with a block-sparse LU. Everything is double precision; a vec holds LANES cells side by side.
 *
 * Structs that Python fills have one field a line: native/__init__.py reads this file.
 */
#ifndef CAYLEY_ENGINE_H
#define CAYLEY_ENGINE_H

#include <stdint.h>

typedef int64_t i64;
typedef double vec __attribute__((vector_size(8 * LANES)));

/* Compiled kernels, see codegen/llvm.py: run(data, uniforms, first block, last block) and setup(uniforms). */
typedef i64 (*kernel)(double *, double *, i64, i64);
typedef void (*prepare)(double *);

enum outcome { FINISHED, NOT_CONVERGED, NOT_FINITE, REDUNDANT, TENSE, FAST, DEEP };

/* A part of the action (or a force density) that is evaluated at quadrature points of cells, LANES cells at a time.
 *
 * The kernel sees u = (sum of phi q, sum of psi q) over the nodes of a cell, and du/dt where it wants rates, and returns
 * gradient and Hessian there; see terms.c for their contraction. Of a force it returns force and Jacobian instead. */
struct term {
    i64 run;             /* kernel with second derivatives */
    i64 setup;
    i64 light_run;       /* the same without them */
    i64 light_setup;
    double *uniforms;    /* [stages][uniform_width], the first of them the time */
    i64 uniform_width;
    double *light_uniforms;
    i64 light_width;
    double *data;        /* scratch, [stages][gauss][rows][LANES] */
    i64 rows;            /* rows of a block of the kernel */
    i64 light_rows;      /* rows of a block of the light kernel */
    i64 constant_row;    /* where constants begin */
    i64 constants;
    double *constant;    /* [blocks][gauss][constants][LANES] */
    i64 cells;
    i64 width;           /* nodes of a cell */
    i64 gauss;           /* points of a cell */
    i64 slots;           /* 1: u = sum phi q; 2: and sum psi q */
    i64 rates;           /* whether the kernel sees du/dt */
    i64 rated;           /* whether it returns derivatives along du/dt, too */
    i64 gradient;        /* row of the gradient */
    i64 *starts;         /* first entry of each part of the Hessian, [outputs][inputs] and the end; parts are slots */
    i64 *entries;        /* (place in the part, row) of entries that are not always zero, [][2] */
    i64 *nodes;          /* [blocks * LANES][width] */
    double *phi;         /* [gauss][width] */
    double *psi;         /* [gauss][width] */
    double *inverse;     /* factor of psi, [blocks][LANES] */
    double *weight;      /* [blocks][gauss][LANES], 0 where there is no cell */
    i64 *places;         /* (offset, stride) of the block of every pair of nodes, [cells][width][width][2] */
    i64 *held;           /* whether a cell of the block has a held component, [blocks] */
    i64 force;           /* whether it is a force: its work is summed */
    i64 account;         /* row of the power of its work and of its loss, or -1: all of it is loss */
    double *work;        /* work and loss of the last evaluation, [2] */
};

/* Constraints g(u) = 0 at points of cells, at every control time but the first, with multipliers. */
struct coupling {
    i64 run;
    i64 setup;
    i64 light_run;
    i64 light_setup;
    double *uniforms;    /* [controls][uniform_width] */
    i64 uniform_width;
    double *light_uniforms;
    i64 light_width;
    double *data;        /* scratch, [controls][gauss][rows][LANES] */
    i64 rows;
    i64 light_rows;
    i64 constant_row;
    i64 constants;
    double *constant;    /* [blocks][gauss][constants][LANES] */
    i64 drives;          /* how many of the constants, the last ones, may change with time */
    i64 *driver;         /* which driven cell it is, or -1, [blocks * LANES] */
    i64 driven;          /* number of driven cells */
    double *drive;       /* [steps][controls][driven][drives] */
    double *drive_rate;  /* their rates, as drive */
    double *slopes;      /* left-trivialized derivatives at the first control, [blocks][gauss * count][width][dofs][LANES] */
    i64 multiplier_row;  /* where multipliers stand */
    i64 count;           /* constraints of a point */
    i64 alternating;     /* whether its forces can make alternating rotations unstable (see overstrained) */
    i64 value;           /* row of g */
    i64 gradient;        /* row of its derivatives, by rows */
    i64 *starts;         /* of the Hessian of lambda g, see struct term */
    i64 *entries;
    i64 cells;
    i64 width;
    i64 gauss;
    i64 slots;
    i64 *nodes;          /* [blocks * LANES][width] */
    double *phi;
    double *psi;
    double *inverse;
    double *weight;      /* [blocks][gauss][LANES] */
    i64 *places;         /* pairs of nodes, [cells][width][width][2] */
    i64 *across;         /* rows of a node, columns of the multipliers, [cells][width][2] */
    i64 *along;          /* rows of the constraints, columns of a node, [cells][width][2] */
    i64 *inside;         /* whether a node is eliminated with the multipliers, [cells][width] */
    i64 *spot;           /* first unknown of a cell's multipliers, [cells] */
    double *multiplier;  /* [cells][r][gauss * count] */
    double *start;       /* their values at the start of a try */
    double *kept;        /* their values at the last accepted correction */
};

/* What touches: segments with a radius (elements of rods, capsules, spheres, edges of boxes) and solids.
 *
 * A segment runs between two points, each fixed to a node or the ground. Solids are fixed to one. See contact.c. */
struct contacts {
    i64 nodes;           /* the ground stands behind them */
    i64 rows;            /* values of a node */
    i64 dofs;
    i64 place_row;       /* row of its position, */
    i64 turn_row;        /* of its rotation, */
    i64 place_dof;       /* and their degrees of freedom */
    i64 turn_dof;
    i64 points;
    i64 *node;           /* node of a point, [points] */
    double *offset;      /* of a point from its node, in its body frame, [points][3] */
    double *inverse;     /* inverse of the mass that answers there [1/kg], [points] */
    i64 segments;
    i64 *ends;           /* points, [segments][2] */
    i64 *beyond;         /* the points before and behind them in a rod, or -1, [segments][2] */
    double *radius;      /* [segments] */
    double *length;      /* at rest, [segments] */
    i64 *owner;          /* the rod or shape it is of, [segments] */
    i64 *along;          /* its number along that, [segments] */
    i64 *reach;          /* segments of one owner nearer than this do not touch; 0: none do, [segments] */
    i64 *round;          /* 0: an edge, which touches solids alone, [segments] */
    i64 *tail;           /* whether its second end touches solids itself, or the next segment's first does, [segments] */
    i64 solids;
    i64 *kind;           /* enum solid, [solids] */
    i64 *carrier;        /* node, [solids] */
    i64 *possessor;      /* the shape it is of, [solids] */
    double *frame;       /* position and rotation in the body frame of the node, [solids][7] */
    double *size;        /* see contact.c, [solids][18] */
    double *bound;       /* largest distance from the node, [solids] */
    double *yield;       /* inverse of the mass that answers, [solids] */
    i64 owners;
    double *rough;       /* coefficient of friction, [owners] */
    i64 *together;       /* owners with the same number do not touch each other, [owners] */
    i64 apart_count;
    i64 *apart;          /* pairs of owners that do not touch, a owners + b with a < b, in rising order */
    i64 tied_count;
    i64 *tied;           /* pairs of segments, or of segments and solids behind them, that do not touch, as apart */
    double per_mass;     /* stiffness for a unit of mass [1/s^2], but at least */
    double least;        /* so much [N/m] */
    double soft;         /* part of a radius in which stiffness sets in */
    double deepest;      /* depth at which an explicit step ends the run, in radii */
    double shear;        /* tangential stiffness for a unit of the normal one */
    double damping;      /* part of critical damping */
    double relax;        /* part of overlaps at the start that is left after a step; 0: there are none */
    double clearance;    /* of what the search lists at first [m] */
    i64 state;           /* address of what is kept between evaluations */
    double *force;       /* on the nodes, left-trivialized, [nodes + 1][dofs] */
    double *told;        /* energy; loss; deepest now, in radii; contacts; candidates; searches; deepest since the last frame, [7] */
    i64 *blame;          /* number of segment and of partner (solids behind segments) of the deepest or the failure, [2] */
    i64 capacity;        /* contacts that memory has room for */
    double *memory;      /* contacts of the last evaluation, [2 + capacity * 14] */
};

struct problem {
    i64 nodes;           /* one more, the ground, stands behind them */
    i64 rows;            /* values of a node */
    i64 dofs;            /* degrees of freedom of a node */
    i64 fields;
    i64 *field;          /* (is rotation, row, dof, size), [fields][4] */
    i64 stages;          /* r: control times are 0 ... r */
    i64 still;           /* 1: an equilibrium, see statics.c; else 0 */
    i64 order;           /* of the matrix of an equilibrium: derivatives along values 0, rates 1, or accelerations 2 */
    double *penalty;     /* stiffness of a kind of degree of freedom that constraints are given, [dofs]; or null */
    double *spin;        /* rates of a still node, dq/dt = spin q, [rows][rows]; or null */
    double *ell;         /* values at the stages, [stages][r + 1] */
    double *dell;        /* slopes, per step */
    double *weights;     /* [stages] */
    double *at;          /* [stages] */
    double *ends;        /* positions of the control times, [r + 1] */
    double *onward;      /* the polynomial of the step before, continued, [r + 1][r + 1] */
    double *control;     /* [r + 1][nodes + 1][rows] */
    double *memory;      /* control nodes of the step before, without its last, [r][nodes + 1][rows] */
    double *accepted;    /* room, [r + 1][nodes + 1][rows] */
    double *reached;     /* room, [r + 1][nodes + 1][rows] */
    double *momenta;     /* [nodes + 1][dofs] */
    double *velocity;    /* room, [nodes + 1][dofs] */
    double *after;       /* those at the end of the step, [nodes + 1][dofs] */
    double *residual;    /* D_i L_d, [nodes + 1][r][dofs] */
    double *free;        /* 1, or 0 where held, [nodes + 1][dofs] */
    i64 *place;          /* first unknown of a node, [nodes] */
    i64 *diagonal;       /* where the diagonal entry of every unknown stands in the matrix, [unknowns] */
    double tangent_cost; /* of an evaluation with tangent and factorization, in those of one without */
    double extent;       /* what a correction of positions is measured by, its inverse [1/m] */
    struct term *term;
    i64 terms;
    i64 inertia;         /* the first so many terms are those of inertia */
    struct coupling *coupling;
    i64 couplings;
    struct contacts *contacts; /* or null */
    i64 *contact_nodes;  /* of every candidate, see contact_implicit.c, [candidates][8] */
    i64 *contact_places; /* (offset, stride) of the block of every pair of them, [candidates][8][8][2] */
    i64 renew;           /* called where the candidates changed: i64 (*)(void), 0 if all went well */
    i64 fronts;          /* address of the elimination plan */
    double *matrix;
    i64 matrix_size;
    i64 *pivots;
    double *watch;       /* what rows of multipliers are at least, G D^-1 G' with the diagonal D of nodes eliminated before,
                            and with them; 0 for others, [unknowns][2]; or null */
    double *unknown;     /* right-hand side, then correction */
    double *taken;       /* the last accepted correction */
    double *mass;        /* mass matrices, [nodes + 1][dofs][dofs padded to whole vectors] */
    double *bias;        /* momenta of nodes at rest, by terms linear in velocities: mu = M v + b, [nodes + 1][dofs] */
    i64 unknowns;
    double *cells;       /* room of a block of cells */
    double *table;       /* loads at the stages, [steps][stages][columns] */
    i64 columns;
    i64 *entries;        /* (node, row, row of rotation, form, column, is moment, dof), [entry_count][7] */
    double *scales;      /* factor and lever of each, [entry_count][4] */
    i64 entry_count;
    double origin;
    double h;
    double first;        /* number of steps before the first */
    i64 warm;            /* whether memory holds a step */
    i64 stride;
    i64 saves;
    double *frames;      /* [saves][nodes][rows + dofs] */
    double *motion;      /* v h of the last three steps, the latest first, [3][nodes + 1][dofs]; or null */
    double *rates;       /* v at the frames that these say, NaN before the third step, [saves][nodes][dofs] */
    double *works;       /* work and loss at the frames, [saves][2] */
    double *contact_told; /* told of the contacts at the frames, [saves][7] */
    double *contact_force; /* and their forces, [saves][nodes][dofs] */
    i64 *counts;         /* iterations in all, most in a step, number and node of the last step */
    double *history;     /* (relative correction, residual) of the last iterations, [history_size][2] */
    i64 history_size;
    double *energy;      /* work of loads in a step; work and loss since the start, [3] */
};

/* The blocks of one density in a run of a rule with corners in time, and its kernels. */
struct explicit_group {
    i64 kick;            /* kernel: adds h times the forces to the momenta */
    i64 kick_setup;
    i64 drift;           /* kernel: from momenta to the values and momenta of the next time */
    i64 drift_setup;
    i64 predict;         /* kernel: velocities for forces that depend on them, or 0 (then it is 0 in all groups) */
    i64 predict_setup;
    double *uniforms;    /* [3][width], h and the two times first */
    i64 width;
    double *data;        /* [blocks + 2][rows][LANES] */
    i64 blocks;
    i64 rows;
    i64 kept;            /* rows of a frame */
    i64 *spans;          /* (first block, last block, whether constraints know it), [span_count][3] */
    i64 span_count;
    double *saved;       /* room, as data */
    i64 *fixed;          /* (block, row, lane) of momenta that stay zero, [fixed_count][3] */
    i64 fixed_count;
    double *frames;      /* [saves][blocks][kept][LANES] */
};

/* A run of a rule with corners in time and constraints; the problem holds the nodes that constraints know, with r = 1. */
struct explicit_run {
    struct problem *problem;
    struct contacts *contacts; /* or null */
    i64 *contact_slot;   /* as slot, behind it the row that forces are added to, [contacts->nodes][7] */
    double *contact_values; /* room, [contacts->nodes + 1][rows], the ground's behind them */
    double *contact_told; /* told of the contacts at the frames, [saves][7] */
    double *contact_force; /* and their forces, [saves][contacts->nodes][dofs] */
    struct explicit_group *group;
    i64 groups;
    i64 *slot;           /* (group, block, lane, first row of its values, of its momenta, of v* or -1), [nodes][6] */
    double *given;       /* momenta after the kick, [nodes + 1][dofs] */
    double *before;      /* those before, [nodes + 1][dofs] */
    double *table;       /* loads at the times, [steps + 1][columns] */
    i64 columns;
    i64 *entries;        /* (group, block, lane, row, row of rotation, form, column), [entry_count][7] */
    double *scales;      /* factor and lever of each, [entry_count][4] */
    i64 entry_count;
};

/* What the library was compiled from, see native/fingerprint.py. */
const char *sources(void);

/* blocks.c */
i64 order_blocks(i64 count, const i64 *size, const i64 *start, const i64 *neighbor, const i64 *after_start,
                 const i64 *after);
void release_blocks(i64 fronts);
i64 matrix_size(i64 fronts);
void unknown_starts(i64 fronts, i64 *start);
void locate(i64 fronts, i64 count, const i64 *row, const i64 *column, i64 *found);
i64 factorize(i64 fronts, double *matrix, i64 *pivots, const double *watch);
i64 negatives(i64 fronts, double *matrix, i64 *pivots, i64 *negative);
void solve(i64 fronts, const double *matrix, const i64 *pivots, double *x);
i64 factorize_dense(double *a, i64 n, i64 stride, i64 *pivots, const double *watch);
void solve_dense(const double *a, i64 n, i64 stride, const i64 *pivots, double *x);

/* controls.c */
void normalize(struct problem *p);
void hold(struct problem *p);
void move(struct problem *p, const double *x, double part);
void stretch(struct problem *p, double factor);
void extrapolate(struct problem *p);
double measure(struct problem *p, const double *x, double *turn, i64 *worst);
void hand_on(struct problem *p);
void note_motion(struct problem *p);
void write_rates(struct problem *p, i64 steps, double *out);
void push_turn(const double *z, const double *moment, double *out);
void trivialize(struct problem *p, const double *gradient, const double *point, double *out);

/* terms.c */
void add_terms(struct problem *p, double begin, double h, i64 tangent);
void mass_matrices(struct problem *p, double time, double *mass); /* and the bias */
void add_loads(struct problem *p, i64 number, double h);
void add_ties(struct problem *p, i64 rates, const double *velocity, double part, double *out);

/* newton.c */
void assemble(struct problem *p, i64 number, double begin, double h, i64 tangent);

/* statics.c */
void add_still_loads(struct problem *p, i64 tangent);
void add_inertia(struct problem *p, double time, double factor);

/* couplings.c */
void add_couplings(struct problem *p, i64 number, double begin, double h, i64 tangent);
double violations(struct problem *p, i64 number, i64 i, double time);
i64 saddle_point(struct problem *p, i64 number, i64 i, double time);
void push_multipliers(struct problem *p, double h, double *out);
void velocities(struct problem *p, i64 number, i64 i, double h, const double *momenta, double *out);
double drive_work(struct problem *p, i64 number, double h);
double projection_work(struct problem *p);
void multiply_mass(struct problem *p, const double *v, double *out);
i64 project(struct problem *p, i64 number, i64 i, double time, double h);
i64 overstrained(struct problem *p, double time, double h);

/* contact.c */
i64 begin_contacts(struct contacts *c, const double *values, i64 recalled);
i64 touch_all(struct contacts *c, i64 state, const double *values, double h);
void tell_contacts(struct contacts *c, i64 frame, double *told, double *force);
i64 remember_contacts(struct contacts *c, i64 state);
i64 view_contacts(struct contacts *c, const double *values, i64 most, double *out);
void end_contacts(i64 state);

/* contact_implicit.c */
void add_contacts(struct problem *p, double h, i64 tangent);
double hold_contacts(struct problem *p);
void release_contacts(struct problem *p);
i64 list_contacts(struct problem *p, i64 again);
void contact_nodes(struct contacts *c, i64 *out);
i64 contact_count(const struct contacts *c);
i64 outran(struct problem *p);
i64 accept_contacts(struct problem *p, double h);

#endif
