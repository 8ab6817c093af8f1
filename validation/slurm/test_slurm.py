"""The job scripts of examples/cluster on a real SLURM, which tools/slurm-here starts: tasks and workers are killed and
cancelled, their time runs out, and what comes out has the bytes of a study that nobody disturbed.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tether.config import load
from tether.study.cost import cost_of_step, trial

ROOT = Path(__file__).parents[2]
SCRIPTS = ROOT / "examples" / "cluster"
PROGRAMS = Path(sys.executable).parent
TABLES = ("results.csv", "results.parquet", "means.csv", "means.parquet", "results.nc")

BASE = """\
[box]
size = [6.0, 6.0]
[fluid]
temperature = 1.0
[[bodies]]
shape = "square"
count = 6
[flow]
kind = "couette"
shear_rate = 0.5
[run]
timestep = 0.005
equilibration = 100
steps = {steps}
[output]
checkpoint = {{ seconds = 1 }}
"""

STUDY = """\
base = "base.toml"
repeats = 2
relative = true
[sweep]
flow.shear_rate = [0.2, 0.8]
"""

# In the order of their numbers.
SHORT_AND_LONG = """\
base = "base.toml"
[[sweep.zip]]
flow.shear_rate = [0.2, 0.8]
run.equilibration = [100, 200]
output.checkpoint = [{ steps = 1000000000 }, { seconds = 600 }]
"""


@dataclass(frozen=True)
class Slurm:
    """A SLURM that is up, and a folder to submit from."""

    configuration: str
    folder: Path

    def call(self, *command: object) -> str:
        """What a command prints; it has to succeed."""
        paths = f"{PROGRAMS}{os.pathsep}{os.environ['PATH']}"
        ran = subprocess.run(
            [str(part) for part in command], cwd=self.folder, capture_output=True, text=True, check=False,
            env=os.environ | {"SLURM_CONF": self.configuration, "PATH": paths},
        )  # fmt: skip
        assert ran.returncode == 0, (command, ran.stdout, ran.stderr)
        return ran.stdout.strip()

    def submit(self, *arguments: object) -> str:
        """The number of a new job."""
        return self.call("sbatch", "--parsable", *arguments)

    def state(self, job: str) -> dict[str, str]:
        """All that SLURM tells of a job, or of one task of an array."""
        return dict(part.split("=", 1) for part in self.call("scontrol", "show", "job", job).split() if "=" in part)

    def wait_for(self, condition: Callable[[], bool], seconds: float = 300.0) -> None:
        until = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < until, (self.call("squeue"), self.logs())
            time.sleep(0.2)

    def wait(self, *, again_at_once: bool = False) -> None:
        """Until no job is left. again_at_once: what was queued again need not wait there for two minutes."""

        def is_empty() -> bool:
            left = [line.split() for line in self.call("squeue", "--noheader", "--format=%i %r").splitlines()]
            for job in [job for job, reason in left if again_at_once and reason == "BeginTime"]:
                self.call("scontrol", "update", f"JobId={job}", "StartTime=now")
            return not left

        self.wait_for(is_empty, 900.0)

    def logs(self) -> str:
        return "\n".join(f"--- {path.name}\n{path.read_text()}" for path in sorted(self.folder.glob("*.log")))

    def begun(self) -> list[Path]:
        """The folders of runs that have a checkpoint and no results."""
        checkpoints = self.folder.glob("study/points/*/checkpoint.h5")
        return [path.parent for path in checkpoints if not (path.parent / "summary.json").exists()]


@pytest.fixture(scope="module")
def configuration() -> Iterator[str]:
    """The path of slurm.conf, while it is up."""
    if lacking := [each for each in ("sbatch", "slurmctld", "slurmd", "munged") if not _has(each)]:
        pytest.skip(f"{lacking[0]} is not installed: apt-get install slurm-wlm munge")
    command = [ROOT / "tools" / "slurm-here", "sh", "-c", "echo $SLURM_CONF; exec cat"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as here:
        try:
            path = here.stdout.readline().strip()
            assert path, "tools/slurm-here could not start SLURM; it says why above"
            yield path
        finally:
            here.stdin.close()
            here.wait(60.0)


def _has(program: str) -> bool:
    return shutil.which(program, path=f"{os.environ['PATH']}:/usr/sbin:/sbin") is not None


@pytest.fixture
def slurm(configuration: str, tmp_path: Path) -> Iterator[Slurm]:
    made = Slurm(configuration, tmp_path)
    yield made
    made.call("scancel", "--user", os.environ.get("USER") or os.getuid())


def write(folder: Path, seconds: float, study: str = STUDY) -> None:
    """A study, and its base with a run of about so many seconds on one processor here."""
    path = folder / "base.toml"
    path.write_text(BASE.format(steps=1000))
    steps = round(seconds * trial(load(path), 1) / cost_of_step(load(path)))
    path.write_text(BASE.format(steps=steps))
    (folder / "study.toml").write_text(study)


def assert_same_as_undisturbed(slurm: Slurm) -> None:
    slurm.call("tether", "study", "study.toml", "--out", "undisturbed", "--quiet")
    for name in TABLES:
        mine, expected = (slurm.folder / folder / name for folder in ("study", "undisturbed"))
        assert mine.read_bytes() == expected.read_bytes(), name


def process_of(*words: str) -> list[int]:
    """The processes whose command line ends in these words."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line = path.read_bytes().split(b"\0")[:-1]
        except OSError:
            continue
        if line[-len(words) :] == [word.encode() for word in words]:
            found.append(int(path.parent.name))
    return found


