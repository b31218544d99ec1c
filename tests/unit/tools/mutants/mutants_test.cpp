// The mutation tool: what it changes in a small text, what it leaves alone, and its tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/temp_folder.h"
#include "tools/mutants/builder.h"
#include "tools/mutants/operators.h"
#include "tools/mutants/subjects.h"
#include "tools/mutants/tables.h"
#include "tools/mutants/tests_of_build.h"

namespace screed::mutants {
namespace {

/// The text of a function's body after each of its mutants.
std::vector<std::string> mutants_of(const std::string& body) {
  const std::string head = "void f() { ";
  const std::string source = head + body + " }";
  std::vector<std::string> texts;
  for (const Site& site : find_mutations(source).sites) {
    for (const Mutant& mutant : site.mutants) {
      const std::string text = with_edit(source, mutant.edit);
      texts.push_back(text.substr(head.size(), text.size() - head.size() - 2));
    }
  }
  std::sort(texts.begin(), texts.end());
  return texts;
}

std::vector<std::string> sorted(std::vector<std::string> texts) {
  std::sort(texts.begin(), texts.end());
  return texts;
}

TEST(MutantOperators, ComparisonsMoveTheirBoundaryAndTurnRound) {
  EXPECT_EQ(mutants_of("bool b = x < y;"), sorted({"bool b = x <= y;", "bool b = x >= y;"}));
  EXPECT_EQ(mutants_of("bool b = x == y;"), sorted({"bool b = x != y;"}));
}

TEST(MutantOperators, ArithmeticTurnsIntoItsOpposite) {
  EXPECT_EQ(mutants_of("int a = b + c * d;"), sorted({"int a = b - c * d;", "int a = b + c / d;"}));
  EXPECT_EQ(mutants_of("int a = -b;"), sorted({"int a = b;"}));
}

TEST(MutantOperators, StatementsAreLeftOutButNotDeclarations) {
  EXPECT_EQ(mutants_of("int a = b; Type c(d); call(a);"), sorted({"int a = b; Type c(d); ;"}));
  EXPECT_EQ(mutants_of("a.b += c;"), sorted({";", "a.b -= c;"}));
  EXPECT_EQ(mutants_of("++a;"), sorted({";", "--a;"}));
  EXPECT_EQ(mutants_of("return;"), sorted({";"}));
  EXPECT_EQ(mutants_of("return a;"), std::vector<std::string>{});
}

TEST(MutantOperators, AGuardIsTakenAwayOrTurnedRound) {
  EXPECT_EQ(mutants_of("if (a) call();"),
            sorted({"if (true) call();", "if (!(a)) call();", "if (a) ;"}));
  // The opposite of a comparison is the comparison's own mutant.
  EXPECT_EQ(mutants_of("if (a == b) return;"),
            sorted({"if (a != b) return;", "if (true) return;", "if (a == b) ;"}));
}

TEST(MutantOperators, AndTurnsIntoOr) {
  EXPECT_EQ(mutants_of("bool a = b && c;"), sorted({"bool a = b || c;"}));
}

TEST(MutantOperators, MinimumAndTruthAreSwapped) {
  EXPECT_EQ(mutants_of("int a = std::min(b, c);"), sorted({"int a = std::max(b, c);"}));
  EXPECT_EQ(mutants_of("bool a = true;"), sorted({"bool a = false;"}));
}

TEST(MutantOperators, NumbersBecomeTheirNeighboursOrAnEighthMoreAndLess) {
  EXPECT_EQ(other_numbers("0"), (std::vector<std::string>{"1"}));
  EXPECT_EQ(other_numbers("1U"), (std::vector<std::string>{"0U", "2U"}));
  EXPECT_EQ(other_numbers("100"), (std::vector<std::string>{"88", "112"}));
  EXPECT_EQ(other_numbers("0x80U"), (std::vector<std::string>{"0x70U", "0x90U"}));
  EXPECT_EQ(other_numbers("48'000"), (std::vector<std::string>{"42000", "54000"}));
  EXPECT_EQ(other_numbers("0.0"), (std::vector<std::string>{"1.0"}));
  EXPECT_EQ(other_numbers("0.5F"), (std::vector<std::string>{"0.25F", "1.0F"}));
}

TEST(MutantOperators, LeaveCommentsTextsIncludesAndTypesAlone) {
  const std::vector<std::string> nothing;
  EXPECT_EQ(mutants_of("// a + 1 < 2"), nothing);
  EXPECT_EQ(mutants_of("/* call(1); */"), nothing);
  EXPECT_EQ(mutants_of("auto a = \"1 + 1 == 2\";"), nothing);
  EXPECT_EQ(mutants_of("auto a = R\"(1 < \" 2)\";"), nothing);
  EXPECT_EQ(mutants_of("\n#define A 1 + 1\n"), nothing);
  EXPECT_EQ(mutants_of("static_assert(1 + 1 == 2);"), nothing);
  EXPECT_EQ(mutants_of("std::array<int, 3> a; int b[4];"), nothing);
}

TEST(MutantOperators, LeaveAloneWhatOnlyTheMicrocontrollerSees) {
  EXPECT_EQ(mutants_of("\n#ifdef __AVR__\n\n#if A\na = b;\n#else\na = 2;\n#endif\n"
                       "a = 3;\n#else\n++a;\n#endif\n")
                .size(),
            2U);
  EXPECT_EQ(mutants_of("\n#ifdef __AVR__\na = 3;\n#endif\n++a;").size(), 2U);
  EXPECT_EQ(mutants_of("\n#ifdef OTHER\n++a;\n#endif\n").size(), 2U);
}

TEST(MutantSwitches, StandInOneTextThatKeepsItsLines) {
  const std::string source = "constexpr int kA = 5;\nbool f(int a) {\n  return a < kA;\n}\n";
  const Mutations mutations = find_mutations(source);
  EXPECT_EQ(with_switches(source, mutations, {}, {}),
            "const int kA = (::mutants::on(1) ? 4 : ::mutants::on(2) ? 6 : 5);\nbool f(int a) {\n"
            "  return a < ::mutants::Less{3} < kA;\n}\n");
  EXPECT_EQ(with_switches(source, mutations, {1}, {"kA"}), source);
  EXPECT_EQ(with_switches(source, mutations, {}, {"kA"}, 100),
            "constexpr int kA = 5;\nbool f(int a) {\n  return a < ::mutants::Less{103} < kA;\n}\n");
}

TEST(MutantSwitches, NestAsTheirExpressionsDo) {
  const std::string source = "void f() {\n  if (a && b) ++c;\n}\n";
  EXPECT_EQ(with_switches(source, find_mutations(source), {2, 3}, {}),
            "void f() {\n  if (::mutants::condition(1, 2, static_cast<bool>("
            "::mutants::flip(3, static_cast<bool>(::mutants::flip(3, static_cast<bool>(a)) && "
            "::mutants::flip(3, static_cast<bool>(b))))))) ++c;\n}\n");
}

TEST(MutantTables, AnEquivalentMutantIsFoundByItsTextWhereverItStands) {
  const TempFolder folder;
  const std::filesystem::path table = folder.path() / "equivalent.txt";
  write_text(table, "# why\n\nfile a.cpp\n- x   = 1;\n+ x = 2;\n= nobody reads x\n");
  const std::vector<Equivalent> entries = read_equivalents(table);
  ASSERT_EQ(entries.size(), 1U);
  const std::string source = "void f() {\n\n    x = 1;\n}\n";
  const Change change = change_of(source, {20, 21, "2"});
  EXPECT_EQ(change.line, 3U);
  EXPECT_EQ(change.column, 9U);
  ASSERT_NE(equivalent(entries, "moved/to/a.cpp", change), nullptr);
  EXPECT_EQ(equivalent(entries, "moved/to/a.cpp", change)->reason, "nobody reads x");
  EXPECT_EQ(equivalent(entries, "b.cpp", change), nullptr);
  EXPECT_EQ(equivalent(entries, "a.cpp", change_of(source, {20, 21, "3"})), nullptr);
}

TEST(MutantTables, AnIncompleteEntryIsRefusedWithItsLine) {
  const TempFolder folder;
  const std::filesystem::path table = folder.path() / "equivalent.txt";
  write_text(table, "file a.cpp\n- x = 1;\n= nobody reads x\n");
  try {
    read_equivalents(table);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("equivalent.txt:3:"), std::string::npos)
        << error.what();
  }
}

TEST(MutantTables, ATargetsPatternStandsForAllItsFiles) {
  const TempFolder folder;
  write_text(folder.path() / "a.cpp", "");
  write_text(folder.path() / "b.cpp", "");
  const std::filesystem::path table = folder.path() / "targets.txt";
  write_text(table, "*.cpp 85 sample=7 tests=Soil*  # these\n");
  const std::vector<Target> targets = read_targets(table, folder.path());
  ASSERT_EQ(targets.size(), 2U);
  EXPECT_EQ(targets[1].source, "b.cpp");
  EXPECT_EQ(targets[1].bound, 85.0);
  EXPECT_EQ(targets[1].sample, 7U);
  EXPECT_EQ(targets[1].tests, "Soil*");
  write_text(table, "*.cpp 85 sample=7\na.cpp 95\n");
  ASSERT_EQ(read_targets(table, folder.path()).size(), 2U);
  EXPECT_EQ(read_targets(table, folder.path())[0].bound, 95.0) << "the last row of a source";
  EXPECT_EQ(read_targets(table, folder.path())[0].sample, 0U);
  write_text(table, "c.cpp 85\n");
  EXPECT_THROW(read_targets(table, folder.path()), std::runtime_error);
  write_text(table, "a.cpp 120\n");
  EXPECT_THROW(read_targets(table, folder.path()), std::runtime_error);
}

/// Below `folder`, at any depth.
std::vector<std::string> sources_below(const std::string& folder) {
  std::vector<std::string> sources;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".cpp") sources.push_back(entry.path().string());
  }
  return sources;
}

