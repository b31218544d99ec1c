// `screed fix`: position fixes of a camera or another surveying system, sent to a robot as
// authenticated commands.
//
// One fix a line, `x y` or `x y sigma`, metres in the frame of the site, from a file, a pipe or UDP
// datagrams. Exit codes: 0 the source has ended, 1 link or robot, 2 wrong input, 130 interrupted.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <deque>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/pseudo_terminal.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "schema/class_values.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/link/robot_link.h"

namespace screed {
namespace {

constexpr std::chrono::milliseconds kFixPump{20};
// Commands go at most four times a second.
constexpr uint64_t kFixPeriod_us = 250'000;
// An older one tells the robot where it was: it is given up.
constexpr uint64_t kFresh_us = 500'000;
constexpr double kMaxPlace_m = 20.47;  // 12 bits of centimetres

struct FixArguments {
  LinkArguments link;
  std::string from = "-";
  std::optional<int> udp;
  double max_sigma_m = 0.1;
  bool listen = false;
};

struct Fix {
  double x_m = 0.0;
  double y_m = 0.0;
  double sigma_m = 0.0;
};

/// Nothing for an empty line or a comment. `where`: of the line, for the message.
std::optional<Fix> parse_fix(const std::string& line, const std::string& where) {
  std::istringstream words(line.substr(0, line.find('#')));
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const std::optional<double> number = finite_number<double>(word);
    if (!number.has_value()) {
      std::string message = where + ": '";
      throw InputError(message.append(word).append("' is no number"));
    }
    numbers.push_back(*number);
  }
  if (numbers.empty()) return std::nullopt;
  if (numbers.size() != 2 && numbers.size() != 3)
    throw InputError(where + ": " + std::to_string(numbers.size()) +
                     " numbers; allowed: x y or x y sigma, in metres");
  if (std::abs(numbers[0]) > kMaxPlace_m || std::abs(numbers[1]) > kMaxPlace_m)
    throw InputError(where + ": a place beyond -20.47 to 20.47 m");
  if (numbers.size() == 3 && numbers[2] < 0.0)
    throw InputError(where + ": a negative standard deviation");
  return Fix{numbers[0], numbers[1], numbers.size() == 3 ? numbers[2] : 0.0};
}

/// A later fix may be taken.
bool is_passing(const CommandAnswer& answer) {
  const auto result = static_cast<message::CommandAckResult>(answer.result);
  return result == message::CommandAckResult::kBusy ||
         result == message::CommandAckResult::kLockedOut;
}

/// Where fixes come from. Of a file each one counts, of anything else the newest.
class FixSource {
 public:
  explicit FixSource(const FixArguments& arguments) {
    if (arguments.udp.has_value()) {
      open_udp(*arguments.udp);
    } else {
      open_file(arguments.from);
    }
  }

  /// What has come since the last call, as far as it is to be sent now.
  std::optional<Fix> next() {
    while (!ended_ && fixes_.size() < kAhead &&
           wait_readable(in_.get(), kNoWait) != Readiness::kNothing)
      read_some();
    if (fixes_.empty()) return std::nullopt;
    if (!is_file_) fixes_.erase(fixes_.begin(), fixes_.end() - 1);
    const Fix fix = fixes_.front();
    fixes_.pop_front();
    return fix;
  }
  bool ended() const { return ended_ && fixes_.empty(); }

 private:
  static constexpr std::chrono::milliseconds kNoWait{0};
  static constexpr size_t kAhead = 1000;

