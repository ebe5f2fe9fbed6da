#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_coordinator.sh BINARY: the coordinator never traces a ray, so the renderer must not be linked into it.
# Exit status 0 if it is not, 1 with the names found if it is, 2 if BINARY's symbols cannot be read.
set -euo pipefail

binary=${1:?usage: check_coordinator.sh BINARY}
symbols=$(nm --demangle "$binary") || exit 2
# A binary whose symbols are stripped would pass whatever it contains.
grep -q ' main$' <<<"$symbols" || { echo "check_coordinator.sh: $binary has no symbol 'main'" >&2; exit 2; }

found=$(grep -E 'tessera::core::(integrators|accel)::' <<<"$symbols" || true)
[ -n "$found" ] || exit 0
printf 'The coordinator links the renderer:\n%s\n' "$found"
exit 1
