// The linear system of a closed chain: every pin has two unknowns and is coupled with its two
// neighbours.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/running_gear.h"
#include "host_sim/physics/vehicle/vehicle_options.h"

namespace screed {

/// Solves A x = b, A symmetric and positive definite, in blocks of 2 x 2: block i of the diagonal
/// is diagonal[i], the block in row i and column i + 1 is next[i]; the last one couples the last
/// pin with the first. By elimination, in time proportional to the number of pins (three or more);
/// allocates nothing.
class ChainSolver {
 public:
  explicit ChainSolver(size_t pins);

  std::vector<Eigen::Matrix2d> diagonal;
  std::vector<Eigen::Matrix2d> next;
  std::vector<Eigen::Vector2d> right;

  /// Uses up diagonal and right. The result is valid until the next call.
  const std::vector<Eigen::Vector2d>& solve();

 private:
  std::vector<Eigen::Matrix2d> to_last_;  // what is left of each row's coupling with the last pin
  std::vector<Eigen::Vector2d> x_;
};

// A track of links round the two wheels of a side: pins, links between them, shoes on the links.
//
// Every pin is a point mass with two degrees of freedom in the plane of its wheels (the guides on
// the wheels hold it there: what pushes it sideways pushes the carrying body). Links are stiff
// springs from pin to pin. Wheels bear the pins radially and hold them by their teeth; the ground
// presses on the shoes. One linearly implicit step of the whole chain costs one elimination
// (chain_track.h), so neither the lightness of the pins (some 1:1000 against the robot) nor the
// stiffness of links, teeth and soil limits the step. Forces on the carrying body, and torques on
// the wheels' shafts, are what the pins felt.
//
// Method: Baraff and Witkin, Large steps in cloth simulation, SIGGRAPH 1998, in one dimension.
// docs/studies/robot-models.md says what else was tried.

/// Of the shoes, inwards from the pins: the solid that loose elements meet.
inline constexpr double kChainShoeThickness_m = 0.008;

class ChainTrack {
 public:
  /// Speeds of the wheels against the carrying body, rad/s, driving forward positive: front, rear.
  using WheelRates = std::array<double, 2>;

  /// Throws InputError when the options give no chain.
  ChainTrack(const RunningGearGeometry& geometry, const ChainOptions& options, double friction,
             const GearLoad& load);

  /// Begins a step: moves the pins with the velocities of the last one, and adds what the terrain
  /// is to be given to `contacts` (footprint_count() of them, valid until the next call). As a
  /// lower surface the shoes are one band round the wheels, a footprint of the carrier: in a grid
  /// of some millimetres a shoe is hardly wider than a cell. As solids they are one each.
  void begin_step(FootprintShape shape, const CarrierMotion& carrier, const WheelRates& rates,
                  double dt, std::vector<FootprintContact>& contacts);
  size_t footprint_count(FootprintShape shape) const;
  /// Ends it once the terrain has answered: finds the pins' new velocities. `pressed`: the contacts
  /// of begin_step(). Adds what the chain does to the carrying body to `wrench` (a band's reaction
  /// it must have got already); returns the torques on front and rear wheel, N m, driving forward
  /// positive.
  std::array<double, 2> end_step(const Terrain& terrain, std::span<const FootprintContact> pressed,
                                 const CarrierMotion& carrier, double dt, Wrench& wrench);

  /// Lays the chain round its wheels as at the start, at rest with the body.
  void reset();

  double radius_m() const { return geometry_.radius; }
  double mass_kg() const { return pin_mass_ * static_cast<double>(pins()); }
  const Eigen::Vector3d& centre() const { return centre_; }
  double normal_load_n() const { return normal_load_; }
  /// Greatest depth below the undisturbed terrain, 0 on terrain that remembers none.
  double sinkage_m() const { return sinkage_; }
  /// Corners of the shoes at rest, in the frame of the carrier's centre of mass.
  std::vector<Eigen::Vector3d> points() const;
  /// Of each of them the direction of the shoes when driving forward, unit length.
  std::vector<Eigen::Vector3d> directions() const;

  /// Mean speed of the chain over its wheels, driving forward positive, m/s.
  double surface_speed(const CarrierMotion& carrier) const {
    return surface_speed(frame_of(carrier));
  }
  /// Something holds the chain with `force` (N, world), which the carrier has got as a whole, at
  /// `arm` from its centre of mass (world axes): what of it lies along `along` pulls on the pin
  /// that is nearest, in the step that begins next.
  void pull(const CarrierMotion& carrier, const Eigen::Vector3d& arm, const Eigen::Vector3d& along,
            const Eigen::Vector3d& force);

  size_t pins() const { return position_.size(); }
  /// Of a pin, in the frame of the carrier's centre of mass.
  Eigen::Vector3d pin(size_t i) const { return on_axes(position_[i]) + centre_; }
  double length_m() const;
  double unloaded_length_m() const { return link_length_ * static_cast<double>(pins()); }
  /// How far the pin that is farthest from the ideal loop round the wheels stands from it, m.
  double farthest_from_loop_m() const;

