#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# slurm_render_test.sh CASE PROGRAMS SOURCE: deploy/slurm/tessera.sbatch on a real Slurm. The image must equal that of
# tessera render in every CASE: two_nodes, lost_node, requeued, signalled, time_limit, array, frames.
set -euo pipefail

case_name=$1 programs=$2 source=$3
# shellcheck source=tests/cluster/slurm_cluster.sh
. "$source/tests/cluster/slurm_cluster.sh"

export PATH=$programs:$PATH
export TESSERA_HOST=127.0.0.1 TESSERA_LISTEN=127.0.0.1:0 TESSERA_CACHE=$cluster
unset OMP_NUM_THREADS
processors=$(nproc)
scene=cornell
script=$source/deploy/slurm/tessera.sbatch

start_cluster 3

# work_for SECONDS: a render that costs so many seconds of a processor, and its image in local.pfm.
work_for() {
  spp=$(spp_for "$1" $scene 64x64)
  options=(--size 64x64 --spp "$spp")
  total=$((64 * 64 * spp))
  tessera render $scene "${options[@]}" -o local.pfm --threads 2 >/dev/null 2>&1
}
# submit SBATCH-OPTIONS...: the job's number.
submit() { sbatch --parsable --ntasks-per-node=1 -o slurm.log "$@" "$script" $scene "${options[@]}" -o farm.pfm; }
has_rendered() {  # has_rendered JOB SAMPLES
  local log=tessera-$1/coordinator.log
  [ -s "$log" ] || return 1
  [ "$(progress "$1")" -ge "$2" ]
}
# Samples that are done, asked as the job itself does.
progress() {
  local run
  run=$(find "tessera-$1" -maxdepth 1 -name 'run-*' | sort | tail -n 1)
  TESSERA_TLS_CA=$run/certificate.pem TESSERA_TLS_CERTIFICATE=$run/certificate.pem TESSERA_TLS_KEY=$run/key.pem \
    tessera jobs --json --coordinator "127.0.0.1:$(sed -n 's/.*:\([0-9]*\)$/\1/p' "$run/address")" |
    grep -o '"samples_done": *"\?[0-9]*' | grep -o '[0-9]*$'
}
has_rendered_or_ended() { has_rendered "$1" "$2" || job_is "$1" COMPLETED; }
# start_job SHARE SBATCH-OPTIONS...: `job` has rendered 1/SHARE, and goes on. On a busy machine it may end while it is asked:
# then another one has three times the work.
start_job() {
  local share=$1 seconds done_so_far
  shift
  for seconds in 10 30 90; do
    work_for "$seconds"
    job=$(submit "$@")
    wait_until 120 has_rendered_or_ended "$job" $((total / share))
    done_so_far=$(progress "$job" 2>/dev/null) || done_so_far=$total
    [ "$done_so_far" -eq $total ] || return 0
    wait_until 120 job_is "$job" COMPLETED
  done
  fail "each job ended too early"
}
# The job's last act is to remove its state. (Slurm takes half a minute more where a node is lost.)
ends_well() {
  wait_until 120 test ! -e "tessera-$1"
  cmp local.pfm farm.pfm || fail "the image differs from the local one"
}

