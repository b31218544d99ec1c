// `make bench-terrain`: runs every case in a child process; prints the table, writes CSV and
// charts.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/child_process.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/render/chart/line_chart.h"
#include "tools/bench/terrain/terrain_bench.h"
#include "tools/command_line/program.h"

namespace {

using namespace screed;
using terrain_bench::Case;
using terrain_bench::Load;
using terrain_bench::Measurement;

struct Options {
  std::string out = "out/bench-terrain";
  std::uint64_t frames = 1000;
  double seconds = 60.0;
  std::string bed;  ///< of a child: it measures one case and prints it as JSON
  std::vector<std::string> set;
  int threads = 1;
  bool all_awake = false;
};

/// A case and what came of it.
struct Row {
  Case bench;
  Measurement measured;
};

void print_measurement(const Options& options) {
  const Measurement m =
      options.all_awake
          ? terrain_bench::measure_all_awake(options.bed, options.set, options.threads,
                                             options.frames, options.seconds)
          : terrain_bench::measure(options.bed, options.set, options.threads, options.frames,
                                   options.seconds);
  std::printf("%s\n", Json({{"frames", m.frames},
                            {"wall_ms", m.wall_ms},
                            {"processor_ms", m.processor_ms},
                            {"fastest_ms", m.fastest_ms},
                            {"memory_mb", m.memory_mb},
                            {"elements", m.elements},
                            {"awake", m.awake}})
                          .dump()
                          .c_str());
}

Measurement measure_in_child(const Case& bench, const std::string& bed, const Options& options) {
  // The words hold no quotes: they are ours.
  std::string command = "'" + std::filesystem::read_symlink("/proc/self/exe").string() +
                        "' --bed '" + bed + "' --frames " + std::to_string(options.frames) +
                        " --seconds " + std::to_string(options.seconds) + " --threads " +
                        std::to_string(bench.threads);
  if (bench.load == terrain_bench::Load::kAllAwake) command += " --all-awake";
  for (const std::string& text : bench.overrides) command += " --set '" + text + "'";
  const ShellOutput child = shell_output(command);
  if (child.exit_code != 0) throw RunError("a case failed: " + command);
  const auto json = Json::parse(child.text);
  const auto number = [&](const char* name) { return json.at(name).get<double>(); };
  return Measurement{json.at("frames").get<std::uint64_t>(),
                     number("wall_ms"),
                     number("processor_ms"),
                     number("fastest_ms"),
                     number("memory_mb"),
                     json.at("elements").get<std::uint64_t>(),
                     number("awake")};
}

void print_head() {
  std::printf(
      "| terrain | bed, m | heights or particles | awake | threads | ms a frame | processor "
      "ms | "
      "thesis, ms | times faster | memory, MB |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
}

void print_row(const Row& row) {
  std::printf("| %s | %.1f | ", row.bench.terrain.c_str(), row.bench.size_m);
  const Measurement& m = row.measured;
  const auto thesis_s = terrain_bench::thesis_frame_s(row.bench.terrain, row.bench.size_m);
  std::printf("%llu | ", static_cast<unsigned long long>(m.elements));
  if (m.awake > 0.0) std::printf("%.0f", m.awake);
  std::printf(" | %d | %.3f | %.3f | ", row.bench.threads, m.wall_ms, m.processor_ms);
  if (thesis_s) {
    std::printf("%.0f | %.0f | ", *thesis_s * 1e3, *thesis_s * 1e3 / m.processor_ms);
  } else {
    std::printf("figure only | | ");
  }
  std::printf("%.0f |\n", m.memory_mb);
  std::fflush(stdout);
}

/// Of the beds whose particles are all awake, a line each.
void print_all_awake(const std::vector<Row>& rows) {
  std::printf("\n");
  for (const Row& row : rows) {
    if (row.bench.load != Load::kAllAwake) continue;
    const Measurement& m = row.measured;
    std::printf(
        "%.1f m, all awake: %.0f of %llu particles awake, %d thread%s: %.1f ms for 10 ms of "
        "simulated time, fastest %.1f ms, %.2f us a particle\n",
        row.bench.size_m, m.awake, static_cast<unsigned long long>(m.elements), row.bench.threads,
        row.bench.threads == 1 ? "" : "s", m.wall_ms, m.fastest_ms, 1e3 * m.wall_ms / m.awake);
  }
}

void write_csv(const std::filesystem::path& path, const std::vector<Row>& rows) {
  std::ostringstream file;
  file << "terrain,bed_m,threads,elements,awake,frames,wall_ms,processor_ms,fastest_ms,memory_mb\n";
  for (const Row& row : rows) {
    const Measurement& m = row.measured;
    file << '"' << row.bench.terrain << "\"," << row.bench.size_m << ',' << row.bench.threads << ','
         << m.elements << ',' << m.awake << ',' << m.frames << ',' << m.wall_ms << ','
         << m.processor_ms << ',' << m.fastest_ms << ',' << m.memory_mb << '\n';
  }
  write_file(path, file.str());
}

/// One group of bars a bed, one bar a terrain and number of threads. Nothing when no row passes.
void write_bars(const std::filesystem::path& path, const std::vector<Row>& rows, const char* title,
                const char* axis, double Measurement::*value, bool (*wanted)(const Case&)) {
  Chart chart;
  chart.kind = ChartKind::kBars;
  chart.title = title;
  chart.y_label = axis;
  chart.x_label = "bed";
  chart.value_labels = true;
  for (const Row& row : rows) {
    if (!wanted(row.bench)) continue;
    char bed[30];
    std::snprintf(bed, sizeof bed, "%.1f m", row.bench.size_m);
    const auto place = std::find(chart.categories.begin(), chart.categories.end(), bed);
    const auto group = static_cast<double>(place - chart.categories.begin());
    if (place == chart.categories.end()) chart.categories.emplace_back(bed);
    std::string label = row.bench.terrain;
    if (row.bench.threads > 1) {
      label += ", " + std::to_string(row.bench.threads) +
               (row.bench.load == Load::kRobot ? " worlds" : " threads");
    }
    auto series = std::find_if(chart.series.begin(), chart.series.end(),
                               [&](const ChartSeries& s) { return s.label == label; });
    if (series == chart.series.end()) {
      chart.series.push_back({label, {}, true});
      series = chart.series.end() - 1;
    }
    series->points.push_back({group, row.measured.*value});
  }
  if (!chart.series.empty()) write_chart(path, chart);
}

void write_charts(const std::filesystem::path& folder, const std::vector<Row>& rows) {
  // Beds whose particles are all awake take a thousand times as long: a chart of their own.
  const auto all_awake = [](const Case& bench) { return bench.load == Load::kAllAwake; };
  const auto driven_alone = [](const Case& bench) {
    return bench.threads == 1 && bench.load == Load::kRobot;
  };
  const auto soft = [](const Case& bench) {
    return bench.threads == 1 && bench.terrain.find("particles") == std::string::npos;
  };
  const auto particles = [](const Case& bench) { return bench.terrain == "particles"; };
  const char* time = "processor time of a frame [ms]";
  const char* memory = "memory [MB]";
  write_bars(folder / "figure_5.6.svg", rows, "Time of a frame, as Figure 5.6", time,
             &Measurement::processor_ms, driven_alone);
  write_bars(folder / "particles_all_awake.svg", rows, "Time of a frame, all particles awake",
             "time of a frame by the clock [ms]", &Measurement::wall_ms, all_awake);
  write_bars(folder / "figure_5.6_soil.svg", rows, "Time of a frame without particles", time,
             &Measurement::processor_ms, soft);
  write_bars(folder / "figure_5.7.svg", rows, "Memory, as Figure 5.7", memory,
             &Measurement::memory_mb, driven_alone);
  write_bars(folder / "figure_5.8.svg", rows, "Time of a frame on particles, as Figure 5.8",
             "time of a frame by the clock [ms]", &Measurement::wall_ms, particles);
  write_bars(folder / "figure_5.9.svg", rows, "Memory with particles, as Figure 5.9", memory,
             &Measurement::memory_mb, particles);
}

int run(const Options& options) {
  if (!options.bed.empty()) {
    print_measurement(options);
    return 0;
  }
  const std::filesystem::path folder = options.out;
  const std::filesystem::path bed = terrain_bench::write_bed(folder);
  std::vector<Row> rows;
  print_head();
  for (const Case& bench : terrain_bench::all_cases()) {
    rows.push_back({bench, measure_in_child(bench, bed.string(), options)});
    print_row(rows.back());
  }
  print_all_awake(rows);
  write_csv(folder / "terrain.csv", rows);
  write_charts(folder, rows);
  std::printf("\ntable and charts: %s\n", folder.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  Command app("Time and memory of a frame on every terrain: thesis figures 5.6 to 5.9 again",
              "terrain_bench");
  app.add_option("--out", options.out, "Output folder for the table and the charts")
      ->show_default();
  app.add_option("--frames", options.frames, "Number of frames to time per case")
      ->range(1, 1000000)
      ->show_default();
  app.add_option("--seconds", options.seconds, "Maximum time to measure per case [s]")
      ->range(0.1, 36000.0)
      ->show_default();
  app.add_option("--bed", options.bed,
                 "Measure a single case in this process: its experiment file");
  app.add_option("--set", options.set, "Override a key of that case: section.key=value")
      ->one_value_each();
  app.add_flag("--all-awake", options.all_awake,
               "Without a robot, all particles of that case awake");
  app.add_option("--threads", options.threads,
                 "Number of threads in that case: a world each, or of the bed with --all-awake")
      ->range(1, 64);
  return run_program(app, argc, argv, [&] { return run(options); });
}
