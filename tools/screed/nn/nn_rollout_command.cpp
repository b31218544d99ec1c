// `screed nn rollout|divergence`: what stands in for the physics is driven beside it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "host_sim/core/statistics.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/standin/planar_pose.h"
#include "nn/model/model_file.h"
#include "nn/surrogate/rollout.h"
#include "nn/surrogate/slip_law.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/nn/rollout_picture.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr double kPercent = 100.0;
constexpr double kDegrees = 57.29577951308232;

struct RolloutArguments {
  std::vector<std::string> sessions;
  std::vector<std::string> models;
  std::size_t starts = 0;
  std::string drive = "firmware";
  std::string out;
};

struct RolloutColumn {
  std::vector<double> place;
  std::vector<double> heading;
};

/// Errors of all rollouts of a stand-in after one of the ways: of straight ways, or of others.
RolloutColumn column_of(const std::vector<nn::SessionRollouts>& all, std::size_t surrogate,
                        std::size_t distance, bool straight) {
  RolloutColumn column;
  for (const nn::SessionRollouts& session : all) {
    for (const nn::Rollout& rollout : session.by_surrogate[surrogate]) {
      const nn::RolloutCheck& check = rollout.checks.at(distance);
      if (!check.reached || check.straight != straight) continue;
      column.place.push_back(kPercent * check.position_error);
      column.heading.push_back(kDegrees * check.heading_error_rad);
    }
  }
  return column;
}

void print_table(const std::vector<nn::SessionRollouts>& all,
                 const std::vector<nn::SurrogateFactory>& surrogates, bool straight) {
  std::printf("  %-24s", straight ? "straight paths" : "paths with turns");
  for (const double distance : nn::kRolloutDistances_m) std::printf(" | %26.0f m", distance);
  std::printf("\n  %-24s", "");
  for (std::size_t i = 0; i < nn::kRolloutDistances_m.size(); ++i) {
    std::printf(" | %4s %7s %7s %7s", "n", "place", "p90", "head");
  }
  std::printf("\n");
  for (std::size_t i = 0; i < surrogates.size(); ++i) {
    std::printf("  %-24s", surrogates[i].name.c_str());
    for (std::size_t distance = 0; distance < nn::kRolloutDistances_m.size(); ++distance) {
      const RolloutColumn column = column_of(all, i, distance, straight);
      if (column.place.empty()) {
        std::printf(" | %4d %7s %7s %7s", 0, "-", "-", "-");
        continue;
      }
      std::printf(" | %4zu %6.2f%% %6.2f%% %6.1f\u00b0", column.place.size(),
                  quantile(column.place, 0.5), quantile(column.place, 0.9),
                  quantile(column.heading, 0.5));
    }
    std::printf("\n");
  }
}

/// Of resampled sessions, all rollouts of a session together: what other sessions of this kind
/// would have shown. Values by session; quantiles 2.5 % and 97.5 % of a quantile.
std::array<double, 2> range_of(const std::vector<std::vector<double>>& by_session, double share) {
  constexpr int kResamples = 2000;
  WorldRandom random(1, "resampled sessions");
  std::vector<double> found;
  for (int i = 0; i < kResamples; ++i) {
    std::vector<double> values;
    for (std::size_t k = 0; k < by_session.size(); ++k) {
      const auto which =
          static_cast<std::size_t>(random.uniform() * static_cast<double>(by_session.size()));
      values.insert(values.end(), by_session[which].begin(), by_session[which].end());
    }
    found.push_back(quantile(values, share));
  }
  return {quantile(found, 0.025), quantile(found, 0.975)};
}

