// `screed grid`: the grid world of thesis 4.2, one run or thousands.
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <thread>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/grid/grid_figures.h"
#include "host_sim/grid/grid_recording.h"
#include "host_sim/grid/grid_run.h"
#include "host_sim/grid/grid_scene.h"
#include "host_sim/grid/grid_sweep.h"
#include "host_sim/grid/grid_text_view.h"
#include "host_sim/render/scene/povray.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

struct GridOptions {
  GridConfig config;
  std::string algorithm = "probabilistic";
  std::optional<std::string> size;
  std::optional<double> mean;
  std::optional<double> probability;
  std::string stop = "level";
  std::optional<double> epsilon;
  std::string border = "walls";
  std::string fitness_base = "executed";
  std::string follow_slope;
  std::string turn_back;
  int runs = 1;
  const Option* runs_option = nullptr;
  int workers = 0;
  std::string figure;
  std::string out;
  std::string record;
  std::string replay;
  std::string render;
  int render_width = 1600;
  std::string curve;
  double speed = 1000.0;
  bool headless = false;
  bool json = false;
  bool quiet = false;
};

/// "32" or "40x30" as width and height.
std::pair<int, int> parse_size(const std::string& text) {
  if (const auto sides = whole_pair(text)) return *sides;
  if (const auto side = finite_number<int>(text)) return {*side, *side};
  throw InputError("grid: size = " + text + "; allowed is cells a side, or WIDTHxHEIGHT");
}

template <class Value>
Value choice(const char* name, const std::string& text,
             std::initializer_list<std::pair<const char*, Value>> choices) {
  std::string all;
  for (const auto& [word, value] : choices) {
    if (text == word) return value;
    all += (all.empty() ? "" : ", ") + std::string(word);
  }
  throw InputError(std::string("grid: ") + name + " = " + text + "; allowed is " + all);
}

GridConfig config_of(const GridOptions& options) {
  GridConfig config = options.config;
  config.algorithm = grid_algorithm(options.algorithm);
  config.stop.measure = choice<GridStop>("stop", options.stop,
                                         {{"level", GridStop::kLevel},
                                          {"gradient", GridStop::kGradient},
                                          {"deviation", GridStop::kDeviation}});
  config.stop.epsilon =
      options.epsilon.value_or(config.stop.measure == GridStop::kDeviation  ? 0.5
                               : config.stop.measure == GridStop::kGradient ? 1.5
                                                                            : 1.0);
  config.noise.border = choice<GridBorder>(
      "border", options.border, {{"walls", GridBorder::kWalls}, {"torus", GridBorder::kTorus}});
  config.fitness_base = choice<FitnessBase>(
      "fitness-base", options.fitness_base,
      {{"executed", FitnessBase::kExecuted}, {"attempted", FitnessBase::kAttempted}});
  const auto yes_or_no = [](const char* name, const std::string& text) {
    return choice<bool>(name, text, {{"yes", true}, {"no", false}});
  };
  if (!options.follow_slope.empty()) {
    config.follows_slope = yes_or_no("follow-slope", options.follow_slope);
  }
  if (!options.turn_back.empty()) config.turns_back = yes_or_no("turn-back", options.turn_back);
  if (options.size.has_value()) {
    const auto [width, height] = parse_size(*options.size);
    config.noise.width = config.image_width = width;
    config.noise.height = config.image_height = height;
    // Zero means "as the image" in the configuration only.
    if (width == 0 || height == 0) config.image_width = config.image_height = -1;
  }
  if (options.mean) {
    config.noise.mean = *options.mean;
    config.image_mean = options.mean;
  }
  if (options.probability) config.p_pick_up = config.p_deposit = *options.probability;
  return config;
}

/// Where a live view is drawn: again and again over itself.
class LiveView {
 public:
  LiveView(std::string title, int lowest, int highest, double speed)
      : cycles_a_frame_(std::max(1.0, speed / kFrames_hz)),
        frame_time_(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
            std::chrono::duration<double>(cycles_a_frame_ / speed))) {
    options_.title = std::move(title);
    options_.lowest = lowest;
    options_.highest = highest;
    const char* colors = std::getenv("COLORTERM");
    const std::string term = colors == nullptr ? "" : colors;
    options_.true_color = term == "truecolor" || term == "24bit";
    std::fputs("\033[?25l\033[?7l", stdout);  // no cursor, long lines are cut
    next_ = std::chrono::steady_clock::now();
  }
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;
  ~LiveView() {
    std::fputs("\033[?25h\033[?7h", stdout);
    std::fflush(stdout);
  }

  [[nodiscard]] uint64_t cycles_a_frame() const { return static_cast<uint64_t>(cycles_a_frame_); }

  void show(const GridFrame& frame, double progress) {
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
      options_.columns = size.ws_col;
      options_.rows = size.ws_row;
    }
    options_.progress = progress;
    std::string text;
    if (lines_ > 0) text = "\033[" + std::to_string(lines_) + "A";
    text += text_view(frame, options_) + "\033[J";
    lines_ = text_view_lines(frame, options_);
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
    next_ += frame_time_;
    std::this_thread::sleep_until(next_);
  }

 private:
  static constexpr double kFrames_hz = 20.0;
  TextViewOptions options_;
  double cycles_a_frame_;
  std::chrono::steady_clock::duration frame_time_;
  std::chrono::steady_clock::time_point next_;
  int lines_ = 0;
};

