"""A finished run to look at, to spoil, and to go on from."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from small_runs import tether, write_couette


@pytest.fixture(scope="session")
def run_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with couette.toml and its finished run, out, not to be changed."""
    folder = tmp_path_factory.mktemp("once")
    outcome = tether("run", write_couette(folder), "--out", folder / "out", "--quiet")
    assert outcome.code == 0, outcome
    return folder


@pytest.fixture
def finished(run_once: Path, tmp_path: Path) -> Path:
    """A copy of the finished run's folder; couette.toml stands beside it."""
    shutil.copy(run_once / "couette.toml", tmp_path / "couette.toml")
    return Path(shutil.copytree(run_once / "out", tmp_path / "out"))
