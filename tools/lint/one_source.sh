#!/bin/bash
# one_source.sh: facts that stand once. A source that lists three or more soil parameters or named soils beside their
# table, or that names a board, repeats what is to be made from the table. Tests may: they say what must come out. And
# libraries whose headers cost a compiler seconds: one source includes them, whatever the others need of them stands in
# a header of ours.
set -euo pipefail
cd "$(dirname "$0")/../.."

SOIL=host_sim/physics/soil/soil_parameters
# Rows of the tables: KIND<TAB>NAME<TAB>STRING, a line for each string that gives NAME away.
tables() {
  sed -nE 's/^ *X\((\w+), *"([^"]+)", *"([^"]+)",.*/\1 \2 \3/p' "$SOIL.h" | while read -r member key option; do
    for string in "$member" "$key" "$option"; do printf 'soil parameter\t%s\t%s\n' "$key" "$string"; done
  done
  sed -nE 's/.*\bsoil\("(\w+)",.*/named soil\t\1\t\1/p' "$SOIL.cpp"
  for board in boards/*/board.mk; do
    board=$(basename "$(dirname "$board")")
    printf 'board\t%s\t%s\n' "$board" "$board"
  done
}

for kind in 'soil parameter' 'named soil' board; do
  tables | cut -f1 | grep -qx "$kind" \
    || { echo "tools/lint/one_source.sh: finds no $kind; has its table moved?" >&2; exit 1; }
done

status=0
while read -r library source; do
  found=$(grep -rlE "^# *include <$library/" --include='*.cpp' --include='*.h' firmware hal host_sim nn tools tests |
    grep -vx "$source") || continue
  sed "s|\$|: includes <$library/...>, which is for $source alone|" <<< "$found"
  status=1
done <<'END'
CLI tools/command_line/program.cpp
nlohmann host_sim/core/json_text.cpp
END

# Debian packages are built with what the list names before its tests, less what every build of a
# package has and what only runs.
NOT_BUILT_WITH='g\+\+|pkg-config|python3|povray|avrdude|tio|zip|unzip|fonts-.*'
NOT_IN_THE_LIST='debhelper-compat.*|dh-python|help2man|python3|libsimavr-dev'
listed=$(sed '/^# tests/q; /^#/d' tools/debian-packages.txt | grep -vxE "$NOT_BUILT_WITH|#.*" | LC_ALL=C sort)
build_depends=$(sed -n '/^Build-Depends:/,/^Standards-Version:/p' tools/package/debian/control |
  sed 's/^Build-Depends://; /^Standards-Version:/d; s/[ ,]//g' | grep -vxE "$NOT_IN_THE_LIST" | LC_ALL=C sort)
if ! diff <(echo "$listed") <(echo "$build_depends"); then
  echo "tools/package/debian/control: Build-Depends (>) is not what tools/debian-packages.txt (<) names to build with"
  status=1
fi

mapfile -t sources < <(find firmware hal host_sim nn tools Makefile tests/*.mk tests/*/*.mk \
  \( -name '*.cpp' -o -name '*.h' -o -name '*.mk' -o -name Makefile \) ! -path "$SOIL.*" \
  ! -path tools/build/options.mk | LC_ALL=C sort)
awk -F '\t' -v soil="$SOIL" '
  function report(kind, instead) {
    if (count[kind] >= enough[kind]) {
      printf("%s: repeats %s%s %s; %s\n", file, kind, (count[kind] > 1 ? "s" : ""), names[kind], instead)
      bad = 1
    }
    count[kind] = 0
    names[kind] = ""
  }
  function finish() {
    if (file == "") return
    report("soil parameter", "use kSoilParameters of " soil ".h")
    report("named soil", "use soil_presets() of " soil ".h")
    report("board", "use kDefaultBoard or board_names() of host_sim/run/experiment/board_table.h, " \
      "in makefiles $(BOARD) or $(BOARDS)")
    delete seen
  }
  BEGIN { enough["soil parameter"] = 3; enough["named soil"] = 3; enough["board"] = 1 }
  NR == FNR { kind_of[$3] = $1; name_of[$3] = $2; next }
  FILENAME != file { finish(); file = FILENAME; makefile = file ~ /(\.mk|Makefile)$/
                      word = makefile ? "[A-Za-z0-9_]+" : "\"[^\"]*\"" }
  /^#include/ || (makefile && /^#/) { next }
  {
    line = $0
    while (match(line, word)) {
      string = substr(line, RSTART, RLENGTH)
      gsub(/"/, "", string)
      line = substr(line, RSTART + RLENGTH)
      if (!(string in kind_of) || (makefile && kind_of[string] != "board")) continue
      kind = kind_of[string]
      if ((kind, name_of[string]) in seen) continue
      seen[kind, name_of[string]] = 1
      names[kind] = names[kind] (count[kind]++ ? ", " : "") name_of[string]
    }
  }
  END { finish(); exit bad }' <(tables) "${sources[@]}" || status=1
exit $status
