#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fetches the Stanford bunny and Spot the cow from where they were first published, and models the menagerie of a build
# folder with them in place of our own animals: scenes/menagerie/fetch.sh [BUILD]. Needs curl, tar, unzip and sha256sum. To
# go back, delete BUILD/share/tessera/scenes/menagerie and build again.
#
# The bunny: Stanford 3D Scanning Repository, Turk and Levoy 1994. For research, with credit; not to be sold.
# Spot: Keenan Crane. Public domain (CC0).
set -euo pipefail
build=${1:-$(dirname "${BASH_SOURCE[0]}")/../../build/release}

bunny_url=https://graphics.stanford.edu/pub/3Dscanrep/bunny.tar.gz
spot_url=https://www.cs.cmu.edu/~kmcrane/Projects/ModelRepository/spot.zip
bunny_archive_sha256=a5720bd96d158df403d153381b8411a727a1d73cff2f33dc9b212d6f75455b84
spot_sha256=0738b5e8608fed74e5e8c7aa8dd0af97b4b74f9f6cbf7aac84cd7e40b2e44a75
spot_texture_sha256=cddabbae52a666173e7953e238b88340d285044dc20b36f8ed3f1a41db534fa5
generator=$build/bin/tessera-generate-menagerie
scene=$build/share/tessera/scenes/menagerie

fail() {
  echo "fetch.sh: $*" >&2
  exit 1
}

# verify FILE SHA256
verify() {
  local found
  found=$(sha256sum "$1" | cut -d ' ' -f 1)
  [ "$found" = "$2" ] || fail "$1 is not the file it should be: its SHA-256 is $found, not $2"
}

# ply_to_obj: an ASCII PLY file whose vertices begin with x y z and whose faces are triangles.
ply_to_obj() {
  awk '/^element vertex/ { vertices = $3 }
       body && vertices > 0 { print "v", $1, $2, $3; vertices--; next }
       body && $1 == 3 { print "f", $2 + 1, $3 + 1, $4 + 1 }
       /^end_header/ { body = 1 }'
}

[ -x "$generator" ] || fail "there is no $generator; build it first (./run.sh does)"
for tool in curl tar unzip sha256sum awk; do
  command -v "$tool" >/dev/null || fail "$tool is needed; on Debian: apt-get install curl tar unzip coreutils mawk"
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

curl --fail --location --silent --show-error --output "$work/bunny.tar.gz" "$bunny_url"
verify "$work/bunny.tar.gz" "$bunny_archive_sha256"
tar -xzOf "$work/bunny.tar.gz" bunny/reconstruction/bun_zipper.ply | ply_to_obj >"$work/bunny.obj"

curl --fail --location --silent --show-error --output "$work/spot.zip" "$spot_url"
unzip -q -j "$work/spot.zip" '*/spot_triangulated.obj' '*/spot_texture.png' -d "$work"
verify "$work/spot_triangulated.obj" "$spot_sha256"
verify "$work/spot_texture.png" "$spot_texture_sha256"

mkdir -p "$scene/generated"
mv "$work/bunny.obj" "$scene/bunny.obj"
mv "$work/spot_triangulated.obj" "$scene/spot.obj"
mv "$work/spot_texture.png" "$scene/spot_texture.png"

"$generator" "$scene/generated" "$scene"
echo "The menagerie of $build is now the bunny's and Spot's: tessera render menagerie"
