#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds Tessera, renders a still life on a farm of one coordinator and two workers, renders it again in one
# process, and shows that both files are the same bytes. Needs Debian 12; ends a minute or two after the build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

size=600x400
spp=64
scene=still_life
# At so few samples, caustics leave bright specks; the limit removes them and darkens the image by 1.3 %.
clamp=5
bin=$PWD/build/release/bin
source scripts/build.sh
source scripts/processes.sh

heading() { printf '\n== %s\n' "$*"; }

fail() {
  echo "run.sh: $*" >&2
  tail -n 40 "$work"/*.log >&2 2>/dev/null || true
  exit 1
}

heading "Packages"
scripts/setup.sh build
echo "all there"

heading "Build (some minutes the first time)"
mkdir -p out
build release "-DTESSERA_TESTS=OFF -DTESSERA_FARM_FLAGS=-O1 -DTESSERA_FILE_FLAGS=-O1" tessera tessera-coordinator tessera-worker tessera-scene-loader tessera-validator tessera_scene_still_life
echo "built in build/release"

heading "A farm: one coordinator, two workers"
threads=$(($(nproc) > 1 ? $(nproc) / 2 : 1))
start_coordinator "$bin"
for name in first second; do start_worker "$bin" "$name" "$threads"; done
echo "coordinator at $address, workers with $threads threads each"

heading "The still life, $size pixels, $spp samples each, indirect light limited to $clamp, on the farm"
"$bin/tessera" submit "$scene" --coordinator "$address" --size "$size" --spp "$spp" \
  --clamp-indirect "$clamp" --wait -o out/still_life.png -o out/still_life.exr || fail "the farm did not render the image"

heading "The same in one process"
"$bin/tessera" render "$scene" --size "$size" --spp "$spp" --clamp-indirect "$clamp" \
  -o out/still_life_local.png -o out/still_life_local.exr || fail "the image was not rendered"

heading "Are they the same?"
for ending in png exr; do
  cmp "out/still_life.$ending" "out/still_life_local.$ending" || fail "the images differ"
  echo "out/still_life.$ending and out/still_life_local.$ending are identical, byte for byte"
done

heading "Done"
cat <<EOF_TEXT
The image:        $PWD/out/still_life.png
In the terminal:  build/release/bin/tessera view out/still_life.exr
In the browser:   build/release/bin/tessera demo
                  starts a farm, prints the address of its page, and renders the still life while you watch.
                  A coordinator of your own has the page too: tessera-coordinator --http 127.0.0.1:7421
To look at next:  build/release/bin/tessera help
The other scenes: cmake --build build/release --target scene_files
EOF_TEXT
