#!/bin/bash
# run.sh: installs the C libraries, moves the tree and builds against it what a user would: the examples, in strict C99
# and as C++. Ends with "N passed, N failed". SCREED_PROGRAM is the program that they are compared with.
set -uo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
. tests/check.sh

make --no-print-directory INSTALLED=yes install-libraries PREFIX="$tree/first" > "$tree/log" 2>&1 ||
  { cat "$tree/log"; exit 1; }
mv "$tree/first" "$tree/moved"
library=$tree/moved/lib
examples=host_sim/interface/examples
export PKG_CONFIG_PATH=$library/pkgconfig LD_LIBRARY_PATH=$library
read -ra soil <<< "$(pkg-config --cflags --libs screed-soil)"
read -ra core <<< "$(pkg-config --cflags --libs screed-core)"
read -ra ode <<< "$(pkg-config --cflags --libs ode)"
strict=(gcc -std=c99 -Wall -Wextra -pedantic -Werror)

# What programs may rely on: the names of the headers, and no library but the compiler's.
names_in() { grep -ohE 'screed_[a-z_]+\(' "$@" | tr -d '(' | LC_ALL=C sort -u; }
foreign='! readelf -d "$0" | grep NEEDED | grep -vE "\[(libstdc\+\+|libm|libgcc_s|libc|ld-linux.*)\.so"'
headers() { (cd "$tree/moved/include/screed" && cat "$@") > "$tree/headers"; }
for it in screed-soil screed-core screed; do
  case $it in
    screed-soil) headers soil.h ;;
    screed-core) headers soil.h world.h ;;
    *) headers soil.h world.h run.h ;;
  esac
  names_in "$tree/headers" > "$tree/header"
  for file in "$library/lib$it".so "$library/lib$it".a; do
    [ -e "$file" ] || continue
    nm "$([[ $file = *.so ]] && echo -D || echo -g)" --defined-only "$file" |
      awk '$2 == "T" { sub(/@.*/, "", $3); print $3 }' | LC_ALL=C sort > "$tree/names"
    check "names of $(basename "$file")" diff "$tree/header" "$tree/names"
  done
done
check 'libscreed needs no simavr' bash -c '! readelf -d "$0" | grep simavr' "$library/libscreed.so"
for it in screed-soil screed-core; do
  check "lib$it needs no library but the compiler's" bash -c "$foreign" "$library/lib$it.so"
  check "nothing else of the program is left in lib$it" \
    bash -c '! nm -C "$0" | grep -E "H5[A-Z]|\b(dBody|dWorld|avr_|cairo_|CLI::)"' "$library/lib$it.a"
done
printf '#include <screed/soil.h>\n#include <screed/run.h>\n' > "$tree/header.cpp"
check 'the headers alone, as C++' g++ -std=c++11 -Wall -Wextra -pedantic -Werror "${soil[@]:0:1}" -fsyntax-only \
  "$tree/header.cpp"

# The wheel pulls as that of the program, to the last bit.
slips=(0 0.2 0.4)
"$SCREED_PROGRAM" soil wheel --json --slip 0,0.2,0.4 | python3 -c '
import json, sys
values = [it["value"] for it in json.load(sys.stdin)["results"] if it["name"] in ("sinkage_mm", "drawbar_pull_n")]
print("\n".join(f"{value:.17g}" for value in values))' > "$tree/program"
check 'a wheel' "${strict[@]}" $examples/wheel.c "${soil[@]}" -lm -o "$tree/wheel"
check 'a wheel, linked statically' "${strict[@]}" $examples/wheel.c "${soil[@]:0:1}" "$library/libscreed-soil.a" \
  -lstdc++ -lm -o "$tree/wheel_static"
for it in wheel wheel_static; do
  "$tree/$it" "${slips[@]}" | grep -oE '(mm|_n) [-0-9.e]+' | cut -d' ' -f2 > "$tree/library"
  check "$it pulls as in the program" diff "$tree/program" "$tree/library"
done

# A world lives as in the program, to the last bit.
figures() { grep -oE '[-0-9.e]+ m' | cut -d' ' -f1 | tail -3; }
"$SCREED_PROGRAM" prepare level_bed --out "$tree/level_bed.world" 2> /dev/null
"$SCREED_PROGRAM" sim level_bed --hal surrogate --duration 60 --no-pictures --json --quiet --out "$tree/run" \
  > "$tree/summary" 2> /dev/null
python3 -c '
import csv, json, sys
row = list(csv.reader(open(sys.argv[1])))[-1]
level = json.load(open(sys.argv[2]))["terrain_after"]["level_deviation_m"]
print("\n".join(f"{float(value):.17g}" for value in (*row[1:3], level)))' "$tree/run/frames.csv" "$tree/summary" \
  > "$tree/program"
check 'a world' "${strict[@]}" $examples/world.c "${core[@]}" -o "$tree/world"
"$tree/world" "$tree/level_bed.world" | figures > "$tree/library"
check 'it lives as in the program' diff "$tree/program" "$tree/library"

# A rover crosses the bed, sinks by some millimetres, and no soil gets lost.
crosses='/ s: x / { ++lines; x = $4; if (NR > 1 && ($10 < 3 || $10 > 15)) sinks_wrong = 1 }
  END { exit !(lines == 6 && x > 0.25 && !sinks_wrong && $0 == "soil moved: 0 units are missing") }'
check 'a rover in ODE' "${strict[@]}" $examples/ode_rover.c "${ode[@]}" "${soil[@]}" -lm -o "$tree/ode_rover"
check 'it crosses the hump' bash -c 'cd "$(dirname "$0")" && "$0" | awk "$1"' "$tree/ode_rover" "$crosses"
check 'a rover in MuJoCo' "${strict[@]}" $examples/mujoco_rover.c "${soil[@]}" -lmujoco -lm -o "$tree/mujoco_rover"
check 'it crosses the bed' bash -c 'cd "$(dirname "$0")" && "$0" | awk "$1"' "$tree/mujoco_rover" "$crosses"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
