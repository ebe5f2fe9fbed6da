#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Adds to the corpora what fuzzing has found, as few inputs of at most 2 kB as reach the same branches. How often each is
# taken does not count: that would be thousands.
# Usage: tests/fuzz/minimise.sh [TARGET ...]     (by default all of them)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls tests/fuzz/corpus)
for target in "${targets[@]}"; do
  corpus=tests/fuzz/corpus/$target
  merged=$(mktemp -d)
  cp "$corpus"/* "$merged"
  "build/fuzz/bin/fuzz_$target" -merge=1 -set_cover_merge=1 -use_counters=0 -max_len=2048 \
    "$merged" "build/fuzz/found/$target" >/dev/null 2>&1
  # The seeds keep their names; what is new has its content's hash for one.
  cp --update=none "$merged"/* "$corpus" 2>/dev/null || cp -n "$merged"/* "$corpus"
  rm -r "$merged"
  echo "$target: $(find "$corpus" -type f | wc -l) inputs"
done
