#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# How cost grows with triangles, pixels, samples, lights, depth, threads and workers: measures all of that or the
# SERIES named, writes a table for each into DIR, and plots all that are there. Needs the release build with
# -DTESSERA_BENCH=ON, jq and gnuplot-nox, and a machine with nothing else to do.
set -euo pipefail

all=(triangles pixels samples lights depth threads workers)
[ $# -ge 1 ] || { echo "Usage: bench/growth/measure.sh DIR [SERIES...], of: ${all[*]}" >&2; exit 2; }
mkdir -p "$1"
out=$(cd "$1" && pwd)
shift
for name in "$@"; do
  [[ " ${all[*]} " == *" $name "* ]] || { echo "measure.sh: there is no series '$name', but ${all[*]}" >&2; exit 2; }
done
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
bin=build/profiled/bin
for program in tessera tessera_bench tessera-coordinator tessera-worker; do
  [ -x "$bin/$program" ] || { echo "measure.sh: there is no $bin/$program; configure with -DTESSERA_BENCH=ON" >&2; exit 1; }
done
command -v gnuplot >/dev/null || { echo "measure.sh: install Debian's gnuplot-nox" >&2; exit 1; }

source scripts/processes.sh

# The scene of all series but two. Its materials come by path, so that it can be changed elsewhere.
cornell=$work/cornell.json
sed -e 's|^ *//.*||' -e "s|\"box.obj\"|\"$PWD/scenes/cornell/box.obj\"|" scenes/cornell/scene.json >"$cornell"

rounds=3
# render_seconds THREADS SCENE OPTIONS...: the least of some renders.
render_seconds() {
  local round threads=$1 scene=$2
  shift 2
  for ((round = 0; round < rounds; ++round)); do
    "$bin/tessera" render "$scene" --quiet --threads "$threads" "$@" -o "$work/image.exr" --stats "$work/stats.json"
    jq .render_seconds "$work/stats.json"
  done | sort -g | head -n 1
}

# series NAME HEADING: says what comes, and starts its table.
series() {
  echo "== $1" >&2
  table=$out/$1.tsv
  printf '# %s\n' "$2" >"$table"
}
# What was measured comes through a pipe: where that fails, so does the script.
row() { printf '%s\t%s\n' "$1" "$(cat)" | tee -a "$table" >&2; }

triangles() {
  echo "== triangles" >&2
  "$bin/tessera_bench" --benchmark_filter='^growth_' --benchmark_format=json 2>/dev/null >"$work/triangles.json"
  { echo "# triangles	ns for each primary ray	bounce	shadow ray	one by one: primary	bounce	shadow ray"
    jq -r '.benchmarks | group_by(.triangles) | .[] |
      [.[0].triangles, (("batched", "single") as $way | ("primary", "bounce", "shadow") as $kind |
        .[] | select(.name | startswith("growth_\($kind)_\($way)")) | 1e9 / ."rays/s")] | @tsv' "$work/triangles.json"
  } | tee "$out/triangles.tsv" >&2
}

pixels() {
  local side
  series pixels 'pixels	seconds'
  for side in 64 128 256 512 1024; do
    render_seconds 1 "$cornell" --size "${side}x$side" --spp 4 | row $((side * side))
  done
}

samples() {
  local spp
  series samples 'samples per pixel	seconds'
  for spp in 1 4 16 64 256; do render_seconds 1 "$cornell" --size 128x128 --spp "$spp" | row "$spp"; done
}

# A floor under evenly spread lamps that together are as bright, however many.
lamps() {
  jq -n --argjson side "$1" '{
    render: {width: 256, height: 256, spp: 4},
    camera: {position: [0, 8, 14], look_at: [0, 0, 0], up: [0, 1, 0], vertical_fov_degrees: 50},
    materials: {floor: {type: "lambert", albedo: 0.7},
                lamp: {type: "lambert", albedo: 0, emission: 40}},
    shapes: ([{type: "quad", corner: [-10, 0, 10], edge_u: [20, 0, 0], edge_v: [0, 0, -20], material: "floor"}] +
      [range($side) as $x | range($side) as $z |
       {type: "sphere", radius: (0.3 / $side), material: "lamp",
        center: [-8 + 16 * ($x + 0.5) / $side, 1, -8 + 16 * ($z + 0.5) / $side]}])}'
}
lights() {
  local side
  series lights 'lights	µs for each sample'
  for side in 1 3 10 32 100 316; do
    lamps "$side" >"$work/lamps.json"
    render_seconds 1 "$work/lamps.json" | jq "1e6 * . / (256 * 256 * 4)" | row $((side * side))
  done
}

depth() {
  local depth
  series depth 'max_depth	seconds'
  for depth in 1 2 4 8 16 32 64; do
    sed "s|\"spp\": 64|\"spp\": 64, \"max_depth\": $depth|" "$cornell" >"$work/depth.json"
    render_seconds 1 "$work/depth.json" --size 256x256 --spp 16 | row "$depth"
  done
}

threads() {
  local n
  series threads 'threads	samples per second'
  for ((n = 1; n <= $(nproc); ++n)); do
    render_seconds "$n" "$cornell" --spp 16 | jq '512 * 512 * 16 / .' | row "$n"
  done
}

workers() {
  local n begin
  series workers 'workers of one thread	samples per second'
  start_coordinator "$bin"
  for ((n = 1; n <= $(nproc); ++n)); do
    start_worker "$bin" "worker-$n" 1
    begin=$(date +%s.%N)
    "$bin/tessera" submit "$cornell" --spp 192 --coordinator "$address" --wait -o "$work/farm.exr" >/dev/null 2>&1
    jq -n "512 * 512 * 192 / ($(date +%s.%N) - $begin)" | row "$n"
  done
}

[ $# -gt 0 ] || set -- "${all[@]}"
for name in "$@"; do "$name"; done
gnuplot -e "dir='$out'" bench/growth/plots.gp
echo "tables and plots are in $out" >&2
