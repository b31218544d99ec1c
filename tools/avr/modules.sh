#!/bin/bash
# modules.sh ELF: the bytes of code of each module of an image, largest first. A byte belongs to the source line that it
# was compiled from (addr2line), wherever it was inlined; what has no line are constants, start-up code and libraries.
set -euo pipefail

elf=$1
end=$(avr-size -A "$elf" | awk '$1 == ".text" {print $2}')
seq 0 2 $((end - 2)) | awk '{printf "0x%x\n", $1}' | avr-addr2line -e "$elf" \
  | sed -E 's#:[0-9?]+.*##; s#^.*/(firmware|hal|nn|boards|build)/#\1/#; s#^\./##' \
  | awk -F/ '{
      module = $1 == "firmware" ? "firmware/" $2 : $1 == "hal" &&
        NF > 3 ? "hal/avr/" $3 : $1 == "hal" ? "hal/avr" : $1 == "nn" ? "nn/infer" \
             : $1 == "boards" ? "boards" : $1 == "build" ? "schema" : "constants, libraries"
      if (module ~ /\.(cpp|h)$/) module = "firmware"
      bytes[module] += 2
    }
    END { for (module in bytes) printf "%6d B  %s\n", bytes[module], module }' | sort -rn