// A row that names nothing and an entry without a mutant end `make mutants` before its first one.
TEST(MutantTables, OfTheTreeNameWhatThereIs) {
  EXPECT_NO_THROW(read_subjects("tools/mutants/targets.txt", "tools/mutants/equivalent.txt"));
  std::vector<std::string> named;
  for (const Target& target : read_targets("tools/mutants/targets.txt", ".")) {
    named.push_back(target.source);
    EXPECT_GE(target.bound, 85.0) << target.source;
    const std::string folder = target.source.substr(0, target.source.find('/'));
    EXPECT_TRUE(folder == "firmware" || folder == "host_sim" || folder == "nn" ||
                target.source.starts_with("hal/host/"))
        << target.source << " is not in the library of the tests";
  }
  for (const char* folder : {"firmware", "hal/host"}) {
    for (const std::string& source : sources_below(folder)) {
      EXPECT_NE(std::find(named.begin(), named.end(), source), named.end()) << source;
    }
  }
}

TEST(MutantUnits, AreWhatTheCompilersNotesSay) {
  const Unit one = unit_of("b/a.o: \\\n a.cpp a.h \\\n c.h\na.h:\nc.h:\n");
  EXPECT_EQ(one.object, "b/a.o");
  EXPECT_EQ(one.source, "a.cpp");
  EXPECT_EQ(one.included, (std::vector<std::string>{"a.cpp", "a.h", "c.h"}));
  EXPECT_EQ(unit_of("").object, "");
}

TEST(MutantTests, TheTestThatFailedIsNotTheSkippedOneBehindIt) {
  EXPECT_EQ(failed_test("[ RUN      ] A.First\n"
                        "[       OK ] A.First (0 ms)\n"
                        "[ RUN      ] A.Second\n"
                        "a.cpp:3: Failure\n"
                        "[  FAILED  ] A.Second (1 ms)\n"
                        "[ RUN      ] A.Third\n"
                        "[  SKIPPED ] A.Third (0 ms)\n"),
            "A.Second");
  EXPECT_EQ(failed_test("[ RUN      ] A.First\n"
                        "[       OK ] A.First (0 ms)\n"
                        "[ RUN      ] A.Second\n"),
            "A.Second")
      << "crashed";
  EXPECT_EQ(failed_test("no such program"), "");
}

TEST(MutantTests, ATestWithParametersIsKnownByItsPlainName) {
  EXPECT_EQ(plain_name("Suite.Name"), "Suite.Name");
  EXPECT_EQ(plain_name("All/Suite.Name/3"), "Suite.Name");
  EXPECT_EQ(plain_name("Suite/0.Name"), "Suite.Name");
}

}  // namespace
}  // namespace screed::mutants
