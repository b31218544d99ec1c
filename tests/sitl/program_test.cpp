// The program as a user meets it: bad input ends with one clear line, the right exit code, and
// nothing left behind.
#include "tests/sitl/program.h"
#include "tests/sitl/terminal.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "paths.h"

namespace screed::testing {
namespace {

constexpr const char* kShort = "[experiment]\nduration = 1\n";
// The smallest model that is complete.
std::string urdf(const std::string& body_name, const std::string& inertia,
                 const std::string& extra = "") {
  std::string text =
      "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n<link name=\"" + body_name +
      "\"><inertial><mass value=\"1\"/><inertia ixx=\"" + inertia +
      "\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial></link>\n";
  for (const std::string wheel : {"fl", "fr", "bl", "br"}) {
    text += "<link name=\"" + wheel;
    text +=
        "_Wheel\"><inertial><mass value=\"0.1\"/><inertia ixx=\"1e-4\" ixy=\"0\" ixz=\"0\" "
        "iyy=\"1e-4\" "
        "iyz=\"0\" izz=\"1e-4\"/></inertial><collision><origin rpy=\"1.5707963 0 0\"/><geometry>"
        "<cylinder radius=\"0.03\" length=\"0.03\"/></geometry></collision></link>\n<joint name=\"";
    text += wheel;
    text += "_joint\" type=\"continuous\"><parent link=\"" + body_name;
    text += "\"/><child link=\"" + wheel;
    text += "_Wheel\"/><origin xyz=\"";
    text += wheel[0] == 'f' ? "0.09 " : "-0.09 ";
    text += wheel[1] == 'l' ? "0.1" : "-0.1";
    text += " 0\"/><axis xyz=\"0 1 0\"/><limit effort=\"1\" velocity=\"1.0\"/></joint>\n";
  }
  return text + extra + "</robot>\n";
}

TEST_F(Program, RunsAndReplays) {
  write("e.ini", kShort);
  const Result sim = run("sim e.ini --quiet --no-pictures");
  EXPECT_EQ(sim.exit_code, 0) << sim.err;
  EXPECT_NE(sim.out.find("out/experiment-0001 "), std::string::npos) << sim.out;
  const Result replay = run("replay out/experiment-0001");
  EXPECT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_NE(replay.out.find("100 ticks"), std::string::npos) << replay.out;
  EXPECT_NE(replay.out.find("identical"), std::string::npos) << replay.out;
}

TEST_F(Program, AModelOfOnesOwnDrives) {
  write("own.urdf", urdf("Body", "0.01"));
  write("e.ini", std::string(kShort) + "[vehicle]\nmodel = own.urdf\n");
  EXPECT_EQ(run("sim e.ini --quiet --no-pictures").exit_code, 0);
}

TEST_F(Program, KeysAreATableForPeopleOnATerminal) {
  Terminal terminal({program_, "sim", "--keys"}, root_);
  EXPECT_EQ(terminal.exit_code(), 0);
  EXPECT_EQ(terminal.screen().rfind("key  ", 0), 0U) << terminal.screen().substr(0, 200);
  EXPECT_EQ(terminal.screen().find("| "), std::string::npos);
  const std::string programs = run("sim --keys").out;
  EXPECT_EQ(programs.rfind("| key | unit | default | allowed | meaning |\n| --- |", 0), 0U);
}

// What pages say of keys, as `[map] edges` or `--set map.edges=walls`: there is such a key.
TEST_F(Program, DocsNameKeysThatThereAre) {
  std::set<std::string> keys;
  std::set<std::string> sections;
  for (const char* command : {"sim --keys", "campaign plan --keys"}) {
    const Result listed = run(command);
    ASSERT_EQ(listed.exit_code, 0) << listed.err;
    std::istringstream table(listed.out);
    for (std::string line; std::getline(table, line);) {
      std::smatch row;
      if (!std::regex_search(line, row, std::regex(R"(^\| \[(\w+)\](?:, \[\w+\])? (\w+) \|)")))
        continue;
      keys.insert(row.str(1) + "." + row.str(2));
      sections.insert(row.str(1));
    }
  }
  EXPECT_GT(keys.size(), 150U);
  std::size_t mentions = 0;
  for (const auto& file : std::filesystem::directory_iterator("docs")) {
    // The examples of extending.md are keys that are to be added.
    if (file.path().extension() != ".md" || file.path().stem() == "extending") continue;
    const std::string page = read(file.path().string());
    const std::regex mention(R"(`\[(\w+)\] (\w+)|--set '?(\w+)\.(\w+)=)");
    for (std::sregex_iterator at(page.begin(), page.end(), mention), end; at != end; ++at) {
      const std::string section = at->str(1) + at->str(3);
      const std::string key = at->str(2) + at->str(4);
      if (sections.count(section) == 0 || key == "KEY") continue;
      ++mentions;
      EXPECT_EQ(keys.count(std::string(section).append(".").append(key)), 1U)
          << file << ": " << at->str();
    }
  }
  EXPECT_GT(mentions, 60U);
}

TEST_F(Program, DocsHaveTheFiguresOfASummary) {
  write("e.ini", std::string(kShort) + "[map]\nmodel = scm\nsize = 0.5\n");
  const Json summary = Json::parse(run("sim e.ini --quiet --no-pictures --json").out);
  const std::string page = read("docs/experiments.md") + read("docs/leveling-metrics.md");
  for (const char* group : {"terrain_before", "terrain_after", "terrain_change", "leveling"}) {
    for (const auto& [name, value] : summary[group].items())
      EXPECT_NE(page.find("`" + name + "`"), std::string::npos) << group << " " << name;
  }
}

// Every subcommand that a file registers is there, and they are listed by name.
TEST_F(Program, ListsEverySubcommandByName) {
  static const std::regex registration("\nvoid register_(\\w+)_command\\(Command&");
  std::map<std::string, std::filesystem::path> folders;
  for (const auto& file : std::filesystem::recursive_directory_iterator("tools/screed")) {
    if (!file.path().filename().string().ends_with("_command.cpp")) continue;
    const std::string text = read(file.path());
    for (std::sregex_iterator it(text.begin(), text.end(), registration), end; it != end; ++it)
      folders.emplace((*it)[1], file.path().parent_path());
  }
  std::vector<std::string> expected;
  for (const auto& [name, folder] : folders) {
    const std::string group = name.substr(0, name.find('_'));
    if (group != name && folders.contains(group) && folders.at(group) == folder) continue;
    expected.push_back(name);
    std::replace(expected.back().begin(), expected.back().end(), '_', '-');
  }
  std::sort(expected.begin(), expected.end());
  EXPECT_GT(expected.size(), 15U);
  std::istringstream help(run("--help").out);
  std::vector<std::string> listed;
  std::string line;
  while (std::getline(help, line) && line != "Subcommands:") {
  }
  while (std::getline(help, line) && !line.empty()) {
    if (line.size() > 2 && line[2] != ' ') listed.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  EXPECT_EQ(listed, expected);
}

TEST_F(Program, ShowsATable) {
  write("e.ini", kShort);
  const Result sim = run("sim e.ini --no-pictures");
  for (const char* part : {"simulated time", "distance driven", "energy", "mean slope",
                           "real-time factor", "content hash"}) {
    EXPECT_NE(sim.out.find(part), std::string::npos) << part;
  }
}

TEST_F(Program, MissingExperiment) {
  expect_refused(run("sim none.ini"), 2, {"none.ini", "no such"});
}

TEST_F(Program, NoArguments) {
  expect_refused(run(""), 2, {"subcommand"});
}

TEST_F(Program, UnknownKey) {
  write("e.ini", "[experiment]\nname = x\n\n[map]\nfoo = 1\n");
  expect_refused(run("sim e.ini"), 2, {"e.ini:5", "'foo'", "[map]", "filename"});
}

TEST_F(Program, UnknownSection) {
  write("e.ini", "[moon]\ngravity = 1\n");
  expect_refused(run("sim e.ini"), 2, {"e.ini:2", "[moon]", "[vehicle]"});
}

TEST_F(Program, NegativeSize) {
  write("e.ini", "[map]\nsize = -3\n");
  expect_refused(run("sim e.ini"), 2, {"e.ini:2", "size", "-3", "0.1..1000"});
}

TEST_F(Program, OverrideOutOfRange) {
  write("e.ini", kShort);
  expect_refused(run("sim e.ini --set experiment.duration=nan"), 2, {"--set", "duration", "nan"});
  expect_refused(run("sim e.ini --seed minus"), 2, {"seed", "minus"});
}

TEST_F(Program, StepThatDoesNotDivideTheTick) {
  write("e.ini", "[physics]\nstep = 0.003\n");
  expect_refused(run("sim e.ini"), 2, {"step", "0.003", "0.01"});
}

TEST_F(Program, MissingImage) {
  write("e.ini", "[map]\nfilename = gone.png\n");
  expect_refused(run("sim e.ini"), 2, {"filename", "gone.png", "no such"});
}

TEST_F(Program, TruncatedImage) {
  const std::string whole =
      read(std::filesystem::path(kDataFolder) / "terrain" / "jacksboro_fault_dem_16bit.png");
  ASSERT_GT(whole.size(), 100000u);
  write("cut.png", whole.substr(0, whole.size() / 2));
  write("e.ini", "[map]\nfilename = cut.png\n");
  expect_refused(run("sim e.ini"), 2, {"cut.png"});
}

TEST_F(Program, ColourImage) {
  // 1 x 1 pixel, RGB, 8 bits; made by ImageMagick.
  static const unsigned char kPng[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
      0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00,
      0x00, 0x90, 0x77, 0x53, 0xde, 0x00, 0x00, 0x00, 0x0c, 0x49, 0x44, 0x41, 0x54, 0x08,
      0xd7, 0x63, 0xf8, 0xcf, 0xc0, 0x00, 0x00, 0x03, 0x01, 0x01, 0x00, 0x18, 0xdd, 0x8d,
      0xb0, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  write("rgb.png", std::string(reinterpret_cast<const char*>(kPng), sizeof kPng));
  write("e.ini", "[map]\nfilename = rgb.png\n");
  expect_refused(run("sim e.ini"), 2, {"rgb.png", "grey"});
}

TEST_F(Program, ModelWithoutWheels) {
  write("m.urdf", "<robot name=\"r\"><link name=\"Body\"/></robot>");
  write("e.ini", "[vehicle]\nmodel = m.urdf\n");
  expect_refused(run("sim e.ini"), 2, {"m.urdf", "four wheels", "wheel_links"});
}

TEST_F(Program, ModelWithNaNInertia) {
  write("m.urdf", urdf("Body", "nan"));
  write("e.ini", "[vehicle]\nmodel = m.urdf\n");
  expect_refused(run("sim e.ini"), 2, {"m.urdf", "ixx"});
}

TEST_F(Program, ModelWithAJointCycle) {
  write("m.urdf", urdf("Body", "0.01",
                       "<joint name=\"back\" type=\"fixed\"><parent link=\"fl_Wheel\"/><child "
                       "link=\"Body\"/></joint>\n"));
  write("e.ini", "[vehicle]\nmodel = m.urdf\n");
  expect_refused(run("sim e.ini"), 2, {"m.urdf", "cycle"});
}

TEST_F(Program, FullDisk) {
  write("e.ini", "[experiment]\nduration = 60\n[map]\nfilename = jacksboro_fault_dem_16bit.png\n");
  // A limit on the size of files stands for a full disk: writing fails half-way. 100 blocks of 1024
  // bytes.
  expect_refused(run("sim e.ini --quiet", "trap '' XFSZ; ulimit -f 100;"), 1, {"session.h5"});
}

TEST_F(Program, UnwritableFolder) {
  write("e.ini", kShort);
  write("file", "in the way");
  expect_refused(run("sim e.ini --out file/run"), 2, {"file"});
  expect_refused(run("sim e.ini --set output_directory_prefix=/proc/nowhere"), 1,
                 {"/proc/nowhere"});
}

TEST_F(Program, TakenFolder) {
  write("e.ini", kShort);
  std::filesystem::create_directories(root_ / "taken");
  write("taken/precious.txt", "precious");
  expect_refused(run("sim e.ini --out taken"), 2, {"taken"});
  EXPECT_EQ(read(root_ / "taken" / "precious.txt"), "precious");
}

TEST_F(Program, ReplayOfSomethingElse) {
  write("session.h5", "no session");
  expect_refused(run("replay session.h5"), 2, {"session.h5"});
  expect_refused(run("replay nowhere"), 2, {"nowhere"});
}

}  // namespace
}  // namespace screed::testing
