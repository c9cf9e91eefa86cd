#!/bin/sh
# A Slurm cluster of one node on this machine, in a folder of its own, as the user who calls.
#
#   cluster.sh start DIR [LINE]...   controller and node; each LINE is added to its slurm.conf
#   cluster.sh controller DIR        the controller alone, again
#   cluster.sh node DIR              the node alone, again
#   cluster.sh stop DIR              all of it, jobs included
#   cluster.sh crash-node DIR        the node and all that runs on it, at once; until it is missed
#   cluster.sh crash-controller DIR  the controller, at once
#   cluster.sh crash-task DIR        the process of one running task, at once
#   cluster.sh hasten DIR            tasks that wait for their time do not
#
# Its commands find it by SLURM_CONF=DIR/slurm.conf. Needs Debian's slurm-wlm and munge.
set -eu

command=$1
dir=$(cd "$2" && pwd)
export SLURM_CONF="$dir/slurm.conf"
PATH="$PATH:/usr/sbin:/sbin"

configure() {
    user=$(id -un)
    cores=$(nproc)
    mkdir -p "$dir/state" "$dir/spool" "$dir/munge"
    chmod 700 "$dir/munge"
    head -c 1024 /dev/urandom >"$dir/munge/key"
    chmod 400 "$dir/munge/key"
    cat >"$SLURM_CONF" <<CONF
ClusterName=test
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$(free_port 0)
SlurmdPort=$(free_port 1)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
CryptoType=crypto/munge
AuthInfo=socket=$dir/munge/socket,cred_expire=3
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_min_interval=100000
ReturnToService=2
SlurmdTimeout=5
KillWait=2
MessageTimeout=5
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$cores State=UNKNOWN
PartitionName=test Nodes=ALL Default=YES MaxTime=60 State=UP
CONF
    for line in "$@"; do echo "$line" >>"$SLURM_CONF"; done
}

# A port above those that the system hands out, by this process' number.
free_port() {
    echo $((61000 + ($$ * 2 + $1) % 4500))
}

munge_daemon() {
    munged --force --num-threads=2 --socket="$dir/munge/socket" --key-file="$dir/munge/key" \
        --pid-file="$dir/munge/pid" --log-file="$dir/munge/log" --seed-file="$dir/munge/seed"
}

controller() {
    slurmctld -i </dev/null >>"$dir/slurmctld.out" 2>&1
    await controller_answers slurmctld.log
}

node() {
    slurmd -N "$(hostname -s)" </dev/null >>"$dir/slurmd.out" 2>&1
    await node_is_up slurmd.log
}

controller_answers() {
    scontrol ping | grep -q "is UP"
}

node_is_up() {
    sinfo --noheader --format=%T | grep -q -E "idle|mixed|allocated|completing"
}

node_is_down() {
    sinfo --noheader --format=%T | grep -q "down"
}

await() {
    tries=0
    until "$1" 2>/dev/null; do
        tries=$((tries + 1))
        if [ $tries -gt 300 ]; then
            echo "$1: not within 30 s" >&2
            tail -n 20 "$dir/$2" >&2
            exit 1
        fi
        sleep 0.1
    done
}

# Ends the process whose number stands in a file, at once.
crash() {
    if [ -s "$1" ]; then kill -KILL "$(cat "$1")" 2>/dev/null || true; fi
    rm -f "$1"
}

# Ends what runs on the node at once: the processes of jobs, and those that keep them.
crash_jobs() {
    for process in $(scontrol listpids 2>/dev/null | awk '$1 + 0 > 1 { print $1 }'); do
        keeper=$(awk '$1 == "PPid:" { print $2 }' "/proc/$process/status" 2>/dev/null || true)
        case $(cat "/proc/$keeper/comm" 2>/dev/null || true) in
        slurmstepd) kill -KILL "$keeper" 2>/dev/null || true ;;
        esac
        kill -KILL "$process" 2>/dev/null || true
    done
}

case $command in
start)
    shift 2
    configure "$@"
    munge_daemon
    controller
    node
    ;;
controller) controller ;;
node) node ;;
crash-controller) crash "$dir/slurmctld.pid" ;;
crash-task)
    kill -KILL "$(scontrol listpids | awk '$1 + 0 > 1 { print $1; exit }')"
    ;;
hasten)
    for task in $(squeue --noheader --array --states=PENDING --format=%i); do
        scontrol update "JobId=$task" StartTime=now
    done
    ;;
crash-node)
    crash "$dir/slurmd.pid"
    crash_jobs
    await node_is_down slurmctld.log
    ;;
stop)
    crash "$dir/slurmctld.pid"
    crash "$dir/slurmd.pid"
    crash_jobs
    crash "$dir/munge/pid"
    ;;
*)
    echo "no such command: $command" >&2
    exit 2
    ;;
esac
