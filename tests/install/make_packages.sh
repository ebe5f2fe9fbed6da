#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# make_packages.sh BUILD CPACK OUTPUT: makes the Debian packages and the tarball of BUILD in the folder OUTPUT, and has
# lintian look at the packages. Exit status 77 without dpkg-shlibdeps or lintian.
set -euo pipefail

build=$1
cpack=$2
output=$3
log=$output/log

fail() {
  echo "make_packages.sh: $*" >&2
  exit 1
}

for program in dpkg-shlibdeps lintian; do
  command -v $program >/dev/null || { echo "make_packages.sh: skipped: there is no $program"; exit 77; }
done

rm -rf "$output"
mkdir -p "$output"
"$cpack" --config "$build/CPackConfig.cmake" -B "$output" >"$log" 2>&1 || { tail -n 60 "$log" >&2; fail "cpack failed"; }
rm -r "$output/_CPack_Packages"
(cd "$output" && ls -sh -- *.deb *.tar.gz)

# Each override says in its file why it is there, and is needed. Not asked for: a list of symbols, which C++ changes with
# the compiler.
lintian --no-cfg --allow-root --fail-on none --display-info --suppress-tags no-symbols-control-file \
  "$output"/*.deb >"$log" 2>&1 || { cat "$log" >&2; fail "lintian failed"; }
! grep -E '^[EW]: |(unused|mismatched|malformed)-override' "$log" || fail "lintian complains"
