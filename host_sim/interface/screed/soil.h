/* Soil under your own rover: Screed's deformable soil for any physics engine, as a C library,
   libscreed-soil.

   In every step of your engine: say where each body and its running gear are, take the wrenches
   that the soil answers with and apply them, end the step.

     screed_soil* soil = screed_soil_create(&bed, "gravel", NULL, 0, &error);
     int rover = screed_soil_add_body(soil, patches, 4, &error);
     for (;;) {
       screed_soil_press(soil, rover, &motion, patch_motions, dt, wrenches, &error);
       screed_soil_end_step(soil, &error);
     }

   Units, errors and threads: base.h. */
#ifndef SCREED_SOIL_H
#define SCREED_SOIL_H

#include <screed/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* That of the program: "MAJOR.MINOR.PATCH", and behind a plus the commit that it was built from. */
SCREED_API const char* screed_soil_version(void);

/* ---- a bed ----------------------------------------------------------------------------------- */

typedef struct screed_soil screed_soil;

typedef enum screed_edge {
  SCREED_EDGE_OPEN = 0,    /* heights at the edge go on outwards */
  SCREED_EDGE_WRAPPED = 1, /* the same bed again */
  SCREED_EDGE_WALLED = 2   /* walls hold the soil; what robots feel of them is up to you */
} screed_edge;

/* A square grid of heights, its centre at x = 0, y = 0. Node (0, 0) is the south-west corner; x
   grows to the east. */
typedef struct screed_bed {
  int nodes_x; /* 2..16384 */
  int nodes_y;
  double spacing;        /* of nodes, 1e-6..100 m; 5 to 10 mm for small robots */
  int edge;              /* a screed_edge */
  const double* heights; /* +-127 m, nodes_y rows of nodes_x from the south; null: level at 0 */
} screed_bed;

/* A parameter of the soil or of the model under its key. */
typedef struct screed_setting {
  const char* key;
  double value;
} screed_setting;

/* `preset`: a soil by name. Settings replace single values of it. Keys of the soil are those of
   screed_soil_key(); keys of the model, each 0 or 1: "bulldozing" (material is pushed aside; else
   compacted where it was, 1), "avalanches" (slopes above the angle of repose slide, 1),
   "vertical_stress" (normal stress straight up instead of along the surface, 0). */
SCREED_API screed_soil* screed_soil_create(const screed_bed* bed, const char* preset,
                                           const screed_setting* settings, size_t count,
                                           screed_error* error);
/* Null is allowed. */
SCREED_API void screed_soil_destroy(screed_soil* soil);

/* Names of soils and keys of their parameters, by number from 0 on; null behind the last. */
SCREED_API const char* screed_soil_preset(size_t number);
SCREED_API const char* screed_soil_key(size_t number);
/* The value of a parameter of this soil. */
SCREED_API screed_status screed_soil_parameter(const screed_soil* soil, const char* key,
                                               double* value, screed_error* error);

/* ---- bodies on it ---------------------------------------------------------------------------- */

typedef enum screed_shape {
  SCREED_WHEEL = 0, /* radius, width; its axle along the patch's y */
  SCREED_TRACK = 1, /* radius of its wheels, width, distance of its axles along the patch's x */
  SCREED_BOX = 2,   /* sides along x, y and z */
  SCREED_DISC = 3   /* radius, thickness; its axis along z */
} screed_shape;

/* What a body lays against the soil. */
typedef struct screed_patch {
  int shape;         /* a screed_shape */
  double size[3];    /* m, > 0, as the shape has it; those that it has not are ignored */
  double friction;   /* on soil, tangent of its angle; INFINITY: rough, soil shears on soil */
  double adhesion;   /* of soil to the surface, Pa */
  double lug_height; /* of what holds soil and takes it along, 0..0.1 m */
} screed_patch;

/* A rigid body with its patches; a rover on wheels or tracks is one. Returns its number, from 0. */
SCREED_API int screed_soil_add_body(screed_soil* soil, const screed_patch* patches, size_t count,
                                    screed_error* error);

/* Places are within ten beds of the middle, speeds within 1000 m/s and 10000 rad/s. */
typedef struct screed_body_motion {
  double mass;       /* that its patches carry, kg; INFINITY: the motion is imposed */
  double inertia[9]; /* about the centre of mass, world axes, kg m^2; all zero: the soil does not
                        tilt the body */
  double centre[3];  /* of mass, world */
  double velocity[3];
  double omega[3];
} screed_body_motion;

typedef struct screed_patch_motion {
  double position[3];   /* of its centre, world */
  double axes[9];       /* rotation from the patch's axes to the world's */
  double surface_speed; /* of a rim or belt over its wheels, m/s: positive drives towards the
                           patch's x */
} screed_patch_motion;

/* What the soil does to a patch. */
typedef struct screed_wrench {
  double force[3];      /* world, N; acts at the patch's centre */
  double torque[3];     /* about that centre, world, N m; of a wheel its y part brakes or drives the
                           axle */
  double along_surface; /* force against the motion of rim or belt, N: negative while the soil holds
                           it back */
  double load;          /* vertical part of the normal force, N */
  double sinkage;       /* greatest depth, m */
  double area;          /* touched, seen from above, m^2 */
} screed_wrench;

/* A body in this step, with all its patches in the order of screed_soil_add_body(). Sinking is
   solved at the end of the step (implicitly), so stiff soil needs no short steps: `dt`, 1e-5..0.02
   s, is that of your engine. */
SCREED_API screed_status screed_soil_press(screed_soil* soil, int body,
                                           const screed_body_motion* motion,
                                           const screed_patch_motion* patches, double dt,
                                           screed_wrench* wrenches, screed_error* error);
/* After all bodies of a step: material is laid down beside them, slopes slide. */
SCREED_API screed_status screed_soil_end_step(screed_soil* soil, screed_error* error);

/* ---- its surface ----------------------------------------------------------------------------- */

/* Of the surface between nodes, m; beyond the edge as the edge says. Not a number: failed. */
SCREED_API double screed_soil_height(const screed_soil* soil, double x, double y);
/* Heights of a part of the bed, nodes_y rows of nodes_x from the south, m. */
SCREED_API screed_status screed_soil_heights(const screed_soil* soil, const screed_rectangle* part,
                                             double* heights, screed_error* error);
/* A rectangle that holds all nodes whose height was set since the last call (at first all nodes);
   one of no nodes where none was. */
SCREED_API screed_status screed_soil_changed(screed_soil* soil, screed_rectangle* changed,
                                             screed_error* error);

/* Volumes in whole units, so that they add up: now = before - compacted - in_transit. */
typedef struct screed_volumes {
  int64_t before;
  int64_t now;
  int64_t compacted;
  int64_t in_transit; /* pressed away in the last steps and not yet laid down */
  double unit;        /* m^3 */
} screed_volumes;
SCREED_API screed_status screed_soil_volumes(const screed_soil* soil, screed_volumes* volumes,
                                             screed_error* error);

/* ---- saving ---------------------------------------------------------------------------------- */

/* The whole state between two steps, bodies included: loaded, it goes on with the same bits.
   Returns its size in bytes and writes it where `room` is enough (`state` may be null with a room
   of 0); 0: failed. */
SCREED_API size_t screed_soil_save(const screed_soil* soil, void* state, size_t room,
                                   screed_error* error);
/* Damaged bytes, and those of another version of the state, are refused. */
SCREED_API screed_soil* screed_soil_load(const void* state, size_t size, screed_error* error);

#ifdef __cplusplus
}
#endif

#endif
