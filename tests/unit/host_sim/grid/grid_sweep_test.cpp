// Sweeps, recordings and charts of the grid world: what is kept in files.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/task_worker.h"
#include "host_sim/grid/grid_figures.h"
#include "host_sim/grid/grid_recording.h"
#include "host_sim/grid/grid_sweep.h"
#include "host_sim/render/chart/line_chart.h"
#include "tests/temp_folder.h"

namespace screed::testing {
namespace {

class GridFiles : public ::testing::Test {
 protected:
  TempFolder temporary_;
  std::filesystem::path folder_ = temporary_.path();
};

std::vector<SweepPoint> small_sweep() {
  GridConfig config;
  config.noise.width = config.noise.height = 8;
  config.agents = 4;
  config.algorithm = GridAlgorithm::kForager;
  GridConfig other = config;
  other.algorithm = GridAlgorithm::kProbabilistic;
  return {{"ours", 0.0, config}, {"theirs", 1.0, other}};
}

SweepOptions options_of(const std::filesystem::path& folder, int runs) {
  SweepOptions options;
  options.folder = folder;
  options.table = folder / "runs.csv";
  options.version = "1.2.3";
  options.runs = runs;
  return options;
}

/// What a worker would do: executes the first runs of each point.
void serve(const std::filesystem::path& path, const std::vector<SweepPoint>& points, size_t runs,
           const std::string& version = "1.2.3") {
  const TaskFolder folder{path};
  std::filesystem::create_directories(path);
  write_text(folder.plan(), sweep_plan_text(make_sweep_plan(points, version)));
  std::vector<size_t> tasks(points.size() * runs);
  std::iota(tasks.begin(), tasks.end(), size_t{0});
  std::istringstream requests(execute_request(tasks, 1));
  serve_sweep(folder, version, requests, [](const std::string& text) {
    const WorkerAnswer answer = parse_answer(text);
    EXPECT_EQ(answer.kind, WorkerAnswer::Kind::kDone) << text;
    EXPECT_TRUE(answer.failures.empty()) << text;
  });
}

/// A configuration that differs from all others here and from the default in every value.
GridConfig unusual(const std::filesystem::path& image) {
  GridConfig config;
  config.algorithm = GridAlgorithm::kMemetic2;
  config.seed = 12345678901234567890U;
  config.agents = 3;
  config.max_cycles = 77;
  config.stop = {GridStop::kDeviation, 0.1 + 0.2};
  config.noise = {9, 8, 4.0 / 3.0, 2.0 / 3.0, 7.0 / 3.0, GridBorder::kTorus};
  config.image = image;
  config.image_width = 5;
  config.image_height = 4;
  config.white = 10.0 / 3.0;
  config.image_mean = 5.0 / 3.0;
  config.p_sense = 1.0 / 3.0;
  config.p_turn = 1.0 / 7.0;
  config.p_pick_up = 1.0 / 9.0;
  config.p_deposit = 1.0 / 11.0;
  config.k = 13.0 / 3.0;
  config.memory = 7;
  config.fitness_threshold = 1.0 / 13.0;
  config.chromosomes = 4;
  config.repetitions = 3;
  config.fitness_base = FitnessBase::kAttempted;
  config.averaging = 99;
  config.dead_band = 1.0 / 17.0;
  config.patience = 11;
  config.hold_out = 12;
  config.follows_slope = true;
  config.turns_back = false;
  return config;
}

TEST_F(GridFiles, PlanOfASweepIsReadBack) {
  std::filesystem::copy_file("host_sim/data/terrain/terrain_a.png", folder_ / "image.png");
  const SweepPlan plan = make_sweep_plan(
      {{"a", 0.0, unusual(folder_ / "image.png")}, {"b", 1.0, GridConfig()}}, "1.2.3");
  write_text(folder_ / "plan.json", sweep_plan_text(plan));
  const SweepPlan read = read_sweep_plan(folder_ / "plan.json");
  EXPECT_EQ(read.version, "1.2.3");
  EXPECT_EQ(read.ids, plan.ids);
  ASSERT_EQ(read.points.size(), 2U);
  // Each value to the last bit, in the text and in what workers use.
  EXPECT_EQ(sweep_plan_text(read), sweep_plan_text(plan));
  EXPECT_EQ(describe(read.points[0]), describe(unusual(folder_ / "image.png")));
  EXPECT_EQ(read.points[0].stop.epsilon, 0.1 + 0.2);
  EXPECT_EQ(read.points[0].noise.mean, 4.0 / 3.0);
  EXPECT_EQ(identity_of(read.points[0], "1.2.3"), plan.ids[0]);
  EXPECT_EQ(run_grid(read.config_of(2)), run_grid(plan.config_of(2)));

  for (const std::string& damage : {std::string("{}"), std::string("[]"), std::string(),
                                    read_text(folder_ / "plan.json").substr(0, 500)}) {
    write_text(folder_ / "damaged.json", damage);
    EXPECT_THROW(read_sweep_plan(folder_ / "damaged.json"), InputError) << damage;
  }
  EXPECT_THROW(read_sweep_plan(folder_ / "gone.json"), InputError);
}

TEST_F(GridFiles, IdentityOfARunIsAllThatDecidesIt) {
  const GridConfig base;
  std::set<std::string> ids = {identity_of(base, "1"), identity_of(base, "2")};
  GridConfig changed = base;
  changed.seed = 2;
  ids.insert(identity_of(changed, "1"));
  changed = base;
  changed.p_pick_up = 0.3 + 1e-15;
  ids.insert(identity_of(changed, "1"));
  EXPECT_EQ(ids.size(), 4U);
  // What is not given has the value that it would be given.
  EXPECT_EQ(identity_of(with_defaults(base), "1"), identity_of(base, "1"));

  // The image counts by its bytes.
  std::filesystem::copy_file("host_sim/data/terrain/terrain_a.png", folder_ / "image.png");
  write_text(folder_ / "other.png", read_text(folder_ / "image.png") + "x");
  GridConfig image = base;
  image.image = folder_ / "image.png";
  const std::string id = identity_of(image, "1");
  image.image = folder_ / "other.png";
  EXPECT_NE(identity_of(image, "1"), id);
}

using GridSweep = GridFiles;

TEST_F(GridSweep, HasTheRunsOfItsSeeds) {
  serve(folder_, small_sweep(), 3);
  const SweepResult sweep = run_sweep(small_sweep(), options_of(folder_, 3));
  EXPECT_TRUE(sweep.complete);
  EXPECT_EQ(sweep.resumed, 6U);
  ASSERT_EQ(sweep.results.size(), 2U);
  GridConfig config = small_sweep()[1].config;
  config.seed += 2;
  ASSERT_EQ(sweep.results[1].size(), 3U);
  EXPECT_EQ(sweep.results[1][2], run_grid(config));
  const std::string table = read_text(folder_ / "runs.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2 + 6);
  const GridResult r = sweep.results[1][2];
  std::ostringstream line;
  line << "\n1,2,3," << r.level << ',' << r.cycles << ',' << r.units << ',' << r.min_units << ','
       << r.straight << ',' << r.diagonal << '\n';
  EXPECT_NE(table.find(line.str()), std::string::npos) << table;
}

TEST_F(GridSweep, FewerRunsAreReadWithoutLoss) {
  serve(folder_, small_sweep(), 6);
  run_sweep(small_sweep(), options_of(folder_, 6));
  const std::string table = read_text(folder_ / "runs.csv");
  const SweepResult fewer = run_sweep(small_sweep(), options_of(folder_, 2));
  EXPECT_EQ(fewer.results[1].size(), 2U);
  EXPECT_EQ(fewer.resumed, 4U);
  EXPECT_EQ(read_text(folder_ / "runs.csv"), table);
}

TEST_F(GridSweep, SaysWhatIsOddAboutItsResults) {
  serve(folder_, small_sweep(), 2, "1.2.2");
  serve(folder_, small_sweep(), 2);
  SweepOptions options = options_of(folder_, 2);
  std::vector<std::string> notes;
  options.note = [&notes](const std::string& note) { notes.push_back(note); };
  EXPECT_EQ(run_sweep(small_sweep(), options).resumed, 4U);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes[0].starts_with("4 results are of other")) << notes[0];
}

TEST_F(GridSweep, RefusesFilesOfOthers) {
  serve(folder_, small_sweep(), 2);
  run_sweep(small_sweep(), options_of(folder_, 1));
  auto other = small_sweep();
  other[1].config.p_pick_up = 0.31;
  EXPECT_THROW(run_sweep(other, options_of(folder_, 1)), InputError);
  const std::string table = read_text(folder_ / "runs.csv");
  write_text(folder_ / "runs.csv", "Dear Madam,\nthank you\nfor nothing\n");
  EXPECT_THROW(run_sweep(small_sweep(), options_of(folder_, 1)), InputError);
  EXPECT_EQ(read_text(folder_ / "runs.csv"), "Dear Madam,\nthank you\nfor nothing\n");
  // A table of this sweep that holds more than is stored here.
  write_text(folder_ / "runs.csv", table + "1,2,3,1,5,6,7,8,9\n");
  EXPECT_THROW(run_sweep(small_sweep(), options_of(folder_, 2)), InputError);
  // One that was hardly begun.
  write_text(folder_ / "runs.csv", table.substr(0, 30));
  EXPECT_TRUE(run_sweep(small_sweep(), options_of(folder_, 2)).complete);
  EXPECT_EQ(read_text(folder_ / "runs.csv"), table);
  EXPECT_THROW(run_sweep(small_sweep(), options_of({}, 0)), InputError);
}

TEST(GridResult, IsReadBack) {
  const GridResult result{true, 18446744073709551615U, 2, 3, 4, 5};
  const std::string text = result_text(result);
  EXPECT_EQ(parse_result(text), result);
  EXPECT_EQ(parse_result(result_text({})), GridResult());
  EXPECT_EQ(Json::parse(text)["cycles"], 18446744073709551615U);
  for (const std::string& bad : {std::string(), std::string("{}"), text.substr(0, 40)})
    EXPECT_THROW(parse_result(bad), RunError) << bad;
}

TEST_F(GridSweep, AnImageMayNotChangeMeanwhile) {
  std::filesystem::copy_file("host_sim/data/terrain/terrain_a.png", folder_ / "image.png");
  GridConfig config = small_sweep()[0].config;
  config.image = folder_ / "image.png";
  config.image_width = config.image_height = 8;
  SweepPlan plan = make_sweep_plan({{"image", 0.0, config}}, "1.2.3");
  plan.ids[0] = std::string(32, '0');  // as of other bytes
  const TaskFolder folder{folder_ / "sweep"};
  std::filesystem::create_directories(folder.path);
  write_text(folder.plan(), sweep_plan_text(plan));
  std::istringstream requests(execute_request({0}, 1));
  std::string said;
  serve_sweep(folder, "1.2.3", requests, [&said](const std::string& text) { said = text; });
  const WorkerAnswer answer = parse_answer(said);
  ASSERT_EQ(answer.failures.size(), 1U) << said;
  EXPECT_NE(answer.failures[0].second.find("image"), std::string::npos);
}

TEST(GridSummary, IsTextbookStatistics) {
  const Summary summary = summarise({2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0});
  EXPECT_DOUBLE_EQ(summary.mean, 5.0);
  // Sample deviation sqrt(32 / 7), over sqrt(8).
  EXPECT_NEAR(summary.standard_error, std::sqrt(32.0 / 7.0 / 8.0), 1e-12);
  EXPECT_EQ(summary.minimum, 2.0);
  EXPECT_EQ(summary.maximum, 9.0);
  EXPECT_EQ(summarise({3.0}).standard_error, 0.0);
}

TEST(GridFigure, EveryNameHasItsPoints) {
  for (const std::string& name : grid_figure_names()) {
    const GridFigure figure = grid_figure(name, GridConfig());
    EXPECT_FALSE(figure.points.empty());
    EXPECT_EQ(figure.points.size() % figure.series.size(), 0U);
    for (const SweepPoint& point : figure.points) EXPECT_NO_THROW(check(point.config));
  }
  EXPECT_THROW(grid_figure("4.1", GridConfig()), InputError);
}

using GridRecording = GridFiles;

TEST_F(GridRecording, ReplaysEveryCycle) {
  GridConfig config;
  config.algorithm = GridAlgorithm::kForager;
  GridRun run(config);
  std::vector<GridFrame> frames = {frame_of(run)};
  GridRecorder recorder(folder_ / "run.h5", run, "test");
  for (int i = 0; i < 2500; ++i) {  // more than two chunks
    run.cycle();
    recorder.add_cycle(run);
    if (i % 250 == 0) frames.push_back(frame_of(run));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5"));  // not before it is complete
  recorder.finish(run);

  GridReplay replay(folder_ / "run.h5");
  EXPECT_EQ(replay.cycles(), 2500U);
  EXPECT_EQ(replay.value("algorithm"), "forager");
  size_t next = 0;
  while (true) {
    if (next < frames.size() && replay.frame().cycle == frames[next].cycle) {
      const GridFrame& frame = frames[next++];
      ASSERT_EQ(replay.frame().terrain.heights, frame.terrain.heights);
      ASSERT_EQ(replay.frame().units, frame.units);
      for (size_t i = 0; i < frame.agents.size(); ++i) {
        ASSERT_EQ(replay.frame().agents[i].x, frame.agents[i].x);
        ASSERT_EQ(replay.frame().agents[i].y, frame.agents[i].y);
        ASSERT_EQ(replay.frame().agents[i].carries, frame.agents[i].carries);
      }
    }
    if (replay.finished()) break;
    replay.cycle();
  }
  EXPECT_EQ(next, frames.size());
  EXPECT_TRUE(replay.matches());
}

TEST_F(GridRecording, OverwritesNothingAndLeavesNothingHalf) {
  const GridRun run((GridConfig()));
  write_text(folder_ / "taken.h5", "mine");
  EXPECT_THROW(GridRecorder(folder_ / "taken.h5", run, "test"), InputError);
  EXPECT_EQ(read_text(folder_ / "taken.h5"), "mine");
  { const GridRecorder abandoned(folder_ / "run.h5", run, "test"); }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5.partial"));
  EXPECT_THROW(GridRecorder(folder_ / "none" / "run.h5", run, "test"), RunError);
}

TEST_F(GridRecording, RefusesWhatIsNoRecording) {
  EXPECT_THROW(GridReplay(folder_ / "missing.h5"), InputError);
  write_text(folder_ / "text.h5", "no HDF5 at all");
  EXPECT_THROW(GridReplay(folder_ / "text.h5"), InputError);
  const hid_t other =
      H5Fcreate((folder_ / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(other);
  EXPECT_THROW(GridReplay(folder_ / "other.h5"), InputError);

  // A damaged byte in the middle of the tables.
  GridConfig config;
  config.algorithm = GridAlgorithm::kForager;
  GridRun run(config);
  GridRecorder recorder(folder_ / "run.h5", run, "test");
  for (int i = 0; i < 1500; ++i) {
    run.cycle();
    recorder.add_cycle(run);
  }
  recorder.finish(run);
  std::string bytes = read_text(folder_ / "run.h5");
  write_text(folder_ / "short.h5", bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(GridReplay(folder_ / "short.h5"), InputError);
}

TEST(LineChart, DrawsEveryPointWithItsErrorBar) {
  Chart chart;
  chart.title = "a < b & c";
  chart.x_label = "x";
  chart.y_label = "y";
  chart.series = {{"one", {{0.0, 10.0, 1.0}, {1.0, 20.0, 2.0}, {2.0, 15.0}}, true}};
  const std::string svg = chart_svg(chart);
  const auto count = [&svg](const std::string& what) {
    int found = 0;
    for (size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<circle"), 3);
  EXPECT_EQ(count("<polyline"), 1);
  EXPECT_EQ(count("stroke-width=\"1.4\""), 6);  // two error bars of three strokes
  EXPECT_NE(svg.find("a &lt; b &amp; c"), std::string::npos);
  // The upright stroke of the first error bar, y = 9 to 11, against the way through 10 and 20.
  double x[3];
  double y[3];
  ASSERT_EQ(std::sscanf(svg.c_str() + svg.find("points=\""), "points=\"%lf,%lf %lf,%lf %lf,%lf",
                        &x[0], &y[0], &x[1], &y[1], &x[2], &y[2]),
            6);
  const size_t end = svg.find("stroke-width=\"1.4\"");
  double x1 = 0.0;
  double y1 = 0.0;
  double x2 = 0.0;
  double y2 = 0.0;
  ASSERT_EQ(std::sscanf(svg.c_str() + svg.rfind("<line", end),
                        "<line x1=\"%lf\" y1=\"%lf\" x2=\"%lf\" y2=\"%lf\"", &x1, &y1, &x2, &y2),
            4);
  const double unit_px = (y[0] - y[1]) / 10.0;
  EXPECT_EQ(x1, x[0]);
  EXPECT_EQ(x2, x[0]);
  EXPECT_NEAR(y1, y[0] - unit_px, 0.02);
  EXPECT_NEAR(y2, y[0] + unit_px, 0.02);
  EXPECT_EQ(chart_svg(chart), svg);
}

TEST(LineChart, PutsPointsWhereTheAxesSay) {
  Chart chart;
  chart.series = {{"", {{0.0, 0.0}, {10.0, 100.0}}, true}};
  const std::string svg = chart_svg(chart);
  // The ends of the way lie on the lowest and the highest grid line.
  double first_x = 0.0;
  double first_y = 0.0;
  double last_x = 0.0;
  double last_y = 0.0;
  const size_t at = svg.find("points=\"");
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(std::sscanf(svg.c_str() + at, "points=\"%lf,%lf %lf,%lf", &first_x, &first_y, &last_x,
                        &last_y),
            4);
  EXPECT_LT(first_x, last_x);
  EXPECT_GT(first_y, last_y);  // y grows upwards
  char line[60];
  std::snprintf(line, sizeof line, "y1=\"%g\"", first_y);
  EXPECT_NE(svg.find(line), std::string::npos);
  std::snprintf(line, sizeof line, "y1=\"%g\"", last_y);
  EXPECT_NE(svg.find(line), std::string::npos);
}

TEST(LineChart, BarsStandOnZero) {
  Chart chart;
  chart.kind = ChartKind::kBars;
  chart.categories = {"a", "b"};
  chart.value_labels = true;
  chart.series = {{"one", {{0.0, 1234.0}, {1.0, 4321.0}}, true}};
  const std::string svg = chart_svg(chart);
  EXPECT_NE(svg.find(">1\u2009234</text>"), std::string::npos);
  EXPECT_NE(svg.find(">0</text>"), std::string::npos);
  EXPECT_NE(svg.find(">b</text>"), std::string::npos);
}

TEST(LineChart, RefusesWhatItCannotDraw) {
  Chart chart;
  EXPECT_THROW(chart_svg(chart), InputError);
  chart.series = {{"one", {{0.0, std::nan("")}}, true}};
  EXPECT_THROW(chart_svg(chart), InputError);
  chart.series = {{"one", {{0.0, 5.0}}, true}};
  EXPECT_NO_THROW(chart_svg(chart));  // a single point is a chart
  chart.width_px = 10;
  EXPECT_THROW(chart_svg(chart), InputError);
  chart.width_px = 760;
  EXPECT_THROW(write_chart("/nowhere/at/all.svg", chart), RunError);
}

}  // namespace
}  // namespace screed::testing
