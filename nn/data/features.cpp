// The table of features.
#include "nn/data/features.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/session/session_reader.h"

namespace screed::nn {
namespace {

constexpr std::size_t kMaxFramesAgo = 1000;

/// Heading in the middle of the step that ended with this frame.
double middle_yaw(const SimFrame& frame) {
  return frame.yaw - 0.5 * frame.delta_theta;
}

double mean_wheel(const SimFrame& frame) {
  return 0.5 * (frame.v_left + frame.v_right);
}
double wheel_difference(const SimFrame& frame) {
  return frame.v_right - frame.v_left;
}

constexpr Feature kFeatures[] = {
    // Thesis 6.2.1 and 6.3.1: inputs
    {"v_left", "rad/s", "left drive wheel, as commanded", 1,
     [](const FrameWindow& w) { return w.now().v_left; }},
    {"v_right", "rad/s", "right drive wheel, as commanded", 1,
     [](const FrameWindow& w) { return w.now().v_right; }},
    {"pitch", "rad", "nose up positive", 1, [](const FrameWindow& w) { return w.now().pitch; }},
    {"roll", "rad", "left side up positive", 1, [](const FrameWindow& w) { return w.now().roll; }},
    // and outputs
    {"v", "m/frame", "distance in the plane, never negative", 1,
     [](const FrameWindow& w) { return portable::hypot(w.now().delta_x, w.now().delta_y); }},
    {"delta_theta", "rad/frame", "change of heading", 1,
     [](const FrameWindow& w) { return w.now().delta_theta; }},
    {"delta_x", "m/frame", "displacement to the east", 1,
     [](const FrameWindow& w) { return w.now().delta_x; }},
    {"delta_y", "m/frame", "displacement to the north", 1,
     [](const FrameWindow& w) { return w.now().delta_y; }},
    // Beyond the thesis
    {"linear", "m/s", "desired speed", 1, [](const FrameWindow& w) { return w.now().linear; }},
    {"angular", "rad/s", "desired rate of turn", 1,
     [](const FrameWindow& w) { return w.now().angular; }},
    {"forward", "m/frame", "displacement along the heading", 1,
     [](const FrameWindow& w) {
       const auto [sine, cosine] = portable::sine_cosine(middle_yaw(w.now()));
       return w.now().delta_x * cosine + w.now().delta_y * sine;
     }},
    {"sideways", "m/frame", "displacement to the left of the heading", 1,
     [](const FrameWindow& w) {
       const auto [sine, cosine] = portable::sine_cosine(middle_yaw(w.now()));
       return w.now().delta_y * cosine - w.now().delta_x * sine;
     }},
    // Products and absolute values, to be formed before a stage smooths: a mean over several
    // headings on a
    // slope, or over ahead and back, has lost them.
    {"speed", "rad/s", "absolute value of the mean of both wheels, as commanded", 1,
     [](const FrameWindow& w) { return std::abs(mean_wheel(w.now())); }},
    {"spin", "rad/s", "absolute value of the wheels' difference, as commanded", 1,
     [](const FrameWindow& w) { return std::abs(wheel_difference(w.now())); }},
    {"climb", "rad/s", "slope along the heading times the wheels' mean: > 0 uphill", 1,
     [](const FrameWindow& w) { return portable::sin(w.now().pitch) * mean_wheel(w.now()); }},
    {"lean", "rad/s", "slope across times the wheels' difference", 1,
     [](const FrameWindow& w) { return portable::sin(w.now().roll) * wheel_difference(w.now()); }},
    {"slide", "rad/s", "slope across times the wheels' mean", 1,
     [](const FrameWindow& w) { return portable::sin(w.now().roll) * mean_wheel(w.now()); }},
    {"pivot", "rad/s", "slope along the heading times the wheels' difference", 1,
     [](const FrameWindow& w) { return portable::sin(w.now().pitch) * wheel_difference(w.now()); }},
    {"tilt", "1", "sine of the slope, whatever its direction", 1,
     [](const FrameWindow& w) {
       return portable::hypot(portable::sin(w.now().pitch), portable::sin(w.now().roll));
     }},
    {"bank", "1", "absolute value of the sine of the roll", 1,
     [](const FrameWindow& w) { return std::abs(portable::sin(w.now().roll)); }},
    // Gyro rates; not available in the surrogate world.
    {"yaw_rate", "rad/s", "absolute value, about the chassis' upward axis", 1,
     [](const FrameWindow& w) { return std::abs(w.now().rate_z); }},
    {"pitch_rate", "rad/s", "absolute value, about its leftward axis", 1,
     [](const FrameWindow& w) { return std::abs(w.now().rate_y); }},
    {"roll_rate", "rad/s", "absolute value, about its forward axis", 1,
     [](const FrameWindow& w) { return std::abs(w.now().rate_x); }},
    {"arc", "rad2/s2", "speed times yaw_rate", 1,
     [](const FrameWindow& w) { return std::abs(mean_wheel(w.now()) * w.now().rate_z); }},
    {"whirl", "rad2/s2", "square of yaw_rate", 1,
     [](const FrameWindow& w) { return w.now().rate_z * w.now().rate_z; }},
    {"banked_turn", "rad/s", "bank times yaw_rate", 1,
     [](const FrameWindow& w) { return std::abs(portable::sin(w.now().roll) * w.now().rate_z); }},
};

}  // namespace

std::span<const Feature> features() {
  return kFeatures;
}

NamedFeature::Term NamedFeature::term_of(std::string_view text) {
  const std::size_t at = text.find('@');
  const std::string_view base = text.substr(0, at);
  const Feature* found = nullptr;
  for (const Feature& feature : kFeatures) {
    if (base == feature.name) found = &feature;
  }
  if (found == nullptr) {
    std::string known;
    for (const Feature& feature : kFeatures) known += std::string(", ") + feature.name;
    throw InputError("feature '" + std::string(text) + "' is not known; allowed is " +
                     known.substr(2) + ", each also as NAME@FRAMES_AGO, and NAME-NAME");
  }
  std::size_t ago = 0;
  if (at != std::string_view::npos) {
    const char* end = text.data() + text.size();
    const auto result = std::from_chars(text.data() + at + 1, end, ago);
    if (result.ec != std::errc() || result.ptr != end || ago > kMaxFramesAgo) {
      throw InputError("feature '" + std::string(text) +
                       "': allowed behind the @ is an integer 0 to " +
                       std::to_string(kMaxFramesAgo));
    }
  }
  return {found, ago};
}

NamedFeature::NamedFeature(const std::string& name) : name_(name) {
  const std::size_t minus = name.find('-');
  terms_.push_back(term_of(std::string_view(name).substr(0, minus)));
  if (minus != std::string::npos) {
    terms_.push_back(term_of(std::string_view(name).substr(minus + 1)));
  }
}

std::size_t NamedFeature::frames() const {
  std::size_t most = 0;
  for (const Term& term : terms_) most = std::max(most, term.feature->frames + term.ago);
  return most;
}

double NamedFeature::value(const FrameWindow& window) const {
  const auto of = [&](const Term& term) { return term.feature->value(window.until(term.ago)); };
  return terms_.size() == 1 ? of(terms_[0]) : of(terms_[0]) - of(terms_[1]);
}

// ---- tables of sessions, which are read whole: 64,000 frames are some 20 MB

namespace {

namespace fs = std::filesystem;

std::size_t column_index(const FeatureTable& table, const std::string& name) {
  const auto found = std::find(table.names.begin(), table.names.end(), name);
  if (found == table.names.end()) throw std::out_of_range("no column " + name);
  return static_cast<std::size_t>(found - table.names.begin());
}

}  // namespace

bool FeatureTable::has(const std::string& name) const {
  return std::find(names.begin(), names.end(), name) != names.end();
}

const std::vector<double>& FeatureTable::column(const std::string& name) const {
  return columns[column_index(*this, name)];
}

std::vector<double>& FeatureTable::column(const std::string& name) {
  return columns[column_index(*this, name)];
}

void FeatureTable::keep(const std::vector<std::uint8_t>& marks) {
  const auto filter = [&](auto& values) {
    std::size_t kept = 0;
    for (std::size_t row = 0; row < marks.size(); ++row) {
      if (marks[row] != 0) values[kept++] = values[row];
    }
    values.resize(kept);
  };
  for (std::vector<double>& column : columns) filter(column);
  filter(frames);
}

FeatureTable read_features(const fs::path& session, const std::vector<std::string>& names) {
  std::vector<NamedFeature> wanted;
  std::size_t before = 0;
  for (const std::string& name : names) {
    wanted.emplace_back(name);
    before = std::max(before, wanted.back().frames() - 1);
  }
  const SessionReader reader(session);
  const FrameRange range = training_frames(reader);
  if (range.count == 0) {
    throw InputError(session.string() + ": no training frames; screed record makes them");
  }
  before = std::min<std::size_t>(before, range.first);
  std::vector<SimFrame> frames(before + range.count);
  reader.read(range.first - before, std::span(frames));

  FeatureTable table;
  table.source = reader.info().experiment_name;
  table.content_hash = reader.content_hash();
  table.names = names;
  table.columns.assign(names.size(), std::vector<double>(range.count));
  for (std::size_t row = 0; row < range.count; ++row) {
    table.frames.push_back(range.first + row);
    const FrameWindow window(std::span<const SimFrame>(frames).first(before + row + 1));
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const double value = wanted[i].value(window);
      if (!std::isfinite(value)) {
        throw InputError(session.string() + ": frame " + std::to_string(range.first + row) + ": " +
                         names[i] + " is not a finite number");
      }
      table.columns[i][row] = value;
    }
  }
  return table;
}

fs::path find_session(const fs::path& folder, const std::string& name) {
  const auto file_in = [](const fs::path& run) { return run / "session.h5"; };
  if (fs::is_regular_file(file_in(folder / name))) return file_in(folder / name);
  fs::path newest;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string run = entry.path().filename().string();
    const bool numbered =
        run.size() == name.size() + 5 && run.starts_with(name + "-") &&
        std::all_of(run.end() - 4, run.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (numbered && fs::is_regular_file(file_in(entry.path())) && entry.path() > newest) {
      newest = entry.path();
    }
  }
  if (newest.empty()) {
    throw InputError(folder.string() + ": no session " + name +
                     "; screed record makes it, and make sessions all of them");
  }
  return file_in(newest);
}

}  // namespace screed::nn
