#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# instructions.sh RENDER_SAMPLES: how many machine instructions a sample of a path takes, by callgrind, against what they
# were when rendering was last tuned (expected.tsv: scene, instructions of a sample). What is read and built before is not
# in it: it is the difference of two renders. Fails beyond a margin of 3 %, for compilers other than the one that was
# counted with. Whoever saves some stores the new numbers.
set -euo pipefail

render_samples=$1
folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
margin=1.03
side=48
counted=$(mktemp)
trap 'rm -f "$counted"' EXIT

# instructions_of SCENE SPP
instructions_of() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$render_samples" "$folder/../../$1" "$side" "$2" \
    >"$counted" 2>&1 || { cat "$counted" >&2; exit 1; }
  sed -n 's/.*Collected : //p' "$counted"
}

worse=0
while IFS=$'\t' read -r scene expected; do
  few=$(instructions_of "$scene" 2)
  many=$(instructions_of "$scene" 10)
  of_sample=$(((many - few) / (8 * side * side)))
  echo "$scene: $of_sample instructions for a sample; when last tuned $expected"
  awk "BEGIN { exit !($of_sample > 0 && $of_sample <= $margin * $expected) }" || worse=1
done < <(grep -v '^#' "$folder/expected.tsv")
[ $worse = 0 ] || { echo "instructions.sh: more than $margin times what they were" >&2; exit 1; }
