#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What more threads and a farm are worth, as a Markdown table: one thread beside two, and one process of two threads
# beside a farm of two workers of one thread each on loopback, with the coordinator's share of the CPU time.
# Needs the release build, and two cores with nothing else to do.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
  cat <<'EOF_USAGE'
Usage: bench/threads_and_farm.sh [--seconds N] [--rounds N] [SCENE]

  --seconds N   about how long each render of two threads takes [60]
  --rounds N    how often each is measured, interleaved; the table has medians [3]
  SCENE         scene file to render [scenes/cornell/scene.json]
EOF_USAGE
}

seconds=60
rounds=3
scene=scenes/cornell/scene.json
while [ $# -gt 0 ]; do
  case $1 in
    --seconds | --rounds)
      [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || { echo "threads_and_farm.sh: $1 needs a number above 0" >&2; exit 2; }
      declare "${1#--}=$2"
      shift
      ;;
    -h | --help) usage; exit 0 ;;
    -*) echo "threads_and_farm.sh: unknown option '$1'" >&2; usage >&2; exit 2 ;;
    *) scene=$1 ;;
  esac
  shift
done

bin=build/profiled/bin
for program in tessera tessera-coordinator tessera-worker; do
  [ -x "$bin/$program" ] || { echo "threads_and_farm.sh: there is no $bin/$program; cmake --preset profiled -DTESSERA_BENCH=ON && cmake --build --preset profiled builds it" >&2; exit 1; }
done
[ "$(nproc)" -ge 2 ] || { echo "threads_and_farm.sh: two threads need two cores; here is one" >&2; exit 1; }

source scripts/processes.sh

# Seconds of CPU time that process PID has used (proc(5): user and system are fields 14 and 15).
cpu_seconds() { awk -v tick="$(getconf CLK_TCK)" '{ print ($14 + $15) / tick }' "/proc/$1/stat"; }

# timed FILE COMMAND...: adds the wall clock's seconds to FILE.
timed() {
  local file=$1 begin
  shift
  begin=$(date +%s.%N)
  "$@" >"$work/output.log" 2>&1 || { cat "$work/output.log" >&2; exit 1; }
  awk -v begin="$begin" -v end="$(date +%s.%N)" 'BEGIN { print end - begin }' >>"$file"
}

median() { sort -g "$1" | awk '{ v[NR] = $1 } END { print (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'; }
calculate() { awk "BEGIN { printf \"$1\", $2 }"; }

in_process() { "$bin/tessera" render "$scene" --spp "$spp" --quiet --threads "$1" -o "$work/process.exr" "${@:2}"; }
on_farm() { "$bin/tessera" submit "$scene" --spp "$spp" --coordinator "$address" --wait -o "$work/farm.exr"; }

# As many samples as two threads take in the time that was asked for.
spp=8
in_process 2 --stats "$work/trial.json"
spp=$(jq "(.samples_per_second * $seconds / (.width * .height)) | ceil" "$work/trial.json")

start_coordinator "$bin"
for name in first second; do start_worker "$bin" "$name" 1; done
for ((round = 0; round < rounds; ++round)); do
  timed "$work/one" in_process 1
  timed "$work/two" in_process 2
  before=$(cpu_seconds "${started[0]}")
  timed "$work/farm" on_farm
  cmp "$work/process.exr" "$work/farm.exr"
  calculate '%f\n' "$(cpu_seconds "${started[0]}") - $before" >>"$work/coordinator"
done

one=$(median "$work/one") two=$(median "$work/two") farm=$(median "$work/farm") coordinator=$(median "$work/coordinator")
cat <<EOF_TABLE
$scene, $spp samples per pixel, medians of $rounds; from start to the file on disk; all files the same bytes.

| render | seconds | |
|---|---|---|
| one process, 1 thread | $(calculate %.2f "$one") | |
| one process, 2 threads | $(calculate %.2f "$two") | $(calculate %.3f "$one / $two") times the speed of 1 thread |
| coordinator and 2 workers of 1 thread | $(calculate %.2f "$farm") | $(calculate %.1f "100 * $two / $farm") % of the speed of the process |
| of which the coordinator, CPU time | $(calculate %.2f "$coordinator") | $(calculate %.2f "100 * $coordinator / (2 * $farm)") % of both cores |
EOF_TABLE
