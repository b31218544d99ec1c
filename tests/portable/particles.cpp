// A world of particles, beside the portable core.
#include "host_sim/physics/particles/particle_bed.h"
#include "tests/portable/portable.h"

namespace screed {
namespace {

/// Spheres fall into place, and a box is pushed through them.
void push_particles() {
  ParticleOptions options;
  ParticleBed bed(hills(24, 0.025), options);
  Footprint box = Footprint::box({0.1, 0.1, 0.1});
  Hash hash;
  const double dt = bed.longest_step_s();
  for (int step = 0; step < 300; ++step) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << 0.3 * step * dt, 0.0, 0.05;
    box.set_pose(pose);
    FootprintMotion motion;
    motion.velocity = {0.3, 0.0, 0.0};
    hash.add(bed.press(box, motion, dt).force);
    bed.step(dt);
  }
  for (size_t i = 0; i < bed.size(); ++i) {
    hash.add(bed.position(i));
    hash.add(bed.angular_velocity(i));
  }
  hash.add(bed.surface());
  hash.print("spheres");
}

}  // namespace
}  // namespace screed

int main() {
  screed::push_particles();
}
