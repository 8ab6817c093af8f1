#!/bin/bash
# A study as a job array, a task for each of its runs:
#
#     tasks=$(tether study count study.toml)
#     array=$(sbatch --parsable --array=0-$((tasks - 1)) array.sh study.toml)
#     sbatch --dependency=afterany:$array --wrap="tether study collect study"
#
# It writes the folder `study`. `--array=0-99%20` has 20 tasks at a time. Tasks that were killed, or failed for want of
# memory or disk, are done by the same lines again: runs that are done take a second, the others go on. Where the site has
# a smaller MaxArraySize than the study has runs, submit it in parts, each with the number of its first run after the
# study: --array=0-999 array.sh study.toml 1000
#
#SBATCH --job-name=tether
#SBATCH --output=%x-%A_%a.log
#SBATCH --open-mode=append
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=1G
#SBATCH --time=08:00:00
# Two minutes before its time is over a task writes a checkpoint and goes back into the queue, as often as it takes.
#SBATCH --signal=B:USR1@120
#SBATCH --requeue

study=$1
number=$((${2:-0} + SLURM_ARRAY_TASK_ID))
threads=${SLURM_CPUS_PER_TASK:-1}

# Bash hears a signal only while it waits, so the run is a background job. A scancel reaches the run itself: then the
# shell has to stay until the run's checkpoint is written, and nothing is to be queued again.
time_is_over=no
trap 'time_is_over=yes; kill -TERM "$run"' USR1
trap : TERM

tether study run-point "$study" "$number" --threads "$threads" &
run=$!
while kill -0 "$run" 2>/dev/null; do
    wait "$run"
done
wait "$run"
status=$?

if [ "$time_is_over" = yes ] && [ "$status" -eq 143 ]; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID" # one of the tasks has the SLURM_JOB_ID of the whole array
fi
exit "$status"