bool is_live(const GridOptions& options) {
  return !options.headless && !options.json && !options.quiet && isatty(STDOUT_FILENO) == 1;
}

Json json_of(const GridConfig& config) {
  Json json;
  for (const auto& [name, value] : describe(config)) json[name] = value;
  return json;
}

void print_run(const GridRun& run, bool json) {
  const GridResult result = run.result();
  const GridWorld& world = run.world();
  const Json figures = {{"level", result.level},          {"cycles", result.cycles},
                        {"units", result.units},          {"least_units", result.min_units},
                        {"distance", result.distance()},  {"progress", run.progress().progress},
                        {"lowest", world.lowest()},       {"highest", world.highest()},
                        {"deviation", world.deviation()}, {"config", json_of(run.config())}};
  if (json) return print_json(figures, -1);
  print("{}, seed {}: {}\n", name_of(run.config().algorithm), run.config().seed,
        result.level ? "level" : "not level");
  print(
      "  cycles                 {cycles:12s}\n"
      "  units moved            {units:12s}\n"
      "  fewest possible        {least_units:12s}\n"
      "  distance               {distance:12.0f} cells\n"
      "  leveled                {progress*100:10.1f} %\n"
      "  heights                {lowest:9s} to {highest}, deviation {deviation:.3f}\n",
      figures);
}

/// Points of the progress curve, ever farther apart.
class CurveFile {
 public:
  explicit CurveFile(const std::string& path) : file_(path) {
    file_.write("cycle,units,distance,progress\n");
  }
  void add(const GridRun& run, bool last) {
    if (!last && run.cycles() < next_) return;
    const GridProgress now = run.progress();
    file_.write(filled("{},{},{:.1f},{:.6f}\n", now.cycle, now.units, now.distance, now.progress));
    next_ = std::max(now.cycle + 1, now.cycle + now.cycle / 50);
  }
  void finish() { file_.commit(); }

 private:
  AtomicFile file_;
  uint64_t next_ = 0;
};

/// How much of a run without a live view is leveled.
class LeveledBar {
 public:
  LeveledBar() : bar_(std::cerr) {}
  LeveledBar(const LeveledBar&) = delete;
  LeveledBar& operator=(const LeveledBar&) = delete;
  ~LeveledBar() { bar_.clear(); }

  void show(const GridRun& run) {
    constexpr uint64_t kCycles = 1000;  // between looks at all cells
    if (run.cycles() % kCycles != 0) return;
    const GridProgress now = run.progress();
    bar_.show_share(now.progress, "leveled, cycle " + std::to_string(now.cycle));
  }

 private:
  ProgressBar bar_;
};

void render(const GridOptions& options, const std::vector<GridFrame>& frames) {
  TaskBar bar(options.quiet);
  const bool rendered = render_scene(options.render, frames, options.render_width, bar.progress());
  bar.clear();
  if (!rendered) {
    std::cerr << "note: povray is not installed; only the scene was written, beside "
              << options.render << " (apt install povray)\n";
  }
}

