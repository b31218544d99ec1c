#!/usr/bin/env python3
"""Changes one thing at a time in the sources of tools/mutants/targets.txt and says which changes the tests notice.
`make mutants` runs it, in the root of the tree; docs/mutants.md describes it."""
import argparse
import contextlib
import fnmatch
import hashlib
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter, namedtuple
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import operators

HERE = Path(__file__).resolve().parent
TARGETS = Path("tools/mutants/targets.txt")
EQUIVALENTS = Path("tools/mutants/equivalent.txt")
# A mutant's limit: several times what the tests take without one, and what a program needs to start.
SLOWER = 5
START_S = 1
FIRST_PART_S = 0.3  # tests that run in one process; the next ones twice as long
MAX_MEMORY = 6 << 30
LARGEST_FILE = 1 << 30
KEPT_BYTES = 200_000  # of what a program said

Target = namedtuple("Target", "source bound sample")
Equivalent = namedtuple("Equivalent", "file before after reason line")
Change = namedtuple("Change", "line column before after")  # the lines that an edit touches, with single spaces
Unit = namedtuple("Unit", "object source included")  # what the compiler makes one object of
Ended = namedtuple("Ended", "good said out_of_time cpu_s")
Test = namedtuple("Test", "program name file_hash cpu_s reached")


class Wrong(Exception):
    """What ends the program, in one line."""


@dataclass
class Candidate:
    """A mutant of a source."""
    site: int
    number: int  # in its source, from 1
    mutant: operators.Mutant
    change: Change
    fate: str = ""  # killed, survived, equivalent or invalid
    detail: str = ""  # the test that kills it, or the reason why none can

    @property
    def id(self):
        return f"{self.change.line}:{self.change.column}:{self.mutant.name}"


@dataclass
class Subject:
    """A source that is mutated, and what is built of it."""
    target: Target
    text: str
    mutations: operators.Finder
    candidates: list
    first: int = 0  # its number 0 among those of all sources
    folder: Path = None
    objects: dict = field(default_factory=dict)  # with all switches, by the object that they stand for
    alone: set = field(default_factory=set)  # sites without a switch
    kept: set = field(default_factory=set)  # constants without switches

    def is_switched(self, site):
        return site not in self.alone and self.mutations.sites[site].constant not in self.kept


def digest(*parts):
    return hashlib.sha1("\0".join(parts).encode()).hexdigest()[:16]


def digest_of_file(path):
    return hashlib.sha1(Path(path).read_bytes()).hexdigest()[:16]


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def error_of(said):
    """The first line of a compiler's or linker's output that says what is wrong."""
    lines = [line for line in said.splitlines() if "error" in line or "undefined" in line]
    return (lines or said.splitlines() or ["for no reason that it says"])[0]


def tell(text):
    print(f"mutants: {text}", file=sys.stderr, flush=True)


# --- The tables ---

def read_targets(table, root=Path()):
    """Lines "PATTERN BOUND [sample=N]", of which the last one of a source holds."""
    targets = {}
    for number, line in enumerate(table.read_text(encoding="utf-8").splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        if len(words) < 2 or not re.fullmatch(r"\d+(\.\d+)?", words[1]) or float(words[1]) > 100:
            raise Wrong(f"{table}:{number}: a bound of 0 to 100 per cent must follow the source")
        sample = re.fullmatch("sample=0*([1-9][0-9]*)", words[2]) if len(words) == 3 else None
        if len(words) > 2 and not sample:
            raise Wrong(f"{table}:{number}: behind the bound nothing but sample=NUMBER may follow")
        files = sorted(path.relative_to(root).as_posix() for path in root.glob(words[0]))
        if not files:
            raise Wrong(f"{table}:{number}: {words[0]}: no such file")
        for file in files:
            targets[file] = Target(file, float(words[1]), int(sample[1]) if sample else 0)
    return list(targets.values())


def read_equivalents(table):
    """Groups of four lines: "file NAME", "- LINE", "+ LINE", "= REASON"."""
    entries = []
    parts = []
    starts = ["file ", "- ", "+ ", "= "]
    lines = table.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines + [""], 1):
        if not line or line.startswith("#"):
            if parts:
                raise Wrong(f"{table}:{number}: the entry before is not complete")
            continue
        start = starts[len(parts)]
        if not line.startswith(start):
            raise Wrong(f"{table}:{number}: must begin with '{start}'")
        parts.append(" ".join(line[len(start):].split()))
        if len(parts) == 4:
            entries.append(Equivalent(*parts, number))
            parts = []
    return entries


