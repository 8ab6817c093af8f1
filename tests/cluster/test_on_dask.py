"""The script of examples/cluster that has Dask submit jobs: what they ask for, and the study on a cluster here."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest
from small_studies import InThisThread, assert_same_study, study, write_study

from tether.study import run_study

pytest.importorskip("dask_jobqueue")

# Dask leaves sockets and event loops to the garbage collector.
pytestmark = pytest.mark.filterwarnings("ignore:unclosed:ResourceWarning")

STUDY = """\
base = "couette.toml"

[sweep]
flow.shear_rate = [0.5, 1.0, 1.5]
"""


@pytest.fixture(scope="module")
def script() -> ModuleType:
    path = Path(__file__).parents[2] / "examples" / "cluster" / "on_dask.py"
    specification = importlib.util.spec_from_file_location("on_dask", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def test_what_a_job_asks_of_slurm(script: ModuleType) -> None:
    """One task with the threads of a run; the worker leaves well before its time is over."""
    given = script.parser.parse_args(
        ["study.toml", "--threads", "4", "--hours", "1.5", "--memory", "2GB", "--sbatch=--partition=long"]
    )
    with script.slurm(given) as cluster:
        job = cluster.job_script()
    asked = re.findall(r"^#SBATCH (.*)$", job, re.MULTILINE)
    for directive in ("-J tether", "-n 1", "--cpus-per-task=4", "--mem=2G", "-t 1:30:00", "--partition=long"):
        assert directive in asked, job
    for option in ("--nthreads 1", "--lifetime 4860s", "--lifetime-stagger 270s"):
        assert option in job, job


def test_the_study_on_a_cluster_here(script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers are started when there are runs to do, and the results are those of a study without Dask."""
    from distributed import LocalCluster

    run_study(study(tmp_path / "here", STUDY), tmp_path / "here" / "study", InThisThread())
    write_study(tmp_path, STUDY)
    monkeypatch.chdir(tmp_path)
    given = script.parser.parse_args(["study.toml", "--jobs", "2"])
    with LocalCluster(n_workers=0, threads_per_worker=1, dashboard_address=":0") as cluster:
        script.do(given, cluster)
    assert_same_study(tmp_path / "study", tmp_path / "here" / "study")