int run_one(const GridOptions& options, const std::string& version) {
  const GridConfig config = config_of(options);
  GridRun run(config);
  std::vector<GridFrame> frames;
  if (!options.render.empty()) {
    frames.push_back(frame_of(run));
    static_cast<void>(scene_text(frames));  // refuses before the run what it cannot draw after it
  }
  std::optional<GridRecorder> recorder;
  if (!options.record.empty()) recorder.emplace(options.record, run, version);
  std::optional<CurveFile> curve;
  if (!options.curve.empty()) {
    curve.emplace(options.curve);
    curve->add(run, false);
  }
  {
    std::optional<LiveView> view;
    if (is_live(options)) {
      view.emplace(std::string(name_of(run.config().algorithm)) + ", seed " +
                       std::to_string(run.config().seed),
                   run.world().lowest(), run.world().highest(), options.speed);
      view->show(frame_of(run), run.progress().progress);
    }
    std::optional<LeveledBar> bar;
    if (!view && !options.quiet) bar.emplace();
    while (!run.finished() && !interrupted()) {
      run.cycle();
      if (bar) bar->show(run);
      if (recorder) recorder->add_cycle(run);
      if (curve) curve->add(run, false);
      if (view && (run.finished() || run.cycles() % view->cycles_a_frame() == 0)) {
        view->show(frame_of(run), run.progress().progress);
      }
    }
  }
  if (recorder) recorder->finish(run);
  if (curve) {
    curve->add(run, true);
    curve->finish();
  }
  print_run(run, options.json);
  if (!run.finished() && interrupted()) return interrupted_exit_code();
  if (!options.render.empty()) {
    frames.push_back(frame_of(run));
    render(options, frames);
  }
  return 0;
}

int run_replay(const GridOptions& options) {
  GridReplay replay(options.replay);
  std::vector<GridFrame> frames = {replay.frame()};
  if (!options.render.empty()) static_cast<void>(scene_text(frames));
  {
    std::optional<LiveView> view;
    if (is_live(options)) {
      const auto& heights = replay.frame().terrain.heights;
      const auto [minimum, maximum] = std::minmax_element(heights.begin(), heights.end());
      view.emplace(replay.value("algorithm") + ", seed " + replay.value("seed") + ", recorded",
                   *minimum, *maximum, options.speed);
    }
    const auto show = [&] {
      const double all = static_cast<double>(std::max<uint64_t>(1, replay.cycles()));
      view->show(replay.frame(), static_cast<double>(replay.frame().cycle) / all);
    };
    if (view) show();
    std::optional<ProgressBar> bar;
    if (!view && !options.quiet) bar.emplace(std::cerr);
    while (!replay.finished() && !interrupted()) {
      replay.cycle();
      if (bar) {
        bar->show_share(
            static_cast<double>(replay.frame().cycle) / static_cast<double>(replay.cycles()),
            "replaying");
      }
      if (view && (replay.finished() || replay.frame().cycle % view->cycles_a_frame() == 0)) show();
    }
    if (bar) bar->clear();
  }
  if (!replay.finished()) return interrupted_exit_code();
  const bool matches = replay.matches();
  const Json figures = {{"cycles", replay.cycles()},
                        {"units", replay.frame().units},
                        {"algorithm", replay.value("algorithm")},
                        {"seed", replay.value("seed")},
                        {"matches", matches}};
  if (options.json) {
    print_json(figures, -1);
  } else {
    print(
        "{algorithm}, seed {seed}: {cycles} cycles, {units} units moved; the terrain at the end "
        "is ",
        figures);
    print(matches ? "the recorded one\n" : "NOT the recorded one\n");
  }
  if (!options.render.empty()) {
    frames.push_back(replay.frame());
    render(options, frames);
  }
  return matches ? 0 : 1;
}

/// Runs a sweep with a bar.
SweepResult sweep(const GridOptions& options, const std::vector<SweepPoint>& points,
                  SweepOptions settings, const std::string& version) {
  settings.runs = options.runs;
  settings.workers = options.workers;
  settings.version = version;
  settings.worker_arguments = {"campaign", "worker", "--grid"};
  settings.stop = &interrupted();
  settings.note = [](const std::string& note) { std::cerr << "note: " << note << "\n"; };
  std::optional<ProgressBar> bar;
  if (!options.quiet) {
    bar.emplace(std::cerr);
    settings.progress = [&bar](const EngineProgress& progress) {
      bar->show_share(progress.share, std::to_string(progress.done) + " of " +
                                          std::to_string(progress.tasks) + " runs");
    };
  }
  try {
    SweepResult result = run_sweep(points, settings);
    if (bar) bar->clear();
    if (result.resumed > 0) {
      std::cerr << "note: " << result.resumed << " runs were there already\n";
    }
    return result;
  } catch (...) {
    if (bar) bar->clear();
    throw;
  }
}

int stopped_early(bool is_kept) {
  std::cerr << "stopped" << (is_kept ? "; the same command goes on where it stopped" : "") << "\n";
  return interrupted_exit_code();
}

