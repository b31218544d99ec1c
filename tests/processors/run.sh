#!/bin/bash
# run.sh [WAY...]: runs, each computed in the ways that are asked for (all of them without arguments), must have the
# bits that they have on this processor as it is: drives of every kind of world, a flashed image, a network, a replay of
# a session from here, a campaign, worlds that a C program and Python make.
# Ends with "N passed, N failed".
#
# Needs RELEASE, a folder with the program and its libraries, for the way `arm64` ARM64, the same for that, with SYSROOT
# and PYTHON_ARM64, where its packages lie (make test-processors sets all). An emulated processor takes ten to forty
# times as long as this one.
set -uo pipefail
declare -A ways=(
  [older]='env GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-AVX512F'
  [narrowest]='env SCREED_INSTRUCTIONS=baseline'
  [AVX2]='env SCREED_INSTRUCTIONS=AVX2'
  [nehalem]='qemu-x86_64 -cpu Nehalem'
  [arm64]=''
)
order=(older narrowest AVX2 nehalem arm64)
for way in "$@"; do
  [ -v "ways[$way]" ] || { echo "run.sh: '$way': ${order[*]}" >&2; exit 2; }
done
[ $# -gt 0 ] && order=("$@")

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat > "$folder/small.ini" <<'END'
[campaign]
experiment = soft_bed.ini
seeds = 1..2
keep = summary
[grid]
soil.preset = gravel, lete_sand
experiment.duration = 6
END
cp host_sim/data/experiments/soft_bed.ini "$folder"

screed() {  # as the way says
  case $way in
    here) "$RELEASE/screed" "$@" ;;
    arm64) "$ARM64/screed" "$@" ;;
    *) ${ways[$way]} "$RELEASE/screed" "$@" ;;
  esac
}
drive() {
  screed sim "$@" --no-pictures --quiet --out "$folder/$way" > "$folder/log" 2>&1 || { cat "$folder/log"; return 1; }
  sed -nE 's/.*"content_hash": "([0-9a-f]+)".*/\1/p' "$folder/$way/summary.json" | paste -sd ' '
  [ "$way $*" = 'here first_drive --duration 20' ] && mv "$folder/$way" "$folder/recorded"
  rm -rf "${folder:?}/$way"
}
replay() { screed replay "$folder/recorded" 2>&1; }
campaign() {
  { screed campaign run "$folder/small.ini" --out "$folder/$way" --quiet && screed campaign merge "$folder/$way"; } \
    > "$folder/log" 2>&1 ||
    { cat "$folder/log"; return 1; }
  sha256sum < "$folder/$way/runs.csv" | cut -c 1-32
  rm -rf "${folder:?}/$way"
}
c_program() {
  local build=$RELEASE compiler=gcc run=${ways[$way]-}
  [ "$way" = arm64 ] && build=$ARM64 compiler=aarch64-linux-gnu-gcc run='qemu-aarch64 -L /usr/aarch64-linux-gnu'
  $compiler -std=c99 -Ihost_sim/interface host_sim/interface/examples/world.c "$build/libscreed-core.a" -lstdc++ -lm \
    -o "$folder/world" || return 1
  screed prepare "$1" --out "$folder/$1.world" > "$folder/log" 2>&1 || { cat "$folder/log"; return 1; }
  $run "$folder/world" "$folder/$1.world" | tail -n 1
}
# The module takes the library of the folder that it is told.
python() {
  local build=$RELEASE run="${ways[$way]-} /usr/bin/python3" path=tools/python lib=usr/lib/aarch64-linux-gnu
  if [ "$way" = arm64 ]; then
    build=$ARM64
    path+=:$PYTHON_ARM64/usr/lib/python3/dist-packages
    run="qemu-aarch64 -L $SYSROOT -E PYTHONHOME=$PYTHON_ARM64/usr -E LD_LIBRARY_PATH=$SYSROOT/$lib"
    run+=$(printf ":$PYTHON_ARM64/%s" {,usr/}lib/aarch64-linux-gnu $lib/blas $lib/lapack)
    run+=" $PYTHON_ARM64/usr/bin/python3"
  fi
  PYTHONPATH=$path SCREED_LIBRARY=$build/libscreed.so \
    $run -c 'import screed, sys
experiment, hal, seconds, out = sys.argv[1:]
print(screed.sim(experiment, hal=hal, set={"experiment.duration": seconds}, out=out).content_hash)' \
    "$@" "$folder/$way" || return 1
  rm -rf "${folder:?}/$way"
}
# A campaign starts the program anew, for its workers: under qemu-x86_64 these would run on this very processor, and of
# other processors' programs the kernel must know that qemu runs them.
left_out() {
  case "$way $1" in
    'nehalem campaign'*) return 0 ;;
    'arm64 campaign'*) [ ! -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] ;;
    *) return 1 ;;
  esac
}
runs=('drive first_drive --duration 20'
  'drive level_bed --duration 20'
  'drive soft_bed --duration 10'
  'drive straight_ruts --duration 10'
  'drive four_wheels --duration 10'
  'drive gravel_bed --duration 4'
  'drive soft_bed --duration 6 --set robots.count=4'
  'drive soft_bed --hal surrogate --duration 60'
  "drive soft_bed --hal surrogate --model $PWD/nn/models/v2.json --duration 20"
  'drive first_drive --hal mcu --duration 3'
  'replay first_drive'
  'campaign small.ini'
  'c_program level_bed'
  'python level_bed surrogate 60'
  'python soft_bed native 4')

passed=0
failed=0
declare -A expected
for way in here "${order[@]}"; do
  begin=$SECONDS
  for run in "${runs[@]}"; do
    left_out "$run" && { echo "$way: $run left out, since its workers would not be emulated"; continue; }
    if ! got=$($run) || [ -z "$got" ]; then
      failed=$((failed + 1))
      printf '%s: %s fails: %s\n' "$way" "$run" "$got"
    elif [ "$way" = here ]; then
      expected[$run]=$got
      printf '%s  %s\n' "$got" "${run/"$PWD/"/}"
    elif [ "$got" = "${expected[$run]-}" ]; then
      passed=$((passed + 1))
    else
      failed=$((failed + 1))
      printf '%s: %s gives %s\n' "$way" "$run" "$got"
    fi
  done
  echo "$way: $((SECONDS - begin)) s"
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ] && [ $passed -gt 0 ]
