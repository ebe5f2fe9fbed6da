#!/usr/bin/env bash
# instructions.sh TESSERA: how many machine instructions a sample of a path takes, by callgrind, against what they were
# when rendering was last tuned (expected.tsv: scene, instructions of a sample). What is read and built before is not
# in it: it is the difference of two renders. Fails beyond a margin of 6 %: `tessera render` cuts its work by the clock, so
# that a slow or busy machine renders more and smaller pieces, for up to 3 % more. Whoever saves some stores the new numbers.
set -euo pipefail

tessera=$1
folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
margin=1.06
side=48
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# instructions_of SCENE SPP
instructions_of() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$tessera" render "$folder/../../$1" --size "${side}x$side" \
    --spp "$2" --threads 1 --quiet -o "$work/picture.pfm" 2>"$work/callgrind" || { cat "$work/callgrind" >&2; exit 1; }
  sed -n 's/.*Collected : //p' "$work/callgrind"
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