def change_of(source, edit):
    begin = source.rfind("\n", 0, edit.begin) + 1
    end = source.find("\n", edit.end)
    end = end if end >= 0 else len(source)
    after = source[begin:edit.begin] + edit.text + source[edit.end:end]
    return Change(source.count("\n", 0, edit.begin) + 1, edit.begin - begin + 1,
                  " ".join(source[begin:end].split()), " ".join(after.split()))


def read_subjects(targets=TARGETS, equivalents=EQUIVALENTS, root=Path()):
    """All sources with all their mutants, the equivalent ones marked."""
    entries = {}
    stale = []
    for entry in read_equivalents(equivalents):
        if entries.setdefault(entry[:3], entry) is not entry:
            stale.append(entry)
    used = set()
    subjects = []
    for target in read_targets(targets, root):
        text = (root / target.source).read_text(encoding="utf-8")
        mutations = operators.Finder(text)
        candidates = []
        for site_number, site in enumerate(mutations.sites):
            for mutant in site.mutants:
                candidate = Candidate(site_number, len(candidates) + 1, mutant, change_of(text, mutant.edit))
                entry = entries.get((Path(target.source).name, candidate.change.before, candidate.change.after))
                if entry:
                    candidate.fate, candidate.detail = "equivalent", entry.reason
                    used.add(entry)
                candidates.append(candidate)
        subjects.append(Subject(target, text, mutations, candidates))
    stale += [entry for entry in entries.values() if entry not in used]
    if stale:
        raise Wrong("\n".join(f"{equivalents}:{entry.line}: no such mutant of {entry.file} any more"
                              for entry in stale))
    return subjects


def draw_sample(candidates, size, seed):
    """So many of the mutants: a larger sample of the same seed contains a smaller one."""
    if size == 0 or len(candidates) <= size:
        return candidates
    order = sorted(candidates, key=lambda one: digest(str(seed), one.change.before, one.change.after, one.id))
    return sorted(order[:size], key=lambda one: one.number)


# --- Processes ---

def run(command, output, environment=None, limit_s=0.0):
    """Runs a program to its end, or, with a limit of its processor time, until it is ended."""
    output.parent.mkdir(parents=True, exist_ok=True)
    with open(output, "wb") as out:
        child = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                 env={**os.environ, **(environment or {})}, start_new_session=True)
    hung = threading.Event()

    def end():
        hung.set()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child.pid, signal.SIGKILL)

    # What sleeps for ever uses no processor time; what waits for a processor gets some.
    timer = threading.Timer(30 + 20 * limit_s, end)
    if limit_s > 0:
        seconds = math.ceil(limit_s)
        with contextlib.suppress(ProcessLookupError):
            resource.prlimit(child.pid, resource.RLIMIT_CPU, (seconds, seconds + 1))
            resource.prlimit(child.pid, resource.RLIMIT_DATA, (MAX_MEMORY, MAX_MEMORY))
            resource.prlimit(child.pid, resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE))
            resource.prlimit(child.pid, resource.RLIMIT_CORE, (0, 0))
        timer.start()
    _, status, usage = os.wait4(child.pid, 0)
    timer.cancel()
    child.returncode = os.waitstatus_to_exitcode(status)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child.pid, signal.SIGKILL)  # what it started
    with open(output, "rb") as out:
        out.seek(max(0, output.stat().st_size - KEPT_BYTES))
        said = out.read().decode(errors="replace")
    out_of_time = hung.is_set() or child.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
    return Ended(child.returncode == 0, said, out_of_time, usage.ru_utime + usage.ru_stime)


