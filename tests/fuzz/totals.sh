#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Executions, seconds of processor time, coverage and crashes of each target, from the logs of run.sh.
# Usage: tests/fuzz/totals.sh [FOLDER ...]     (by default build/fuzz/logs; figures of several folders add up)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
[ $# -gt 0 ] || set -- build/fuzz/logs
cat_logs() { find "$@" -name '*.log' | sort | while read -r log; do sed "s|^|$(basename "$log" .log) |" "$log"; done; }
cat_logs "$@" | awk '
  $2 ~ /^#[0-9]+$/ { for (i = 3; i < NF; ++i) if ($i == "cov:") covered[$1] = $(i + 1) > covered[$1] ? $(i + 1) : covered[$1] }
  $2 == "processor" { seconds[$1] += $4 + $5 }
  $2 == "stat::number_of_executed_units:" { executions[$1] += $3 }
  /SUMMARY: / { ++crashes[$1] }
  { seen[$1] = 1 }
  END {
    for (target in seen)
      printf "%-8s %12d %8d %9d %8d\n", target, executions[target], seconds[target], covered[target], crashes[target]
  }' | sort | { printf 'target     executions  seconds  branches  crashes\n'; cat; }
