#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# nightly.sh FARMS [FIRST_SEED] [PROGRAM]: simulates FARMS farms on all cores, of seeds from FIRST_SEED (1) on.
# PROGRAM is simulate_farms, by default of the release build. Prints what went wrong, with the command that replays
# it. Exit status: 0 if nothing went wrong.
set -euo pipefail

farms=${1:?usage: nightly.sh FARMS [FIRST_SEED] [PROGRAM]}
first=${2:-1}
program=${3:-$(dirname "${BASH_SOURCE[0]}")/../../build/release/bin/simulate_farms}
[ -x "$program" ] || { echo "nightly.sh: there is no $program: build the target simulate_farms" >&2; exit 2; }

# In small parts, so that no core is idle for long at the end.
part=1000
parts() {
  local begin left
  for ((begin = first; begin < first + farms; begin += part)); do
    left=$((first + farms - begin))
    echo "$((left < part ? left : part)) $begin"
  done
}

log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
parts | xargs --max-procs="$(nproc)" --max-args=2 "$program" >"$log" || status=$?
grep -v 'nothing went wrong' "$log" || true
if [ "$status" -ne 0 ]; then
  echo "nightly.sh: something went wrong in $farms farms from seed $first on" >&2
  exit 1
fi
echo "$farms farms from seed $first on: nothing went wrong"
