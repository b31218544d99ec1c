#!/usr/bin/env python3
"""Runs worlds with keys at the ends of their ranges, and with pairs of keys at random.

A run may end by itself, with one line and exit 1, or be refused with exit 2. It may not crash, and not end well with a
robot that nothing can have brought where it is: lifted faster than its motors can, by no hand.
"""
import argparse
import concurrent.futures
import csv
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile

DURATION_S = 7  # start-up takes 4.5
# What a robot's motors, 5 W for its 1.4 kg, could lift it in the window.
WINDOW_S = 0.5
MOST_LIFT_M = 0.25
GRAVITY = 9.80665

DRIVES = ["experiment.algorithm=drive", "drive.speed=0.15", "later.at=1", "later.yaw_kp=0"]
WORLDS = {
    "level": ("straight_ruts", ["map.model=rigid", "trap.kind=none", "vehicle.tracks=false", *DRIVES]),
    "rigid": ("first_drive", DRIVES),
    "chain": ("first_drive", ["vehicle.track_model=chain", *DRIVES]),
    "soil": ("soft_bed", DRIVES),
    "gravel": ("level_bed", DRIVES),
    "wheels": ("level_bed", ["vehicle.tracks=false", "vehicle.model=four_wheels", *DRIVES]),
    "particles": ("gravel_bed", DRIVES),
    "fixed": ("gravel_bed", ["map.model=static_particles", *DRIVES]),
    "robots": ("level_bed", ["robots.count=3", "map.size=3", *DRIVES]),
    "stand-in": ("level_bed", DRIVES),
}
OPTIONS = {"stand-in": ["--hal", "surrogate"]}
# How long or how big a run is, and where its files go.
LEFT_OUT = re.compile(r"experiment\.(duration|name|frames|stop_after|seed)|output_directory_prefix|map\.size")


def keys_of(screed):
    """Of every key with numbers or a few words the values at its ends."""
    text = subprocess.run([screed, "sim", "--keys"], check=True, capture_output=True, text=True).stdout
    ends = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        match = re.fullmatch(r"\[(\w+)\] (\w+)", cells[1]) if len(cells) > 4 else None
        if not match or LEFT_OUT.match(".".join(match.groups())):
            continue
        allowed = cells[4]
        numbers = re.fullmatch(r"an? (number|integer) (\S+?)\.\.(\S+)", allowed)
        if numbers:
            ends[".".join(match.groups())] = [numbers[2], numbers[3]]
        elif re.fullmatch(r"[\w, ]+ or \w+", allowed):
            ends[".".join(match.groups())] = re.split(r", | or ", allowed)
    return ends


def between(ends, chance):
    """One of the ends, or a value between them: even in its logarithm where the range spans decades."""
    if chance.random() < 0.4 or not re.fullmatch(r"[-+.\de]+", ends[0]):
        return chance.choice(ends)
    low, high = float(ends[0]), float(ends[1])
    if high > 1e3 * max(low, 1e-3) and low >= 0.0:
        least = max(low, 1e-3 if high < 1e3 else 1.0)
        value = least * (high / least) ** chance.random()
    else:
        value = chance.uniform(low, high)
    return str(round(value)) if "." not in ends[0] + ends[1] and "e" not in ends[0] + ends[1] else f"{value:.5g}"


def greatest_lift(frames):
    """How much height, motion counted as height, the robot gained within the window, and its greatest, m."""
    with open(frames, newline="") as file:
        rows = csv.reader(file)
        next(rows)
        states = [[float(cell) for cell in row[:4]] for row in rows]
    heights = []
    for before, now in zip(states, states[1:]):
        dt = now[0] - before[0]
        speed = sum((b - a) ** 2 for a, b in zip(before[1:], now[1:])) ** 0.5 / dt
        if any(abs(b - a) > 0.4 for a, b in zip(before[1:3], now[1:3])):
            speed = 0.0  # it came in at the other edge
        heights.append((now[0], now[3] + 0.5 * speed * speed / GRAVITY))
    lift, first = 0.0, 0
    for i, (time, height) in enumerate(heights):
        while heights[first][0] < time - WINDOW_S:
            first += 1
        lift = max(lift, height - min(h for _, h in heights[first:i + 1]))
    return lift, max((abs(h) for _, h in heights), default=0.0)