/// After the last of the ways, with 95 % ranges, and how the robots wagged.
void print_ranges(const std::vector<nn::SessionRollouts>& all,
                  const std::vector<nn::SurrogateFactory>& surrogates, bool straight) {
  const std::size_t distance = nn::kRolloutDistances_m.size() - 1;
  std::printf("  %-24s | after %.0f m, 95 %% ranges over sessions | rate of turn, s.d. (physics)\n",
              straight ? "straight paths" : "paths with turns",
              nn::kRolloutDistances_m.at(distance));
  for (std::size_t i = 0; i < surrogates.size(); ++i) {
    std::vector<std::vector<double>> by_session;
    std::vector<double> values;
    std::vector<double> wags;
    std::vector<double> real;
    for (const nn::SessionRollouts& session : all) {
      const RolloutColumn column = column_of({session}, i, distance, straight);
      if (!column.place.empty()) by_session.push_back(column.place);
      values.insert(values.end(), column.place.begin(), column.place.end());
      for (const nn::Rollout& rollout : session.by_surrogate[i]) {
        const nn::RolloutCheck& check = rollout.checks.at(distance);
        if (!check.reached || check.straight != straight) continue;
        wags.push_back(kDegrees * rollout.yaw_rate_deviation_rad_per_s);
        real.push_back(kDegrees * rollout.recorded_yaw_rate_deviation_rad_per_s);
      }
    }
    if (values.empty()) continue;
    const std::array<double, 2> middle = range_of(by_session, 0.5);
    const std::array<double, 2> high = range_of(by_session, 0.9);
    std::printf(
        "  %-24s | n %zu of %zu, median %.2f%% (%.2f to %.2f), p90 %.2f%% (%.2f to %.2f) | "
        "%.1f\u00b0/s (%.1f\u00b0/s)\n",
        surrogates[i].name.c_str(), values.size(), by_session.size(), quantile(values, 0.5),
        middle[0], middle[1], quantile(values, 0.9), high[0], high[1], quantile(wags, 0.5),
        quantile(real, 0.5));
  }
}

/// By how much the first is nearer to the recording than each of the others, from the same starts:
/// median of the differences and its 95 % range over sessions.
void print_paired(const std::vector<nn::SessionRollouts>& all,
                  const std::vector<nn::SurrogateFactory>& surrogates, bool straight) {
  const std::size_t distance = nn::kRolloutDistances_m.size() - 1;
  for (std::size_t i = 1; i < surrogates.size(); ++i) {
    std::vector<std::vector<double>> by_session;
    std::vector<double> values;
    for (const nn::SessionRollouts& session : all) {
      const RolloutColumn own = column_of({session}, 0, distance, straight);
      RolloutColumn column = column_of({session}, i, distance, straight);
      if (column.place.empty()) continue;
      for (std::size_t k = 0; k < column.place.size(); ++k) column.place[k] -= own.place[k];
      by_session.push_back(column.place);
      values.insert(values.end(), column.place.begin(), column.place.end());
    }
    if (values.empty()) continue;
    const std::array<double, 2> range = range_of(by_session, 0.5);
    std::printf("  %s nearer than %s: median %.2f%% (%.2f to %.2f) of the distance\n",
                surrogates[0].name.c_str(), surrogates[i].name.c_str(), quantile(values, 0.5),
                range[0], range[1]);
  }
}

/// How far one stand-in leads from another: distance of the robots at the end of every rollout's
/// way, in per cent of it.
void print_divergence(const std::vector<nn::SessionRollouts>& all, std::size_t one,
                      std::size_t other, const std::string& what) {
  std::vector<double> divergence;
  for (const nn::SessionRollouts& session : all) {
    for (std::size_t i = 0; i < session.real.size(); ++i) {
      const auto& a = session.by_surrogate[one][i].path;
      const auto& b = session.by_surrogate[other][i].path;
      double distance = 0.0;
      for (std::size_t k = 1; k < a.size(); ++k) {
        distance += portable::hypot(a[k].x_m - a[k - 1].x_m, a[k].y_m - a[k - 1].y_m);
      }
      divergence.push_back(
          kPercent * portable::hypot(a.back().x_m - b.back().x_m, a.back().y_m - b.back().y_m) /
          distance);
    }
  }
  if (divergence.empty()) {
    std::printf("  %s: no distance was driven\n", what.c_str());
    return;
  }
  std::printf("  %s: median %.4f %%, p90 %.4f %% of the distance\n", what.c_str(),
              quantile(divergence, 0.5), quantile(divergence, 0.9));
}

/// The model in floating point with one part in 10^9 on its outputs. How far that leads tells which
/// differences are the loop's own (firmware, counts of sensors), whatever the arithmetic.
nn::Model nudged(nn::Model model) {
  for (nn::ModelNetwork& network : model.networks) {
    for (double& bias : network.trained.back().bias) bias += 1e-9;
  }
  return model;
}

