#!/usr/bin/env bash
# Runs planned precomputes with the engines that users have: GNU parallel, mpirun, and Slurm with the scripts of
# examples/slurm on a cluster of this one host. All must give the bytes of a single part.
#   run.sh RELUMINE RELUMINE_MPI SOURCE_DIR
set -euo pipefail
relumine=$(realpath "$1")
relumine_mpi=$(realpath "$2")
source=$(realpath "$3")
folder=$(mktemp -d)
slurm_pids=()
finish() {
    [ ${#slurm_pids[@]} -eq 0 ] || kill "${slurm_pids[@]}" 2>/dev/null || true
    wait 2>/dev/null || true
    rm -rf "$folder"
}
trap finish EXIT
cd "$folder"
mkdir bin
ln -s "$relumine" "$relumine_mpi" bin/
export PATH="$folder/bin:$PATH"

failed=0
compare() { # NAME FILE
    if cmp -s "$2" whole.prt; then echo "$1: the same bytes"; else echo "$1: other bytes"; failed=1; fi
}

relumine generate knot -o . --vertices 20000 -q
relumine plan knot.ply -o knot.plan --tolerance 0.04 --floor 40 --bounces 0.02 -q
relumine precompute knot.plan --part 1/1 -o whole.part -q
relumine join whole.part -o whole.prt -q

if command -v parallel >/dev/null; then
    parallel --will-cite -j 2 relumine precompute knot.plan --part {}/5 -o parallel.part.{} -q ::: 1 2 3 4 5
    relumine join parallel.part.* -o parallel.prt -q
    compare "GNU parallel, 5 parts" parallel.prt
else
    echo "GNU parallel: not installed (packages/scale.txt)"
fi

if command -v mpirun >/dev/null; then
    as_root=()
    [ "$(id -u)" -ne 0 ] || as_root=(--allow-run-as-root)
    # shellcheck disable=SC2016 # the ranks expand it
    mpirun "${as_root[@]}" --oversubscribe --mca btl self,vader -n 3 sh -c 'relumine precompute \
        knot.plan --part $((OMPI_COMM_WORLD_RANK + 1))/$OMPI_COMM_WORLD_SIZE \
        -o mpi.part.$OMPI_COMM_WORLD_RANK --threads 1 -q'
    relumine join mpi.part.* -o mpi.prt -q
    compare "mpirun, 3 ranks" mpi.prt
else
    echo "MPI: not installed (packages/scale.txt)"
fi

# A task that was killed is done again by its command; nothing half written is left.
relumine precompute knot.plan --part 2/2 -o killed.part.2 -q &
sleep 0.3
kill -9 $! 2>/dev/null || true
wait $! 2>/dev/null || true
[ ! -e killed.part.2 ] || echo "killed: the part was done before"
for i in 1 2; do relumine precompute knot.plan --part $i/2 -o killed.part.$i -q; done
relumine join killed.part.1 killed.part.2 -o killed.prt -q
compare "a task that was killed and done again" killed.prt

start_slurm() {
    host=$(hostname -s)
    export SLURM_CONF="$folder/slurm.conf"
    mkdir -p state spool
    cat >slurm.conf <<CONF
ClusterName=t
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmctldPort=16817
SlurmdPort=16818
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=p Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
    mkdir -p /run/munge
    chown munge:munge /run/munge
    if ! pgrep -x munged >/dev/null; then
        runuser -u munge -- /usr/sbin/munged --foreground >munged.log 2>&1 &
        slurm_pids+=($!)
    fi
    sleep 1
    slurmctld -D >slurmctld.log 2>&1 &
    slurm_pids+=($!)
    slurmd -D -N "$host" >slurmd.log 2>&1 &
    slurm_pids+=($!)
    for _ in $(seq 60); do
        sinfo -h -o %T 2>/dev/null | grep -q idle && return 0
        sleep 0.5
    done
    return 1
}

if ! command -v slurmctld >/dev/null || ! command -v munged >/dev/null; then
    echo "Slurm: not installed (packages/scale.txt)"
elif [ "$(id -u)" -ne 0 ]; then
    echo "Slurm: its daemons need root"
elif ! start_slurm; then
    tail -n 5 slurmctld.log slurmd.log
    echo "Slurm: did not start"
    failed=1
else
    options=(--cpus-per-task=1 --mem=0)
    job=$(sbatch --parsable "${options[@]}" --array=1-4 "$source/examples/slurm/array.sbatch" knot.plan)
    sbatch --wait --parsable --mem=0 --dependency="afterok:$job" "$source/examples/slurm/join.sbatch" knot >/dev/null
    compare "Slurm, an array of 4 and its join" knot.prt
    relumine precompute knot.ply -o whole.prt --tolerance 0.04 --floor 40 --bounces 0.02 -q
    OMPI_MCA_btl=self,vader sbatch --wait --parsable --mem=0 --nodes=1 --ntasks-per-node=2 --cpus-per-task=1 \
        "$source/examples/slurm/mpi.sbatch" knot.ply shared.prt --tolerance 0.04 --floor 40 --bounces 0.02 >/dev/null
    compare "Slurm, 2 ranks of one job" shared.prt
fi
exit "$failed"