def test_an_array_with_tasks_that_are_killed_and_cancelled(slurm: Slurm) -> None:
    """One task gets a SIGKILL, one is cancelled; the job that depends on all gathers the others. Then once more."""
    write(slurm.folder, 6.0)
    tasks = int(slurm.call("tether", "study", "count", "study.toml"))
    array = (f"--array=0-{tasks - 1}", SCRIPTS / "array.sh", "study.toml")
    first = slurm.submit(*array)
    collect = ("--wrap", "tether study collect study", "--output=collect.log")
    slurm.submit(f"--dependency=afterany:{first}", *collect)
    slurm.wait_for(lambda: len(slurm.begun()) == 2)
    (killed,) = process_of("run-point", "study.toml", "0", "--threads", "1")
    os.kill(killed, signal.SIGKILL)
    slurm.call("scancel", f"{first}_1")
    slurm.wait()
    assert slurm.state(f"{first}_0")["JobState"] == "FAILED"
    assert slurm.state(f"{first}_1")["JobState"] == "CANCELLED"
    assert "stopped; the same command goes on with it" in (slurm.folder / f"tether-{first}_1.log").read_text()
    table = (slurm.folder / "study" / "results.csv").read_text()
    assert len(table.splitlines()) - 1 == tasks - 2
    second = slurm.submit(*array)
    slurm.submit(f"--dependency=afterany:{second}", *collect)
    slurm.wait()
    assert_same_as_undisturbed(slurm)


def test_an_array_whose_time_is_too_short(slurm: Slurm) -> None:
    """A run longer than the time limit is queued again, it alone, and ends. What depends on it waits until then.

    SLURM gives the signal up to a minute early: 15 to 45 seconds after a task began. The number of the last task is
    that of the whole array, so of all tasks this one might take the others along.
    """
    write(slurm.folder, 75.0, SHORT_AND_LONG)
    limit = ("--time=2", "--signal=B:USR1@45", "--array=0-1")
    array = slurm.submit(*limit, SCRIPTS / "array.sh", "study.toml")
    assert slurm.state(f"{array}_1")["JobId"] == array
    slurm.submit(f"--dependency=afterany:{array}", "--wrap", "tether study collect study", "--output=collect.log")
    slurm.wait(again_at_once=True)
    short, long = (slurm.state(f"{array}_{number}") for number in (0, 1))
    assert short["JobState"] == long["JobState"] == "COMPLETED"
    assert short["Restarts"] == "0"
    assert int(long["Restarts"]) >= 1
    assert_same_as_undisturbed(slurm)


def test_an_mpi_job_with_a_process_that_is_killed(slurm: Slurm) -> None:
    """It takes the job along, and the same job again goes on."""
    pytest.importorskip("mpi4py")
    write(slurm.folder, 6.0)
    job = slurm.submit("--ntasks=2", SCRIPTS / "mpi.sh", "study.toml")
    slurm.wait_for(lambda: bool(slurm.begun()))
    os.kill(process_of("-m", "tether", "study", "study.toml", "--threads", "1")[-1], signal.SIGKILL)
    slurm.wait_for(lambda: slurm.state(job)["JobState"] == "FAILED", 60.0)
    slurm.submit("--ntasks=2", SCRIPTS / "mpi.sh", "study.toml")
    slurm.wait()
    assert_same_as_undisturbed(slurm)


def test_an_mpi_job_whose_time_is_over_goes_on(slurm: Slurm) -> None:
    """The signal of the time limit, given early: checkpoints are written, and the job ends what is left."""
    pytest.importorskip("mpi4py")
    write(slurm.folder, 10.0)
    job = slurm.submit("--ntasks=2", SCRIPTS / "mpi.sh", "study.toml")
    slurm.wait_for(lambda: bool(slurm.begun()))
    slurm.call("scancel", "--batch", "--signal=USR1", job)
    slurm.wait(again_at_once=True)
    assert slurm.state(job)["Restarts"] == "1"
    assert "stopped; the same command goes on with it" in (slurm.folder / f"tether-{job}.log").read_text()
    assert_same_as_undisturbed(slurm)


def test_jobs_of_dask_that_are_cancelled_are_replaced(slurm: Slurm) -> None:
    """dask-jobqueue submits others, which go on with the runs."""
    pytest.importorskip("dask_jobqueue")
    write(slurm.folder, 6.0)
    command = ["python", SCRIPTS / "on_dask.py", "study.toml", "--jobs", "2", "--hours", "1"]
    paths = f"{PROGRAMS}{os.pathsep}{os.environ['PATH']}"
    script = subprocess.Popen(
        command, cwd=slurm.folder, env=os.environ | {"SLURM_CONF": slurm.configuration, "PATH": paths}
    )
    slurm.wait_for(lambda: bool(slurm.begun()))
    first = slurm.call("squeue", "--noheader", "--states=RUNNING", "--format=%i").split()[0]
    slurm.call("scancel", first)
    assert script.wait(600.0) == 0
    slurm.wait()
    assert_same_as_undisturbed(slurm)
