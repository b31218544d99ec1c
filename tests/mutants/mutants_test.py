"""The mutation tool: what it changes in a small text, what it leaves alone, its tables, and a campaign on a program
of a few lines."""
import contextlib
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools/mutants"))
import mutants
import operators


def mutants_of(body):
    """The text of a function's body after each of its mutants."""
    head = "void f() { "
    source = head + body + " }"
    return sorted(operators.with_edit(source, mutant.edit)[len(head):-2]
                  for site in operators.Finder(source).sites for mutant in site.mutants)


class Operators(unittest.TestCase):
    def check(self, body, *changed):
        self.assertEqual(mutants_of(body), sorted(changed))

    def test_comparisons_move_their_boundary_and_turn_round(self):
        self.check("bool b = x < y;", "bool b = x <= y;", "bool b = x >= y;")
        self.check("bool b = x == y;", "bool b = x != y;")

    def test_arithmetic_turns_into_its_opposite(self):
        self.check("int a = b + c * d;", "int a = b - c * d;", "int a = b + c / d;")
        self.check("int a = -b;", "int a = b;")
        self.check("int a = b << c;", "int a = b >> c;")

    def test_statements_are_left_out_but_not_declarations(self):
        self.check("int a = b; Type c(d); call(a);", "int a = b; Type c(d); ;")
        self.check("a.b += c;", ";", "a.b -= c;")
        self.check("++a;", ";", "--a;")
        self.check("return;", ";")
        self.check("return a;")

    def test_a_case_begins_a_statement(self):
        self.check("switch (a) { case k: call(); break; }", "switch (a) { case k: ; break; }",
                   "switch (a) { case k: call(); ; }")

    def test_a_guard_is_taken_away_or_turned_round(self):
        self.check("if (a) call();", "if (true) call();", "if (!(a)) call();", "if (a) ;")
        # The opposite of a comparison is the comparison's own mutant.
        self.check("if (a == b) return;", "if (a != b) return;", "if (true) return;", "if (a == b) ;")
        self.check("int a = b ? c : d;", "int a = !(b) ? c : d;")

    def test_and_turns_into_or(self):
        self.check("bool a = b && c;", "bool a = b || c;")

    def test_a_negation_is_left_out(self):
        self.check("bool a = !b;", "bool a = b;")

    def test_minimum_and_truth_are_swapped(self):
        self.check("int a = std::min(b, c);", "int a = std::max(b, c);")
        self.check("bool a = true;", "bool a = false;")

    def test_numbers_become_their_neighbours_or_an_eighth_more_and_less(self):
        for number, others in {"0": ["1"], "1U": ["0U", "2U"], "100": ["88", "112"], "0x80U": ["0x70U", "0x90U"],
                               "48'000": ["42000", "54000"], "010": ["7", "9"], "0.0": ["1.0"],
                               "0.5F": ["0.25F", "1.0F"], "1e-3": ["5e-04", "0.002"], "1e12": ["5e+11", "2e+12"],
                               "0b11": []}.items():
            self.assertEqual(operators.other_numbers(number), others)

    def test_comments_texts_includes_and_types_are_left_alone(self):
        for body in ("// a + 1 < 2", "/* call(1); */", 'auto a = "1 + 1 == 2";', 'auto a = R"(1 < " 2)";',
                     "\n#define A 1 + 1\n", "\n  #define A \\\n  1 + 1\n", "static_assert(1 + 1 == 2);",
                     "std::array<int, 3> a; int b[4];"):
            self.check(body)

    def test_what_only_the_microcontroller_sees_is_left_alone(self):
        self.assertEqual(len(mutants_of("\n#ifdef __AVR__\n\n#if A\na = b;\n#else\na = 2;\n#endif\n"
                                        "a = 3;\n#else\n++a;\n#endif\n")), 2)
        self.assertEqual(len(mutants_of("\n#ifdef __AVR__\na = 3;\n#endif\n++a;")), 2)
        self.assertEqual(len(mutants_of("\n#ifdef OTHER\n++a;\n#endif\n")), 2)


