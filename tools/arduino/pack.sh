#!/bin/bash
# pack.sh BOARD VERSION GENERATED OUT.zip: packs the firmware as a library that the Arduino IDE takes as it is.
#
# The IDE compiles every source below src/ with src/ as the only include folder. So the sources keep their paths below
# src/, and src/pins.h, src/board.h and src/build_info.h lead to the board the library is packed for.
set -euo pipefail

board=$1
version=$2
generated=$3
out=$(realpath -m "$4")
here=$(dirname "$0")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
library=$folder/Screed
src=$library/src

# The IDE wants a version MAJOR.MINOR.PATCH; what comes from elsewhere stays readable in build_info.h.
number=$({ grep -oE '^v?[0-9]+(\.[0-9]+){0,2}' <<< "$version" || [ $? -eq 1 ]; } | tr -d v)
[[ $number =~ \. ]] || number=0.0.0
while [[ $number != *.*.* ]]; do number=$number.0; done

mkdir -p "$src"
# Sources of the firmware and what they include, and nothing of tests or hosts.
find firmware nn/infer hal/avr boards \( -name '*.h' -o -name '*.cpp' \) -print0 | LC_ALL=C sort -z \
  | xargs -0 cp --parents -t "$src"
cp --parents hal/*.h "$src"
# The sketch takes the main program's place, the core's USB that of the image's own.
rm -r "$src/hal/avr/arduino/main.cpp" "$src/hal/avr/usb"
# The core writes the bootloader's key into RAM where that of strokes would lie.
sed -i '/^#define SCREED_LEAVE_OUT "training_drive peak_memory"$/s/"$/ strokes"/' \
  "$src/firmware/parameters/algorithms_in_build.h"
grep -q '"training_drive peak_memory strokes"' "$src/firmware/parameters/algorithms_in_build.h"
# The IDE has flags of its own, and 28,672 bytes as well: what makes the image smaller stands in the sources.
pragma=$(printf ', "%s"' ${SMALLER:-})
[ -z "${SMALLER:-}" ] || find "$src" -name '*.cpp' -exec sed -i "1i #pragma GCC optimize (${pragma#, })" {} +
install -D -m 644 -t "$src/schema" "$generated"/schema/{values,class_values,classes,messages}.h
cp "$here/Screed.h" "$src"

{ echo '// The board this library was packed for: change it here and in pins.h.' ;
  echo "#include \"boards/$board/board.h\"" ; } > "$src/board.h"
{ echo '// The board this library was packed for: change it here and in board.h.' ;
  echo "#include \"boards/$board/pins.h\"" ; } > "$src/pins.h"
{ echo "#define SCREED_VERSION \"$version\"" ; echo "#define SCREED_BOARD \"$board\"" ; } > "$src/build_info.h"

sed "s/@VERSION@/$number/" "$here/library.properties.in" > "$library/library.properties"
install -D -m 644 "$here/Screed.ino" "$library/examples/Screed/Screed.ino"
cp LICENSE "$library/"

mkdir -p "$(dirname "$out")"
rm -f "$out"
# The same content gives the same archive.
find "$library" -exec touch -d '2000-01-01 00:00:00 UTC' {} +
(cd "$folder" && find Screed -type f | LC_ALL=C sort | TZ=UTC zip -q -X "$out" -@)
