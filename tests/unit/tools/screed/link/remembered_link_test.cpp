// The remembered link: where its file is, what it keeps, what it refuses.
#include "tools/screed/link/robot_link.h"

#include <gtest/gtest.h>

#include <functional>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"
#include "tests/unit/environment_variable.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

/// The message of the InputError.
std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing is refused";
}

TEST(RememberedLink, LiesInTheUsersFolderForConfigurations) {
  const EnvironmentVariable home("HOME", "/home/ada");
  {
    const EnvironmentVariable config("XDG_CONFIG_HOME", "/elsewhere");
    EXPECT_EQ(remembered_link_file(), "/elsewhere/screed/link.ini");
  }
  for (const char* none : {static_cast<const char*>(nullptr), "", "relative"}) {
    const EnvironmentVariable config("XDG_CONFIG_HOME", none);
    EXPECT_EQ(remembered_link_file(), "/home/ada/.config/screed/link.ini");
    const EnvironmentVariable no_home("HOME", nullptr);
    EXPECT_EQ(remembered_link_file(), "");
  }
}

TEST(RememberedLink, ComesBack) {
  const TempFolder folder;
  const fs::path file = folder.path() / "new" / "screed" / "link.ini";
  LinkArguments link;
  link.port = "/dev/ttyUSB0";
  link.baud = 115200;
  link.api = 2;
  link.key = "robot.key";
  write_remembered_link(file, link);
  const LinkArguments read = read_remembered_link(file);
  EXPECT_EQ(read.port, "/dev/ttyUSB0");
  EXPECT_EQ(read.baud, 115200);
  EXPECT_EQ(read.api, 2);
  EXPECT_EQ(read.key, fs::absolute("robot.key").string());
  EXPECT_FALSE(read.can.has_value() || read.pty.has_value() || read.remember);
  EXPECT_EQ(remembered_link_text(read), "port /dev/ttyUSB0, key " + *read.key);

  LinkArguments other;
  other.can = "slcan0";
  write_remembered_link(file, other);  // in place of the first
  EXPECT_EQ(remembered_link_text(read_remembered_link(file)), "can slcan0");
}

TEST(RememberedLink, IsNothingWithoutAFile) {
  const TempFolder folder;
  EXPECT_EQ(remembered_link_text(read_remembered_link(folder.path() / "none")), "");
  EXPECT_EQ(remembered_link_text(read_remembered_link("")), "");
  EXPECT_THROW(write_remembered_link("", {}), InputError);
}

TEST(RememberedLink, RefusesWhatItDoesNotKnowWithFileAndLine) {
  const TempFolder folder;
  const fs::path file = folder.path() / "link.ini";
  for (const char* line : {"baud = fast", "bauds = 9600", "port =", "api = 1.5", "api = 7",
                           "api = -1", "baud = 9599", "baud = 230401"}) {
    write_text(file, std::string("[link]\n") + line + "\n");
    try {
      read_remembered_link(file);
      ADD_FAILURE() << line;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(file.string() + ":2: ", 0), 0U) << error.what();
    }
  }
}

TEST(RememberedLink, SaysWhichNumbersAreAllowed) {
  const TempFolder folder;
  const fs::path file = folder.path() / "link.ini";
  write_text(file, "[link]\nport = /dev/ttyUSB0\napi = 7\n");
  EXPECT_EQ(refusal_of([&] { read_remembered_link(file); }),
            file.string() +
                ":3: 'api = 7' is not allowed; allowed are whole numbers 0 to 2; screed writes the "
                "file anew with --remember");
}

TEST(RememberedLink, OfSeveralLinksIsRefusedWithItsFile) {
  const TempFolder folder;
  const fs::path file = folder.path() / "link.ini";
  write_text(file, "[link]\nport = /dev/ttyUSB0\npty = radio\n");
  const std::string refusal = refusal_of([&] { read_remembered_link(file); });
  EXPECT_EQ(refusal.rfind(file.string() + ": names several links", 0), 0U) << refusal;
}

TEST(RememberedLink, AKeyFileThatIsGoneIsNamedWithTheFileThatRemembersIt) {
  const TempFolder folder;
  const EnvironmentVariable config("XDG_CONFIG_HOME", folder.path().c_str());
  LinkArguments link;
  link.pty = "radio";
  link.key = "/nonexistent";
  write_remembered_link(remembered_link_file(), link);
  const std::string file = "(key remembered in " + remembered_link_file().string() + ")";
  const std::string remembered = refusal_of([] { command_key({}); });
  EXPECT_EQ(remembered.rfind("/nonexistent: No such file", 0), 0U) << remembered;
  EXPECT_NE(remembered.find(file), std::string::npos) << remembered;
  LinkArguments given;
  given.key = "/nonexistent";
  EXPECT_EQ(refusal_of([&] { command_key(given); }).find(file), std::string::npos);
}

}  // namespace
}  // namespace screed
