// How every host program ends.
#include "tools/command_line/program.h"

#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tools/command_line/parser.h"

namespace screed {

int run_program(Command& program, int argc, char** argv, const std::function<int()>& body) {
  constexpr int kFailed = 1;
  constexpr int kWrongInput = 2;
  const auto fail = [&](int code, const std::string& what) {
    std::cerr << program.name() << ": " << what << "\n";
    return code;
  };
  std::signal(SIGXFSZ, SIG_IGN);  // past a limit of file sizes a write fails, as on a full disk
  try {
    std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words.front() == "help") {
      words.erase(words.begin());
      words.emplace_back("--help");
    }
    const std::string page = parse(program, words);
    if (page.empty()) return body();
    std::cout << page;
    return 0;
  } catch (const UsageError& error) {
    return fail(kWrongInput, error.what() + (" (see " + error.command()) + " --help)");
  } catch (const InputError& error) {
    return fail(kWrongInput, error.what());
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}

}  // namespace screed
