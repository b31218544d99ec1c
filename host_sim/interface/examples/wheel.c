/* A wheel in a single-wheel testbed, without any engine: it rolls at a constant speed and slip and
   is free up and down. Prints its sinkage and pull, means over the second half of the way, as
   `screed soil wheel` finds them.

     cc wheel.c $(pkg-config --cflags --libs screed-soil) -lm && ./a.out 0 0.2 0.4 */
#include <math.h>
#include <screed/soil.h>
#include <stdio.h>
#include <stdlib.h>

static const double kRadius = 0.03, kWidth = 0.025; /* m */
static const double kLoad = 3.0, kMass = 0.05;      /* N; kg that go up and down with it */
static const double kSpeed = 0.05, kDuration = 6.0; /* m/s, s */
static const double kStep = 1e-3, kCell = 0.005;    /* s, m */
static const double kOffset = 0.0007,
                    kMargin = 0.03; /* of the track across the grid, of soil round it, m */

static void stop(const screed_error* error) {
  fprintf(stderr, "wheel: %s\n", error->text);
  exit(2);
}

/* An odd number, so that a node is in the middle. */
static int nodes_over(double extent) {
  return 2 * (int)ceil(0.5 * extent / kCell) + 3;
}

static void roll(double slip) {
  screed_error error;
  const screed_bed bed = {nodes_over(kSpeed * kDuration + 2.0 * (kRadius + kMargin)),
                          nodes_over(kWidth + 2.0 * (kMargin + kOffset)), kCell, SCREED_EDGE_OPEN,
                          NULL};
  /* Nothing moves but what is pressed down, as in the formulas that such tests are compared with.
   */
  const screed_setting settings[] = {{"bulldozing", 0}, {"avalanches", 0}};
  const screed_patch wheel = {SCREED_WHEEL, {kRadius, kWidth, 0.0}, INFINITY, 0.0, 0.0};
  const int steps = (int)lround(kDuration / kStep);
  screed_body_motion body = {0};
  screed_patch_motion patch = {{0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, 0.0};
  double along = -0.5 * kSpeed * kDuration, height = kRadius + 1e-4, rising = 0.0;
  double sinkage = 0.0, pull = 0.0;
  int counted = 0;

  screed_soil* soil = screed_soil_create(&bed, "viper", settings, 2, &error);
  const int number = soil == NULL ? -1 : screed_soil_add_body(soil, &wheel, 1, &error);
  if (number < 0) stop(&error);
  body.mass = kMass;
  patch.surface_speed = kSpeed / (1.0 - slip);
  for (int i = 0; i < steps; ++i) {
    screed_wrench wrench;
    body.centre[0] = patch.position[0] = along;
    body.centre[1] = patch.position[1] = kOffset;
    body.centre[2] = patch.position[2] = height;
    body.velocity[0] = kSpeed;
    body.velocity[2] = rising;
    if (screed_soil_press(soil, number, &body, &patch, kStep, &wrench, &error) != SCREED_OK ||
        screed_soil_end_step(soil, &error) != SCREED_OK) {
      stop(&error);
    }
    if (2 * i >= steps) {
      ++counted;
      sinkage += kRadius - height;
      pull += wrench.force[0];
    }
    rising += kStep * (wrench.force[2] - kLoad) / kMass;
    height += kStep * rising;
    along += kStep * kSpeed;
  }
  printf("slip %g: sinkage_mm %.17g, drawbar_pull_n %.17g\n", slip, 1e3 * (sinkage / counted),
         pull / counted);
  screed_soil_destroy(soil);
}

int main(int count, char** words) {
  for (int i = 1; i < count; ++i) roll(atof(words[i]));
  return 0;
}
