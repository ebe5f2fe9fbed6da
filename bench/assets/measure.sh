#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# bench/assets/measure.sh BIN [MB] [WORKERS] [MBIT] [SERVE]: what a scene with MB megabytes of files (500) costs the
# coordinator when WORKERS workers (16) begin at the same time, each host behind a line of MBIT megabit a second (100).
# Prints the bytes that the coordinator sent over those of the files, the time until the first pixel and until all
# workers have the files. SERVE=no: the workers serve nobody. The programs are those in the folder BIN.
# Needs root, network namespaces, a bridge and the queue tbf, and (WORKERS + 2) * MB of disk in TMPDIR.
set -euo pipefail

bin=$(realpath "${1:?usage: measure.sh BIN [MB] [WORKERS] [MBIT] [SERVE]}")
megabytes=${2:-500} workers=${3:-16} megabit=${4:-100} serve=${5:-yes}
if [ "${TESSERA_IN_NAMESPACE:-}" != yes ]; then
  exec env TESSERA_IN_NAMESPACE=yes unshare --net --mount "$0" "$@"
fi

folder=$(mktemp -d)
hosts=() # the processes that keep the namespaces
programs=()
finish() {
  kill -KILL "${programs[@]}" "${hosts[@]}" 2>/dev/null || true
  wait 2>/dev/null || true
  rm -rf "$folder"
}
trap finish EXIT

ip link set lo up
ip link add bridge0 type bridge
ip link set bridge0 up
ip addr add 10.78.0.1/16 dev bridge0

# add_host NUMBER: a namespace with the address 10.78.1.NUMBER. Its line is limited in both directions.
add_host() {
  unshare --net sleep infinity &
  local keeper=$! port=port$1
  hosts+=("$keeper")
  until [ "$(readlink "/proc/$keeper/ns/net")" != "$(readlink /proc/self/ns/net)" ]; do sleep 0.01; done
  ip link add "$port" type veth peer name eth0 netns "$keeper"
  ip link set "$port" master bridge0 up
  nsenter --net="/proc/$keeper/ns/net" sh -c "ip link set lo up; ip addr add 10.78.1.$1/16 dev eth0; ip link set eth0 up"
}
# limit NUMBER: from then on.
limit() {
  local line=(rate "${megabit}mbit" burst 256k latency 100ms)
  tc qdisc add dev "port$1" root tbf "${line[@]}"
  nsenter --net="/proc/${hosts[$1 - 1]}/ns/net" tc qdisc add dev eth0 root tbf "${line[@]}"
}
# on_host NUMBER COMMAND...: in the background.
on_host() {
  local keeper=${hosts[$1 - 1]}
  shift
  nsenter --net="/proc/$keeper/ns/net" "$@" &
  programs+=($!)
}
sent_by_coordinator() { cat /sys/class/net/port1/statistics/rx_bytes 2>/dev/null || ip -s -j link show port1 |
  grep -o '"rx":{"bytes":[0-9]*' | grep -o '[0-9]*$'; }
seconds_since() { echo "$(($(date +%s%N) - $1))" | awk '{printf "%.1f", $1 / 1e9}'; }

# Files of random bytes: OBJ comments, one eighth of the megabytes each.
for i in 1 2 3 4 5 6 7 8; do
  {
    printf 'v -1 -%d -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\n' "$i"
    head -c $((megabytes * 1000000 * 3 / 4 / 8)) /dev/urandom | base64 -w 100 | sed 's/^/# /'
  } >"$folder/mesh$i.obj"
done
{
  echo '{"camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},'
  echo '"materials": {"lamp": {"type": "lambert", "emission": 1, "albedo": 0.5}}, "shapes": ['
  for i in 1 2 3 4 5 6 7 8; do echo "{\"type\": \"mesh\", \"file\": \"mesh$i.obj\", \"material\": \"lamp\"},"; done
  echo '{"type": "sphere", "center": [0, -2, 0], "radius": 2, "material": "lamp"}]}'
} >"$folder/scene.json"
bytes=$(cat "$folder"/mesh*.obj "$folder/scene.json" | wc -c)

for ((i = 1; i <= workers + 1; ++i)); do add_host "$i"; done
address=10.78.1.1:7420
on_host 1 "$bin/tessera-coordinator" --listen "$address" --insecure --http off --state "$folder/state" \
  --lease-seconds 60 >"$folder/coordinator.log" 2>&1
until grep -q "listening on" "$folder/coordinator.log"; do sleep 0.1; done
job=$("$bin/tessera" submit "$folder/scene.json" --coordinator "$address" --insecure --size 2048x2048 --spp 4096 | head -1)
state() { "$bin/tessera" job "$job" --coordinator "$address" --insecure --json 2>/dev/null; }
until state | grep -q '"state":"running"'; do sleep 0.2; done

for ((i = 1; i <= workers + 1; ++i)); do limit "$i"; done
before=$(sent_by_coordinator)
start=$(date +%s%N)
options=()
[ "$serve" = no ] || options=(--serve-blobs 0.0.0.0:0)
for ((i = 2; i <= workers + 1; ++i)); do
  on_host "$i" "$bin/tessera-worker" --coordinator "$address" --insecure --threads 1 --name "worker$i" \
    --cache "$folder/cache$i" "${options[@]}" >"$folder/worker$i.log" 2>&1
done

first_pixel=
while :; do
  if [ -z "$first_pixel" ] && state | grep -Eq '"samples_done":[1-9]'; then first_pixel=$(seconds_since "$start"); fi
  complete=0
  for ((i = 2; i <= workers + 1; ++i)); do
    have=$(find "$folder/cache$i" -type f -regextype posix-extended -regex '.*/[0-9a-f]{64}' -printf '%s\n' 2>/dev/null |
      awk '{sum += $1} END {print sum + 0}')
    [ "$have" -lt "$bytes" ] || complete=$((complete + 1))
  done
  [ "$complete" -lt "$workers" ] || break
  sleep 0.5
done
sent=$(($(sent_by_coordinator) - before))
echo "files $bytes bytes, $workers workers, $megabit Mbit/s each"
echo "the coordinator sent $sent bytes: $(awk -v a="$sent" -v b="$bytes" 'BEGIN {printf "%.2f", a / b}') times the files"
echo "all workers have the files after $(seconds_since "$start") s, the first pixel after ${first_pixel:-more} s"
