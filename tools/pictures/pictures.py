#!/usr/bin/env python3
"""Makes the pictures of the pages as pictures.ini says (`make`), looks whether their sources have changed since then
(`check`, which draws nothing), or notes that a change of the sources changes no picture (`accept`).

made.txt has a line a picture: the hash of its sources and of how it is made, its own hash, its path. Comments and white
space of a source do not count, and of a test only the content hashes of runs that it expects: these change whenever a
run does.
"""
import argparse
import configparser
import fnmatch
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
MADE = HERE / "made.txt"
FOLDERS = ("docs/images", "docs/studies/images")


def tracked(*paths):
    # With what is new and not ignored, so that a hash made before a commit holds after it.
    listed = subprocess.run(["git", "ls-files", "-z", "-c", "-o", "--exclude-standard", "--", *paths], cwd=ROOT,
                            check=True, capture_output=True, text=True)
    return sorted({name for name in listed.stdout.split("\0") if name and (ROOT / name).exists()})


def short(data):
    return hashlib.sha256(data).hexdigest()[:16]


def essence(name):
    data = (ROOT / name).read_bytes()
    if name.startswith("tests/"):
        return b" ".join(re.findall(rb'"[0-9a-f]{32}"', data))
    if name.endswith((".cpp", ".h", ".js", ".ini", ".css")):
        comment = rb";.*" if name.endswith(".ini") else rb"//.*"
        return re.sub(rb"\s", b"", re.sub(comment, b"", data))
    return data


class Picture:
    """A section of pictures.ini: pictures that one command makes, or that were drawn by hand (no `by`)."""

    def __init__(self, pattern, section, groups):
        self.pattern = pattern
        self.by = section.get("by", "").strip()
        self.sources = []
        for word in section.get("from", "").split():
            self.sources += groups[word].split() if word in groups else [word]

    def hash(self):
        text = self.by.encode()
        for source in self.sources:
            names = tracked(source)
            if not names:
                sys.exit(f"tools/pictures/pictures.ini: {self.pattern}: no file {source}")
            for name in names:
                text += b"\n" + name.encode() + b" " + essence(name)
        return short(text)

    def make(self):
        """Runs the command in a folder of its own, in whose folder $OUT it leaves the pictures. Their paths."""
        with tempfile.TemporaryDirectory() as work:
            out = pathlib.Path(work) / "out"
            out.mkdir()
            subprocess.run(["bash", "-ec", self.by], cwd=work, check=True, stdout=subprocess.DEVNULL,
                           env={**os.environ, "OUT": str(out), "ROOT": str(ROOT)})
            folder, name = os.path.split(self.pattern)
            made = [f"{folder}/{it.name}" for it in sorted(out.iterdir()) if fnmatch.fnmatch(it.name, name)]
            if not made:
                sys.exit(f"{self.pattern}: its command made no such picture")
            for path in made:
                shutil.copyfile(out / os.path.basename(path), ROOT / path)
            return made


def read():
    ini = configparser.RawConfigParser(comment_prefixes=(";",), delimiters=("=",))
    ini.read(HERE / "pictures.ini")
    return [Picture(name, ini[name], ini["groups"]) for name in ini.sections() if name != "groups"]


def read_made():
    lines = MADE.read_text().splitlines() if MADE.exists() else []
    return {path: (sources, own) for sources, own, path in (line.split() for line in lines)}


def check(pictures):
    made = read_made()
    findings = []
    for path in tracked(*FOLDERS):
        picture = next((it for it in pictures if fnmatch.fnmatch(path, it.pattern)), None)
        if picture is None:
            findings.append(f"{path}: tools/pictures/pictures.ini does not say how it is made")
        elif picture.by:
            sources, own = made.get(path, ("", ""))
            if own != short((ROOT / path).read_bytes()):
                findings.append(f"{path}: not as `make pictures` has made it")
            elif sources != picture.hash():
                findings.append(f"{path}: its sources have changed: make pictures PICTURES={os.path.basename(path)}")
    paths = tracked(*FOLDERS)
    findings += [f"{path}: made, and gone" for path in made if path not in paths]
    findings += [f"tools/pictures/pictures.ini: no picture {it.pattern}" for it in pictures
                 if not fnmatch.filter(paths, it.pattern)]
    for finding in findings:
        print(finding, file=sys.stderr)
    return 1 if findings else 0


def make(pictures, wanted, accept):
    every = {os.path.basename(it) for it in tracked(*FOLDERS)} | {os.path.basename(it.pattern) for it in pictures}
    for want in wanted:
        if not fnmatch.filter(every, want):
            sys.exit(f"{want}: no picture has this name; names are without folders")
    for picture in pictures:
        names = fnmatch.filter(tracked(*FOLDERS), picture.pattern) or [picture.pattern]
        if not picture.by or not any(fnmatch.fnmatch(os.path.basename(it), want) for it in names for want in wanted):
            continue
        print(f"  PICTURE {picture.pattern}", flush=True)
        paths = names if accept else picture.make()
        made = read_made()  # line by line: what is done stays noted when a later one fails
        for path in paths:
            made[path] = (picture.hash(), short((ROOT / path).read_bytes()))
        MADE.write_text("".join(f"{sources} {own} {path}\n" for path, (sources, own) in sorted(made.items())))
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=("make", "check", "accept"))
    parser.add_argument("names", nargs="*", default=["*"], help="pictures to make, e.g. report.png 'soil_*' (all)")
    arguments = parser.parse_args()
    if arguments.command == "check":
        return check(read())
    return make(read(), arguments.names or ["*"], arguments.command == "accept")


if __name__ == "__main__":
    sys.exit(main())
