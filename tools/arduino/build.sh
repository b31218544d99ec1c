#!/bin/bash
# build.sh LIBRARY.zip OUT.elf: unpacks the library and builds its example as the Arduino IDE would, with Debian's
# Arduino core: recipes and flags of its platform.txt, recursive src/, and no include folder but src/, the core and the
# variant.
set -euo pipefail

zip=$(realpath "$1")
out=$(realpath -m "$2")
root=${ARDUINO_ROOT:-/usr/share/arduino/hardware/arduino/avr}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

unzip -q "$zip" -d "$folder"
library=$folder/Screed
core=$root/cores/arduino
for file in library.properties src/Screed.h examples/Screed/Screed.ino; do
  [ -f "$library/$file" ] || { echo "$1: no $file in it" >&2 ; exit 1 ; }
done

# As platform.txt (recipe.c.o.pattern and its neighbours) with Pololu's boards.txt, warnings at their default.
common=(-c -g -Os -w -ffunction-sections -fdata-sections -flto -mmcu=atmega32u4 -DF_CPU=16000000L -DARDUINO=10819
  -DARDUINO_AVR_A_STAR_32U4 -DARDUINO_ARCH_AVR -DUSB_VID=0x1ffb -DUSB_PID=0x2300 \
    '-DUSB_MANUFACTURER="Pololu Corporation"'
  '-DUSB_PRODUCT="Pololu A-Star 32U4"' "-I$core" "-I$root/variants/leonardo")
c=(avr-gcc -std=gnu11 -fno-fat-lto-objects "${common[@]}")
# WString.cpp of this core knows DECIMAL_DIG by the compiler's name only.
cxx=(avr-g++ -std=gnu++11 -fpermissive -fno-exceptions -fno-threadsafe-statics -Wno-error=narrowing
  -DDECIMAL_DIG=__DECIMAL_DIG__ "${common[@]}")

objects=$folder/objects
mkdir -p "$objects/core"
{
  for file in "$core"/*.c; do printf '%s\0' "${c[*]@Q} $file -o $objects/core/$(basename "$file").o" ; done
  for file in "$core"/*.cpp; do printf '%s\0' "${cxx[*]@Q} $file -o $objects/core/$(basename "$file").o" ; done
  while IFS= read -r file; do
    object=$objects/${file#"$library"/src/}.o
    mkdir -p "$(dirname "$object")"
    printf '%s\0' "${cxx[*]@Q} -I$library/src $file -o $object"
  done < <(find "$library/src" -name '*.cpp' | LC_ALL=C sort)
  # A sketch is compiled as C++ behind #include <Arduino.h>.
  printf '%s\0' "${cxx[*]@Q} -I$library/src -x c++ -include Arduino.h \
$library/examples/Screed/Screed.ino -o $objects/sketch.o"
} | xargs -0 -P "$(nproc)" -I{} bash -c '{}'

avr-gcc-ar rcs "$folder/core.a" "$objects"/core/*.o
mkdir -p "$(dirname "$out")"
mapfile -t linked < <(find "$objects" -name '*.o' -not -path "$objects/core/*" | LC_ALL=C sort)
read -ra flags <<< "$(sed -n 's/^ldflags=//p' "$library/library.properties")"  # {compiler.libraries.ldflags}
avr-gcc -w -Os -g -flto -fuse-linker-plugin -Wl,--gc-sections -mmcu=atmega32u4 -o "$out" "${linked[@]}" "${flags[@]}" \
  "$folder/core.a" -lm
flash=$(avr-size -A "$out" | awk '$1 == ".text" || $1 == ".data" {sum += $2} END {print sum}')
echo "$out: $flash of 28672 B of flash"
[ "$flash" -le 28672 ]
