#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# no_vectors.sh OBJECT ...: that none of them, which all variants of core share, has an inline function of vectors: equal
# names can mean other lanes or registers with AVX-512, and the linker takes one of them.
set -euo pipefail

[ $# -gt 0 ] || { echo "no_vectors.sh: no objects" >&2; exit 1; }
shared=$(nm -C "$@" | grep -E ' [WVu] .*((Float|Double|Mask|U32x|U64x)(N|Half|Vector)\b|lanes_of|to_set|vectors_of)' || true)
[ -z "$shared" ] || { printf '%s\n' "$shared" "no_vectors.sh: take ONCE from the library that has these" >&2; exit 1; }
