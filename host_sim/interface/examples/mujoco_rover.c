/* A rover on four driven wheels crosses a bed of sand: MuJoCo moves its bodies, the soil's wrenches
   are external forces.

     cc mujoco_rover.c $(pkg-config --cflags --libs screed-soil) -lmujoco -lm && ./a.out */
#include <math.h>
#include <mujoco/mujoco.h>
#include <screed/soil.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kWheels = 4 };

static const double kRadius = 0.04, kWidth = 0.03; /* of a wheel, m */
static const double kSpin = 4.0;                   /* rad/s */

/* Nothing touches anything in MuJoCo: the soil does. */
static const char kModel[] =
    "<mujoco>"
    "  <option timestep='0.002'/>"
    "  <default>"
    "    <geom contype='0' conaffinity='0'/>"
    "    <default class='wheel'>"
    "      <geom type='cylinder' size='0.04 0.015' zaxis='0 1 0' mass='0.1'/>"
    "      <joint type='hinge' axis='0 1 0' armature='0.001'/>"
    "    </default>"
    "  </default>"
    "  <worldbody>"
    "    <body name='chassis' pos='-0.4 0 0.061'>"
    "      <freejoint/>"
    "      <geom type='box' size='0.125 0.075 0.03' mass='1.5'/>"
    "      <body name='wheel0' pos='0.1 0.1 -0.02'><joint name='0' class='wheel'/><geom "
    "class='wheel'/></body>"
    "      <body name='wheel1' pos='0.1 -0.1 -0.02'><joint name='1' class='wheel'/><geom "
    "class='wheel'/></body>"
    "      <body name='wheel2' pos='-0.1 0.1 -0.02'><joint name='2' class='wheel'/><geom "
    "class='wheel'/></body>"
    "      <body name='wheel3' pos='-0.1 -0.1 -0.02'><joint name='3' class='wheel'/><geom "
    "class='wheel'/></body>"
    "    </body>"
    "  </worldbody>"
    "  <actuator>"
    "    <velocity joint='0' kv='0.2'/><velocity joint='1' kv='0.2'/>"
    "    <velocity joint='2' kv='0.2'/><velocity joint='3' kv='0.2'/>"
    "  </actuator>"
    "</mujoco>";

static void stop(const char* text) {
  fprintf(stderr, "mujoco_rover: %s\n", text);
  exit(2);
}

static mjModel* load_model(void) {
  char text[256] = "";
  mjModel* model;
  mjVFS* files = malloc(sizeof *files);
  if (files == NULL) stop("not enough memory");
  mj_defaultVFS(files);
  mj_makeEmptyFileVFS(files, "rover.xml", sizeof kModel);
  memcpy(files->filedata[mj_findFileVFS(files, "rover.xml")], kModel, sizeof kModel);
  model = mj_loadXML("rover.xml", files, text, sizeof text);
  mj_deleteVFS(files);
  free(files);
  if (model == NULL) stop(text);
  return model;
}

/* The rover as the soil sees it: one rigid body, with the chassis' rotation. */
static screed_body_motion motion_of(const mjModel* model, const mjData* data, int chassis) {
  screed_body_motion all = {0};
  mjtNum twist[6];
  all.mass = model->body_subtreemass[chassis];
  mju_copy3(all.centre, data->subtree_com + 3 * chassis);
  mju_copy3(all.velocity, data->subtree_linvel + 3 * chassis);
  mj_objectVelocity(model, data, mjOBJ_BODY, chassis, twist, 0);
  mju_copy3(all.omega, twist);
  for (int i = chassis; i <= chassis + kWheels; ++i) { /* R I R^T, and Steiner's part */
    const mjtNum* turn = data->ximat + 9 * i;
    mjtNum arm[3];
    mju_sub3(arm, data->xipos + 3 * i, all.centre);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        all.inertia[3 * r + c] +=
            model->body_mass[i] * ((r == c ? mju_dot3(arm, arm) : 0) - arm[r] * arm[c]);
        for (int k = 0; k < 3; ++k)
          all.inertia[3 * r + c] +=
              turn[3 * r + k] * model->body_inertia[3 * i + k] * turn[3 * c + k];
      }
    }
  }
  return all;
}

int main(void) {
  screed_error error;
  const screed_bed bed = {121, 61, 0.01, SCREED_EDGE_OPEN, NULL};
  const screed_patch wheel = {SCREED_WHEEL, {kRadius, kWidth, 0.0}, INFINITY, 0.0, 0.0};
  const screed_patch wheels[kWheels] = {wheel, wheel, wheel, wheel};
  screed_volumes volumes;
  mjModel* model = load_model();
  mjData* data = mj_makeData(model);
  const int chassis = mj_name2id(model, mjOBJ_BODY, "chassis");
  screed_soil* soil = screed_soil_create(&bed, "cmu_2022", NULL, 0, &error);
  const int body = soil == NULL ? -1 : screed_soil_add_body(soil, wheels, kWheels, &error);
  if (body < 0) stop(error.text);

  for (int i = 0; i < kWheels; ++i) data->ctrl[i] = kSpin;
  for (int step = 0; step <= 2500; ++step) {
    screed_body_motion motion;
    screed_patch_motion patches[kWheels];
    screed_wrench wrenches[kWheels];
    mj_step1(model, data);
    mj_subtreeVel(model, data);
    motion = motion_of(model, data, chassis);
    for (int i = 0; i < kWheels; ++i) {
      mju_copy3(patches[i].position, data->xipos + 3 * (chassis + 1 + i));
      mju_copy(patches[i].axes, data->xmat + 9 * chassis, 9); /* a patch does not spin */
      patches[i].surface_speed = kRadius * data->qvel[6 + i];
    }
    if (screed_soil_press(soil, body, &motion, patches, model->opt.timestep, wrenches, &error) !=
            SCREED_OK ||
        screed_soil_end_step(soil, &error) != SCREED_OK) {
      stop(error.text);
    }
    for (int i = 0; i < kWheels; ++i) {
      mju_copy3(data->xfrc_applied + 6 * (chassis + 1 + i), wrenches[i].force);
      mju_copy3(data->xfrc_applied + 6 * (chassis + 1 + i) + 3, wrenches[i].torque);
    }
    if (step % 500 == 0) {
      const mjtNum* at = data->xpos + 3 * chassis;
      printf("%4.1f s: x %6.3f m, z %5.3f m, sinks %4.1f mm in front, pulled with %5.2f N\n",
             data->time, at[0], at[2], 1e3 * wrenches[0].sinkage, wrenches[0].force[0]);
    }
    mj_step2(model, data);
  }
  screed_soil_volumes(soil, &volumes, &error);
  printf("soil moved: %lld units are missing\n",
         (long long)(volumes.before - volumes.compacted - volumes.in_transit - volumes.now));
  screed_soil_destroy(soil);
  mj_deleteData(data);
  mj_deleteModel(model);
  return 0;
}