def in_parallel(jobs, what, items):
    """Throws what one of the calls threw, and then begins no other."""
    with ThreadPoolExecutor(jobs) as executor:
        try:
            return [done.result() for done in [executor.submit(what, item) for item in items]]
        except BaseException:
            executor.shutdown(cancel_futures=True)
            raise


# --- Compiling and linking ---

def unit_of(notes):
    """The unit of a compiler's notes (.d), "OBJECT: SOURCE INCLUDED..."; rules of headers follow."""
    rule = notes.replace("\\\n", " ").split("\n")[0].split()
    return Unit(rule[0][:-1], rule[1], rule[1:]) if len(rule) > 1 and rule[0].endswith(":") else None


def complaints_of(said, file):
    """Numbers of the lines of `file` that the compiler's complaints name, and the names that it quotes."""
    lines, names = set(), set()
    for line in said.splitlines():
        place = re.match(r"(?:In file included from )?([^\s:]+):(\d+):(?:\d+:)?(.*)$", line)
        if not place:
            continue
        if place[1].endswith(file) and ("error:" in place[3] or "required from" in place[3]):
            lines.add(int(place[2]))
        names.update(re.findall(r"'(?:[^']*[ :])?(\w+)(?:\([^']*\))?'", place[3]))
    return lines, names


