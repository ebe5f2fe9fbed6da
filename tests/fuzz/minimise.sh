#!/usr/bin/env bash
# Adds to the corpora what fuzzing has found, as few and as small inputs as reach the same code: those of at most 4 kB.
# Usage: tests/fuzz/minimise.sh [TARGET ...]     (by default all of them)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls tests/fuzz/corpus)
for target in "${targets[@]}"; do
  corpus=tests/fuzz/corpus/$target
  merged=$(mktemp -d)
  cp "$corpus"/* "$merged"
  "build/fuzz/bin/fuzz_$target" -merge=1 -max_len=4096 "$merged" "build/fuzz/found/$target" >/dev/null 2>&1
  # The seeds keep their names; what is new has its content's hash for one.
  cp --update=none "$merged"/* "$corpus" 2>/dev/null || cp -n "$merged"/* "$corpus"
  rm -r "$merged"
  echo "$target: $(find "$corpus" -type f | wc -l) inputs"
done
