#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# licenses_self_test.sh CHECK_LICENSES: plants files without the licence in a tree of its own and expects the check to name
# them, to write the line where it belongs, and to find nothing to write afterwards.
set -euo pipefail

check=${1:?usage: licenses_self_test.sh CHECK_LICENSES}
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/core" "$tree/build" "$tree/tests/fuzz/corpus"
identifier='SPDX-License-Identifier: Apache-2.0'

fail() {
  echo "licenses_self_test.sh: $*" >&2
  exit 1
}

echo '// What it is for.' >"$tree/core/a.hpp"
printf '#!/bin/sh\necho\n' >"$tree/core/generate"
echo '#!/usr/bin/env python3' >"$tree/core/short.py"
echo 'project(x)' >"$tree/CMakeLists.txt"
echo 'text' >"$tree/core/notes"
echo '// generated' >"$tree/build/b.cpp"
echo '// an input' >"$tree/tests/fuzz/corpus/c.cpp"

status=0
named=$("$check" "$tree") || status=$?
[ "$status" -eq 1 ] || fail "exit status $status, not 1"
for file in core/a.hpp core/generate core/short.py CMakeLists.txt; do
  grep -qF "./$file does not" <<<"$named" || fail "does not name $file"
done
[ "$(grep -c 'does not say' <<<"$named")" -eq 4 ] || fail "names others: $named"

chmod +x "$tree/core/generate"
"$check" "$tree" --fix
"$check" "$tree" || fail "wrote the line and still misses it"
[ "$(head -n 1 "$tree/core/a.hpp")" = "// $identifier" ] || fail "not the first line of a.hpp"
[ "$(sed -n 2p "$tree/core/generate")" = "# $identifier" ] || fail "not the second line of a script"
[ -x "$tree/core/generate" ] || fail "a script cannot be run any more"
[ "$(tail -n 1 "$tree/core/short.py")" = "# $identifier" ] || fail "not after a first line that is the only one"
before=$(sha256sum "$tree/core/a.hpp")
"$check" "$tree" --fix
[ "$(sha256sum "$tree/core/a.hpp")" = "$before" ] || fail "writes the line twice"