 private:
  using Vector2 = Eigen::Vector2d;  // along and up, in the plane of the wheels
  using Matrix2 = Eigen::Matrix2d;

  struct PlaneFrame {      // of this step, world
    Eigen::Matrix3d axes;  // forward, left, up of the plane
    Eigen::Vector3d centre;
    const CarrierMotion& carrier;

    Vector2 in_plane(const Eigen::Vector3d& v) const {
      return {axes.col(0).dot(v), axes.col(2).dot(v)};
    }
    Eigen::Vector3d from_plane(const Vector2& v) const {
      return v.x() * axes.col(0) + v.y() * axes.col(2);
    }
    Eigen::Vector3d to_world(const Vector2& p) const { return centre + from_plane(p); }
    Eigen::Vector3d carrier_velocity(const Eigen::Vector3d& position) const {
      return carrier.velocity + carrier.omega.cross(position - carrier.origin);
    }
  };
  struct Link {     // from a pin to the next
    Vector2 along;  // unit length
    double length;
    Vector2 out;      // away from the wheels, unit length
    Vector2 inwards;  // from the pins to the middle of the shoe
  };
  struct ShoeContact {  // one corner of a shoe in the ground
    size_t pin;
    int row;
    Eigen::Vector3d normal;
    Eigen::Vector3d force;  // as if the pin kept its velocity
    double gain;            // N s/m, of the velocity's change
    double grip;            // share of the gain along the ground
  };
  struct Pull {  // on a pin, in the plane
    size_t pin;
    Vector2 force;
  };
  struct Engagement {  // a link on a wheel
    size_t link;       // from pin `link` to the next one
    size_t wheel;
    double share;  // of the way along the link
    Vector2 out;
    Vector2 force;
    Matrix2 gain;
  };

  Eigen::Vector3d on_axes(const Vector2& p) const {
    return p.x() * axes_.col(0) + p.y() * axes_.col(2);
  }
  size_t after(size_t i) const { return i + 1 == position_.size() ? 0 : i + 1; }
  size_t before(size_t i) const { return i == 0 ? position_.size() - 1 : i - 1; }

  PlaneFrame frame_of(const CarrierMotion& carrier) const;
  PlaneFrame move_pins(const CarrierMotion& carrier, double dt);
  Link link(size_t i) const;
  void begin(const PlaneFrame& frame, double dt);
  void add_links(const PlaneFrame& frame, double dt);
  void add_wheels(const PlaneFrame& frame, const WheelRates& rates, double dt);
  void stand_on(const HeightField& hard, const PlaneFrame& frame, double dt);
  double surface_speed(const PlaneFrame& frame) const;
  FootprintContact band_contact(const CarrierMotion& carrier);
  FootprintContact shoe_contact(const PlaneFrame& frame, size_t i);
  void pull_on_lower_run(const TerrainReaction& band, const PlaneFrame& frame, double dt,
                         Wrench& wrench);
  void push_shoes(std::span<const FootprintContact> shoes, const ContactStiffness& stiffness,
                  const PlaneFrame& frame, double dt, Wrench& wrench);
  void add_force(size_t pin, const Vector2& force, const Matrix2& gain, double dt);
  std::array<double, 2> finish(const PlaneFrame& frame, double dt, Wrench& wrench);

  RunningGearGeometry geometry_;
  Eigen::Vector3d centre_;
  Eigen::Matrix3d axes_;  // forward, left, up of the plane, in the carrier's frame
  double half_length_;    // of the run between the axles
  double link_length_;    // unloaded
  double pin_mass_;
  double stiffness_;  // of one link, N/m
  ContactLaw law_;

  // A pin's neighbour of higher index is the one ahead of it when driving forward, on the upper
  // run.
  std::vector<Vector2> rest_;                 // where the pins are laid at the start
  std::vector<Vector2> position_;             // from centre_, in the plane
  std::vector<Eigen::Vector3d> velocity_;     // world
  std::vector<Eigen::Vector3d> bristles_;     // world, two rows
  std::vector<std::array<double, 2>> teeth_;  // how far the teeth of each wheel are bent, m
  std::vector<std::array<uint8_t, 2>> engaged_;
  bool at_rest_ = true;  // just laid: takes over the body's velocity

  ChainSolver solver_;
  std::vector<ShoeContact> shoe_contacts_;
  std::vector<Engagement> engagements_;
  std::vector<Pull> pulls_;
  std::vector<Eigen::Vector3d> terrain_force_;  // on each pin, for the guides
  double normal_load_ = 0.0;
  double sinkage_ = 0.0;

  Footprint footprint_;           // the band
  Footprint side_footprint_;      // when it lies on its side
  std::vector<Footprint> shoes_;  // of each link
  ContactMemory memory_;
};

}  // namespace screed
