#!/bin/bash
# debian_changelog.sh NUMBER: debian/changelog of a release, whose changes stand in CHANGELOG.md. DEBFULLNAME and
# DEBEMAIL sign it.
set -euo pipefail
cat <<END
screed ($1) unstable; urgency=medium

  * Release $1: see CHANGELOG.md.

 -- $DEBFULLNAME <$DEBEMAIL>  $(git log -1 --format=%cD)
END
