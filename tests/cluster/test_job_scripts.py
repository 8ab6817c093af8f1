"""The job scripts of examples/cluster, done without SLURM; validation/slurm does them with it.

Bash tells by its trace (-x) what a script calls. SLURM's own commands are kept off its path: "not found" ends them.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from small_runs import tether
from small_studies import InThisThread, assert_same_study, study, write_study

from tether.study import run_study

EXAMPLES = Path(__file__).parents[2] / "examples" / "cluster"
PROGRAMS = Path(sys.executable).parent
SCRIPTS = sorted(EXAMPLES.glob("*.sh"))

# Three runs; the first is the longest, about a second and a half.
STUDY = """\
base = "couette.toml"

[set]
output.checkpoint = {seconds = 600}

[[sweep.zip]]
flow.shear_rate = [0.5, 1.0, 1.5]
run.steps = [12000, 200, 200]
"""


@pytest.fixture(scope="module")
def done_here(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of STUDY, done in one go in one process."""
    folder = tmp_path_factory.mktemp("here")
    run_study(study(folder, STUDY), folder / "study", InThisThread())
    return folder / "study"


def environment(**variables: object) -> dict[str, str]:
    return {"PATH": str(PROGRAMS)} | {name: str(value) for name, value in variables.items()}


def called(trace: str, command: str) -> list[list[str]]:
    """The arguments of every call of a command that the trace tells of."""
    lines = [shlex.split(line.lstrip("+ ")) for line in trace.splitlines() if re.match(rf"\++ {command} ", line)]
    return [arguments[1:] for arguments in lines]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_what_a_script_asks_of_slurm(script: Path) -> None:
    """Directives stand before the first command, where alone sbatch reads them, and ask for all that going on takes."""
    head, commands = re.fullmatch(r"(#!/bin/bash\n(?:#.*\n)*)\n(.*)", script.read_text(), re.DOTALL).groups()
    assert "#SBATCH" not in commands
    asked = dict(
        re.fullmatch(r"--([\w-]+)(?:=(\S+))?", line).groups() for line in re.findall("^#SBATCH (.*)", head, re.M)
    )
    assert {"job-name", "output", "ntasks", "cpus-per-task", "mem-per-cpu", "time"} <= asked.keys()
    assert asked["signal"] == "B:USR1@120"
    assert "requeue" in asked
    assert asked["open-mode"] == "append", "a job that goes on must keep what it has said before"
    subprocess.run(["/bin/bash", "-n", script], check=True)


# Arrays


def task(folder: Path, number: object, *arguments: object) -> subprocess.Popen[str]:
    """A task of the job array 77, the shell in a session of its own."""
    return subprocess.Popen(
        ["/bin/bash", "-x", EXAMPLES / "array.sh", "study.toml", *map(str, arguments)],
        env=environment(SLURM_ARRAY_JOB_ID=77, SLURM_ARRAY_TASK_ID=number, SLURM_JOB_ID=99, SLURM_CPUS_PER_TASK=1),
        cwd=folder, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip


def checkpoints(folder: Path) -> list[int]:
    """When the last checkpoint of each run was written, in ns: at its beginning, and when it is stopped."""
    return [path.stat().st_mtime_ns for path in folder.glob("study/points/*/checkpoint.h5")]


@pytest.fixture
def begun(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """The first task of STUDY, once its run is under way; nothing of it is left behind."""
    write_study(tmp_path, STUDY)
    job = task(tmp_path, 0)
    until = time.monotonic() + 60.0
    while not checkpoints(tmp_path):
        assert job.poll() is None, job.stderr.read()
        assert time.monotonic() < until
        time.sleep(0.01)
    yield job
    if job.poll() is None:
        os.killpg(job.pid, signal.SIGKILL)
        job.wait()


def test_tasks_of_an_array_together_are_the_study(tmp_path: Path, done_here: Path) -> None:
    """All at once, as SLURM may begin them; the last one as a second part of the study."""
    write_study(tmp_path, STUDY)
    jobs = [task(tmp_path, 0), task(tmp_path, 1), task(tmp_path, 0, 2)]
    for job in jobs:
        _, said = job.communicate(timeout=60)
        assert job.returncode == 0, said
        assert not called(said, "scontrol")
    assert tether("study", "collect", tmp_path / "study").code == 0
    assert_same_study(tmp_path / "study", done_here)


def test_a_task_whose_time_is_over_goes_back_into_the_queue(
    begun: subprocess.Popen[str], tmp_path: Path, done_here: Path
) -> None:
    """The signal reaches the shell alone. Of the whole array only this task is queued again, and it ends the run."""
    first = checkpoints(tmp_path)
    begun.send_signal(signal.SIGUSR1)
    _, said = begun.communicate(timeout=60)
    assert begun.returncode == 128 + signal.SIGTERM, said
    assert called(said, "scontrol") == [["requeue", "77_0"]]
    assert checkpoints(tmp_path) > first
    assert not list(tmp_path.glob("study/points/*/summary.json"))
    again = task(tmp_path, 0)
    _, said = again.communicate(timeout=60)
    assert again.returncode == 0, said
    run = next(tmp_path.glob("study/points/*/summary.json"))
    expected = done_here / "points" / run.parent.name / "series.nc"
    assert (run.parent / "series.nc").read_bytes() == expected.read_bytes()


def test_a_task_that_is_cancelled_writes_a_checkpoint_and_stays_away(
    begun: subprocess.Popen[str], tmp_path: Path
) -> None:
    """SLURM's SIGTERM reaches the shell and the run. A shell that ended at once would take the run along."""
    first = checkpoints(tmp_path)
    os.killpg(begun.pid, signal.SIGTERM)
    _, said = begun.communicate(timeout=60)
    assert begun.returncode == 128 + signal.SIGTERM, said
    assert "stopped; the same command goes on with it" in said
    assert not called(said, "scontrol")
    assert checkpoints(tmp_path) > first


# MPI


def test_the_processes_of_an_mpi_job_do_the_study(tmp_path: Path, done_here: Path) -> None:
    """What the script has srun start is started by mpiexec here."""
    pytest.importorskip("mpi4py")
    launcher = shutil.which("mpiexec", path=f"{PROGRAMS}{os.pathsep}{os.environ['PATH']}")
    if launcher is None:
        pytest.skip("there is no mpiexec")
    write_study(tmp_path, STUDY)
    script = subprocess.run(
        ["/bin/bash", "-x", EXAMPLES / "mpi.sh", "study.toml"],
        env=environment(SLURM_JOB_ID=99, SLURM_CPUS_PER_TASK=2), check=False, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert script.returncode == 127, script.stderr
    (arguments,) = called(script.stderr, "srun")
    python = arguments.index("python")
    assert arguments[:python] == ["--mpi=pmi2", "--kill-on-bad-exit=1", "--cpus-per-task=2"]
    assert arguments[-2:] == ["--threads", "2"]
    command = [launcher, "-n", "3", PROGRAMS / arguments[python], *arguments[python + 1 :]]
    ran = subprocess.run(command, check=False, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert ran.returncode == 0, ran.stderr
    assert_same_study(tmp_path / "study", done_here)
