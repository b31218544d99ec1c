/* Worlds of robots with their firmware in the loop, in the stand-in: robots on tracks over soil in
   closed form, hundreds of times faster than real time. The firmware is that of the robot; it
   senses, estimates and drives in ticks of 10 ms.

     screed_world* world = screed_world_create(bytes, size, 1, &error);
     for (int second = 0; second < 60; ++second) {
       screed_world_advance(world, 100, NULL, &error);
       screed_world_row(world, 0, SCREED_FRAMES, frame, &error);
     }

   `bytes` are a world that `screed prepare EXPERIMENT --out FILE` has written: the experiment
   without its files, but with the key of its radio. Of a seed it gives the bits of `screed sim
   EXPERIMENT --hal surrogate --seed`; a robot that leaves an open bed goes on. Units, errors and
   threads: base.h. */
#ifndef SCREED_WORLD_H
#define SCREED_WORLD_H

#include <screed/base.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct screed_world screed_world;

SCREED_API screed_world* screed_world_create(const void* prepared, size_t size, uint64_t seed,
                                             screed_error* error);
/* The same as it was made, of another seed; quicker than a new one. */
SCREED_API screed_status screed_world_reset(screed_world* world, uint64_t seed,
                                            screed_error* error);
/* Null is allowed. */
SCREED_API void screed_world_destroy(screed_world* world);

/* Robots in it; their numbers are from 0. 0 for a null pointer. */
SCREED_API int screed_world_robots(const screed_world* world);
/* Ticks that it has lived. */
SCREED_API screed_status screed_world_ticks(const screed_world* world, uint64_t* ticks,
                                            screed_error* error);

/* What a robot is told to do in place of what its firmware would decide. */
typedef enum screed_control {
  SCREED_FIRMWARE = 0, /* nothing: its algorithm decides; the ground station does as the experiment
                          says */
  SCREED_COMMAND = 1,  /* the ground station commands a speed, m/s, and a yaw rate, rad/s, over the
                          radio; needs the algorithm "drive". A robot takes 65,535 commands: 72
                          minutes of new ones each 100 ms */
  SCREED_DUTY = 2 /* its motors get these shares of the battery's voltage, left and right, -1..1,
                     whatever the firmware says */
} screed_control;

typedef struct screed_action {
  int control; /* a screed_control */
  double values[2];
} screed_action;

/* Goes on by so many ticks, 1..1000000. `actions`: one a robot; null: nothing new. */
SCREED_API screed_status screed_world_advance(screed_world* world, int ticks,
                                              const screed_action* actions, screed_error* error);

/* What is known of a robot at a tick, as rows of bytes with columns, the same as in a recorded run.
 */
typedef enum screed_table {
  SCREED_FRAMES = 0,  /* the truth; under est_... and odometry_... what the firmware thinks */
  SCREED_SAMPLES = 1, /* what the firmware has read of its sensors, in their counts */
  SCREED_OUTPUTS = 2, /* what it has answered */
  SCREED_LEVELING = 3 /* how level the bed is; in recorded runs alone */
} screed_table;

typedef enum screed_type {
  SCREED_UINT8 = 0,
  SCREED_INT16 = 1,
  SCREED_UINT16 = 2,
  SCREED_INT32 = 3,
  SCREED_UINT32 = 4,
  SCREED_DOUBLE = 5
} screed_type;

typedef struct screed_column {
  const char* name;
  const char* unit; /* "m/s", "1"; empty: counts, codes, bits */
  const char* meaning;
  int type;   /* a screed_type */
  int count;  /* of elements; 0: a single one */
  int offset; /* of its first byte in a row; rows have no gaps, numbers the order of this machine */
} screed_column;

/* Bytes of a row, and columns by number, from 0. Of a table that there is not, and behind the last
 * column: 0. */
SCREED_API size_t screed_table_row(int table);
SCREED_API int screed_table_column(int table, int number, screed_column* column);
/* A robot's row of the newest tick. Before the first tick it fails. */
SCREED_API screed_status screed_world_row(const screed_world* world, int robot, int table,
                                          void* row, screed_error* error);

/* How level the ground is (docs/leveling-metrics.md). Transport takes some 20 ms. */
typedef struct screed_level {
  double level_deviation;   /* U, m */
  double relief;            /* R, m */
  double roughness;         /* Q, m */
  double transport;         /* W1, m^3 m; not a number where not asked for */
  double transport_squared; /* the square of W2, m^3 m^2 */
} screed_level;
SCREED_API screed_status screed_world_level(const screed_world* world, int with_transport,
                                            screed_level* level, screed_error* error);

/* The bed: how many nodes it has, from (0, 0), and their spacing, m; its heights as those of
   soil.h. */
SCREED_API screed_status screed_world_bed(const screed_world* world, screed_rectangle* nodes,
                                          double* spacing, screed_error* error);
SCREED_API screed_status screed_world_heights(const screed_world* world,
                                              const screed_rectangle* part, double* heights,
                                              screed_error* error);

#ifdef __cplusplus
}
#endif

#endif
