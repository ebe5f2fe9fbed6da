#!/usr/bin/env bash
# Builds Tessera and runs every test, in three passes:
#   1. the unit, property and simulation tests under the address and undefined-behaviour sanitizers, and what fuzzing
#      has found worth keeping, with mutants of it (tests/fuzz/README.md);
#   2. core by itself, without the farm and so without gRPC, hardly optimised, with its assertions: its unit tests;
#   3. all tests of the release build. CTest's summary of this pass is the last thing printed.
# Ends with an error at the first pass that fails.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

heading() { printf '\n== %s\n' "$*"; }
jobs=$(nproc)

# build DIRECTORY "CMAKE OPTIONS" [TARGET ...]: quiet unless something goes wrong. Several files of a target are compiled
# as one, which takes a third of the time.
build() {
  local directory=$1 options=$2 log=$1.log
  shift 2
  mkdir -p build
  # shellcheck disable=SC2086  # options are words
  if ! { cmake -S . $options -DCMAKE_UNITY_BUILD=ON &&
    cmake --build "$directory" --parallel "$jobs" ${1:+--target "$@"}; } >"$log" 2>&1; then
    tail -n 100 "$log" >&2
    echo "test.sh: building $directory failed; the whole log is in $log" >&2
    exit 1
  fi
}

heading "Packages"
scripts/setup.sh
echo "all there"

heading "Pass 1 of 3: address and undefined-behaviour sanitizers"
build build/asan "--preset asan" tests_unit tests_property tests_simulation tests_fuzz
ASAN_OPTIONS=detect_stack_use_after_return=1 \
  LSAN_OPTIONS=suppressions=$PWD/tests/support/lsan.supp:print_suppressions=0 \
  UBSAN_OPTIONS=print_stacktrace=1 \
  ctest --preset asan --parallel "$jobs" --progress --label-regex '^(unit|property|simulation|fuzz)$'

heading "Pass 2 of 3: core without the farm, hardly optimised"
build build/core "--preset core" tests_unit
ctest --test-dir build/core --output-on-failure --parallel "$jobs" --progress --label-regex '^unit$'

heading "Pass 3 of 3: every test of the release build"
build build/release "--preset release"
# One more than there are processors: tests with real processes wait more than they compute.
ctest --preset release --parallel $((jobs + 1))
