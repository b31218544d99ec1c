// Options of `screed key`, and the talk with the robot's console.
#include "tools/screed/link/key_command.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/random.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/ground_station/link/pseudo_terminal.h"
#include "host_sim/ground_station/link/serial_link.h"
#include "host_sim/ground_station/station/key_file.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

constexpr std::chrono::milliseconds kAnswerTimeout{500};
// 27 bytes of EEPROM take 0.3 s; until then the console does not restart.
constexpr int kRestartTries = 3;

struct Arguments {
  std::string file;
  std::string port;
  std::optional<int> robot_id;
};

/// The robot's console on a serial port over USB.
class UsbConsole {
 public:
  explicit UsbConsole(const std::string& port)
      : port_(open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    if (port_.get() < 0) {
      if (errno == ENOENT) throw InputError(port + ": " + no_such_port());
      throw RunError(port + ": " + std::strerror(errno));
    }
    termios settings{};
    if (tcgetattr(port_.get(), &settings) != 0) throw InputError(port + ": is no serial port");
    cfmakeraw(&settings);
    cfsetspeed(&settings, B115200);
    tcsetattr(port_.get(), TCSANOW, &settings);
    tcflush(port_.get(), TCIOFLUSH);
  }

  std::string ask(const std::string& line) {
    const std::string sent = line + "\n";
    if (write(port_.get(), sent.data(), sent.size()) != static_cast<ssize_t>(sent.size()))
      return "";
    std::string answer;
    const auto end = std::chrono::steady_clock::now() + kAnswerTimeout;
    while (answer.empty() || answer.back() != '\n') {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
          end - std::chrono::steady_clock::now());
      pollfd waiting{port_.get(), POLLIN, 0};
      if (left.count() <= 0 || poll(&waiting, 1, static_cast<int>(left.count())) <= 0) return "";
      char byte = 0;
      if (read(port_.get(), &byte, 1) != 1) return "";  // also a robot that has just restarted
      answer += byte;
    }
    answer.pop_back();
    return answer;
  }

 private:
  FileDescriptor port_;
};

CommandKey new_key_in(const Arguments& arguments) {
  const CommandKey key = random_key(static_cast<uint8_t>(arguments.robot_id.value_or(1)));
  write_key_file(arguments.file, key);
  print("{}: a new key for robot {}\n", arguments.file, key.robot_id);
  return key;
}

/// Nothing where there is no file.
std::optional<CommandKey> key_in(const Arguments& arguments) {
  std::error_code error;
  if (!std::filesystem::exists(arguments.file, error)) return std::nullopt;
  const CommandKey key = read_key_file(arguments.file);
  if (arguments.robot_id.has_value() && *arguments.robot_id != key.robot_id) {
    throw InputError(arguments.file + ": is the key of robot " + std::to_string(key.robot_id) +
                     "; --robot-id says " + std::to_string(*arguments.robot_id));
  }
  print("{}: the key of robot {}\n", arguments.file, key.robot_id);
  return key;
}

int run_key_command(const Arguments& arguments) {
  const std::optional<CommandKey> present = key_in(arguments);
  const auto get_key = [&] { return present.has_value() ? *present : new_key_in(arguments); };
  if (arguments.port.empty()) {
    get_key();
    return 0;
  }
  // A new key is made once there is a robot to take it.
  const bool restarted = provision_key(arguments.port, get_key);
  print(restarted ? "{}: the robot has the key and restarts\n"
                  : "{}: the robot has the key, but cannot restart now: switch it off and on\n",
        arguments.port);
  return 0;
}

}  // namespace

CommandKey random_key(uint8_t robot_id) {
  CommandKey key;
  key.robot_id = robot_id;
  if (getrandom(key.bytes.data(), key.bytes.size(), 0) != static_cast<ssize_t>(key.bytes.size())) {
    throw RunError("the system gives no random numbers");
  }
  return key;
}

bool provision_key(const AskConsole& ask, const std::string& port, const GetKey& get_key) {
  // Ends what somebody has typed, and the radio's lines, which somebody may have asked for.
  ask("");
  ask("C");
  const std::string version = ask("v");
  if (version.rfind("screed ", 0) != 0) {
    throw RunError(port + ": no robot's console answers here; the key was not sent");
  }
  const CommandKey key = get_key();
  char id[3];
  std::snprintf(id, sizeof id, "%02X", static_cast<unsigned>(key.robot_id));
  const std::string digits = key_text(key).substr(0, 2 * key.bytes.size());
  if (ask("k" + digits + id) != "ok") {
    throw RunError(port + ": the robot did not take the key (" + version + ")");
  }
  for (int i = 0; i < kRestartTries; ++i) {
    if (ask("r") != "?") return true;
  }
  return false;
}

bool provision_key(const std::string& port, const GetKey& get_key) {
  UsbConsole console(port);
  return provision_key([&console](const std::string& line) { return console.ask(line); }, port,
                       get_key);
}

void register_key_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<Arguments>(
      root, program, "key",
      "Create the key that signs commands, and provision a robot with it over USB",
      run_key_command);
  command
      .add_option("FILE", arguments.file, "Key file; created with mode 0600 when it does not exist")
      ->required();
  command
      .add_option("--port", arguments.port,
                  "The robot's USB port, e.g. /dev/ttyACM0 (default: create the file only)")
      ->type_name("DEVICE");
  add_number(command, "--robot-id", arguments.robot_id,
             "Robot id of a new key: its node on the radio, as in make flash NODE=N (default: 1)",
             {0, 255});
}

}  // namespace screed