  void open_file(const std::string& path) {
    name_ = path == "-" ? "standard input" : path;
    in_ =
        FileDescriptor(path == "-" ? dup(STDIN_FILENO) : open(path.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat status {};
    if (!in_.is_open() || fstat(in_.get(), &status) != 0)
      throw InputError(name_ + ": " + std::strerror(errno));
    is_file_ = S_ISREG(status.st_mode);
  }

  void open_udp(int port) {
    name_ = "UDP port " + std::to_string(port);
    is_udp_ = true;
    in_ = FileDescriptor(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (!in_.is_open() ||
        bind(in_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw InputError(name_ + ": " + std::strerror(errno));
  }

  void read_some() {
    std::array<char, 2048> bytes{};
    const ssize_t count = read(in_.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) return;
    if (count < 0) throw RunError(name_ + ": " + std::strerror(errno));
    text_.append(bytes.data(), static_cast<size_t>(count));
    ended_ = count == 0 && !is_udp_;
    // The last line of a file, and that of a datagram, need no end.
    if ((ended_ || is_udp_) && !text_.empty()) text_ += '\n';
    for (size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
      const std::optional<Fix> fix =
          parse_fix(text_.substr(0, end), name_ + ", line " + std::to_string(++lines_));
      text_.erase(0, end + 1);
      if (fix.has_value()) fixes_.push_back(*fix);
    }
  }

  std::string name_;
  FileDescriptor in_;
  bool is_file_ = false;
  bool is_udp_ = false;
  bool ended_ = false;
  std::string text_;  ///< of a line that is not whole yet
  size_t lines_ = 0;
  std::deque<Fix> fixes_;
};

class FixSender {
 public:
  explicit FixSender(const FixArguments& arguments)
      : arguments_(arguments),
        source_(arguments),
        link_(open_link(arguments.link)),
        session_(*link_, {command_key(arguments.link), !arguments.listen, {}, {}}) {}

  int run() {
    while (!interrupted() && !(source_.ended() && !session_.waiting())) {
      session_.pump(kFixPump);
      const uint64_t now_us = wall_clock_us();
      follow(now_us);
      if (session_.ready() && !session_.waiting() && now_us >= next_us_) send_next(now_us);
    }
    std::cout << taken_ << " fixes taken by robot " << int{session_.node()} << ", " << unanswered_
              << " without an answer, " << uncertain_ << " too uncertain" << std::endl;
    return interrupted_exit_code();
  }

 private:
  /// What became of the fix that was sent last.
  void follow(uint64_t now_us) {
    if (!sent_us_.has_value()) return;
    if (session_.waiting() && now_us < *sent_us_ + kFresh_us) return;
    session_.give_up();
    sent_us_.reset();
    const std::optional<CommandAnswer> answer = session_.take_answer();
    if (!answer.has_value() || is_passing(*answer)) {
      ++unanswered_;
    } else if (answer->done()) {
      ++taken_;
    } else {
      throw RunError(link_->name() + ": the robot refuses the fix: " +
                     answer_text(*answer, LatestTelemetry(), now_us));
    }
  }

  void send_next(uint64_t now_us) {
    const std::optional<Fix> fix = source_.next();
    if (!fix.has_value()) return;
    if (fix->sigma_m > arguments_.max_sigma_m) {
      ++uncertain_;
      return;
    }
    session_.start(CommandOp::kPositionFix,
                   command_argument({static_cast<int16_t>(std::lround(fix->x_m * 100.0)),
                                     static_cast<int16_t>(std::lround(fix->y_m * 100.0))}));
    sent_us_ = now_us;
    next_us_ = now_us + kFixPeriod_us;
  }

  const FixArguments& arguments_;
  FixSource source_;
  std::unique_ptr<Link> link_;
  CommandSession session_;
  std::optional<uint64_t> sent_us_;
  uint64_t next_us_ = 0;
  uint64_t taken_ = 0;
  uint64_t unanswered_ = 0;
  uint64_t uncertain_ = 0;
};

}  // namespace

void register_fix_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<FixArguments>(
      root, program, "fix", "Send position fixes, of a camera for instance, to a robot",
      [](const FixArguments& given) {
        catch_interrupts();
        return FixSender(given).run();
      });
  add_link_options(command, arguments.link);
  add_key_option(command, arguments.link);
  command
      .add_option("FROM", arguments.from,
                  "File or pipe of fixes, a line each: x y or x y sigma, in metres; -: standard "
                  "input. Of a file every line is sent, four a second; of a pipe the newest")
      ->type_name("FILE");
  add_number(command, "--udp", arguments.udp,
             "Read such lines from datagrams to this port of the loopback interface", {1, 65535});
  add_number(command, "--max-sigma", arguments.max_sigma_m,
             "Leave out fixes with a greater standard deviation [m]", {0.001, 10.0})
      ->show_default();
  command.add_flag("--listen", arguments.listen,
                   "Send no heartbeats: another ground station is in charge");
}

}  // namespace screed
