// The remembered link: where its file is, what it keeps, what it refuses.
#include "tools/screed/link/remembered_link.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

/// Sets a variable of the environment until the end of the test.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    const char* const before = std::getenv(name);
    if (before != nullptr) before_ = before;
    set(value);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { set(before_.has_value() ? before_->c_str() : nullptr); }

 private:
  void set(const char* value) const {
    value == nullptr ? unsetenv(name_) : setenv(name_, value, 1);
  }
  const char* name_;
  std::optional<std::string> before_;
};

TEST(RememberedLink, LiesInTheUsersFolderForConfigurations) {
  const Environment home("HOME", "/home/ada");
  {
    const Environment config("XDG_CONFIG_HOME", "/elsewhere");
    EXPECT_EQ(remembered_link_file(), "/elsewhere/screed/link.ini");
  }
  for (const char* none : {static_cast<const char*>(nullptr), "", "relative"}) {
    const Environment config("XDG_CONFIG_HOME", none);
    EXPECT_EQ(remembered_link_file(), "/home/ada/.config/screed/link.ini");
    const Environment no_home("HOME", nullptr);
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
  for (const char* line : {"baud = fast", "bauds = 9600", "port =", "api = 1.5"}) {
    write_text(file, std::string("[link]\n") + line + "\n");
    try {
      read_remembered_link(file);
      ADD_FAILURE() << line;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(file.string() + ":2: ", 0), 0U) << error.what();
    }
  }
}

}  // namespace
}  // namespace screed
