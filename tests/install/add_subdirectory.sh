#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# add_subdirectory.sh SOURCE CMAKE COMPILER: configures a project that adds SOURCE by add_subdirectory(), and looks at how
# its own file would be compiled and where its program would go.
set -euo pipefail

source=$1
cmake=$2
compiler=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "add_subdirectory.sh: $*" >&2
  exit 1
}

"$cmake" -S "$here/consumer" -B "$work" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DTESSERA_FOLDER="$source" \
  >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "the project cannot be configured"; }

[ "$(cat "$work/where_consumer_is")" = "$work/consumer" ] || fail "its program goes to $(cat "$work/where_consumer_is")"

# Of the command that compiles its file nothing is Tessera's but the folder of the header, and the standard that this takes.
command=$(grep -F '"command"' "$work/compile_commands.json" | grep -F "$here/consumer/main.cpp") ||
  fail "its file is not compiled"
flags=$(sed -E 's/.*"command": "[^ ]+ //; s/",?$//; s# -o [^ ]+ -c [^ ]+##' <<<"$command")
for flag in $flags; do
  case $flag in
    -I"$source"/core/api/include | -isystem | "$source"/core/api/include | -std=*++20) ;;
    *) fail "its file is compiled with $flag, of: $flags" ;;
  esac
done

# Nobody's tests, packages or programs of this project are made without being asked for.
! grep -q 'DTESSERA_SOURCE_DIR' "$work/compile_commands.json" || fail "it has Tessera's tests"
[ ! -e "$work/CPackConfig.cmake" ] || fail "it has Tessera's packages"
