#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# summary.sh LOG: reads CTest's LastTest.log, which has what every process printed, and says how many tests GoogleTest ran
# in them and which were skipped, with the reason of each.
set -euo pipefail

awk '
  /^\[==========\] [0-9]+ tests? from [0-9]+ test suites? ran/ { ran += $2 }
  /: Skipped$/ { getline reason }
  /^\[  SKIPPED \] .* \([0-9]+ ms\)$/ { skipped[++count] = $4 ": " reason }
  END {
    printf "%d tests of GoogleTest ran, of which %d were skipped", ran, count
    for (i = 1; i <= count; ++i) printf "%s\n  %s", i == 1 ? ":" : "", skipped[i]
    print ""
  }' "${1:?usage: summary.sh LOG}"
