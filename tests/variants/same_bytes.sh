#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# same_bytes.sh SCENES SET COMMAND SET COMMAND: renders scenes below SCENES small by both commands, which are tessera as it
# is compiled for instruction sets of these names (patterns), and compares the files. Exit status 77 where the first one is
# not built, or not taken by this processor.
set -euo pipefail

scenes=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "same_bytes.sh: $*" >&2
  exit 1
}

# render SCENE COMMAND NAME: renders to NAME.pfm, and prints the instruction set.
render() {
  # shellcheck disable=SC2086  # commands are words
  $2 render "$1" --size 48x32 --spp 4 --quiet -o "$folder/$3.pfm" --stats "$folder/$3.json" &&
    sed -n 's/.*"instruction_set": "\(.*\)".*/\1/p' "$folder/$3.json"
}

[ -x "${3##* }" ] || { echo "same_bytes.sh: ${3##* } is not built"; exit 77; }
compared=0
for scene in "$scenes"/*/*.json; do
  found=$(render "$scene" "$3" first)
  # shellcheck disable=SC2053  # a pattern
  [[ $found == $2 ]] || { echo "same_bytes.sh: this processor takes $found instead of $2"; exit 77; }
  found=$(render "$scene" "$5" second)
  # shellcheck disable=SC2053  # a pattern
  [[ $found == $4 ]] || fail "$scene was rendered with '$found' instead of $4"
  cmp "$folder/first.pfm" "$folder/second.pfm" || fail "$scene: $2 and $4 render other bytes"
  compared=$((compared + 1))
done
[ $compared -gt 0 ] || fail "no scene below $scenes"
echo "$compared scenes: the same bytes for $2 and $4"
