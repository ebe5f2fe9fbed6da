#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes for long: builds the preset fuzz and runs each target on its corpus and what earlier runs have found.
# Usage: tests/fuzz/run.sh [SECONDS [TARGET ...]]     (by default 60 s for each of all targets)
#
# What is found stays in build/fuzz/found/TARGET, logs and crashes in FUZZ_LOGS (by default build/fuzz/logs). FUZZ_JOBS
# targets run at once (by default 2); FUZZ_BUILD=no takes the executables as they are. Ends with an error if
# something crashed, took longer than a minute or more memory than allowed: from a few kilobytes, that is a defect.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:-60}
shift || true
logs=$(realpath -m "${FUZZ_LOGS:-build/fuzz/logs}")
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls tests/fuzz/corpus)

if [ "${FUZZ_BUILD:-yes}" = yes ]; then
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz
fi
mkdir -p "$logs"

export ASAN_OPTIONS=detect_stack_use_after_return=1:allocator_may_return_null=0 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=tests/support/lsan.supp:print_suppressions=0
fuzz() {
  local target=$1 options=()
  [ ! -f "tests/fuzz/dictionaries/$target.dict" ] || options+=(-dict="tests/fuzz/dictionaries/$target.dict")
  mkdir -p "build/fuzz/found/$target"
  local TIMEFORMAT='processor seconds: %U %S'
  { time "build/fuzz/bin/fuzz_$target" "build/fuzz/found/$target" "tests/fuzz/corpus/$target" "${options[@]}" \
    -max_total_time="$seconds" -max_len=8192 -timeout=60 -rss_limit_mb=2048 -malloc_limit_mb=512 \
    -print_final_stats=1 -artifact_prefix="$logs/$target-" >"$logs/$target.log" 2>&1; } 2>>"$logs/$target.log" ||
    echo "$target: see $logs/$target.log" >>"$logs/failed"
}

rm -f "$logs/failed"
for target in "${targets[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "${FUZZ_JOBS:-2}" ]; do wait -n; done
  fuzz "$target" &
done
wait
tests/fuzz/totals.sh "$logs"
if [ -f "$logs/failed" ]; then
  cat "$logs/failed" >&2
  exit 1
fi
