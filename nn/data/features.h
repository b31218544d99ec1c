// Inputs and outputs of a network: features by name, each a function of the frames up to the
// present one. The same table serves training data from recorded sessions and a running world.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
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

/// Features of one recorded session as columns of numbers, a row a frame. All columns are of the
/// same length.
struct FeatureTable {
  std::string source;                        ///< name of the session
  std::string content_hash;                  ///< of the session
  std::vector<std::string> names;            ///< of the columns
  std::vector<std::vector<double>> columns;  ///< as many as names
  std::vector<std::uint64_t> frames;         ///< row of the session, a row

  std::size_t rows() const { return frames.size(); }
  bool has(const std::string& name) const;
  /// Throws std::out_of_range when there is no such column.
  const std::vector<double>& column(const std::string& name) const;
  std::vector<double>& column(const std::string& name);

  /// Drops the rows whose mark is 0; one mark a row.
  void keep(const std::vector<std::uint8_t>& marks);
};

/// The session's training frames (Algorithm 5). Throws InputError for an unknown feature, a session
/// that cannot be read, one without training frames, and a feature that is not a finite number.
FeatureTable read_features(const std::filesystem::path& session,
                           const std::vector<std::string>& features);

/// The session of that name in a folder of sessions: NAME/session.h5, or NAME-NNNN/session.h5 with
/// the highest number. Throws InputError when there is none.
std::filesystem::path find_session(const std::filesystem::path& folder, const std::string& name);

}  // namespace screed::nn
