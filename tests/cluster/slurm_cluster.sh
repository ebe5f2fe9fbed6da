# SPDX-License-Identifier: Apache-2.0
# A Slurm cluster of several nodes on this machine, in a folder of its own, for tests to source:
#   start_cluster NODES; kill_node NAME; start_node NAME
# The daemons listen on loopback and end with the shell that sources this file. Exit status 77 (skipped) if Slurm is not
# installed or this is not root.

for program in slurmctld slurmd sbatch; do
  PATH=$PATH:/usr/sbin command -v $program >/dev/null ||
    { echo "skipped: $program is not installed (Debian: slurm-wlm)"; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "skipped: a cluster of several slurmd on one machine needs root"; exit 77; }
PATH=$PATH:/usr/sbin

cluster=$(mktemp -d)
declare -A daemons=()  # process ids by name: slurmctld, node1, ...
kept=()                # further processes of the test, ended with the cluster

stop_cluster() {
  local status=$?
  trap - EXIT
  scancel --full --user=root --signal=KILL 2>/dev/null || true
  for process in "${kept[@]}" "${daemons[@]}"; do kill -KILL -- "$process" 2>/dev/null || true; done
  # Tasks outlive their slurmd. All of them have the folder of this cluster in their environment.
  for environment in /proc/[0-9]*/environ; do
    local process=${environment#/proc/}
    process=${process%/environ}
    [ "$process" != $$ ] && [ "$process" != "$BASHPID" ] && [ "$process" != "$PPID" ] || continue
    grep -qz "^TESSERA_TEST_CLUSTER=$cluster\$" "$environment" 2>/dev/null && kill -KILL "$process" 2>/dev/null
  done
  [ "$status" -eq 0 ] || [ "$status" -eq 77 ] || show_logs
  rm -rf "$cluster"
  exit "$status"
}
trap stop_cluster EXIT

show_logs() {
  for file in "$cluster"/*.log "$cluster"/run/*.log "$cluster"/run/*.out "$cluster"/run/*/*.log; do
    [ -s "$file" ] || continue
    echo "==== ${file#"$cluster"/}"
    tail -n 40 "$file"
  done
}

free_ports() {  # free_ports N: N numbers of ports that nobody listens at
  python3 - "$1" <<'END'
import socket, sys
sockets = [socket.socket() for _ in range(int(sys.argv[1]))]
for s in sockets: s.bind(("127.0.0.1", 0))
print(*[s.getsockname()[1] for s in sockets])
END
}

write_configuration() {  # write_configuration NODES PORT...
  local nodes=$1 host
  shift
  host=$(hostname -s)
  cat >"$cluster/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$1
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
AuthInfo=cred_expire=5
CredType=cred/none
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool.%n
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/slurmd.%n.pid
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=100000,bf_interval=1,requeue_setup_env_fail
SlurmdTimeout=4
InactiveLimit=0
KillWait=5
MinJobAge=300
ReturnToService=2
MpiDefault=none
SwitchType=switch/none
END
  for ((i = 1; i <= nodes; ++i)); do
    shift
    echo "NodeName=node$i NodeHostname=$host NodeAddr=127.0.0.1 Port=$1 CPUs=2 State=UNKNOWN" >>"$cluster/slurm.conf"
  done
  echo "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP" >>"$cluster/slurm.conf"
}

start_node() {
  slurmd -D -N "$1" >>"$cluster/$1.log" 2>&1 &
  daemons[$1]=$!
  disown
}

# The node vanishes: its slurmd and everything that runs on it. Two processes look through all environments at once: one
# for each would take seconds on a busy machine, in which the job goes on.
kill_node() {
  kill -KILL "${daemons[$1]}"
  local environment
  while read -r environment; do
    environment=${environment#/proc/}
    kill -KILL "${environment%/environ}" 2>/dev/null || true
  done < <(grep -slzxF "TESSERA_TEST_CLUSTER=$cluster" /proc/[0-9]*/environ |
    xargs -r grep -slzxF "SLURMD_NODENAME=$1")
  unset "daemons[$1]"
}

# wait_until SECONDS COMMAND...: fails if the command does not succeed in time.
wait_until() {
  local end=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    [ "$SECONDS" -lt "$end" ] || { echo "in vain: $*" >&2; return 1; }
    sleep 0.1
  done
}

nodes_are_idle() { [ "$(sinfo -h -N -o %t | grep -c '^idle$')" -eq "$1" ]; }

start_cluster() {
  mkdir -p "$cluster/state" "$cluster/run"
  # shellcheck disable=SC2046  # one word each
  write_configuration "$1" $(free_ports $(($1 + 1)))
  export SLURM_CONF=$cluster/slurm.conf TESSERA_TEST_CLUSTER=$cluster
  slurmctld -D -c >"$cluster/slurmctld.log" 2>&1 &
  daemons[slurmctld]=$!
  disown
  for ((n = 1; n <= $1; ++n)); do start_node "node$n"; done
  wait_until 60 nodes_are_idle "$1"
  cd "$cluster/run"
}

# spp_for SECONDS SCENE SIZE: samples per pixel that cost so many seconds of a processor, whatever build and machine can
# do.
spp_for() {
  local spp=2 took=0
  while [ "$took" -lt 500 ]; do
    spp=$((spp * 4))
    tessera render "$2" --size "$3" --spp $spp -o speed.pfm --stats speed.json --threads 1 >/dev/null 2>&1
    # Without the start, which takes longer than so few samples where other work fills the machine.
    took=$(sed -n 's/.*"render_core_seconds": *\([0-9.e-]*\).*/\1/p' speed.json | awk '{ printf "%d", 1000 * $1 }')
  done
  echo $(($1 * 1000 * spp / took))
}

job_state() { scontrol -o show job "$1" | sed -n 's/.*JobState=\([A-Z_]*\).*/\1/p'; }
job_is() { [ "$(job_state "$1")" = "$2" ]; }
fail() { echo "FAILED: $*" >&2; exit 1; }
