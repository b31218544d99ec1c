// How soil bears the tracks of a driving robot, over what Bekker's law says of a standing one: the
// network that TrackGround asks. It sees the soil, the robot's motion and how far the ground below
// its tracks has been pressed already, and answers with factors and shares that TrackGround's
// closed form works with (Bearing); all are bounded, so no weights can make a robot dig itself in.
//
// One tanh layer of a few nodes: it is learned by trying (bearing_trainer.h), not by gradients.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace screed::nn {

/// What the closed form works with; by itself with these numbers, fitted by hand.
struct Bearing {
  /// Unloading in the stance and in pressing, over the soil's mean stiffness at 2 kPa: softer than
  /// the soil's own E, so that soil that is already pressed does not hold a track up by one cell.
  double stance_stiffness = 10.0;
  double press_stiffness = 20.0;
  double load = 1.15;  ///< share of the robot's weight that presses
  double trail = 0.2;  ///< by which the soil bears less below a track's trailing end
  double lift = 0.16;  ///< of what the track has risen over its way, that the soil does not follow
  double ahead_m = 0.0;  ///< of the centre of mass, by which the robot leans its way
  double follow = 1.0;   ///< share of the way to the stance of its forces that it makes in a stride
};

class BearingNetwork {
 public:
  static constexpr std::size_t kInputs = 11;
  static constexpr std::size_t kAnswers = 7;

  /// Answers as the closed form, its hidden nodes at random.
  BearingNetwork(std::size_t hidden, std::uint64_t seed);
  /// Throws InputError when the file is no such network.
  static BearingNetwork read(const std::filesystem::path& file);
  void write(const std::filesystem::path& file) const;

  std::size_t hidden() const { return hidden_; }
  /// A row a hidden node, then a row an answer: weights, then the bias.
  std::vector<float>& weights() { return weights_; }
  const std::vector<float>& weights() const { return weights_; }

  Bearing answer(std::span<const float> inputs) const;

 private:
  std::size_t hidden_;
  std::vector<float> weights_;
};

}  // namespace screed::nn
