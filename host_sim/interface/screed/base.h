/* What the C interfaces of Screed have in common.

   Units are SI, angles in radians, the world's z is up; matrices are row by row. Nothing is thrown
   or printed. Functions that can fail return a screed_status, or a null pointer, -1 or 0 in place
   of what they make, and say why in `error`, which may be null. Arguments that are not allowed
   change nothing. The libraries keep no state of their own: handles on several threads do not know
   of each other. One handle is for one thread at a time; a call that comes while another is at work
   fails with SCREED_BUSY, and destroying does nothing then. Same calls, same bits, on every
   processor. */
#ifndef SCREED_BASE_H
#define SCREED_BASE_H

#include <stddef.h>
#include <stdint.h>

#define SCREED_API __attribute__((visibility("default")))

typedef enum screed_status {
  SCREED_OK = 0,
  SCREED_BAD_INPUT = 1, /* an argument is not allowed: the text says which and what is */
  SCREED_BUSY = 2,      /* the handle is in use on another thread */
  SCREED_NO_MEMORY = 3,
  SCREED_FAILED = 4
} screed_status;

typedef struct screed_error {
  int status;     /* a screed_status */
  char text[252]; /* one line, ends with 0; empty after success */
} screed_error;

/* Nodes from (x, y) on, so many to the east and to the north. */
typedef struct screed_rectangle {
  int x;
  int y;
  int nodes_x;
  int nodes_y;
} screed_rectangle;

#endif