# Until the job requeues itself, workers run for a tenth of the time: they render as long as Slurm takes to look at the
# limit, and take a tenth of the processor. They are looked for while they are stopped: on a busy machine that takes long.
slow_workers() {
  local workers=()
  signal_workers() { [ ${#workers[@]} -eq 0 ] || kill "-$1" "${workers[@]}" 2>/dev/null || true; }
  until grep -qs "the time limit is near" slurm.log; do
    signal_workers CONT
    sleep 0.1
    signal_workers STOP
    sleep 0.9
    mapfile -t workers < <(pgrep -x tessera-worker | sed 's#.*#/proc/&/environ#' |
      xargs -r grep -slzxF "TESSERA_TEST_CLUSTER=$cluster" | cut -d / -f 3)
  done
  signal_workers CONT
}

case $case_name in
  two_nodes)
    work_for 5
    job=$(TESSERA_KEEP=yes submit -N 2)
    wait_until 120 job_is "$job" COMPLETED
    cmp local.pfm farm.pfm || fail "the image differs from the local one"
    for node in node1 node2; do
      grep -q "has rendered [1-9]" "tessera-$job/worker-$node.log" || fail "$node rendered nothing"
      grep -q "with 1 threads" "tessera-$job/worker-$node.log" || fail "$node took more threads than it was granted"
    done
    from_peers=$(sed -n 's/.* bytes of scene files, \([0-9]*\) of them from other workers.*/\1/p' \
      "tessera-$job"/worker-*.log | paste -sd+ | bc)
    [ "$from_peers" -gt 0 ] || fail "each node fetched all files from the coordinator" ;;
  lost_node)
    start_job 20 -N 3
    kill_node node3
    ends_well "$job" ;;
  requeued)
    start_job 5 -N 2
    scontrol requeue "$job"
    ends_well "$job"
    [ "$(scontrol -o show job "$job" | sed -n 's/.* Restarts=\([0-9]*\).*/\1/p')" -eq 1 ] || fail "it was not requeued" ;;
  signalled)
    export TESSERA_KEEP=yes
    start_job 5 -N 2
    # By hand: the signal of a limit comes when Slurm next looks, twice a minute.
    scancel --batch --signal=USR1 "$job"
    wait_until 120 job_is "$job" COMPLETED
    cmp local.pfm farm.pfm || fail "the image differs from the local one"
    grep -q "the time limit is near: requeued" slurm.log || fail "it did not requeue itself"
    # Nothing is rendered twice but what idle workers render again at the end.
    rendered=$(sed -n 's/.*has rendered \([0-9]*\) samples/\1/p' "tessera-$job"/worker-*.log | paste -sd+ | bc)
    [ "$rendered" -le $((total + total / 4)) ] || fail "$rendered samples were rendered for $total" ;;
  time_limit)
    # Slurm signals a job with less than 90 s left when it next looks, up to half a minute after the start.
    work_for 8
    slow_workers &
    kept+=($!)
    disown
    job=$(TESSERA_KEEP=yes submit -N 1 --time=1)
    wait_until 200 job_is "$job" COMPLETED
    cmp local.pfm farm.pfm || fail "the image differs from the local one"
    grep -q "the time limit is near: requeued" slurm.log || fail "it did not requeue itself" ;;
  array)
    cp "$programs"/../share/tessera/scenes/cornell/* .
    cp scene.json shot.01.json
    mv scene.json shot.02.json
    # A variable of the user's profile does not restrict what Slurm has granted.
    job=$(OMP_NUM_THREADS=1 TESSERA_KEEP=yes sbatch --parsable -N 1 --cpus-per-task=2 --array=1-2 -o slurm.%a.log \
      "$script" "shot.##.json" --size 32x32 --spp 4 -o "shot.##.pfm")
    tessera render shot.01.json --size 32x32 --spp 4 -o local.pfm >/dev/null
    for frame in 01 02; do
      wait_until 120 test -s "shot.$frame.pfm"
      wait_until 10 cmp local.pfm "shot.$frame.pfm"
    done
    # The image may be there before what the worker has last logged.
    threads=$((processors < 2 ? processors : 2))
    have_threads() { [ "$(cat tessera-*/worker-*.log | grep -c "with $threads threads")" -eq 2 ]; }
    wait_until 30 have_threads ;;
  frames)
    # A task for each frame, and all frames in one job. Images that tasks would overwrite are refused.
    cat >turn.json <<'END'
      {"render": {"width": 32, "height": 32, "spp": 2},
       "camera": {"position": {"keyframes": [{"frame": 1, "value": [0, 1, 4]}, {"frame": 12, "value": [3, 1, 4]}]},
                  "look_at": [0, 0, 0]},
       "materials": {"clay": {"type": "lambert", "albedo": 0.5}},
       "environment": {"radiance": 0.3},
       "shapes": [{"type": "sphere", "center": [1, 0, 0], "radius": 1, "material": "clay"}]}
END
    tessera render turn.json --frames 9-10 -o "local.##.pfm" >/dev/null
    ! cmp -s local.09.pfm local.10.pfm || fail "nothing moves"
    sbatch --parsable -N 1 --array=9-10 -o slurm.%a.log "$script" turn.json -o "task.##.pfm"
    sbatch --parsable -N 1 -o slurm.log "$script" turn.json --frames 9-10 -o "one.##.pfm"
    for image in task.09 task.10 one.09 one.10; do
      wait_until 120 test -s $image.pfm
      wait_until 10 cmp "local.${image#*.}.pfm" $image.pfm
    done
    sbatch --parsable -N 1 --array=9-10 -o refused.%a.log "$script" turn.json -o task.pfm
    wait_until 60 grep -q "task.pfm would be written by each task" refused.9.log ;;
  *) fail "there is no case $case_name" ;;
esac
