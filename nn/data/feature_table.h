// Features of recorded sessions as columns of numbers, a row a frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace screed::nn {

/// One session. All columns are of the same length.
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
