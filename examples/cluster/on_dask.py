"""A study on SLURM by way of Dask: this process hands out the runs, and submits a job for each worker that does some.

    python on_dask.py study.toml --jobs 20

It writes the folder `study`, and goes on with what is there. Keep it running for as long as the study takes (in tmux on
the login node, or in a small job of its own); if it ends, the same line goes on. Jobs that end, killed or at their
time, are replaced by others, which go on with the runs from their checkpoints. Needs: pip install 'tether[slurm]'
"""

from __future__ import annotations

import argparse
from pathlib import Path

from dask_jobqueue import SLURMCluster
from distributed import Client
from distributed.deploy.cluster import Cluster

from tether.study import Study, run_study

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("study", type=Path)
parser.add_argument("--jobs", type=int, default=20, help="the most jobs at a time, one run each")
parser.add_argument("--threads", type=int, default=1, help="threads of each run")
parser.add_argument("--hours", type=float, default=8.0, help="time limit of each job")
parser.add_argument("--memory", default="1GB", help="memory of each job")
parser.add_argument("--interface", help="network that the jobs reach this machine by, for example ib0")
parser.add_argument(
    "--sbatch", action="append", default=[], metavar="OPTION", help="for example --sbatch=--partition=long"
)


def slurm(given: argparse.Namespace) -> SLURMCluster:
    """Jobs of SLURM, each with one worker that does one run at a time."""
    seconds = round(3600 * given.hours)
    return SLURMCluster(
        job_name="tether",
        cores=1,  # runs at a time; their threads are their own
        processes=1,
        job_cpu=given.threads,
        memory=given.memory,
        walltime=f"{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}",
        interface=given.interface,
        job_extra_directives=given.sbatch,
        log_directory="logs",
        scheduler_options={"dashboard_address": ":0"},
        # A worker hands its run over before SLURM kills it: a run whose worker was killed three times is given up.
        worker_extra_args=["--lifetime", f"{0.9 * seconds:.0f}s", "--lifetime-stagger", f"{0.05 * seconds:.0f}s"],
    )


def do(given: argparse.Namespace, cluster: Cluster) -> None:
    """Do the study on workers that come and go as there are runs to do."""
    study, folder = Study.read(given.study), Path(given.study.stem)
    with Client(cluster) as client:
        # Long runs that Dask knows nothing of: it is to want a worker for each of them at once.
        cluster.adapt(minimum=0, maximum=given.jobs, target_duration="1ms")
        executor = client.get_executor(pure=False)
        run_study(study, folder, executor, workers=given.jobs, threads=given.threads)
    print(f"Results: {folder}; tether study plot {folder} draws them")


if __name__ == "__main__":
    given = parser.parse_args()
    with slurm(given) as cluster:
        do(given, cluster)
