#!/bin/bash
# The Python module against the program and against itself.
set -euo pipefail
python=/usr/bin/python3  # that of Debian's packages
"$python" -c 'import numpy' 2> /dev/null || { echo 'numpy is missing: python3-numpy'; exit 77; }
PYTHONPATH=tools/python "$python" -W error -m unittest tests/python/module_test.py 2>&1
