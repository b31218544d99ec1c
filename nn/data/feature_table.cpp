// Sessions are read whole: 64,000 frames are some 20 MB.
#include "nn/data/feature_table.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host_sim/core/errors.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/session/session_reader.h"
#include "nn/data/features.h"

namespace screed::nn {
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