/// `floats`: where the checks of a model's arithmetic begin, two each, whose paths would cover its
/// own.
void draw(const fs::path& folder, const nn::SessionRollouts& session,
          const std::vector<nn::SurrogateFactory>& surrogates,
          const std::vector<std::size_t>& floats, const std::string& drive) {
  constexpr std::size_t kMaxPictures = 3;
  for (std::size_t i = 0; i < std::min(kMaxPictures, session.real.size()); ++i) {
    const std::size_t which = i * session.real.size() / std::min(kMaxPictures, session.real.size());
    RolloutPicture picture;
    picture.title = session.source + ", from frame " +
                    std::to_string(session.by_surrogate[0][which].start) + ", " + drive + " drive";
    // Paths are recorded from the first tenth of a second on.
    const auto from_start = [&](const std::vector<PlanarPose>& path) {
      std::vector<PlanarPose> whole = {session.starts[which]};
      whole.insert(whole.end(), path.begin(), path.end());
      return whole;
    };
    picture.physics = from_start(session.real[which]);
    for (std::size_t s = 0; s < surrogates.size(); ++s) {
      const auto checks = [s](std::size_t first) { return s == first || s == first + 1; };
      if (std::any_of(floats.begin(), floats.end(), checks)) continue;
      picture.predictions.push_back(
          {surrogates[s].name, from_start(session.by_surrogate[s][which].path)});
    }
    const fs::path file =
        folder / (session.source + "-" + drive + "-" + std::to_string(i + 1) + ".svg");
    write_file(file, rollout_svg(picture));
    std::printf("  %s\n", file.c_str());
  }
}

/// What a stand-in must beat, fitted to a drive; without one their names alone count.
std::vector<nn::SurrogateFactory> baselines_of(const std::vector<nn::MotionSeries>& drive) {
  const nn::SupportGeometry geometry;
  const nn::TrackKinematics no_slip = nn::skid_kinematics(1.0, 2.0 * TrackGeometry{}.half_tread_m);
  std::vector<nn::SurrogateFactory> baselines = {
      {"no slip", [=] { return nn::Surrogate(no_slip, geometry, 1); }}};
  for (const nn::SlipLaw law :
       {nn::SlipLaw::kConstant, nn::SlipLaw::kBySlope, nn::SlipLaw::kRotationCentres,
        nn::SlipLaw::kRotationCentresAndSlope}) {
    const nn::TrackKinematics fitted = nn::fitted_kinematics(law, drive);
    baselines.push_back({nn::name_of(law), [=] { return nn::Surrogate(fitted, geometry, 1); }});
  }
  return baselines;
}

/// Whether the recorded robots had tracks; all or none of them.
bool on_tracks(const std::vector<std::string>& sessions) {
  const auto tracks = [](const std::string& session) {
    return read_experiment(fs::path(session) / "experiment.ini").vehicle.tracks;
  };
  for (const std::string& session : sessions) {
    if (tracks(session) == tracks(sessions.front())) continue;
    throw InputError(session + ": [vehicle] tracks differs from that of " + sessions.front() +
                     "; allowed are sessions on tracks, or sessions on wheels");
  }
  return tracks(sessions.front());
}