class Switches(unittest.TestCase):
    def test_stand_in_one_text_that_keeps_its_lines(self):
        source = "constexpr int kA = 5;\nbool f(int a) {\n  return a < kA;\n}\n"
        found = operators.Finder(source)
        self.assertEqual(operators.with_switches(source, found),
                         "const int kA = (::mutants::on(1) ? 4 : ::mutants::on(2) ? 6 : 5);\nbool f(int a) {\n"
                         "  return a < ::mutants::Less{3} < kA;\n}\n")
        self.assertEqual(operators.with_switches(source, found, {1}, {"kA"}), source)
        self.assertEqual(operators.with_switches(source, found, {0, 1}), source)
        self.assertEqual(operators.with_switches(source, found, (), {"kA"}, 100),
                         "constexpr int kA = 5;\nbool f(int a) {\n  return a < ::mutants::Less{103} < kA;\n}\n")

    def test_nest_as_their_expressions_do(self):
        source = "void f() {\n  if (a && b) ++c;\n}\n"
        self.assertEqual(operators.with_switches(source, operators.Finder(source), {2, 3}),
                         "void f() {\n  if (::mutants::condition(1, 2, static_cast<bool>("
                         "::mutants::flip(3, static_cast<bool>(::mutants::flip(3, static_cast<bool>(a)) && "
                         "::mutants::flip(3, static_cast<bool>(b))))))) ++c;\n}\n")

    def test_do_what_the_edited_sources_do(self):
        """Of a program with all kinds of changes each mutant, switched on, prints what its own source does."""
        source = """#include <algorithm>
#include <cstdio>
constexpr int kLimit = 40;
int f(int a, int b) {
  int sum = 0;
  for (int i = 0; i < 5; ++i) {
    if (i == 3 && a > 2) sum += a * b;
    if (!(b >= 2) || i != 1) sum -= std::min(a, i) % 3;
    sum |= b & 1;
  }
  int left = sum > 2 ? sum << 1 : -sum;
  left--;
  return std::max<int>(left, kLimit / 7) ^ (a - b);
}
int main() {
  for (int a = 0; a < 4; ++a) std::printf("%d ", f(a, 3 - a));
}
"""
        found = operators.Finder(source)
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

        def output_of(text, mutant=0):
            program = folder / "program"
            if text:
                (folder / "a.cpp").write_text(text)
                subprocess.run(["g++", "-w", "-fwrapv", "-Wl,--wrap=main", f"-I{ROOT}", "-include",
                                "tools/mutants/mutant_switch.h", folder / "a.cpp", folder / "switch.o", "-o", program],
                               check=True, cwd=ROOT)
            ended = mutants.run([program], folder / "output", {"MUTANT": str(mutant)}, limit_s=1)
            return "does not end" if ended.out_of_time else ended.said

        subprocess.run(["g++", f"-I{ROOT}", "-c", ROOT / "tools/mutants/mutant_switch.cpp", "-o", folder / "switch.o"],
                       check=True)
        original = output_of(source)
        all_mutants = [mutant for site in found.sites for mutant in site.mutants]
        names = {mutant.name.split(".")[0] for mutant in all_mutants}
        self.assertEqual(names, {"comparison", "arithmetic", "bits", "logical", "negation", "sign", "guard", "constant",
                                 "assignment", "step", "statement", "min-max", "condition"})
        self.assertEqual(output_of(operators.with_switches(source, found)), original)
        switched = [output_of("", number) for number in range(1, len(all_mutants) + 1)]
        self.assertGreater(sum(output != original for output in switched), len(all_mutants) / 3)
        # One in four, to be quick.
        for number, mutant in list(enumerate(all_mutants))[1::4]:
            self.assertEqual(switched[number], output_of(operators.with_edit(source, mutant.edit)), mutant)


