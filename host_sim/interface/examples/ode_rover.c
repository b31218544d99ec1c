/* A rover on four driven wheels crosses a bed of gravel: Open Dynamics Engine moves its bodies, the
   soil holds them.

     cc ode_rover.c $(pkg-config --cflags --libs ode screed-soil) -lm && ./a.out */
#include <math.h>
#include <ode/ode.h>
#include <screed/soil.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kWheels = 4, kBodies = kWheels + 1 }; /* the chassis is the last */

static const double kStep = 0.002;                 /* s */
static const double kRadius = 0.04, kWidth = 0.03; /* of a wheel, m */
static const double kSpin = 4.0, kStrongest = 0.4; /* rad/s; N m of its motor */
static const double kPlace[kWheels][2] = {{0.1, 0.1}, {0.1, -0.1}, {-0.1, 0.1}, {-0.1, -0.1}};

typedef struct {
  dWorldID world;
  dBodyID body[kBodies];
  dJointID axle[kWheels];
} rover;

static void stop(const screed_error* error) {
  fprintf(stderr, "ode_rover: %s\n", error->text);
  exit(2);
}

static rover make_rover(double x, double z) {
  rover it;
  dMass mass;
  it.world = dWorldCreate();
  dWorldSetGravity(it.world, 0, 0, -9.81);
  for (int i = 0; i < kBodies; ++i) it.body[i] = dBodyCreate(it.world);
  dMassSetBoxTotal(&mass, 1.5, 0.25, 0.15, 0.06);
  dBodySetMass(it.body[kWheels], &mass);
  dBodySetPosition(it.body[kWheels], x, 0, z + 0.02);
  for (int i = 0; i < kWheels; ++i) {
    dMassSetCylinderTotal(&mass, 0.1, 2, kRadius, kWidth); /* its axis along y */
    dBodySetMass(it.body[i], &mass);
    dBodySetPosition(it.body[i], x + kPlace[i][0], kPlace[i][1], z);
    it.axle[i] = dJointCreateHinge(it.world, 0);
    dJointAttach(it.axle[i], it.body[kWheels], it.body[i]);
    dJointSetHingeAnchor(it.axle[i], x + kPlace[i][0], kPlace[i][1], z);
    dJointSetHingeAxis(it.axle[i], 0, -1, 0); /* so that a positive angle rolls ahead */
    dJointSetHingeParam(it.axle[i], dParamVel, kSpin);
    dJointSetHingeParam(it.axle[i], dParamFMax, kStrongest);
  }
  return it;
}

/* The rover as the soil sees it: one rigid body. */
static screed_body_motion motion_of(const rover* it) {
  screed_body_motion all = {0};
  double momentum[3] = {0};
  const dReal* omega = dBodyGetAngularVel(it->body[kWheels]);
  for (int i = 0; i < kBodies; ++i) {
    dMass mass;
    dBodyGetMass(it->body[i], &mass);
    all.mass += mass.mass;
    for (int k = 0; k < 3; ++k) {
      all.centre[k] += mass.mass * dBodyGetPosition(it->body[i])[k];
      momentum[k] += mass.mass * dBodyGetLinearVel(it->body[i])[k];
    }
  }
  for (int k = 0; k < 3; ++k) {
    all.centre[k] /= all.mass;
    all.velocity[k] = momentum[k] / all.mass;
    all.omega[k] = omega[k];
  }
  for (int i = 0; i < kBodies; ++i) { /* R I R^T, and Steiner's part */
    dMass mass;
    const dReal* turn = dBodyGetRotation(it->body[i]); /* 3 rows of 4 */
    double arm[3], square = 0;
    dBodyGetMass(it->body[i], &mass);
    for (int k = 0; k < 3; ++k) {
      arm[k] = dBodyGetPosition(it->body[i])[k] - all.centre[k];
      square += arm[k] * arm[k];
    }
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        double part = mass.mass * ((r == c ? square : 0) - arm[r] * arm[c]);
        for (int a = 0; a < 3; ++a) {
          for (int b = 0; b < 3; ++b) part += turn[4 * r + a] * mass.I[4 * a + b] * turn[4 * c + b];
        }
        all.inertia[3 * r + c] += part;
      }
    }
  }
  return all;
}

/* A wheel's patch has the chassis' axes: it does not spin. */
static screed_patch_motion patch_of(const rover* it, int wheel) {
  screed_patch_motion patch;
  const dReal* turn = dBodyGetRotation(it->body[kWheels]);
  for (int r = 0; r < 3; ++r) {
    patch.position[r] = dBodyGetPosition(it->body[wheel])[r];
    for (int c = 0; c < 3; ++c) patch.axes[3 * r + c] = turn[4 * r + c];
  }
  patch.surface_speed = kRadius * dJointGetHingeAngleRate(it->axle[wheel]);
  return patch;
}

int main(void) {
  screed_error error;
  double heights[61][121];
  const screed_bed bed = {121, 61, 0.01, SCREED_EDGE_OPEN, &heights[0][0]};
  const screed_patch wheel = {SCREED_WHEEL, {kRadius, kWidth, 0.0}, INFINITY, 0.0, 0.0};
  screed_patch wheels[kWheels];
  screed_volumes volumes;
  rover it;
  screed_soil* soil;
  int body;

  for (int y = 0; y < 61; ++y) { /* a hump across the way, 20 mm high */
    for (int x = 0; x < 121; ++x) heights[y][x] = 0.02 * exp(-pow((x - 60) * 0.01 / 0.12, 2));
  }
  for (int i = 0; i < kWheels; ++i) wheels[i] = wheel;
  soil = screed_soil_create(&bed, "gravel", NULL, 0, &error);
  body = soil == NULL ? -1 : screed_soil_add_body(soil, wheels, kWheels, &error);
  if (body < 0) stop(&error);

  dInitODE();
  it = make_rover(-0.4, kRadius + 0.001);
  for (int step = 0; step <= 2500; ++step) {
    const screed_body_motion motion = motion_of(&it);
    screed_patch_motion patches[kWheels];
    screed_wrench wrenches[kWheels];
    for (int i = 0; i < kWheels; ++i) patches[i] = patch_of(&it, i);
    if (screed_soil_press(soil, body, &motion, patches, kStep, wrenches, &error) != SCREED_OK ||
        screed_soil_end_step(soil, &error) != SCREED_OK) {
      stop(&error);
    }
    for (int i = 0; i < kWheels; ++i) {
      const screed_wrench* w = &wrenches[i];
      dBodyAddForce(it.body[i], w->force[0], w->force[1], w->force[2]);
      dBodyAddTorque(it.body[i], w->torque[0], w->torque[1], w->torque[2]);
    }
    if (step % 500 == 0) {
      const dReal* at = dBodyGetPosition(it.body[kWheels]);
      printf("%4.1f s: x %6.3f m, z %5.3f m, sinks %4.1f mm in front, pulled with %5.2f N\n",
             step * kStep, at[0], at[2], 1e3 * wrenches[0].sinkage, wrenches[0].force[0]);
    }
    dWorldStep(it.world, kStep);
  }
  screed_soil_volumes(soil, &volumes, &error);
  printf("soil moved: %lld units are missing\n",
         (long long)(volumes.before - volumes.compacted - volumes.in_transit - volumes.now));
  screed_soil_destroy(soil);
  dWorldDestroy(it.world);
  dCloseODE();
  return 0;
}