int run_rollout(const RolloutArguments& arguments) {
  nn::RolloutOptions options;
  options.starts = arguments.starts;
  options.drive =
      arguments.drive == "tracks" ? nn::RolloutDrive::kTracks : nn::RolloutDrive::kFirmware;
  // The stand-in knows tracks alone.
  const bool stand_in = on_tracks(arguments.sessions);
  std::vector<nn::SurrogateFactory> surrogates;
  if (stand_in) surrogates.push_back({"stand-in", {}});
  const std::size_t baselines = surrogates.size();
  const std::vector<nn::SurrogateFactory> first = baselines_of({});
  surrogates.insert(surrogates.end(), first.begin(), first.end());
  std::vector<std::size_t> floats;
  const nn::SupportGeometry geometry;
  for (const std::string& file : arguments.models) {
    const auto model = std::make_shared<const nn::Model>(nn::read_model(file));
    surrogates.push_back({model->name, [=] { return nn::Surrogate(*model, geometry, 1); }});
    if (model->networks.front().trained.empty()) continue;
    floats.push_back(surrogates.size());
    for (const auto& [name, floating] :
         {std::pair{model->name + ", floating", model},
          {model->name + ", 1e-9 off", std::make_shared<const nn::Model>(nudged(*model))}}) {
      surrogates.push_back({name, [=, which = floating] {
                              return nn::Surrogate(*which, geometry, 1,
                                                   nn::Surrogate::Arithmetic::kFloat);
                            }});
    }
  }
  std::vector<nn::SessionRollouts> all;
  for (std::size_t i = 0; i < arguments.sessions.size(); ++i) {
    ProgressBar bar(std::cerr);
    options.progress = [&](std::string_view task, double share) {
      bar.show_share(share, std::to_string(i + 1) + "/" +
                                std::to_string(arguments.sessions.size()) + " " +
                                std::string(task));
    };
    const std::vector<nn::SurrogateFactory> fitted =
        baselines_of({nn::read_motion_series(arguments.sessions[i])});
    std::copy(fitted.begin(), fitted.end(),
              surrogates.begin() + static_cast<std::ptrdiff_t>(baselines));
    all.push_back(nn::roll_out(arguments.sessions[i], surrogates, options));
    bar.clear();
    std::printf("\n%s, %s drive\n", all.back().source.c_str(), arguments.drive.c_str());
    for (const bool straight : {true, false}) print_table({all.back()}, surrogates, straight);
    std::fflush(stdout);
  }
  if (all.size() > 1) {
    std::printf("\nall sessions\n");
    for (const bool straight : {true, false}) print_table(all, surrogates, straight);
    for (const bool straight : {true, false}) {
      print_ranges(all, surrogates, straight);
      if (stand_in) print_paired(all, surrogates, straight);
    }
  }
  std::printf("\n");
  for (const std::size_t floating : floats) {
    print_divergence(all, floating - 1, floating,
                     surrogates[floating - 1].name + ", integers from floating point");
    print_divergence(all, floating + 1, floating, surrogates[floating + 1].name);
  }
  if (!arguments.out.empty()) {
    fs::create_directories(arguments.out);
    for (const nn::SessionRollouts& session : all) {
      draw(arguments.out, session, surrogates, floats, arguments.drive);
    }
  }
  return 0;
}

struct DivergenceArguments {
  std::vector<std::string> sessions;
};

int run_divergence(const DivergenceArguments& arguments) {
  if (arguments.sessions.size() % 2 != 0) {
    throw InputError("screed nn divergence: an odd number of sessions; allowed are pairs");
  }
  nn::SessionRollouts pairs;
  pairs.by_surrogate.resize(1);
  for (std::size_t i = 0; i < arguments.sessions.size(); i += 2) {
    pairs.by_surrogate[0].push_back(
        nn::divergence(arguments.sessions[i], arguments.sessions[i + 1]));
  }
  for (const bool straight : {true, false}) {
    print_table({pairs}, {{"physics", {}}}, straight);
  }
  return 0;
}

}  // namespace

void register_nn_rollout_command(Command& nn, Program& program) {
  auto rollout = std::make_shared<RolloutArguments>();
  Command* rollout_command = nn.add_subcommand(
      "rollout", "Compare the stand-in's motion, and that of networks, with recorded physics");
  rollout_command->add_option("SESSION", rollout->sessions, "Run folders of screed record")
      ->required();
  rollout_command
      ->add_option("--model", rollout->models, "Model files of networks to be rolled out as well")
      ->type_name("FILE");
  add_number(*rollout_command, "--starts", rollout->starts,
             "Number of rollouts per session, spread evenly; 0: each begins where the previous one "
             "ends",
             {0, 100000});
  rollout_command
      ->add_option("--drive", rollout->drive,
                   "Input of the rollout: firmware: the firmware drives and measures the predicted "
                   "motion; tracks: recorded track motion")
      ->show_default()
      ->one_of({"firmware", "tracks"});
  rollout_command
      ->add_option("--out", rollout->out,
                   "Output folder for pictures of some rollouts: paths, and deviation "
                   "from the physics over the distance")
      ->type_name("FOLDER");
  rollout_command->callback(
      [rollout, &program] { program.action = [rollout] { return run_rollout(*rollout); }; });

  auto divergence = std::make_shared<DivergenceArguments>();
  Command* divergence_command = nn.add_subcommand(
      "divergence", "Measure how far pairs of recorded sessions diverge: physics against physics");
  divergence_command
      ->add_option("SESSION", divergence->sessions, "Run folders of screed record, in pairs")
      ->required();
  divergence_command->callback([divergence, &program] {
    program.action = [divergence] { return run_divergence(*divergence); };
  });
}

}  // namespace screed
