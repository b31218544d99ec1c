// `screed attitude FILES...`: how far is the attitude estimator from an optical reference?
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace screed {

/// Errors of the estimator over one recording, root of the mean square over the counted samples.
struct AttitudeScore {
  std::string file;
  long samples = 0;                  ///< counted: `moving` is 1 and the reference is present
  double rms_inclination_deg = 0.0;  ///< angle between estimated and true vertical
  double rms_heading_deg = 0.0;      ///< angle left about the vertical
};

/// Runs the estimator over a recording in CSV (host_sim/core/csv_file.h): a line of column names,
/// then numbers. Needed columns, in any order: gx gy gz ax ay az mx my mz (counts, int16; with `si`
/// rad/s, m/s2 and any unit of the field; rounded to whole counts), qw qx qy qz (reference, sensor
/// to earth; all four empty where there is none), moving (0 or 1). If there is a column t_ms, it
/// must rise by 10. Throws InputError with file and line for anything else, when no sample counts,
/// and for accelerations too small to be counts.
AttitudeScore score_attitude(const std::string& file, bool si = false);

/// Scores every file and prints a table with the mean, or JSON. Returns 0; throws InputError.
int run_attitude(const std::vector<std::string>& files, bool si, bool json, std::ostream& out);

}  // namespace screed
