// `screed report`: a recorded run as one HTML page.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/report/run_page.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_reader.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/task_bar.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string run;
  std::string out;
  bool quiet = false;
};

std::optional<Assembly> robot_of(const SessionReader& session, const fs::path& folder) {
  try {
    return robot_model(setup_of(session.info(), folder), session.info().board_name);
  } catch (const InputError& error) {
    std::cerr << "note: a marker stands for the robot: " << error.what() << "\n";
    return std::nullopt;
  }
}

int run_report(const Options& options) {
  const fs::path file = session_file(options.run);
  const fs::path folder = fs::absolute(file).parent_path();
  const fs::path out = options.out.empty() ? folder / "report.html" : fs::path(options.out);
  if (out.extension() != ".html") {
    throw InputError("--out " + options.out + ": the name ends in .html");
  }
  const SessionReader session(file);
  if (!session.complete()) std::cerr << "note: the recorded run did not end\n";
  TaskBar bar(options.quiet);
  RunPageOptions page;
  page.built_page = data_folders().report / "page.html";
  page.name = file.filename() == "session.h5" ? folder.filename().string() : file.stem().string();
  page.robot = robot_of(session, folder);
  page.progress = bar.progress();
  const std::string text = run_page(session, page);
  bar.clear();
  write_file(out, text);
  char size[32];
  std::snprintf(size, sizeof size, "%.2f MB", static_cast<double>(text.size()) * 1e-6);
  std::cout << out.string() << ": " << size << "\n";
  return 0;
}

}  // namespace

void register_report_command(CLI::App& root, Program& program) {
  CLI::App* command = root.add_subcommand(
      "report", "Write a recorded run as one HTML page: terrain over time, path, curves, figures");
  const auto options = std::make_shared<Options>();
  command->add_option("RUN", options->run, "Run folder or session.h5")->required();
  command
      ->add_option("--out", options->out,
                   "Output page, .html; replaced where it exists (default: RUN/report.html)")
      ->type_name("FILE");
  command->add_flag("--quiet", options->quiet, "Show no progress");
  command->callback(
      [options, &program] { program.action = [options] { return run_report(*options); }; });
}

}  // namespace screed