void print_points(const std::vector<SweepPoint>& points,
                  const std::vector<std::vector<GridResult>>& results, bool as_json) {
  Json json = Json::array();
  for (size_t i = 0; i < points.size(); ++i) {
    const Summary cycles = cycles_of(results[i]);
    const Summary units = units_of(results[i]);
    json.push_back({{"point", points[i].label},
                    {"x", points[i].x},
                    {"runs", results[i].size()},
                    {"failures", failures_of(results[i])},
                    {"cycles", cycles.mean},
                    {"cycles_standard_error", cycles.standard_error},
                    {"units", units.mean},
                    {"units_standard_error", units.standard_error}});
  }
  if (as_json) return print_json(json, -1);
  print("{:-28s} {:18s} {:18s} {:8s} {:8s} {:8s}\n", "", "cycles", "units moved", "fewest",
        "x least", "failed");
  double least_cycles = cycles_of(results.front()).mean;
  for (const auto& runs : results) least_cycles = std::min(least_cycles, cycles_of(runs).mean);
  for (size_t i = 0; i < points.size(); ++i) {
    double fewest = 0.0;
    for (const GridResult& run : results[i]) {
      fewest += static_cast<double>(run.min_units) / static_cast<double>(results[i].size());
    }
    print(
        "{point:-28s} {cycles:9.0f} +- {cycles_standard_error:5.0f} {units:9.0f} +- "
        "{units_standard_error:5.0f} ",
        json[i]);
    print("{:8.0f} {:8.2f} {:4s}/{}\n", fewest, json[i]["cycles"].get<double>() / least_cycles,
          json[i]["failures"], results[i].size());
  }
}

int run_figure(const GridOptions& options, const std::string& version) {
  const GridFigure figure = grid_figure(options.figure, config_of(options));
  const std::filesystem::path folder = options.out.empty() ? "out/grid" : options.out;
  const std::string name = "figure-" + figure.results_name;
  SweepOptions settings;
  settings.folder = folder / name;
  settings.table = folder / (name + "_runs.csv");
  const SweepResult result = sweep(options, figure.points, settings, version);
  if (!result.complete) return stopped_early(true);
  const FigureFiles files = write_figure(folder, figure, result.results);
  print_points(figure.points, result.results, options.json);
  if (!options.json)
    print("\n  runs    {}\n  table   {}\n  figure  {}\n", settings.table, files.csv, files.svg);
  return 0;
}

int run_many(const GridOptions& options, const std::string& version) {
  const GridConfig config = config_of(options);
  const std::vector<SweepPoint> points = {{name_of(config.algorithm), 0.0, config}};
  SweepOptions settings;
  if (!options.out.empty()) {
    settings.folder = options.out;
    settings.table = settings.folder / "runs.csv";
  }
  const SweepResult result = sweep(options, points, settings, version);
  if (!result.complete) return stopped_early(!options.out.empty());
  print_points(points, result.results, options.json);
  return 0;
}

int run_command(GridOptions options, const std::string& version) {
  const bool runs_given = options.runs_option->given();
  if (!options.render.empty()) check_picture_name(options.render);
  const bool one_run = options.figure.empty() && !runs_given;
  if (!one_run && !(options.record + options.replay + options.render + options.curve).empty()) {
    throw InputError("grid: --record, --replay, --render and --curve go with a single run");
  }
  if (!options.replay.empty() && !(options.record + options.curve).empty()) {
    throw InputError("grid: --replay does not go with --record or --curve");
  }
  catch_interrupts();
  if (!options.figure.empty()) {
    if (!runs_given) options.runs = 30;
    return run_figure(options, version);
  }
  if (!options.replay.empty()) return run_replay(options);
  return runs_given ? run_many(options, version) : run_one(options, version);
}

}  // namespace

