#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# slurm_elastic_test.sh PROGRAMS SOURCE: workers of a standing coordinator in a real Slurm, which come with the backlog and
# go with it.
set -euo pipefail

programs=$1 source=$2
# shellcheck source=tests/cluster/slurm_cluster.sh
. "$source/tests/cluster/slurm_cluster.sh"
export PATH=$programs:$PATH TESSERA_CACHE=$cluster

start_cluster 3
tessera-coordinator --listen 127.0.0.1:0 --state "$cluster/coordinator" --lease-seconds 3 --http off >address 2>coordinator.log &
kept+=($!)
disown
wait_until 30 grep -q listening address
export TESSERA_COORDINATOR
TESSERA_COORDINATOR=$(sed -n 's/.*listening on //p' address)

workers() { squeue -h -n farm -t RUNNING | wc -l; }
workers_are() { [ "$(workers)" -eq "$1" ]; }
workers_reach() { [ "$(workers)" -ge "$1" ]; }

"$source/deploy/slurm/tessera-slurm-workers" --name farm --max 3 --seconds-per-worker 2 --release-after 2 --period 0.5 \
  -- --output=worker-%j.log 2>controller.log &
kept+=($!)
disown
sleep 1.5
workers_are 0 || fail "there are workers without work"

# On a busy machine a job may end before a second worker comes: then another one has three times the work.
workers_came_or_job_ended() { workers_reach 2 || ! kill -0 "$watch" 2>/dev/null; }
for seconds in 12 36 108; do
  spp=$(spp_for "$seconds" cornell 64x64)
  samples=$((64 * 64 * spp))
  job=$(tessera submit cornell --size 64x64 --spp "$spp")
  tessera watch "$job" >/dev/null 2>&1 &
  watch=$!
  wait_until 120 workers_came_or_job_ended
  if workers_reach 2; then break; fi
done
workers_reach 2 || fail "each job ended before a second worker came"
tessera watch "$job" >/dev/null
tessera image "$job" -o farm.pfm >/dev/null
wait_until 60 workers_are 0
tessera render cornell --size 64x64 --spp "$spp" -o local.pfm >/dev/null 2>&1
cmp local.pfm farm.pfm || fail "the image differs from the local one"

# Each worker that was let go returned what it had rendered and said goodbye.
came=$(grep -l "registered with" worker-*.log | wc -l)
said_goodbye() { [ "$(cat worker-*.log | grep -c "has rendered")" -eq "$came" ]; }
wait_until 30 said_goodbye
rendered=$(sed -n 's/.*has rendered \([0-9]*\) samples/\1/p' worker-*.log | paste -sd+ | bc)
grep -q "serves files to other workers" worker-*.log || fail "the workers do not serve files to each other"
[ "$rendered" -ge "$samples" ] || fail "$rendered samples were rendered for $samples"
