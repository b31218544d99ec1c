/* Experiments, runs, their sessions, and many worlds at once: what the program does, for other
   programs; libscreed, which holds all of libscreed-core and libscreed-soil as well.

   `sets` are keys of an experiment in place of its own, "section.key=value". Units, errors and
   threads: base.h. */
#ifndef SCREED_RUN_H
#define SCREED_RUN_H

#include <screed/world.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the library has made, for screed_free(). Texts end with a 0, which does not count. */
typedef struct screed_bytes {
  char* data;
  size_t size;
} screed_bytes;
/* Leaves no bytes; may be called again. */
SCREED_API void screed_free(screed_bytes* bytes);

/* ---- experiments ----------------------------------------------------------------------------- */

/* The world of an experiment in the stand-in, for screed_world_create(). */
SCREED_API screed_status screed_prepare(const char* experiment, const char* const* sets,
                                        size_t count, screed_bytes* prepared, screed_error* error);

/* As `screed sim EXPERIMENT --hal HAL --out FOLDER --no-pictures`: hal "native" or "surrogate";
   folder null: a numbered one. `summary`: what --json prints. */
SCREED_API screed_status screed_sim(const char* experiment, const char* const* sets, size_t count,
                                    const char* hal, const char* folder, screed_bytes* summary,
                                    screed_error* error);

/* ---- sessions -------------------------------------------------------------------------------- */

/* A recorded run; of several robots one. */
typedef struct screed_session screed_session;
SCREED_API screed_session* screed_session_open(const char* run, int robot, screed_error* error);
/* Null is allowed. */
SCREED_API void screed_session_close(screed_session* session);

/* JSON: experiment (its text), seed, board, program, complete, content_hash. */
SCREED_API screed_status screed_session_info(const screed_session* session, screed_bytes* info,
                                             screed_error* error);
/* Rows of a table; -1: failed. Beside those of world.h there is SCREED_LEVELING. */
SCREED_API int64_t screed_session_rows(const screed_session* session, int table,
                                       screed_error* error);
/* Rows first, first + 1, ... */
SCREED_API screed_status screed_session_read(const screed_session* session, int table,
                                             int64_t first, int64_t count, void* rows,
                                             screed_error* error);
/* The ground before the run (0) or after it (1): `nodes` and `spacing` say how it lies, `heights`,
   m, row by row from the south, may be null. */
SCREED_API screed_status screed_session_ground(const screed_session* session, int after,
                                               screed_rectangle* nodes, double* spacing,
                                               double* heights, screed_error* error);

/* ---- many worlds ----------------------------------------------------------------------------- */

/* Worlds of one prepared world, each with a seed, advanced by several threads. Where one of them
   fails the others go on; it can be reset. */
typedef struct screed_worlds screed_worlds;
/* count: 1..65536; threads: 1..256. */
SCREED_API screed_worlds* screed_worlds_create(const void* prepared, size_t size,
                                               const uint64_t* seeds, size_t count, int threads,
                                               screed_error* error);
/* Null is allowed. */
SCREED_API void screed_worlds_destroy(screed_worlds* worlds);
/* Robots in each of them; 0 for a null pointer. */
SCREED_API int screed_worlds_robots(const screed_worlds* worlds);
/* Those whose byte in `which` is not 0, with their seeds among `seeds` (one for each world); then
   they live so many ticks, 0..1000000, before the others go on. */
SCREED_API screed_status screed_worlds_reset(screed_worlds* worlds, const uint8_t* which,
                                             const uint64_t* seeds, int ticks, screed_error* error);
/* All by so many ticks, 1..1000000; actions: of each robot of each world; null: nothing new. */
SCREED_API screed_status screed_worlds_advance(screed_worlds* worlds, int ticks,
                                               const screed_action* actions, screed_error* error);
/* Rows of all robots of all worlds; of worlds that have not lived a tick they are 0. */
SCREED_API screed_status screed_worlds_rows(screed_worlds* worlds, int table, void* rows,
                                            screed_error* error);
/* How level each world is. */
SCREED_API screed_status screed_worlds_level(screed_worlds* worlds, int with_transport,
                                             screed_level* levels, screed_error* error);

#ifdef __cplusplus
}
#endif

#endif
