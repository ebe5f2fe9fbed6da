#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# compile_stage.sh SOURCE: follows the first stage of deploy/container/Dockerfile, which compiles, up to the compiler: what
# is copied into the image is configured by the stage's own command, and nothing is missing that the build would read.
# (container.sh builds the other stage, with packages that are at hand. packages.sh asks Debian for the packages that this
# one installs.)
set -euo pipefail

source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "compile_stage.sh: $*" >&2
  exit 1
}

# One instruction a line.
stage=$(awk '/^FROM/ { ++stage } stage < 2' "$source/deploy/container/Dockerfile" | grep -v '^#' |
  sed -e ':join' -e '/\\$/N' -e 's/\\\n *//' -e 'tjoin')
value_of() { sed -n "s/^ARG $1=//p" <<<"$stage"; }
preset=$(value_of PRESET)
[[ $(value_of BASE) == *debian:bookworm-slim ]] || fail "it is based on $(value_of BASE), and not on Debian 12"

# What it installs and how it compiles is what the documentation says.
grep -qx 'RUN scripts/setup.sh build package' <<<"$stage" || fail "it does not install what scripts/setup.sh build package does"
for line in "scripts/setup.sh build package" "cmake --preset $preset && cmake --build build/$preset"; do
  grep -qxF "$line" "$source/docs/operations.md" || fail "docs/operations.md does not say: $line"
done

# The context, without what is ignored, and the script that is copied before it.
mapfile -t ignored < <(sed 's#^#--exclude=./#' "$source/.dockerignore")
mkdir "$work/source"
tar -C "$source" "${ignored[@]}" -cf - . | tar -C "$work/source" -xf -
grep -qx 'COPY scripts/setup.sh scripts/' <<<"$stage" && grep -qx 'COPY . .' <<<"$stage" || fail "it copies other files"

# RUN cmake --preset ... && cmake --build FOLDER && cpack ...: only the first is called.
command=$(sed -n 's/^RUN \(cmake --preset .*\)/\1/p' <<<"$stage")
[[ $command == *' && cmake --build build/${PRESET} && cpack --config build/${PRESET}/CPackConfig.cmake -G DEB '* ]] ||
  fail "it compiles otherwise: $command"
(cd "$work/source" && PRESET=$preset bash -ec "${command%% && *}") >"$work/log" 2>&1 ||
  { tail -n 40 "$work/log" >&2; fail "${command%% && *}"; }

# What the build would read: sources, protocols, scenes, profiles, documents.
build=$work/source/build/$preset
ninja -C "$build" -t inputs all >"$work/inputs"
sed -n "s#^\($work/source/\|\.\./\.\./\)#$work/source/#p" "$work/inputs" | grep -v "^$build/" >"$work/read"
[ "$(wc -l <"$work/read")" -gt 100 ] || fail "it would read $(wc -l <"$work/read") files"
while IFS= read -r file; do [ -e "$file" ] || fail "it would read ${file#"$work/source/"}, which is not there"; done <"$work/read"
for program in tessera tessera-coordinator tessera-worker; do
  ninja -C "$build" -t query "bin/$program" >/dev/null 2>&1 || fail "it does not build $program"
done
