#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# installed_tree.sh BUILD SOURCE CMAKE COMPILER: installs BUILD, moves the tree to another folder, looks for traces of the
# machine in it, and has the program, a project that finds the package, and the compiler by pkg-config render the same.
set -euo pipefail

build=$1
source=$2
cmake=$3
compiler=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "installed_tree.sh: $*" >&2
  exit 1
}

# quiet NAME COMMAND...: its output is shown if it fails.
quiet() {
  "${@:2}" >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "$1 failed"; }
}

quiet "installing" env -u DESTDIR "$cmake" --install "$build" --prefix "$work/first"
mv "$work/first" "$work/tree"
tree=$work/tree

for trace in "$build" "$source/" "$work/first"; do
  found=$(grep -rlaF -- "$trace" "$tree") || continue
  fail "'$trace' stands in ${found//$'\n'/ }"
done

# Manual pages and completions are there, as the programs print them.
for program in tessera tessera-coordinator tessera-worker tessera-validator tessera-scene-loader; do
  "$tree/bin/$program" --print-man-page | cmp - "$tree/share/man/man1/$program.1" || fail "no manual page of $program"
done
for program in tessera tessera-coordinator tessera-worker; do
  for file in "bash bash-completion/completions/$program" "zsh zsh/site-functions/_$program" \
    "fish fish/vendor_completions.d/$program.fish"; do
    "$tree/bin/$program" --print-completion "${file%% *}" | cmp - "$tree/share/${file#* }" ||
      fail "no completion of $program for ${file%% *}"
  done
done

# What the library exports is what its header declares.
library=$(echo "$tree"/lib*/libtessera.so)
symbols=$(nm -DC --defined-only "$library" | sed -E 's/^[0-9a-f]+ . //')
grep -q '^tessera::Scene::load' <<<"$symbols" || fail "$library does not export Scene::load"
others=$(grep -vE '^((typeinfo|typeinfo name|vtable) for )?tessera::(Error|Scene|version|write_image)\b' <<<"$symbols") || true
[ -z "$others" ] || fail "$library exports others' symbols: $(head -n 5 <<<"$others")"

scene=$tree/share/tessera/scenes/cornell/scene.json
cd "$work"
quiet "tessera render" env -i "$tree/bin/tessera" render cornell --size 48x32 --spp 4 --quiet -o by_program.pfm

quiet "configuring the project" "$cmake" -S "$here/consumer" -B "$work/project" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$tree"
quiet "building the project" "$cmake" --build "$work/project"
quiet "the project's program" "$work/project/consumer" "$scene" by_project.pfm
cmp by_program.pfm by_project.pfm || fail "the project renders other bytes"

export PKG_CONFIG_PATH=${library%/*}/pkgconfig
# shellcheck disable=SC2046  # options are words
quiet "compiling by pkg-config" "$compiler" -std=c++20 "$here/consumer/main.cpp" -o by_pkg_config \
  $(pkg-config --cflags --libs tessera) -Wl,-rpath,"${library%/*}"
quiet "the program by pkg-config" ./by_pkg_config "$scene" by_pkg_config.pfm
cmp by_program.pfm by_pkg_config.pfm || fail "the program by pkg-config renders other bytes"
echo "$(find "$tree" -type f | wc -l) files; $(wc -l <<<"$symbols") exported symbols"