class Builder:
    """What a build is made of stands in the files that mutants.mk writes: PROGRAM.link, the linker's arguments;
    library.objects, what the library in them is made of. The compiler's own notes say which source is in which object,
    on its own or with others."""

    def __init__(self, build, work, unit_only):
        self.build = build
        self.work = work
        self.arguments = {path.stem: path.read_text().split() for path in work.glob("*.link")}
        for program in ["unit_tests"] if unit_only else ["unit_tests", "screed"]:
            if program not in self.arguments:
                raise Wrong(f"{work}/{program}.link is missing: use `make mutants`")
        # Those that hold tests, the quickest first, and the one that they run.
        others = sorted(name for name in self.arguments if name.endswith("_tests") and name != "unit_tests")
        self.test_programs = ["unit_tests"] + ([] if unit_only else others)
        self.programs = self.test_programs + ([] if unit_only else ["screed"])
        self.library = (work / "library.objects").read_text().split()
        objects = set(self.library)
        for program in self.programs:
            for word in self.arguments[program]:
                if word.endswith((".o", ".a")) and not Path(word).exists():
                    raise Wrong(f"{word}, of which {program} is linked, is not built")
            objects.update(word for word in self.arguments[program] if word.endswith(".o"))
        self.units = []
        self.newest = 0  # time of the newest object
        for name in sorted(objects):
            notes = Path(name).with_suffix(".d")
            if not Path(name).exists() or not notes.exists():
                raise Wrong(f"{name}, of which the tests are linked, or its .d is not built")
            self.newest = max(self.newest, Path(name).stat().st_mtime)
            unit = unit_of(notes.read_text())
            if unit is None or unit.object != name:
                raise Wrong(f"{notes} does not say what {name} is made of")
            self.units.append(unit)
        self.linker = ["-fuse-ld=lld"] if shutil.which("ld.lld") else []
        self.switch = work / "mutant_switch.o"
        done = run(["g++", "-O2", f"-I{HERE.parents[1]}", "-c", HERE / "mutant_switch.cpp", "-o", self.switch],
                   work / "switch.txt")
        if not done.good:
            raise Wrong(f"mutant_switch.cpp does not compile: {error_of(done.said)}")

    def units_with(self, source):
        units = [unit for unit in self.units if source in unit.included]
        if not units:
            raise Wrong(f"no object of the tests is made of {source}")
        return units

    def compile(self, unit, folder, target, *options):
        """A unit with the sources in `folder` in place of the tree's."""
        target.parent.mkdir(parents=True, exist_ok=True)
        is_firmware = any(file.startswith(("firmware/", "nn/infer/")) and file.endswith(".cpp")
                          for file in unit.included)
        flags = self.build / ("firmware.flags" if is_firmware else "host.flags")
        # A header, or a source that is compiled with others, is found in the folder by the compiler.
        source = folder / unit.source if (folder / unit.source).exists() else unit.source
        command = ["g++", f"-I{folder}", f"@{flags}", "-w", "-fno-diagnostics-show-caret", "-fmax-errors=0",
                   "-include", HERE / "mutant_switch.h", *options, "-c", source, "-o", target]
        ended = run(command, target.with_suffix(".txt"), {"LC_ALL": "C"})
        # GCC 12 breaks off where vectors of numbers are chosen by switches.
        if not ended.good and "internal compiler error" in ended.said:
            ended = run(command + ["-O0"], target.with_suffix(".txt"), {"LC_ALL": "C"})
        return ended

    def compile_text(self, source, text, folder):
        """All units of the source with this text, in `folder`, which holds no other source: the objects, or what the
        compiler said."""
        write(folder / source, text)
        objects = {}
        for unit in self.units_with(source):
            objects[unit.object] = str(folder / unit.object)
            ended = self.compile(unit, folder, folder / unit.object)
            if not ended.good:
                return None, ended.said
        return objects, ""

    def link(self, program, objects, result):
        result.parent.mkdir(parents=True, exist_ok=True)
        arguments = self.arguments[program]
        # Objects of the library stand before it, which then does not add its own.
        first = [ours for theirs, ours in objects.items() if theirs in self.library and theirs not in arguments]
        arguments = [objects.get(word, word) for word in arguments]
        return run(["g++", *self.linker, "-Wl,--wrap=main", *first, self.switch, *arguments, "-o", result],
                   result.with_name(result.name + ".txt"))

    def link_or_stop(self, program, objects, result):
        ended = self.link(program, objects, result)
        if not ended.good:
            raise Wrong(f"{result} does not link: {error_of(ended.said)}")

    def is_new(self, program):
        return program.exists() and program.stat().st_mtime > self.newest

    def compile_switches(self, subject):
        """All switches that compile; which do not, subject.alone and subject.kept say."""
        # What the compiler made of it without mutants stands for all that it includes.
        source, mutations, text = subject.target.source, subject.mutations, subject.text
        key = digest(operators.with_switches(text, mutations), digest_of_file(HERE / "mutant_switch.h"),
                     *[digest_of_file(unit.object) for unit in self.units_with(source)])
        notes = subject.folder / "switches.json"
        if notes.exists():
            known = json.loads(notes.read_text())
            if known["key"] == key:
                subject.objects = known["objects"]
                subject.alone, subject.kept = set(known["alone"]), set(known["kept"])
                return
        while True:
            switched = operators.with_switches(text, mutations, subject.alone, subject.kept)
            subject.objects, said = self.compile_text(source, switched, subject.folder)
            if subject.objects is not None:
                break
            if not self.take_out(subject, *complaints_of(said, source)):
                if len(subject.alone) == len(mutations.sites):
                    raise Wrong(f"{source} does not compile: {error_of(said)}")
                tell(f"{source} has no switches: {error_of(said)}")
                subject.alone = set(range(len(mutations.sites)))
        write(notes, json.dumps({"key": key, "objects": subject.objects, "alone": sorted(subject.alone),
                                 "kept": sorted(subject.kept)}))
        for program in self.programs:
            (subject.folder / program).unlink(missing_ok=True)

    @staticmethod
    def take_out(subject, lines, names):
        """Takes out switches that the compiler complains of. False: of none."""
        alone, kept, sites = subject.alone, subject.kept, subject.mutations.sites
        known = len(alone) + len(kept)
        constants = {constant.name for constant in subject.mutations.constants}
        kept |= constants & names
        # Of a line that does not compile the operators of two operands first: they are choosy.
        for replaced in (True, False):
            for i, site in enumerate(sites):
                if bool(site.replacements) != replaced or i in alone:
                    continue
                begin = subject.text.count("\n", 0, site.mutants[0].edit.begin) + 1
                ends = [subject.text.count("\n", 0, wrap.end - 1) + 1 for wrap in site.wraps]
                if lines.isdisjoint(range(begin, max([begin, *ends]) + 1)):
                    continue
                if site.constant:
                    kept.add(site.constant)
                else:
                    alone.add(i)
            if len(alone) + len(kept) != known:
                return True
        # Sizes of arrays and the like: no message names the constants in them.
        all_lines = subject.text.split("\n")
        named = " ".join(all_lines[line - 1] for line in lines if line <= len(all_lines))
        kept |= constants & set(re.findall(r"\w+", named))
        return len(alone) + len(kept) != known


