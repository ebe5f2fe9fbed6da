#!/usr/bin/env bash
# Builds Tessera, renders a still life on a farm of one coordinator and two workers, renders it again in one
# process, and shows that both files are the same bytes. Needs Debian 12; ends a minute or two after the build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

size=600x400
spp=64
scene=scenes/still_life/scene.json
bin=$PWD/build/release/bin
logs=$(mktemp -d)
started=()

heading() { printf '\n== %s\n' "$*"; }

fail() {
  echo "run.sh: $*" >&2
  tail -n 40 "$logs"/*.log >&2 2>/dev/null || true
  exit 1
}

# Ends what was started here, workers before the coordinator they deliver to.
stop_started() {
  local i
  for ((i = ${#started[@]} - 1; i >= 0; --i)); do
    kill "${started[i]}" 2>/dev/null || true
    wait "${started[i]}" 2>/dev/null || true
  done
  rm -rf "$logs"
}
trap stop_started EXIT

# start LOG COMMAND...: in the background, until this script ends.
start() {
  local log=$logs/$1.log
  shift
  "$@" >"$log" 2>&1 &
  started+=($!)
}

# The coordinator picks a free port and says which.
wait_for_address() {
  local i
  for ((i = 0; i < 200; ++i)); do
    address=$(sed -n 's/.*listening on //p' "$logs/coordinator.log")
    [ -z "$address" ] || return 0
    kill -0 "${started[0]}" 2>/dev/null || break
    sleep 0.05
  done
  fail "the coordinator did not start"
}

# Both workers have registered.
wait_for_workers() {
  local i pid
  for ((i = 0; i < 600; ++i)); do
    [ "$(grep -l "registered with the coordinator" "$logs"/worker-*.log | wc -l)" -lt 2 ] || return 0
    for pid in "${started[@]}"; do kill -0 "$pid" 2>/dev/null || fail "a worker did not start"; done
    sleep 0.05
  done
  fail "the workers did not reach the coordinator"
}

heading "Packages"
scripts/setup.sh
echo "all there"

heading "Build (some minutes the first time)"
mkdir -p build out
programs=(tessera tessera-coordinator tessera-worker tessera-validator scene_files)
if ! { cmake --preset release && cmake --build --preset release --parallel "$(nproc)" --target "${programs[@]}"; } \
  >build/release.log 2>&1; then
  tail -n 60 build/release.log >&2
  fail "the build failed; the whole log is in build/release.log"
fi
echo "built in build/release"

heading "A farm: one coordinator, two workers"
threads=$(($(nproc) > 1 ? $(nproc) / 2 : 1))
start coordinator "$bin/tessera-coordinator" --listen 127.0.0.1:0 --state "$logs/state"
wait_for_address
for name in first second; do
  start "worker-$name" "$bin/tessera-worker" --coordinator "$address" --threads "$threads" \
    --name "$name" --cache "$logs/cache-$name"
done
wait_for_workers
echo "coordinator at $address, workers with $threads threads each"

heading "The still life, $size pixels, $spp samples each, on the farm"
"$bin/tessera" submit "$scene" --coordinator "$address" --size "$size" --spp "$spp" \
  --wait -o out/still_life.png -o out/still_life.exr || fail "the farm did not render the picture"

heading "The same in one process"
"$bin/tessera" render "$scene" --size "$size" --spp "$spp" \
  -o out/still_life_local.png -o out/still_life_local.exr || fail "the picture was not rendered"

heading "Are they the same?"
for ending in png exr; do
  cmp "out/still_life.$ending" "out/still_life_local.$ending" || fail "the pictures differ"
  echo "out/still_life.$ending and out/still_life_local.$ending are identical, byte for byte"
done

heading "Done"
cat <<EOF_TEXT
The picture:      $PWD/out/still_life.png
To look at next:  build/release/bin/tessera render scenes/cornell/scene.json -o out/cornell.png
                  build/release/bin/tessera --help
EOF_TEXT
