// mutants: changes one thing at a time in named sources and says which changes the tests notice.
// `make mutants` builds and runs it, in the root of the tree.
#include <sys/resource.h>

#include <cstdio>
#include <exception>

#include "tools/command_line/program.h"
#include "tools/mutants/campaign.h"

namespace {

int run_campaign(const screed::mutants::Options& options) {
  setpriority(PRIO_PROCESS, 0, 19);
  try {
    screed::mutants::Campaign campaign(options);
    campaign.run();
    return campaign.report() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mutants: %s\n", error.what());
    return 2;
  }
}

}  // namespace

int main(int argc, char** argv) {
  screed::mutants::Options options;
  screed::Command app("Which mutants of the sources in tools/mutants/targets.txt the tests kill",
                      "mutants");
  app.add_option("--build", options.build, "folder of the objects")->required();
  app.add_option("--work", options.work, "folder of mutants and results")->required();
  app.add_option("--file", options.files, "only sources whose name contains this; several times");
  app.add_option("--jobs", options.jobs, "tests at a time")->range(1, 256);
  app.add_option("--sample", options.sample, "as many mutants of each source");
  app.add_option("--seed", options.seed, "of the samples");
  app.add_flag("--list", options.list, "only list the mutants");
  app.add_option("--tests", options.tests, "only these tests: PATTERN:PATTERN with * and ?");
  app.add_flag("--unit", options.unit_only, "without the tests of whole runs (tests/sitl)");
  app.add_option("--longest", options.longest_s,
                 "without the tests that take longer, s of processor time; 0: all")
      ->range(0.0, 3600.0)
      ->show_default();
  return screed::run_program(app, argc, argv, [&] { return run_campaign(options); });
}