# --- Tests ---

def is_wanted(name, patterns):
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns.split(":"))


def failed_test(said):
    """The test that failed, of what a program run with --gtest_fail_fast said: tests behind it are begun, too, as
    skipped ones; one that crashed or was ended has no result and is the last."""
    failed = re.search(r"\[  FAILED  \] ([^\n, ]+)", said)
    begun = re.findall(r"\[ RUN      \] ([^\n, ]+)", said)
    return failed[1] if failed else begun[-1] if begun else ""


def test_environment(programs, scratch):
    temporary = scratch / "tmp"
    shutil.rmtree(temporary, ignore_errors=True)
    temporary.mkdir(parents=True)
    return {"SCREED_PROGRAM": str((programs / "screed").absolute()), "TMPDIR": str(temporary.absolute())}


def find_killer(tests, programs, scratch, mutant):
    """Runs tests, the quickest first, until one fails: that one, or ""."""
    part_s = FIRST_PART_S
    tests = list(tests)
    while tests:
        part = [tests.pop(0)]
        sum_s = part[0].cpu_s
        while tests and tests[0].program == part[0].program and sum_s + tests[0].cpu_s <= part_s:
            sum_s += tests[0].cpu_s
            part.append(tests.pop(0))
        part_s = 2 * max(part_s, sum_s)
        environment = test_environment(programs, scratch) | {"MUTANT": str(mutant)}
        ended = run([programs / part[0].program, "--gtest_fail_fast",
                     "--gtest_filter=" + ":".join(test.name for test in part)],
                    scratch / "output.txt", environment, START_S + SLOWER * sum_s)
        if not ended.good:
            return (failed_test(ended.said) or part[0].name) + " (time)" * ended.out_of_time
    return ""


def names_of(program, scratch):
    """The tests of a program, each with the hash of its source."""
    listing = scratch / "list.json"
    run([program, "--gtest_list_tests", f"--gtest_output=json:{listing}"], scratch / "list.txt")
    if not listing.exists():
        raise Wrong(f"{program} does not list its tests")
    hashes = {}
    for suite in json.loads(listing.read_text())["testsuites"]:
        for test in suite["testsuite"]:
            if test["file"] not in hashes:
                hashes[test["file"]] = digest_of_file(test["file"])
            yield f"{suite['name']}.{test['name']}", hashes[test["file"]]


# --- A campaign ---

