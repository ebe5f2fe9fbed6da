#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds Tessera and runs every test, in two passes:
#   1. with assertions, little optimised, under the address and undefined-behaviour sanitizers: the unit tests of files,
#      command lines and the farm, for which optimising changes nothing, the shipped scenes in small, and the corpora of
#      the fuzzers with mutants (tests/fuzz/README.md). The tests labelled unsanitized, of which sanitizers prevent a
#      part, run in the other pass as well;
#   2. an optimised build: first core and the command line without the farm, and so without gRPC; then, in the same
#      folder, everything, and all other tests. What renders is compiled once more for any processor and, where the
#      processor has it, for AVX-512; their images are compared.
# Ends with an error at the first pass that fails. Skipped tests are named, with the reason.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source scripts/build.sh

heading() { printf '\n== %s\n' "$*"; }
jobs=$(nproc)

# run_tests PRESET JOBS [CTEST OPTION ...]: says, at the end, how many tests the processes of CTest had, and what was skipped.
run_tests() {
  local preset=$1 status=0
  ctest --preset "$preset" --parallel "$2" --progress "${@:3}" || status=$?
  tests/support/summary.sh "build/$preset/Testing/Temporary/LastTest.log"
  return $status
}

heading "Packages"
scripts/setup.sh build package test
echo "all there"

heading "Pass 1 of 2: assertions, address and undefined-behaviour sanitizers"
build asan "" tests_unit tests_farm tests_unsanitized tests_sanitizers tests_fuzz
ASAN_OPTIONS=detect_stack_use_after_return=1 \
  LSAN_OPTIONS=suppressions=$PWD/tests/support/lsan.supp:print_suppressions=0 \
  UBSAN_OPTIONS=print_stacktrace=1 \
  run_tests asan $((jobs + 1)) --label-regex '^(unit|farm|unsanitized|sanitizers|fuzz)$'

heading "Pass 2 of 2: optimised, without the farm"
build tests -DTESSERA_FARM=OFF client_test
run_tests tests "$jobs" --tests-regex '^client_test\.'

heading "Pass 2 of 2: optimised"
grep -qw avx512dq /proc/cpuinfo && avx512=ON || avx512=OFF
build tests "-DTESSERA_FARM=ON -DTESSERA_AVX512=$avx512" tests_optimised
# Of the tests that only compute, one for each processor, at a low priority; beside them twice as many of those with real
# processes, which wait for most of their time (tests/CMakeLists.txt), among them no more browsers than processors.
resources=$PWD/build/tests/resources.json
cat >"$resources" <<EOF_JSON
{"version": {"major": 1, "minor": 0},
 "local": [{"processors": [{"id": "0", "slots": $jobs}], "browsers": [{"id": "0", "slots": $jobs}]}]}
EOF_JSON
run_tests tests $((3 * jobs)) --label-exclude '^(unit|farm|fuzz)$' --resource-spec-file "$resources"
