// Ctrl-C, SIGTERM and SIGHUP in the midst of what takes long before and beside a run: the program
// ends at once, names what it was at, and leaves nothing.
#include <pty.h>
#include <unistd.h>

#include <array>
#include <string>

#include "tests/sitl/program.h"
#include "tests/sitl/terminal.h"

namespace screed::testing {
namespace {

struct Signal {
  int number;
  int exit_code;
};
constexpr Signal kSignals[] = {{SIGHUP, 129}, {SIGINT, 130}, {SIGTERM, 143}};

class Interrupt : public Program {
 protected:
  /// An experiment on particles: so many take a minute to lay, and longer to settle.
  void write_bed(const std::string& name, double size_m) const {
    write(name + ".ini", "[experiment]\nname = " + name +
                             "\nduration = 0.1\n[map]\nmodel = particles\nsize = " +
                             std::to_string(size_m) + "\n[particles]\ndepth = 0.15\n");
  }
  void expect_nothing_left() const {
    for (const auto& entry : std::filesystem::directory_iterator(root_))
      EXPECT_EQ(entry.path().extension(), ".ini") << entry.path();
  }
  /// Runs the program until the text appears, sends the signal, and expects its exit code and that
  /// text at the end.
  void expect_stopped(const std::vector<std::string>& arguments, const std::string& text,
                      const Signal& signal, const std::string& last_words) const {
    std::vector<std::string> words = arguments;
    words.insert(words.begin(), program_);
    Terminal terminal(words, root_);
    ASSERT_TRUE(terminal.wait_for(text)) << terminal.screen();
    terminal.signal(signal.number);
    EXPECT_EQ(terminal.exit_code(), signal.exit_code) << terminal.screen();
    EXPECT_NE(terminal.screen().find(last_words), std::string::npos) << terminal.screen();
  }
};

TEST_F(Interrupt, LayingParticles) {
  write_bed("big", 12.0);
  for (const Signal& signal : kSignals) {
    expect_stopped({"sim", "big.ini"}, "laying particles", signal,
                   "note: big was stopped while laying particles; there is no run of it\r\n");
    expect_nothing_left();
  }
}

// A bed that will take minutes and much memory says so at once.
TEST_F(Interrupt, ALargeBedHasSaidWhatItCosts) {
  write_bed("big", 12.0);  // 480 x 480 stacks of 6
  expect_stopped({"sim", "big.ini", "--quiet"}, "note: a large bed, at least 1.4 million particles",
                 {SIGINT, 130}, "there is no run of it");
}

TEST_F(Interrupt, SettlingParticles) {
  write_bed("wide", 1.5);
  expect_stopped({"record", "wide.ini"}, "settling particles", {SIGINT, 130},
                 "note: wide was stopped while settling particles; there is no run of it\r\n");
  expect_nothing_left();
}

TEST_F(Interrupt, CheckingSeveralExperiments) {
  write_bed("one", 12.0);
  write_bed("two", 12.0);
  expect_stopped({"sim", "one.ini", "two.ini"}, "checking one: laying particles", {SIGINT, 130},
                 "screed: stopped while checking one; no experiment was begun\r\n");
  expect_nothing_left();
}

// An image that is missing is found before particles are laid: those would take many minutes.
TEST_F(Interrupt, AMissingImageShowsBeforeParticlesAreLaid) {
  write_bed("big", 20.0);
  expect_refused(run("sim big.ini --hal mcu --elf none.elf"), 2, {"none.elf"});
}

TEST_F(Interrupt, DrivesIntoATrap) {
  // The bar is gone before the message.
  for (const Signal& signal : kSignals) {
    expect_stopped({"nn", "stuck", "--trapped", "1000"}, "driving", signal,
                   "\r\033[Kscreed: stopped while driving\r\n");
  }
}

TEST_F(Interrupt, QuietRunsAreStoppedAsWell) {
  write_bed("big", 12.0);
  // Before or while particles are laid.
  const Result result = interrupted("sim big.ini --quiet");
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_EQ(result.out, "");
  expect_nothing_left();
}

// A serial port from which nothing comes.
TEST_F(Interrupt, WaitingForARobotIsStoppedAndNoOtherFailure) {
  write("p.ini", "[parameters]\nclimb_speed = 150\n");
  int radio = -1;
  int port = -1;
  std::array<char, 64> name{};
  ASSERT_EQ(openpty(&radio, &port, name.data(), nullptr, nullptr), 0);
  const std::string pty = std::string(" --pty ") + name.data();
  for (const char* command : {"param get", "param diff p.ini", "param load p.ini", "send arm",
                              "send arm --json", "calibrate --plain"}) {
    SCOPED_TRACE(command);
    const Result result = interrupted(command + pty);
    EXPECT_EQ(result.exit_code, 130);
    EXPECT_EQ(result.err, "screed: stopped while waiting for the robot\n");
    EXPECT_EQ(result.out, "");
  }
  // It was sent, and that is said.
  const Result stop = interrupted("send estop" + pty);
  EXPECT_EQ(stop.exit_code, 130);
  EXPECT_EQ(stop.out, "estop: sent, but no robot says that it has stopped\n");
  close(port);
  close(radio);
}

}  // namespace
}  // namespace screed::testing