class Campaign:
    """Builds the mutants, finds what tests reach them, runs those tests, and keeps what came out in a file, so that the
    next campaign does only what is missing."""

    def __init__(self, options, subjects):
        self.options = options
        self.subjects = subjects
        self.builder = Builder(options.build, options.work, options.unit)
        self.tests = []
        self.test_of_name = {}
        self.reached_by = {}  # tests, by number among all mutants
        self.results = {}  # by hash of the source and id of the mutant
        self.kills = Counter()  # by test, in the source at hand
        self.lock = threading.Lock()
        self.results_file = options.work / "results.txt"
        if self.results_file.exists():
            for line in self.results_file.read_text().splitlines():
                source, mutant, *result = line.split(" ", 4)
                self.results[source, mutant] = result

    def run(self):
        in_parallel(self.options.jobs, self.builder.compile_switches, self.subjects)
        self.find_reach()
        missing = [(subject, program) for subject in self.subjects for program in self.builder.programs
                   if not self.builder.is_new(subject.folder / program)]
        in_parallel(self.options.jobs, lambda pair: self.builder.link_or_stop(
            pair[1], pair[0].objects, pair[0].folder / pair[1]), missing)
        for subject in self.subjects:
            to_run = [one for one in subject.candidates if not one.fate and not self.recall(subject, one)]
            tell(f"{subject.target.source}: {len(to_run)} of {len(subject.candidates)} to run")
            self.kills.clear()
            in_parallel(self.options.jobs, lambda candidate: self.decide(subject, candidate), to_run)

    def build_reach(self, folder):
        """Programs that note which mutants a test reaches; they hold all sources with their switches. Returns what they
        are made of, hashed."""
        # All copies in one folder, since an object may be made of several of them.
        sources = folder / "sources"
        shutil.rmtree(sources, ignore_errors=True)
        units = {}
        parts = [digest_of_file(HERE / "mutant_switch.h")]
        for subject in self.subjects:
            text = operators.with_switches(subject.text, subject.mutations, subject.alone, subject.kept, subject.first)
            write(sources / subject.target.source, text)
            parts.append(digest(text))
            units.update((unit.object, unit) for unit in self.builder.units_with(subject.target.source))
        key = digest(*parts)
        stamp = folder / "key.txt"
        if (stamp.exists() and stamp.read_text() == key and
                all(self.builder.is_new(folder / program) for program in self.builder.programs)):
            return key

        def compile_one(unit):
            ended = self.builder.compile(unit, sources, folder / unit.object, "-DMUTANTS_REACH")
            if not ended.good:
                raise Wrong(f"switches do not compile together: {error_of(ended.said)}")

        in_parallel(self.options.jobs, compile_one, units.values())
        objects = {name: str(folder / name) for name in units}
        for program in self.builder.programs:
            self.builder.link_or_stop(program, objects, folder / program)
        write(stamp, key)
        return key

    def find_reach(self):
        folder = self.options.work / "reach"
        key = self.build_reach(folder)
        log = self.options.work / "reach.txt"
        known = {}
        if log.exists():
            for line in log.read_text().splitlines():
                of, *test = json.loads(line)
                if of == key:
                    known[tuple(test[:3])] = Test(*test)
        wanted = [(program, name, file_hash) for program in self.builder.test_programs
                  for name, file_hash in names_of(folder / program, folder)
                  # A stored hash notices everything and asserts nothing.
                  if is_wanted(name, self.options.tests) and not name.startswith("ContentHash.")]
        missing = [test for test in wanted if test not in known]
        tell(f"what {len(wanted)} tests reach; known of {len(wanted) - len(missing)}")
        idle = {program: self.reach_of(folder, program, "-*")[1] for program in {test[0] for test in missing}}

        def reach_one(test):
            program, name, _ = test
            passes, cpu_s, reached = self.reach_of(folder, program, name)
            known[test] = Test(*test, round(max(0.0, cpu_s - idle[program]), 4) if passes else -1.0, reached)
            with self.lock, open(log, "a") as out:
                print(json.dumps([key, *known[test]], separators=(",", ":")), file=out)

        in_parallel(self.options.jobs, reach_one, missing)
        for test in map(known.get, wanted):
            if test.cpu_s < 0:
                tell(f"{test.name} does not pass and is left out")
            elif self.options.longest == 0 or test.cpu_s <= self.options.longest:
                self.tests.append(test)
        tell(f"{len(wanted) - len(self.tests)} tests are left out, most of them for their time (--longest)")
        for test in self.tests:
            self.test_of_name[test.name] = test
            for i in test.reached:
                self.reached_by.setdefault(i, []).append(test)

    def reach_of(self, folder, program, test):
        """Whether it passes, its processor time, and the mutants that it passes."""
        last = self.subjects[-1]
        mutants = last.first + sum(len(site.mutants) for site in last.mutations.sites)
        with tempfile.TemporaryDirectory(dir=self.options.work) as name:
            scratch = Path(name)
            (scratch / "reach").write_bytes(bytes(mutants + 1))
            environment = test_environment(folder, scratch) | {"MUTANTS_REACH": str((scratch / "reach").absolute())}
            ended = run([folder / program, f"--gtest_filter={test}"], scratch / "output.txt",
                        environment)
            passes = ended.good and "[  PASSED  ] 1 test" in ended.said
            return passes, ended.cpu_s, [i for i, passed in enumerate((scratch / "reach").read_bytes()) if passed]

    def tests_for(self, subject, candidate):
        """The tests that may notice a mutant, the quickest first, unit tests before the others."""
        sites = subject.mutations.sites
        site = sites[candidate.site]

        def reaching(wanted):
            numbers = (subject.first + other.first_number + k for i, other in enumerate(sites)
                       if subject.is_switched(i) and wanted(other) for k in range(len(other.mutants)))
            return {test.name for number in numbers for test in self.reached_by.get(number, [])}

        # A constant is made before the first test: whoever uses it reaches it. What has a program of its own is reached
        # with the rest of its function.
        if not site.constant and subject.is_switched(candidate.site) and site.function:
            found = reaching(lambda other: other is site)
        else:
            found = reaching(lambda other: other.function == site.function) if site.function else set()
            found = found or reaching(lambda _: True)
            # Where nothing has a switch, nothing tells which tests reach it.
            if len(subject.alone) == len(sites):
                found = set(self.test_of_name)
        return sorted(map(self.test_of_name.get, found),
                      key=lambda test: (self.builder.programs.index(test.program),
                                        test.cpu_s / (1 + self.kills[test.name]), test.name))

    def recall(self, subject, candidate):
        """What an earlier campaign found, if it still holds: a mutant is killed as long as the file of the test that
        killed it is the same, and survives as long as those of all its tests are."""
        verdict, key, detail = self.results.get((digest(subject.text), candidate.id), ("", "", ""))
        if verdict == "killed":
            test = self.test_of_name.get(detail.split(" ")[0])
            holds = test is not None and test.file_hash == key
        elif verdict == "survived":
            holds = key == self.key_of(self.tests_for(subject, candidate))
        else:
            holds = verdict == "invalid"
        if holds:
            candidate.fate, candidate.detail = verdict, detail
        return holds

    @staticmethod
    def key_of(tests):
        return digest(*sorted(test.name + test.file_hash for test in tests))

    def decide(self, subject, candidate):
        with self.lock:
            tests = self.tests_for(subject, candidate)
        with tempfile.TemporaryDirectory(dir=self.options.work) as scratch:
            if subject.is_switched(candidate.site):
                detail = find_killer(tests, subject.folder, Path(scratch), candidate.number)
            else:
                detail = self.killer_alone(subject, candidate, tests, Path(scratch))
        key = "-"
        if detail is None:
            candidate.fate = "invalid"
        elif detail:
            candidate.fate, candidate.detail = "killed", detail
            name = detail.split(" ")[0]
            key = self.test_of_name[name].file_hash if name in self.test_of_name else "-"
        else:
            candidate.fate, candidate.detail = "survived", "" if tests else "no test reaches it"
            key = self.key_of(tests)
        with self.lock, open(self.results_file, "a") as out:
            self.kills[candidate.detail.split(" ")[0]] += 1
            print(digest(subject.text), candidate.id, candidate.fate, key, candidate.detail, file=out)

    def killer_alone(self, subject, candidate, tests, folder):
        """For a mutant with programs of its own; None: it does not compile."""
        text = operators.with_edit(subject.text, candidate.mutant.edit)
        objects, _ = self.builder.compile_text(subject.target.source, text, folder)
        if objects is None:
            return None
        for program in self.builder.test_programs:
            part = [test for test in tests if test.program == program]
            # Others than unit tests run screed.
            needed = [program] if program == "unit_tests" else [program, "screed"]
            if not part:
                continue
            if not all(self.builder.link(name, objects, folder / name).good for name in needed):
                return None
            killer = find_killer(part, folder, folder / "run", 0)
            if killer:
                return killer
        return ""