def run(screed, name, sets):
    """Runs one; returns its verdict, a word and what there is to say."""
    experiment, keys = WORLDS[name]
    arguments = [screed, "sim", experiment, "--quiet", "--no-pictures", "--duration", str(DURATION_S)]
    arguments += OPTIONS.get(name, [])
    for one in [*keys, *sets]:
        arguments += ["--set", one]
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "run")
        try:
            done = subprocess.run([*arguments, "--out", str(out)], capture_output=True, text=True, check=False,
                                  timeout=600)
        except subprocess.TimeoutExpired:
            return "slow", "not done in 600 s"
        said = without_notes(done.stderr)
        if done.returncode < 0:
            return "FAIL", signal.Signals(-done.returncode).name
        if done.returncode != 0:
            if done.returncode not in (1, 2) or "\n" in said or not said:
                return "FAIL", f"exit {done.returncode}: {said}"
            if any(pathlib.Path(folder).rglob("*.partial")):
                return "FAIL", "left a .partial behind: " + said
        if not (out / "frames.csv").exists():
            return ("refused" if done.returncode == 2 else "ended"), said
        # It has a result, with exit 1 too: a robot that was stopped by a fault, say.
        lift, highest = greatest_lift(out / "frames.csv")
        by_hand = any(one.startswith(("vehicle.z=", "experiment.lay_on_side_at=")) for one in sets)
        if lift > MOST_LIFT_M and not by_hand:
            return "FAIL", f"exit {done.returncode}, lifted by {lift:.3g} m, at most {highest:.3g} m high: {said}"
        return "ran", f"lift {lift:.3g} m"


def without_notes(text):
    """What a program says beside its notes, which may come before the one line of an error, or be it."""
    lines = text.strip().splitlines()
    return "\n".join([line for line in lines if not line.startswith("note: ")] or lines[-1:])


def run_short_of_memory(screed, experiment, megabytes):
    """Runs one with so much address space; returns its verdict."""
    with tempfile.TemporaryDirectory() as folder:
        limit = megabytes << 20
        done = subprocess.run([screed, "sim", experiment, "--quiet", "--duration", "1", "--out", folder + "/run"],
                              capture_output=True, text=True, check=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        said = without_notes(done.stderr)
        if done.returncode not in (0, 1, 127) or "\n" in said or (done.returncode == 1 and not said):
            return "FAIL", f"exit {done.returncode}: {said}"
        if any(pathlib.Path(folder).rglob("*.partial")):
            return "FAIL", "left a .partial behind: " + said
        return {0: "ran", 1: "ended", 127: "refused"}[done.returncode], said


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("screed", help="the program")
    parser.add_argument("--world", action="append", choices=sorted(WORLDS), help="only this world (may be repeated)")
    parser.add_argument("--key", default="", help="only keys that begin like this")
    parser.add_argument("--pairs", type=int, default=300, help="random pairs of keys, over all worlds")
    parser.add_argument("--sample", type=int, help="that many of the runs with one key, at random, instead of all")
    parser.add_argument("--memory-step", type=int, default=1, metavar="MB",
                        help="distance of the limits of memory that two beds run with")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--verbose", action="store_true", help="print every run")
    options = parser.parse_args()
    ends = {key: values for key, values in keys_of(options.screed).items() if key.startswith(options.key)}
    chance = random.Random(options.seed)
    worlds = options.world or list(WORLDS)
    runs = [(world, [f"{key}={value}"]) for world in worlds for key in ends for value in ends[key]]
    if options.sample is not None:
        runs = chance.sample(runs, min(options.sample, len(runs)))
    for _ in range(options.pairs):
        pair = chance.sample(sorted(ends), 2)
        runs.append((chance.choice(worlds), [f"{key}={between(ends[key], chance)}" for key in pair]))
    counts = {}
    for experiment in ("gravel_bed", "soft_bed"):  # below 165 MB the libraries alone do not fit
        for megabytes in range(165, 400, options.memory_step):
            verdict, what = run_short_of_memory(options.screed, experiment, megabytes)
            counts[verdict] = counts.get(verdict, 0) + 1
            if options.verbose or verdict == "FAIL":
                print(f"{verdict:8} {experiment} in {megabytes} MB: {what}", flush=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        verdicts = pool.map(lambda one: run(options.screed, *one), runs)
        for (world, sets), (verdict, what) in zip(runs, verdicts):
            counts[verdict] = counts.get(verdict, 0) + 1
            if options.verbose or verdict in ("FAIL", "slow"):
                print(f"{verdict:8} {world:10} {' '.join(sets)}: {what}", flush=True)
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items())))
    return 1 if "FAIL" in counts else 0


if __name__ == "__main__":
    sys.exit(main())
