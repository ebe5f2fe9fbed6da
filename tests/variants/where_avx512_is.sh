#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# where_avx512_is.sh PROGRAM: runs it. Exit status 77 where the processor has no AVX-512.
set -euo pipefail

grep -qw avx512dq /proc/cpuinfo || { echo "where_avx512_is.sh: this processor has no AVX-512"; exit 77; }
exec "$1"
