// Block elimination of a cyclic tridiagonal system: the last pin is the border of the others.
#include "host_sim/physics/vehicle/chain_track.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"

namespace screed {

ChainSolver::ChainSolver(size_t pins)
    : diagonal(pins), next(pins), right(pins), to_last_(pins), x_(pins) {}

const std::vector<Eigen::Vector2d>& ChainSolver::solve() {
  const size_t last = diagonal.size() - 1;
  for (size_t i = 0; i < last; ++i) to_last_[i].setZero();
  to_last_[0] = next[last].transpose();
  to_last_[last - 1] += next[last - 1];

  // Forwards: what is below the diagonal goes, row by row; the last row is kept up to date.
  for (size_t i = 0; i < last; ++i) {
    const Eigen::Matrix2d inverse = diagonal[i].inverse();
    const Eigen::Matrix2d onto_last = to_last_[i].transpose() * inverse;
    diagonal[last] -= onto_last * to_last_[i];
    right[last] -= onto_last * right[i];
    if (i + 1 < last) {
      const Eigen::Matrix2d onto_next = next[i].transpose() * inverse;
      diagonal[i + 1] -= onto_next * next[i];
      to_last_[i + 1] -= onto_next * to_last_[i];
      right[i + 1] -= onto_next * right[i];
    }
    diagonal[i] = inverse;
  }
  // Backwards.
  x_[last] = diagonal[last].inverse() * right[last];
  for (size_t i = last; i-- > 0;) {
    Eigen::Vector2d residual = right[i] - to_last_[i] * x_[last];
    if (i + 1 < last) residual -= next[i] * x_[i + 1];
    x_[i] = diagonal[i] * residual;
  }
  return x_;
}

// A track of links: forces between pins, wheels and ground, and one implicit step of all of them.

namespace {

constexpr double kPitch_m = 0.010;  // of the links, about
constexpr int kRows = 2;            // of contact points: the outer and the inner edge of the shoes
constexpr double kChainSinkIn_m = 0.0004;
constexpr double kCarryingPins = 6;  // on level ground: three under each wheel
constexpr double kChainDampingRatio = 0.7;

// Between pin and wheel. The teeth are as soft as the light rear wheel allows, whose own motion is
// a step behind the pins'.
constexpr double kWheelStiffness = 8e3;  // N/m
constexpr double kWheelDamping = 2.0;    // N s/m
constexpr double kToothStiffness = 4e3;
constexpr double kToothDamping = 1.0;
constexpr double kToothHeight_m = 0.002;

}  // namespace

ChainTrack::ChainTrack(const RunningGearGeometry& geometry, const ChainOptions& options,
                       double friction, const GearLoad& load)
    : geometry_(geometry),
      centre_(0.5 * (geometry.front + geometry.rear)),
      half_length_(0.5 * (geometry.front - geometry.rear).norm()),
      solver_(0),
      footprint_(Footprint::track(half_length_, geometry.radius, geometry.width)),
      side_footprint_(Footprint::box(
          {2.0 * (half_length_ + geometry.radius), geometry.width, 2.0 * geometry.radius})) {
  const double radius = geometry.radius;
  const double loop = 4.0 * half_length_ + 2.0 * std::numbers::pi * radius;
  const int links =
      options.links > 0 ? options.links : static_cast<int>(std::lround(loop / kPitch_m));
  // Fewer do not wrap round a wheel.
  const int fewest = static_cast<int>(std::ceil(loop / radius));
  if (half_length_ <= 0.0 || links < fewest) {
    throw InputError("robot model: a chain of " + std::to_string(links) +
                     " links does not go round its wheels; at least " + std::to_string(fewest));
  }
  const Eigen::Vector3d forward = (geometry.front - geometry.rear).normalized();
  axes_ << forward, Eigen::Vector3d::UnitY(), forward.cross(Eigen::Vector3d::UnitY());

  // Over the upper run to the front, down round the front wheel, back below, up round the rear one.
  const auto on_loop = [&](double distance, double r) -> Vector2 {
    if (distance < 2.0 * half_length_) return {distance - half_length_, r};
    distance -= 2.0 * half_length_;
    const double half_turn = std::numbers::pi * radius;
    if (distance < half_turn) {
      return {half_length_ + r * portable::sin(distance / radius),
              r * portable::cos(distance / radius)};
    }
    distance -= half_turn;
    if (distance < 2.0 * half_length_) return {half_length_ - distance, -r};
    distance -= 2.0 * half_length_;
    return {-half_length_ - r * portable::sin(distance / radius),
            -r * portable::cos(distance / radius)};
  };
  // The middles of the links lie on the wheels, pressed on by the tension.
  const double pitch = loop / links;
  const double pressed = options.tension_n * pitch / radius / kWheelStiffness;
  const double pins_at = (radius - pressed) / portable::cos(0.5 * pitch / radius);
  double length = 0.0;
  for (int i = 0; i < links; ++i) {
    rest_.push_back(on_loop(i * pitch, pins_at));
    if (i > 0) length += (rest_.back() - rest_[rest_.size() - 2]).norm();
  }
  length += (rest_.front() - rest_.back()).norm();
  link_length_ = length / links / (1.0 + options.tension_n / options.stiffness_n);
  stiffness_ = options.stiffness_n / link_length_;
  pin_mass_ = options.mass_kg / links;

  const double carrying = kRows * kCarryingPins;
  law_.friction = friction;
  law_.stiffness = load.weight_n / (kChainSinkIn_m * carrying);
  // All shoes of the lower run damp, however little they carry.
  const double touching = kRows * (2.0 * half_length_ / pitch);
  law_.damping = 2.0 * kChainDampingRatio * std::sqrt(law_.stiffness * load.mass_kg / touching) *
                 std::sqrt(carrying / touching);

  shoes_.assign(rest_.size(),
                Footprint::box({link_length_, geometry.width, kChainShoeThickness_m}));
  solver_ = ChainSolver(rest_.size());
  shoe_contacts_.reserve(kRows * rest_.size());
  engagements_.reserve(2 * rest_.size());
  terrain_force_.resize(rest_.size());
  reset();
}

void ChainTrack::reset() {
  position_ = rest_;
  velocity_.assign(pins(), Eigen::Vector3d::Zero());
  bristles_.assign(kRows * pins(), Eigen::Vector3d::Zero());
  teeth_.assign(pins(), {0.0, 0.0});
  engaged_.assign(pins(), {0, 0});
  memory_ = {};
  pulls_.clear();
  at_rest_ = true;
}

std::vector<Eigen::Vector3d> ChainTrack::points() const {
  std::vector<Eigen::Vector3d> corners;
  for (const Vector2& pin : rest_) {
    for (const double side : {0.5, -0.5}) {
      corners.emplace_back(centre_ + on_axes(pin) + side * geometry_.width * axes_.col(1));
    }
  }
  return corners;
}

std::vector<Eigen::Vector3d> ChainTrack::directions() const {
  std::vector<Eigen::Vector3d> directions;
  for (size_t i = 0; i < pins(); ++i) {
    directions.insert(directions.end(), kRows,
                      on_axes((rest_[after(i)] - rest_[before(i)]).normalized()));
  }
  return directions;
}

void ChainTrack::pull(const CarrierMotion& carrier, const Eigen::Vector3d& arm,
                      const Eigen::Vector3d& along, const Eigen::Vector3d& force) {
  const PlaneFrame frame = frame_of(carrier);
  const Vector2 at = frame.in_plane(carrier.origin + arm - frame.centre);
  const auto nearest =
      std::min_element(position_.begin(), position_.end(), [&](const Vector2& a, const Vector2& b) {
        return (a - at).squaredNorm() < (b - at).squaredNorm();
      });
  pulls_.push_back(
      {static_cast<size_t>(nearest - position_.begin()), frame.in_plane(force.dot(along) * along)});
}

double ChainTrack::length_m() const {
  double length = 0.0;
  for (size_t i = 0; i < pins(); ++i) length += (position_[after(i)] - position_[i]).norm();
  return length;
}

double ChainTrack::farthest_from_loop_m() const {
  double farthest = 0.0;
  for (const Vector2& pin : position_) {
    const double beyond = std::abs(pin.x()) - half_length_;
    const double from_line = beyond > 0.0 ? portable::hypot(beyond, pin.y()) : std::abs(pin.y());
    farthest = std::max(farthest, std::abs(from_line - geometry_.radius));
  }
  return farthest;
}

ChainTrack::PlaneFrame ChainTrack::frame_of(const CarrierMotion& carrier) const {
  return {carrier.rotation * axes_, carrier.origin + carrier.rotation * centre_, carrier};
}

ChainTrack::PlaneFrame ChainTrack::move_pins(const CarrierMotion& carrier, double dt) {
  PlaneFrame frame = frame_of(carrier);
  for (size_t i = 0; i < pins(); ++i) {
    const Eigen::Vector3d carried = frame.carrier_velocity(frame.to_world(position_[i]));
    if (at_rest_) {
      velocity_[i] = carried;
    } else {
      position_[i] += dt * frame.in_plane(velocity_[i] - carried);
    }
  }
  at_rest_ = false;
  return frame;
}

// `force` is the one that would act if the pin kept its velocity; it falls by gain times the
// velocity's change.
void ChainTrack::add_force(size_t pin, const Vector2& force, const Matrix2& gain, double dt) {
  solver_.right[pin] += dt * force;
  solver_.diagonal[pin] += dt * gain;
}

void ChainTrack::add_links(const PlaneFrame& frame, double dt) {
  for (size_t i = 0; i < pins(); ++i) {
    const size_t j = after(i);
    const Vector2 run = position_[j] - position_[i];
    const double length = run.norm();
    const Vector2 along = run / length;
    const Matrix2 lengthwise = along * along.transpose();
    const Vector2 change = dt * frame.in_plane(velocity_[j] - velocity_[i]);
    const double tension = stiffness_ * (length + along.dot(change) - link_length_);
    const Matrix2 swing = std::max(tension, 0.0) / length * (Matrix2::Identity() - lengthwise);
    const Vector2 pull = tension * along + swing * change;
    const Matrix2 gain = dt * (stiffness_ * lengthwise + swing);
    add_force(i, pull, gain, dt);
    add_force(j, -pull, gain, dt);
    solver_.next[i] = -dt * gain;
  }
}

// A wheel touches a link where the link comes closest to its axle: it rolls on links that lie flat,
// as on a rail, and does not bump from pin to pin.
void ChainTrack::add_wheels(const PlaneFrame& frame, const WheelRates& rates, double dt) {
  engagements_.clear();
  const double radius = geometry_.radius;
  for (size_t i = 0; i < pins(); ++i) {
    const size_t j = after(i);
    const Vector2 run = position_[j] - position_[i];
    for (const size_t wheel : {0U, 1U}) {
      const Vector2 axle(wheel == 0 ? half_length_ : -half_length_, 0.0);
      const double share = std::clamp((axle - position_[i]).dot(run) / run.squaredNorm(), 0.0, 1.0);
      const Vector2 position = position_[i] + share * run;
      const Vector2 arm = position - axle;
      const double distance = arm.norm();
      if (distance > radius + kToothHeight_m) {
        engaged_[i][wheel] = 0;
        continue;
      }
      if (engaged_[i][wheel] == 0) {
        if (distance > radius) continue;
        engaged_[i][wheel] = 1;
        teeth_[i][wheel] = 0.0;
      }
      Engagement engagement{i, wheel, share, arm / distance, Vector2::Zero(), Matrix2::Zero()};
      const Vector2& out = engagement.out;
      const Vector2 along(out.y(), -out.x());
      const Vector2 relative = frame.in_plane((1.0 - share) * velocity_[i] + share * velocity_[j] -
                                              frame.carrier_velocity(frame.to_world(position)));
      const double outwards = relative.dot(out);
      const double push =
          kWheelStiffness * (radius - distance - dt * outwards) - kWheelDamping * outwards;
      if (distance < radius && push > 0.0) {
        engagement.force += push * out;
        engagement.gain += (kWheelDamping + dt * kWheelStiffness) * out * out.transpose();
      }
      const double slide = relative.dot(along) - rates[wheel] * radius;
      teeth_[i][wheel] += dt * slide;  // the change of velocity follows in finish()
      engagement.force -= (kToothStiffness * teeth_[i][wheel] + kToothDamping * slide) * along;
      engagement.gain += (kToothDamping + dt * kToothStiffness) * along * along.transpose();
      add_force(i, (1.0 - share) * engagement.force,
                (1.0 - share) * (1.0 - share) * engagement.gain, dt);
      add_force(j, share * engagement.force, share * share * engagement.gain, dt);
      solver_.next[i] += dt * share * (1.0 - share) * engagement.gain;
      engagements_.push_back(engagement);
    }
  }
}

void ChainTrack::stand_on(const HeightField& hard, const PlaneFrame& frame, double dt) {
  TerrainContact contact;
  for (size_t i = 0; i < pins(); ++i) {
    const Vector2 chord = position_[after(i)] - position_[before(i)];
    const Vector2 out = Vector2(-chord.y(), chord.x()).normalized();
    const bool above = out.x() * frame.axes(2, 0) + out.y() * frame.axes(2, 2) > kUpperSide;
    const Eigen::Vector3d pin = frame.to_world(position_[i]);
    // Sideways the pin moves as the body does now.
    const Eigen::Vector3d axle = frame.axes.col(1);
    const Eigen::Vector3d moving =
        velocity_[i] + axle.dot(frame.carrier_velocity(pin) - velocity_[i]) * axle;
    for (int row = 0; row < kRows; ++row) {
      Eigen::Vector3d& bristle = bristles_[kRows * i + static_cast<size_t>(row)];
      const Eigen::Vector3d edge = (row == 0 ? 0.5 : -0.5) * geometry_.width * axle;
      if (above || !find_contact(hard, pin + edge, contact)) {
        bristle.setZero();
        continue;
      }
      const Eigen::Vector3d velocity = moving + frame.carrier.omega.cross(edge);
      const double normal_speed = velocity.dot(contact.normal);
      const double gain = law_.damping + dt * law_.stiffness;
      const double normal_force = law_.stiffness * contact.depth - gain * normal_speed;
      if (normal_force <= 0.0) {
        bristle.setZero();
        continue;
      }
      const Eigen::Vector3d sliding = velocity - normal_speed * contact.normal;
      bristle -= bristle.dot(contact.normal) * contact.normal;
      Eigen::Vector3d tangential = -law_.stiffness * bristle - gain * sliding;
      const double limit = law_.friction * normal_force;
      const double size = tangential.norm();
      const double grip = size > limit ? limit / size : 1.0;
      tangential *= grip;
      bristle += dt * sliding;
      const Eigen::Vector3d force = normal_force * contact.normal + tangential;
      shoe_contacts_.push_back({i, row, contact.normal, force, gain, grip});
      const Vector2 normal = frame.in_plane(contact.normal);
      add_force(i, frame.in_plane(force),
                gain * (grip * Matrix2::Identity() + (1.0 - grip) * normal * normal.transpose()),
                dt);
    }
  }
}

void ChainTrack::begin(const PlaneFrame& frame, double dt) {
  const Vector2 weight = -pin_mass_ * kGravity_m_per_s2 * frame.in_plane(Eigen::Vector3d::UnitZ());
  for (size_t i = 0; i < pins(); ++i) {
    solver_.diagonal[i] = pin_mass_ * Matrix2::Identity();
    solver_.right[i] = dt * weight;
    terrain_force_[i].setZero();
  }
  for (const Pull& pull : pulls_) solver_.right[pull.pin] += dt * pull.force;
  shoe_contacts_.clear();
  normal_load_ = 0.0;
}

std::array<double, 2> ChainTrack::finish(const PlaneFrame& frame, double dt, Wrench& wrench) {
  const std::vector<Vector2>& change = solver_.solve();
  const Eigen::Vector3d axle = frame.axes.col(1);
  const Eigen::Vector3d& origin = frame.carrier.origin;

  for (ShoeContact& contact : shoe_contacts_) {
    const Eigen::Vector3d more = frame.from_plane(change[contact.pin]);
    const Eigen::Vector3d along_normal = more.dot(contact.normal) * contact.normal;
    const Eigen::Vector3d along_ground = more - along_normal;
    const Eigen::Vector3d force =
        contact.force - contact.gain * (along_normal + contact.grip * along_ground);
    Eigen::Vector3d& bristle = bristles_[kRows * contact.pin + static_cast<size_t>(contact.row)];
    bristle += dt * along_ground;
    const double longest =
        law_.friction * std::max(0.0, force.dot(contact.normal)) / law_.stiffness;
    const double length = bristle.norm();
    if (length > longest) bristle *= longest / length;
    terrain_force_[contact.pin] += force;
    const Eigen::Vector3d edge = (contact.row == 0 ? 0.5 : -0.5) * geometry_.width * axle;
    wrench.torque += edge.cross(force);
    normal_load_ += force.z();
  }

  std::array<double, 2> torque = {0.0, 0.0};
  for (const Engagement& engagement : engagements_) {
    const size_t next = after(engagement.link);
    const Vector2 faster =
        (1.0 - engagement.share) * change[engagement.link] + engagement.share * change[next];
    const Vector2 force = engagement.force - engagement.gain * faster;
    const Vector2 along(engagement.out.y(), -engagement.out.x());
    teeth_[engagement.link][engagement.wheel] += dt * faster.dot(along);
    torque[engagement.wheel] -= force.dot(along) * geometry_.radius;
    const Vector2 position =
        (1.0 - engagement.share) * position_[engagement.link] + engagement.share * position_[next];
    wrench.add(-frame.from_plane(force), frame.to_world(position) - origin);
  }

  for (const Pull& pull : pulls_)
    wrench.add(-frame.from_plane(pull.force), frame.to_world(position_[pull.pin]) - origin);
  pulls_.clear();

  // The guides make the pins follow the body sideways.
  for (size_t i = 0; i < pins(); ++i) {
    const Eigen::Vector3d position = frame.to_world(position_[i]);
    const double sideways = axle.dot(frame.carrier_velocity(position) - velocity_[i]);
    const double guide =
        pin_mass_ * (sideways / dt + kGravity_m_per_s2 * axle.z()) - axle.dot(terrain_force_[i]);
    wrench.add(-guide * axle, position - origin);
    velocity_[i] += frame.from_plane(change[i]) + sideways * axle;
  }
  return torque;
}

size_t ChainTrack::footprint_count(FootprintShape shape) const {
  if (shape == FootprintShape::kNone) return 0;
  return shape == FootprintShape::kSolid ? shoes_.size() : 1;
}

void ChainTrack::begin_step(FootprintShape shape, const CarrierMotion& carrier,
                            const WheelRates& rates, double dt,
                            std::vector<FootprintContact>& contacts) {
  if (shape == FootprintShape::kLowerSurface) contacts.push_back(band_contact(carrier));
  const PlaneFrame frame = move_pins(carrier, dt);
  begin(frame, dt);
  add_links(frame, dt);
  add_wheels(frame, rates, dt);
  if (shape != FootprintShape::kSolid) return;
  for (size_t i = 0; i < pins(); ++i) contacts.push_back(shoe_contact(frame, i));
}

std::array<double, 2> ChainTrack::end_step(const Terrain& terrain,
                                           std::span<const FootprintContact> pressed,
                                           const CarrierMotion& carrier, double dt,
                                           Wrench& wrench) {
  const PlaneFrame frame = frame_of(carrier);
  if (terrain.hard_surface() != nullptr) stand_on(*terrain.hard_surface(), frame, dt);
  switch (terrain.footprint_shape()) {
    case FootprintShape::kNone:
      break;
    case FootprintShape::kLowerSurface:
      pull_on_lower_run(pressed.front().reaction, frame, dt, wrench);
      break;
    case FootprintShape::kSolid:
      push_shoes(pressed, terrain.contact_stiffness(), frame, dt, wrench);
      break;
  }
  return finish(frame, dt, wrench);
}

}  // namespace screed