class TablesCase(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.table = self.folder / "table.txt"

    def assert_refused(self, read, *says):
        with self.assertRaises(mutants.Wrong) as refused:
            read()
        for part in says:
            self.assertIn(part, str(refused.exception))


class Tables(TablesCase):
    def equivalents(self, text):
        self.table.write_text(text)
        return mutants.read_equivalents(self.table)

    def targets(self, text):
        self.table.write_text(text)
        return mutants.read_targets(self.table, self.folder)

    def test_an_equivalent_mutant_is_found_by_its_text_wherever_it_stands(self):
        entry = "# why\n\nfile a.cpp\n- x   = 1;\n+ x = {};\n= nobody reads x\n"
        (self.folder / "a.cpp").write_text("void f() {\n\n    x = 1;\n}\n")
        (self.folder / "b.cpp").write_text("void f() { x = 1; }\n")
        targets = self.folder / "targets.txt"
        targets.write_text("*.cpp 85\n")
        self.table.write_text(entry.format(2))
        of_a, of_b = mutants.read_subjects(targets, self.table, self.folder)
        self.assertEqual([(one.id, one.fate, one.detail) for one in of_a.candidates],
                         [("3:5:statement", "", ""), ("3:9:constant.1", "", ""),
                          ("3:9:constant.2", "equivalent", "nobody reads x")])
        self.assertEqual([one.fate for one in of_b.candidates], ["", "", ""])
        self.table.write_text(entry.format(3))
        self.assert_refused(lambda: mutants.read_subjects(targets, self.table, self.folder), "table.txt:6:", "a.cpp")
        self.table.write_text(2 * entry.format(2))
        self.assert_refused(lambda: mutants.read_subjects(targets, self.table, self.folder), "table.txt:12:")

    def test_an_incomplete_entry_is_refused_with_its_line(self):
        self.assert_refused(lambda: self.equivalents("file a.cpp\n- x = 1;\n= nobody reads x\n"), "table.txt:3:")
        self.assert_refused(lambda: self.equivalents("file a.cpp\n\n"), "table.txt:2:")
        self.assert_refused(lambda: self.equivalents("file a.cpp\n"), "table.txt:2:")

    def test_a_pattern_stands_for_all_its_files(self):
        for name in ("a.cpp", "b.cpp"):
            (self.folder / name).write_text("")
        self.assertEqual(self.targets("*.cpp 85 sample=7  # these\n"), [("a.cpp", 85.0, 7), ("b.cpp", 85.0, 7)])
        # The last row of a source.
        self.assertEqual(self.targets("*.cpp 85 sample=7\na.cpp 95\n"), [("a.cpp", 95.0, 0), ("b.cpp", 85.0, 7)])
        self.assert_refused(lambda: self.targets("c.cpp 85\n"), "table.txt:1:", "c.cpp")
        for row in ("a.cpp 120", "a.cpp", "a.cpp x", "a.cpp 85 sample=0", "a.cpp 85 twice=1", "a.cpp 85 sample=1 x"):
            self.assert_refused(lambda row=row: self.targets(f"\n{row}\n"), "table.txt:2:")

    def test_a_larger_sample_contains_a_smaller_one(self):
        source = "void f() { a(1, 2, 3, 4, 5, 6, 7, 8, 9); }"
        candidates = [mutants.Candidate(0, number, mutant, mutants.change_of(source, mutant.edit))
                      for number, mutant in enumerate((mutant for site in operators.Finder(source).sites
                                                       for mutant in site.mutants), 1)]
        small, large = (mutants.draw_sample(candidates, size, 1) for size in (5, 9))
        self.assertEqual([len(small), len(large)], [5, 9])
        self.assertLess({one.number for one in small}, {one.number for one in large})
        self.assertNotEqual(small, mutants.draw_sample(candidates, 5, 2))
        self.assertEqual(small, sorted(small, key=lambda one: one.number))


class TablesOfTheTree(unittest.TestCase):
    def test_name_what_there_is(self):
        """A row that names nothing and an entry without a mutant end `make mutants` before its first one."""
        self.enterContext(contextlib.chdir(ROOT))
        targets = [subject.target for subject in mutants.read_subjects()]
        named = {target.source for target in targets}
        for target in targets:
            self.assertGreaterEqual(target.bound, 85.0, target.source)
            self.assertTrue(target.source.startswith(("firmware/", "host_sim/", "nn/", "hal/host/")),
                            f"{target.source} is not in the library of the tests")
        for folder in ("firmware", "hal/host"):
            sources = {path.as_posix() for path in Path(folder).rglob("*.cpp")}
            self.assertTrue(sources)
            self.assertEqual(sources - named, set())


class Builds(unittest.TestCase):
    def test_a_unit_is_what_the_compilers_notes_say(self):
        self.assertEqual(mutants.unit_of("b/a.o: \\\n a.cpp a.h \\\n c.h\na.h:\nc.h:\n"),
                         ("b/a.o", "a.cpp", ["a.cpp", "a.h", "c.h"]))
        self.assertIsNone(mutants.unit_of(""))

    def test_the_compilers_complaints_name_lines_and_constants(self):
        said = ("x/a.cpp: In function 'int f()':\n"
                "x/a.cpp:7:3: error: the value of 'kA' is not usable in a constant expression\n"
                "x/b.h:9:1: error: no 'n::kB'\n"
                "x/a.cpp:8:3: note: 'const int kC' is not const\n")
        self.assertEqual(mutants.complaints_of(said, "a.cpp"), ({7}, {"kA", "kB", "kC"}))


class Tests(unittest.TestCase):
    def test_the_one_that_failed_is_not_the_skipped_one_behind_it(self):
        begin = "[ RUN      ] A.First\n[       OK ] A.First (0 ms)\n[ RUN      ] A.Second\n"
        self.assertEqual(mutants.failed_test(begin + "a.cpp:3: Failure\n[  FAILED  ] A.Second (1 ms)\n"
                                             "[ RUN      ] A.Third\n[  SKIPPED ] A.Third (0 ms)\n"), "A.Second")
        self.assertEqual(mutants.failed_test(begin), "A.Second", "crashed")
        self.assertEqual(mutants.failed_test("no such program"), "")

    def test_patterns_choose_them(self):
        self.assertTrue(mutants.is_wanted("Soil.Falls", "Other*:Soil.*"))
        self.assertFalse(mutants.is_wanted("Soil.Falls", "Other*:Soil"))

    def test_what_does_not_end_is_ended(self):
        with tempfile.TemporaryDirectory() as folder:
            output = Path(folder) / "output"
            ended = mutants.run([sys.executable, "-c", "print('begun', flush=True)\nwhile True: pass"], output,
                                limit_s=0.5)
            self.assertEqual((ended.good, ended.said, ended.out_of_time), (False, "begun\n", True))
            ended = mutants.run([sys.executable, "-c", "print(input())"], output, limit_s=5)
            self.assertEqual((ended.good, ended.out_of_time), (False, False), "nothing to read")
            self.assertTrue(mutants.run(["true"], output).good)


SOURCE = """#include "a.h"
constexpr int kSize = 3;
static_assert(kSize > 2, "");
int table[kSize];
int size() { return sizeof(table) / sizeof(int); }
namespace {
int wasted(int a) {
  return a + 1;
}
}  // namespace
int area(int a, int b) {
  if (a < 0) return 0;
  return a * b;
}
int loop(int n) {
  int steps = 0;
  for (int i = 0; i != n; ++i) steps = wasted(steps);
  return steps;
}
int unused(int a) {
  return a - 1;
}
int at_start = unused(7);
"""
TESTS = """#include "a.h"
#include <gtest/gtest.h>
#include <ctime>
TEST(Area, OfARectangle) { EXPECT_EQ(area(2, 5), 10); }
TEST(Area, Fails) { EXPECT_EQ(area(2, 5), 11); }
TEST(Loop, CountsItsSteps) { EXPECT_EQ(loop(3), 3); }
TEST(Table, HasItsSize) { EXPECT_EQ(size(), 3); }
TEST(Unused, Slowly) {
  while (clock() < CLOCKS_PER_SEC / 2) {}
  EXPECT_EQ(unused(2), 1);
}
TEST(ContentHash, NoticesEverything) { EXPECT_EQ(loop(2), 2); }
"""
HEADER = "int area(int a, int b);\nint loop(int n);\nint size();\nint unused(int a);\n"


class ACampaign(unittest.TestCase):
    def setUp(self):
        self.enterContext(contextlib.chdir(self.enterContext(tempfile.TemporaryDirectory())))
        for name, text in {"firmware/a.cpp": SOURCE, "a.h": HEADER, "tests/a_test.cpp": TESTS,
                           "tools/mutants/targets.txt": "firmware/*.cpp 85\n",
                           "tools/mutants/equivalent.txt": "file a.cpp\n- if (a < 0) return 0;\n"
                                                           "+ if (a <= 0) return 0;\n= 0 times b\n",
                           "b/firmware.flags": "-std=c++14 -I.", "b/host.flags": "-std=c++20 -I.",
                           "w/unit_tests.link": "b/a_test.o b/a.o -lgtest_main -lgtest -lpthread",
                           "w/library.objects": "b/a.o"}.items():
            mutants.write(Path(name), text)
        for command in ("g++ @b/firmware.flags -MMD -MP -c firmware/a.cpp -o b/a.o",
                        "g++ @b/host.flags -MMD -MP -c tests/a_test.cpp -o b/a_test.o"):
            subprocess.run(command.split(), check=True)

    def run_tool(self, *arguments):
        """Exit code, what it printed, and what it said beside."""
        command = [sys.executable, "-B", ROOT / "tools/mutants/mutants.py", "--build", "b", "--work", "w", *arguments]
        done = subprocess.run(command, capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def row(self, output):
        return next(line.split() for line in output.splitlines() if line.startswith("firmware/a.cpp "))

    def fates(self):
        return {line.split(" ")[1]: line.split(" ")[2:] for line in Path("w/results.txt").read_text().splitlines()}

    def test_kills_what_tests_notice_and_remembers_it(self):
        code, output, said = self.run_tool("--unit", "--longest", "0.3", "--jobs", "2")
        self.assertEqual(code, 1, said + output)
        self.assertIn("Area.Fails does not pass", said)
        fates = self.fates()
        self.assertEqual(fates["13:12:arithmetic"][::2], ["killed", "Area.OfARectangle"])
        self.assertEqual(fates["8:12:arithmetic"][::2], ["killed", "Loop.CountsItsSteps"])
        self.assertEqual(fates["17:27:step"][::2], ["killed", "Loop.CountsItsSteps"])
        self.assertEqual(fates["21:12:arithmetic"][0], "survived", "it runs before the first test")
        self.assertIn("firmware/a.cpp:21:12:arithmetic  no test reaches it\n- return a - 1;\n+ return a + 1;\n", output)
        self.assertIn("below", output)
        self.assertNotIn("12:9:comparison.1", fates, "equivalent")
        self.assertEqual(self.row(output)[4], "1", "equivalent")
        # The size of an array is a constant: its mutants are compiled each on its own.
        self.assertEqual(fates["2:23:constant.1"][0], "invalid")
        self.assertEqual(fates["2:23:constant.2"][::2], ["killed", "Table.HasItsSize"])
        self.assertEqual(self.row(output)[5], "1", "invalid")

        again = self.run_tool("--unit", "--longest", "0.3")
        self.assertIn("what 5 tests reach; known of 5", again[2])
        self.assertIn("firmware/a.cpp: 0 of", again[2])
        self.assertEqual(self.row(again[1]), self.row(output))

        # A slow test notices what no other one does.
        self.run_tool("--unit", "--longest", "0")
        self.assertEqual(self.fates()["21:12:arithmetic"][::2], ["killed", "Unused.Slowly"])

        # A test that reaches a survivor is new, and the file with the tests that kill another one.
        Path("tests/a_test.cpp").write_text(TESTS + "TEST(Unused, IsNow) { EXPECT_EQ(unused(2), 1); }\n")
        subprocess.run("g++ @b/host.flags -MMD -MP -c tests/a_test.cpp -o b/a_test.o".split(), check=True)
        self.run_tool("--unit", "--longest", "0.3")
        self.assertEqual(self.fates()["21:12:arithmetic"][::2], ["killed", "Unused.IsNow"])
        self.assertEqual(Path("w/results.txt").read_text().count(" 13:12:arithmetic "), 2)
        self.assertEqual(Path("w/results.txt").read_text().count(" 2:23:constant.1 "), 1)

    def test_lists_mutants_without_running_any(self):
        code, output, _ = self.run_tool("--list")
        self.assertEqual(code, 0)
        self.assertIn("firmware/a.cpp:13:12:arithmetic\n- return a * b;\n+ return a / b;\n", output)
        self.assertFalse(Path("w/results.txt").exists())
        _, sample, _ = self.run_tool("--list", "--sample", "3")
        self.assertEqual(len(sample.splitlines()), 9)

    def test_says_in_a_line_what_is_missing(self):
        def assert_ends_with(*parts, arguments=("--unit",)):
            code, _, said = self.run_tool(*arguments)
            self.assertEqual(code, 2, said)
            self.assertEqual(said.count("\n"), 1, said)
            for part in ("mutants: ", *parts):
                self.assertIn(part, said)

        assert_ends_with("screed.link is missing", arguments=())
        assert_ends_with("no row of targets.txt", arguments=("--unit", "--file", "nowhere"))
        notes = Path("b/a.d").read_text()
        Path("b/a.d").write_text("")
        assert_ends_with("a.d does not say what b/a.o is made of")
        Path("b/a.d").write_text(notes.replace("firmware/a.cpp", "firmware/c.cpp"))
        assert_ends_with("no object of the tests is made of firmware/a.cpp")
        Path("b/a.o").unlink()
        assert_ends_with("b/a.o, of which unit_tests is linked, is not built")
        Path("tools/mutants/targets.txt").unlink()
        assert_ends_with("targets.txt")
        self.assertEqual(self.run_tool("--jobs", "0")[0], 2)


if __name__ == "__main__":
    unittest.main()
