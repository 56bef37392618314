#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A tutorial with a body of the reader's own, one with sharp edges: sharp_body.sh TUTORIAL FOLDER SIZE HEIGHT
set -euo pipefail
tests=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
tutorials=$tests/../../docs/tutorials
mkdir -p "$2"
awk -v size="$3" -v height="$4" -f "$tests/octahedron.awk" -f "$tutorials/closed_body.awk" >"$2/body.stl"
"$tutorials/$1/run.sh" "$2"
