#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# same_bytes.sh TESSERA SCENES: renders scenes below SCENES small, once as the loader finds core and once with AVX-512
# hidden from it, and compares the files. Exit status 77 where the processor has no AVX-512.
set -euo pipefail

tessera=$1
scenes=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# instruction_set_of STATS
instruction_set_of() { sed -n 's/.*"instruction_set": "\(.*\)".*/\1/p' "$1"; }

fail() {
  echo "same_bytes.sh: $*" >&2
  exit 1
}

compared=0
for scene in "$scenes"/*/*.json; do
  for variant in v4 v3; do
    hidden=
    [ $variant = v4 ] || hidden=glibc.cpu.hwcaps=-AVX512F
    GLIBC_TUNABLES=$hidden "$tessera" render "$scene" --size 48x32 --spp 4 --quiet \
      -o "$folder/$variant.pfm" --stats "$folder/$variant.json"
    found=$(instruction_set_of "$folder/$variant.json")
    if [ "$variant $found" = "v4 x86-64-v3" ]; then
      echo "same_bytes.sh: this processor has no AVX-512"
      exit 77
    fi
    [ "$found" = "x86-64-$variant" ] || fail "$scene was rendered with '$found' instead of x86-64-$variant"
  done
  cmp "$folder/v4.pfm" "$folder/v3.pfm" || fail "$scene: the variants render other bytes"
  compared=$((compared + 1))
done
[ $compared -gt 0 ] || fail "no scene below $scenes"
echo "$compared scenes: the same bytes with and without AVX-512"
