// Measurements of the telemetry that need much data: `telemetry_lab log N FILE` writes a log of N
// random messages, `telemetry_lab damage N` damages N lines in each of many ways.
#include <charconv>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/candump_log.h"
#include "tools/bench/telemetry/corruption.h"

namespace screed {
namespace {

constexpr const char* kUsage = "usage: telemetry_lab log N FILE | telemetry_lab damage N";

uint64_t number(const std::string& text) {
  uint64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || value == 0) {
    throw InputError(text + " is no number from 1");
  }
  return value;
}

void write_log(uint64_t count, const std::string& path) {
  AtomicFile out(path);
  RandomFrames frames(1);
  for (uint64_t i = 0; i < count; ++i) {
    out.write(candump_line(1700000000000000U + i * 8500, "can0", frames.next()));
  }
  out.commit();
}

int damage(uint64_t lines) {
  std::printf("| damage | lines | wrong frames of the line parser | accepted wrong frames |\n");
  std::printf("| --- | --- | --- | --- |\n");
  for (const CorruptionResult& it : damage_lines(lines, 1)) {
    std::printf("| %s | %llu | %llu | %llu |\n", it.damage.c_str(),
                static_cast<unsigned long long>(it.lines),
                static_cast<unsigned long long>(it.wrong_lines),
                static_cast<unsigned long long>(it.wrong_frames));
  }
  return 0;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 3 && arguments[0] == "log") {
    write_log(number(arguments[1]), arguments[2]);
    return 0;
  }
  if (arguments.size() == 2 && arguments[0] == "damage") return damage(number(arguments[1]));
  throw InputError(kUsage);
}

}  // namespace
}  // namespace screed

int main(int argc, char** argv) {
  try {
    return screed::run({argv + 1, argv + argc});
  } catch (const screed::InputError& error) {
    std::cerr << "telemetry_lab: " << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "telemetry_lab: " << error.what() << "\n";
    return 1;
  }
}
