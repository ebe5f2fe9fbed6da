#!/usr/bin/env bash
# nightly.sh FARMS [FIRST_SEED] [PROGRAM]: simulates FARMS farms on all cores, of seeds from FIRST_SEED (1) on.
# PROGRAM is simulate_farms, by default of the release build. Prints what went wrong, with the command that replays
# it. Exit status: 0 if nothing went wrong.
set -euo pipefail

farms=${1:?usage: nightly.sh FARMS [FIRST_SEED] [PROGRAM]}
first=${2:-1}
program=${3:-$(dirname "${BASH_SOURCE[0]}")/../../build/release/bin/simulate_farms}
[ -x "$program" ] || { echo "nightly.sh: there is no $program: build the target simulate_farms" >&2; exit 2; }

# Small parts, so that a part of hard farms holds nobody up.
part=1000
for ((begin = first; begin < first + farms; begin += part)); do
  left=$((first + farms - begin))
  echo "$((left < part ? left : part)) $begin"
done | xargs --max-procs="$(nproc)" --max-args=2 "$program" >/tmp/simulate_farms.$$ || status=$?
grep -A1 '^seed' /tmp/simulate_farms.$$ || true
rm -f /tmp/simulate_farms.$$
if [ "${status:-0}" -ne 0 ]; then
  echo "nightly.sh: something went wrong" >&2
  exit 1
fi
echo "$farms farms from seed $first on: nothing went wrong"
