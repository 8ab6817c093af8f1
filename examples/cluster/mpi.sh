#!/bin/bash
# A study as one job of many processes: the first one hands out the runs, the longest first, the others do them.
#
#     sbatch --ntasks=65 mpi.sh study.toml
#
# It writes the folder `study` with everything in it. Whatever ends it, the same line goes on with it. A process that
# dies takes an MPI job along, so on nodes that fail now and then array.sh and dask.py lose less.
#
# Needs mpi4py and an MPI that SLURM can start: `srun --mpi=list` shows what it speaks. Where none fits, put
# `mpiexec -n "$SLURM_NTASKS"` in the place of srun and its option.
#
#SBATCH --job-name=tether
#SBATCH --output=%x-%j.log
#SBATCH --open-mode=append
#SBATCH --ntasks=9
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=1G
#SBATCH --time=08:00:00
# Two minutes before its time is over the job writes checkpoints and goes back into the queue, as often as it takes.
#SBATCH --signal=B:USR1@120
#SBATCH --requeue

study=$1
threads=${SLURM_CPUS_PER_TASK:-1}

# Bash hears a signal only while it waits, so srun is a background job. It would kill its processes on a signal; scancel
# tells them instead, and the first one has the others write checkpoints. A scancel by hand reaches them by itself: then
# the shell has to stay until they are done, and nothing is to be queued again.
time_is_over=no
trap 'time_is_over=yes; scancel --signal=TERM "$SLURM_JOB_ID.0"' USR1
trap : TERM

srun --mpi=pmi2 --kill-on-bad-exit=1 --cpus-per-task="$threads" \
    python -m mpi4py.futures -m tether study "$study" --threads "$threads" &
processes=$!
while kill -0 "$processes" 2>/dev/null; do
    wait "$processes"
done
wait "$processes"
status=$?

if [ "$time_is_over" = yes ] && [ "$status" -ne 0 ]; then
    scontrol requeue "$SLURM_JOB_ID"
fi
exit "$status"
