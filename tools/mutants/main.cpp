// mutants: changes one thing at a time in named sources and says which changes the tests notice.
// `make mutants` builds and runs it, in the root of the tree.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "tools/mutants/campaign.h"

int main(int argc, char** argv) {
  screed::mutants::Options options;
  CLI::App app("Which mutants of the sources in tools/mutants/targets.txt the tests kill");
  app.add_option("--build", options.build, "folder of the objects")->required();
  app.add_option("--work", options.work, "folder of mutants and results")->required();
  app.add_option("--file", options.files, "only sources whose name contains this; several times");
  app.add_option("--jobs", options.jobs, "tests at a time")->check(CLI::Range(1, 256));
  app.add_option("--sample", options.sample, "as many mutants of each source");
  app.add_option("--seed", options.seed, "of the samples");
  app.add_flag("--list", options.list, "only list the mutants");
  app.add_option("--tests", options.tests, "only these tests: PATTERN:PATTERN with * and ?");
  app.add_flag("--unit", options.unit_only, "without the tests of whole runs (tests/sitl)");
  app.add_option("--longest", options.longest_s,
                 "without the tests that take longer, s of processor time; 0: all")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
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