def print_list(subjects):
    for subject in subjects:
        for one in subject.candidates:
            print(f"{subject.target.source}:{one.id}\n- {one.change.before}\n+ {one.change.after}")


def report(subjects, seed):
    """Prints survivors and the table. False: a file is below its bound."""
    good = True
    rows = []
    for subject in subjects:
        source = subject.target.source
        for one in subject.candidates:
            if one.fate == "survived":
                print(f"{source}:{one.id}  {one.detail}\n- {one.change.before}\n+ {one.change.after}\n")
        count = Counter(one.fate for one in subject.candidates)
        told = count["killed"] + count["survived"]
        share = 100 * count["killed"] / told if told else 100.0
        below = share < subject.target.bound
        good = good and not below
        is_sample = subject.candidates and subject.candidates[-1].number > len(subject.candidates)
        rows.append(f"{source:44} {len(subject.candidates):5}{'*' if is_sample else ' '} {count['killed']:6} "
                    f"{count['survived']:8} {count['equivalent']:10} {count['invalid']:7} {share:6.1f} % "
                    f"{subject.target.bound:5.0f} %{'  below' if below else ''}")
    print(f"{'file':44} {'mutants':6} {'killed':6} {'survived':8} {'equivalent':10} {'invalid':7} {'killed':>8} "
          f"{'bound':>7}")
    print("\n".join(rows))
    if any("*" in row for row in rows):
        print(f"* a sample, seed {seed}")
    return good


