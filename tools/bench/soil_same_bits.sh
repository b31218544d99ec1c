#!/bin/bash
# soil_same_bits.sh BUILD_FOLDER: compiles soil, particles, terrain and their tests with other optimisations, links each
# with the rest of the build, and compares what the robot leaves behind: on soil every height, and where it stands; on
# particles the hash of the run, in one thread and in two. Ends with 1 when a bit differs.
set -euo pipefail

build=${1:?the folder of a build, such as build/release}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

figures() {  # PROGRAM: heights' hash and the robot's way, without the time it took
  "$1" soil robot --json --bulldozing --avalanches --wrap --relief 0.02 --size 1.5 --duration 2 --left 0.1 --right 0.2 \
    --slip-layer 0.001 \
    | grep -A1 -E 'heights_hash|"name": "(mean_load_n|lower_by_mm|distance_m|away_m)"'
  "$1" soil robot --json --soil gravel --bulldozing --avalanches --duration 1 --left 0.1 --right 0.2 | grep heights_hash
  "$1" soil robot --json --soil lete_sand --slip-bearing 0.3 --duration 1 --cell 0.01 | grep heights_hash
}

on_particles() {  # PROGRAM FOLDER: the run's content hash
  rm -rf "$2"
  "$1" sim host_sim/data/experiments/gravel_bed.ini --set map.size=0.8 --duration 0.5 --quiet --out "$2" > /dev/null
  grep '"content_hash"' "$2/summary.json"
}

for level in -O1 -O3; do
  mkdir -p "$work/$level"
  for source in host_sim/physics/soil/*.cpp host_sim/physics/kernels/*.cpp host_sim/physics/particles/*.cpp \
    host_sim/soil_validation/*.cpp host_sim/physics/terrain/*.cpp; do
    "${CXX:-g++}" @"$build/host.flags" "$level" -c "$source" -o "$work/$level/$(basename "$source" .cpp).o"
  done
  # The library's objects hold several sources each: of what they define again the linker takes the first, which is
  # ours.
  "${CXX:-g++}" "$build/tools/screed/main.o" "$work/$level"/*.o "$build/libscreed.a" \
    -Wl,--allow-multiple-definition -Wl,--as-needed @"$build/link.flags" -o "$work/$level/screed"
  figures "$work/$level/screed" > "$work/$level.txt"
  for threads in 1 2; do
    SCREED_THREADS=$threads on_particles "$work/$level/screed" "$work/run" > "$work/$level-particles-$threads.txt"
    diff "$work/-O1-particles-1.txt" "$work/$level-particles-$threads.txt" || {
      echo "particles: $level in $threads threads gives other bits than -O1 in one"
      exit 1
    }
  done
  diff "$work/-O1.txt" "$work/$level.txt" || { echo "soil: $level gives other bits than -O1"; exit 1; }
done
echo "soil: the same bits with -O1 and -O3 ($(head -1 "$work/-O1.txt" | grep -oE '[0-9a-f]{32}'))"
echo "particles: the same bits with -O1 and -O3, in one thread and in two" \
  "($(grep -oE '[0-9a-f]{32}' "$work/-O1-particles-1.txt"))"
