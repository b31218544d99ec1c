// Inputs and outputs of a network: features by name, each a function of the frames up to the
// present one. The same table serves training data from recorded sessions and a running world.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/core/sim_frame.h"

namespace screed::nn {

/// Consecutive frames, oldest first; the last is the present one.
class FrameWindow {
 public:
  /// At least one frame, which must outlive the window.
  explicit FrameWindow(std::span<const SimFrame> frames) : frames_(frames) {}

  const SimFrame& now() const { return frames_.back(); }
  /// The frame so many frames ago; before the first one: the first.
  const SimFrame& ago(std::size_t frames) const {
    return frames_[frames < frames_.size() ? frames_.size() - 1 - frames : 0];
  }
  /// The same moment, without the last frames.
  FrameWindow until(std::size_t frames_ago) const {
    return FrameWindow(
        frames_.first(frames_ago < frames_.size() ? frames_.size() - frames_ago : 1));
  }

 private:
  std::span<const SimFrame> frames_;
};

struct Feature {
  const char* name;
  const char* unit;
  const char* meaning;
  std::size_t frames;  ///< that it looks at, the present one included
  double (*value)(const FrameWindow&);
};

/// Every feature there is.
std::span<const Feature> features();

/// A feature as configurations name it: "v_left"; "v_left@5", v_left five frames ago;
/// "v_left-v_right", the difference of two of these.
class NamedFeature {
 public:
  /// Throws InputError, naming what there is, when the name is not known.
  explicit NamedFeature(const std::string& name);

  const std::string& name() const { return name_; }
  const char* unit() const { return terms_.front().feature->unit; }
  /// How many frames it looks at, the present one included.
  std::size_t frames() const;
  double value(const FrameWindow& window) const;

 private:
  struct Term {
    const Feature* feature;
    std::size_t ago;
  };
  static Term term_of(std::string_view text);

  std::string name_;
  std::vector<Term> terms_;  ///< one, or two that are subtracted
};

}  // namespace screed::nn
