#!/bin/bash
# Lines of more than 120 characters in text that git knows, except in data and tables: rows of Markdown and of the DBC,
# POV-Ray's declarations, models and recordings. Ends with 1 and a line a finding.
set -euo pipefail
data='\.(json|svg|csv|obj|stl|dae|urdf|txt|dbc|html|in|h5|png|jpg)$|/corpus/'
found=$(git ls-files | grep -vE "$data" | LC_ALL=C.UTF-8 xargs -d '\n' grep -InE '^.{121,}' |
  grep -vE '^[^:]+:[0-9]+:(\||#declare )') || true
[ -z "$found" ] || { sed -E 's/^([^:]+:[0-9]+):.*/\1: more than 120 characters/' <<< "$found"; exit 1; }