def options_of(arguments):
    parser = argparse.ArgumentParser(prog="mutants", description="Which mutants of the sources in "
                                     "tools/mutants/targets.txt the tests kill")
    parser.add_argument("--build", type=Path, required=True, help="folder of the objects")
    parser.add_argument("--work", type=Path, required=True, help="folder of mutants and results")
    parser.add_argument("--file", action="append", help="only sources whose name contains this; several times")
    parser.add_argument("--jobs", type=int, default=1, help="tests at a time")
    parser.add_argument("--sample", type=int, default=0, help="as many mutants of each source")
    parser.add_argument("--seed", type=int, default=1, help="of the samples")
    parser.add_argument("--list", action="store_true", help="only list the mutants")
    parser.add_argument("--tests", default="*", help="only these tests: PATTERN:PATTERN with * and ?")
    parser.add_argument("--unit", action="store_true", help="without the tests of whole runs (tests/sitl)")
    parser.add_argument("--longest", type=float, default=1.5,
                        help="without the tests that take longer, s of processor time; 0: all (%(default)s)")
    options = parser.parse_args(arguments)
    if options.jobs < 1 or options.sample < 0 or options.longest < 0:
        parser.error("--jobs begins with 1, --sample and --longest with 0")
    return options


def main(arguments):
    options = options_of(arguments)
    begin = time.monotonic()
    try:
        subjects = [subject for subject in read_subjects()
                    if not options.file or any(part in subject.target.source for part in options.file)]
        if not subjects:
            raise Wrong("no row of targets.txt has a name like --file")
        first = 0
        for subject in subjects:
            subject.first = first
            first += len(subject.candidates)
            subject.folder = options.work / subject.target.source.replace("/", ".")
            subject.candidates = draw_sample(subject.candidates, options.sample or subject.target.sample, options.seed)
        if options.list:
            print_list(subjects)
            return 0
        os.nice(19)
        Campaign(options, subjects).run()
    except (Wrong, OSError) as error:
        tell(error)
        return 2
    except KeyboardInterrupt:
        tell("ended; the next run goes on from here")
        return 130
    good = report(subjects, options.seed)
    minutes, seconds = divmod(round(time.monotonic() - begin), 60)
    print(f"{len(subjects)} sources in {minutes} min {seconds} s")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