void register_grid_command(Command& root, Program& program) {
  auto [command, options] = add_subcommand<GridOptions>(
      root, program, "grid",
      "Run leveling agents on a grid of stacks (thesis 4.2), once or many times", run_command);
  GridConfig& config = options.config;
  command
      .add_option("--algorithm", options.algorithm,
                  "Algorithm: probabilistic, threshold, memetic-1, memetic-2, patient or forager")
      ->show_default();
  add_number(command, "--seed", config.seed, "Seed of the first run; each further run adds 1",
             kSeedRange);
  add_number(command, "--agents", config.agents, "Number of agents",
             {1, kLargestGridSide * kLargestGridSide});
  command.add_option("--size", options.size,
                     "Grid size [cells]: one number for a square, or WIDTHxHEIGHT");
  command.add_option("--border", options.border, "Border of the grid: walls or torus")
      ->show_default();
  command.add_option("--terrain", config.image, "Grey image used as terrain (default: noise)")
      ->type_name("FILE");
  add_number(command, "--white", config.white, "Height of a white pixel [units]", {0.001, 10000.0});
  add_number(command, "--mean", options.mean, "Mean height [units] (noise: 6.5)", {0.0, 10000.0});
  add_number(command, "--amplitude", config.noise.amplitude, "Amplitude of the noise [units]",
             {0.0, 10000.0});
  add_number(command, "--lattice", config.noise.lattice, "Lattice spacing of the noise [cells]",
             {0.5, 1e6});
  command.add_option("--stop", options.stop, "Stop criterion: level, gradient or deviation")
      ->show_default();
  add_number(command, "--epsilon", options.epsilon,
             "Threshold of the stop criterion [units] (level 1, gradient 1.5, deviation 0.5)",
             {0.0, kMaxStackHeight});
  add_number(command, "--max-cycles", config.max_cycles,
             "Maximum number of cycles; a longer run counts as failed", kCountRange);

  add_number(command, "-p,--probability", options.probability,
             "Probability of picking up and of depositing", kShareRange);
  add_number(command, "--p-pick-up", config.p_pick_up, "Probability of picking up", kShareRange);
  add_number(command, "--p-deposit", config.p_deposit, "Probability of depositing", kShareRange);
  add_number(command, "--p-sense", config.p_sense,
             "Probability of sampling the height on arrival in a cell", kShareRange);
  add_number(command, "--p-turn", config.p_turn, "Probability of a step in a random direction",
             kShareRange);
  add_number(command, "-k", config.k, "Parameter k of the response curves (threshold)",
             {1.0 / 256.0, 255.0});
  add_number(command, "--memory", config.memory, "Length of the height memory [samples]",
             {1, HeightMemory::kMaxLength});
  add_number(command, "--fitness-threshold", config.fitness_threshold,
             "Fitness below which chromosomes are replaced (memetic-2)", kShareRange);
  command
      .add_option("--fitness-base", options.fitness_base,
                  "Operations counted by the fitness: executed or attempted (memetic)")
      ->show_default();
  add_number(command, "--chromosomes", config.chromosomes, "Chromosomes per agent (memetic-2)",
             {1, MemeticAgent::kMaxChromosomes});
  add_number(command, "--repetitions", config.repetitions,
             "Repetitions of a chromosome (memetic-1)", {1, 100});
  add_number(command, "--averaging", config.averaging,
             "Window of the running average [samples] (patient, forager)", {1, 32767});
  add_number(command, "--dead-band", config.dead_band,
             "Dead band around the average in which nothing is moved [units] (patient, forager)",
             {0.0, 255.0});
  add_number(command, "--patience", config.patience,
             "Idle cycles before the dead band shrinks; 0: never (patient, forager)", {0, 65535});
  add_number(command, "--hold-out", config.hold_out,
             "Cycles over which the hold-out decays; 0: none (patient 0, forager 200)", {0, 65535});
  command.add_option(
      "--follow-slope", options.follow_slope,
      "Walk uphill when empty and downhill when loaded: yes or no (patient no, forager yes)");
  command.add_option("--turn-back", options.turn_back,
                     "Turn back after an operation: yes or no (patient no, forager yes)");

  options.runs_option =
      add_number(command, "--runs", options.runs,
                 "Number of runs, on all cores; with --figure: per point", {1, 1e7});
  add_number(command, "--workers,--threads", options.workers,
             "Worker processes of many runs; 0: one per core; results do not depend on it",
             {0, 1024});
  command.add_option("--figure", options.figure,
                     "Reproduce a figure: 4.2, 4.3, 4.4, 4.5, better or better-units");
  command
      .add_option("--out", options.out,
                  "Output folder for runs, tables and charts of --figure (default: out/grid) "
                  "or --runs; resumes an interrupted sweep")
      ->type_name("FOLDER");
  command.add_option("--record", options.record, "Record the run to this HDF5 file")
      ->type_name("FILE");
  command.add_option("--replay", options.replay, "Play a recording instead of a run")
      ->type_name("FILE");
  command
      .add_option("--render", options.render,
                  "Render a ray-traced picture (PNG) of the stacks before and after")
      ->type_name("FILE");
  add_number(command, "--render-width", options.render_width, "Width of the rendered picture [px]",
             {100, 8000});
  command.add_option("--curve", options.curve, "Write the progress curve to this CSV file")
      ->type_name("FILE");
  add_number(command, "--speed", options.speed, "Speed of the live view [cycles/s]", {0.01, 1e9});
  command.add_flag("--headless", options.headless, "Run at full speed without live view");
  command.add_flag("--quiet", options.quiet, "Show neither live view nor progress");
  command.add_flag("--json", options.json, "Print results as JSON");
}

}  // namespace screed
