# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced by scripts that start processes in the background: starts them, waits for what they say, and ends them, the
# last one first, when the script ends. Their output is in $work/NAME.log; $work is a temporary folder that goes with them.

work=$(mktemp -d)
started=()

stop_started() {
  local i
  for ((i = ${#started[@]} - 1; i >= 0; --i)); do
    kill "${started[i]}" 2>/dev/null || true
    wait "${started[i]}" 2>/dev/null || true
  done
  rm -rf "$work"
}
trap stop_started EXIT

# start NAME COMMAND...
start() {
  "${@:2}" >"$work/$1.log" 2>&1 &
  started+=($!)
}

# until_all_say TEXT NAME...: waits, for half a minute at most, until the log of each has TEXT. Fails, with the logs'
# ends, if that does not come about, or if anything that was started has ended.
until_all_say() {
  local i pid text=$1
  shift
  local files=("${@/#/$work/}")
  files=("${files[@]/%/.log}")
  for ((i = 0; i < 600; ++i)); do
    [ "$(grep -l -- "$text" "${files[@]}" 2>/dev/null | wc -l)" -lt $# ] || return 0
    for pid in "${started[@]}"; do kill -0 "$pid" 2>/dev/null || break 2; done
    sleep 0.05
  done
  echo "${0##*/}: no '$text' from $*" >&2
  tail -n 40 "$work"/*.log >&2
  return 1
}

# start_coordinator BIN: at a free port, which is then in $address.
start_coordinator() {
  start coordinator "$1/tessera-coordinator" --listen 127.0.0.1:0 --state "$work/state"
  until_all_say 'listening on' coordinator || return
  address=$(sed -n 's/.*listening on //p' "$work/coordinator.log")
}

# start_worker BIN NAME THREADS: at $address; waits until it is registered.
start_worker() {
  start "$2" "$1/tessera-worker" --coordinator "$address" --name "$2" --threads "$3" --cache "$work/cache-$2"
  until_all_say 'registered with the coordinator' "$2"
}
