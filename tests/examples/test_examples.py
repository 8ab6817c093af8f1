"""Every file of examples/ runs as it stands, only shorter."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest
from small_runs import summary, tether

from tether.config import Measure, load
from tether.flows import Flow

EXAMPLES = Path(__file__).parents[2] / "examples"
CONFIGURATIONS = sorted(EXAMPLES.glob("*.toml"))
STUDIES = sorted(EXAMPLES.glob("studies/*.toml"))
SCRIPTS = {"studies/thinning.py": (["--strain", "0.1"], 3)}
"""What makes each script short, and how many viscosities it prints."""

CLUSTER = sorted(EXAMPLES.glob("cluster/*"))
"""Job scripts, which tests/cluster runs."""


def test_there_are_examples_and_no_others_than_those_run_here() -> None:
    assert CONFIGURATIONS
    assert STUDIES
    scripts = [EXAMPLES / name for name in SCRIPTS]
    known = sorted([*CONFIGURATIONS, *STUDIES, *scripts, *CLUSTER])
    assert sorted(path for path in EXAMPLES.glob("**/*") if path.is_file() and "__pycache__" not in path.parts) == known


def test_examples_show_every_flow_every_model_and_every_measurement() -> None:
    shown = [load(path) for path in CONFIGURATIONS]
    kinds = {kind.model_fields["kind"].default for kind in get_args(get_args(Flow)[0])}
    assert {example.flow.kind for example in shown} == kinds
    assert {bodies.model for example in shown for bodies in example.bodies} == {"tethered", "rigid", "single"}
    for name in Measure.model_fields:
        assert any(getattr(example.measure, name) for example in shown), name


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_runs(name: str, tmp_path: Path) -> None:
    arguments, viscosities = SCRIPTS[name]
    command = [sys.executable, EXAMPLES / name, *arguments]
    answer = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert answer.stdout.count("viscosity ") == viscosities


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_a_study_runs(path: Path, tmp_path: Path) -> None:
    shorter = [f"--set=run.{key}" for key in ("equilibration=0", "steps=20")]
    outcome = tether("study", path, "--out", tmp_path / "out", *shorter, "--workers", 1)
    assert outcome.code == 0, outcome
    assert (tmp_path / "out" / "results.parquet").is_file()


@pytest.mark.parametrize("path", CONFIGURATIONS, ids=lambda path: path.stem)
def test_an_example_runs(path: Path, tmp_path: Path) -> None:
    outcome = tether("run", path, "--out", tmp_path / "out", "--set", "run.equilibration=20", "--set", "run.steps=40")
    assert outcome.code == 0, outcome
    assert f"Results: {tmp_path / 'out'}" in outcome.out
    assert summary(tmp_path / "out")["steps"] == 40
    temperature = load(tmp_path / "out" / "config.toml").fluid.temperature
    assert 0.8 < summary(tmp_path / "out")["temperature"]["all"]["value"] / temperature < 1.2
