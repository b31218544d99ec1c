#!/bin/bash
# screenshot.sh PAGE PNG WIDTH HEIGHT: the top of a page in a headless Chromium.
set -euo pipefail
chromium --headless --no-sandbox --disable-dev-shm-usage --use-angle=swiftshader --enable-unsafe-swiftshader \
  --force-color-profile=srgb --hide-scrollbars --virtual-time-budget=20000 --window-size="$3,$4" --screenshot="$2" \
  "file://$(realpath "$1")" 2> /dev/null
