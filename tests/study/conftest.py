"""Studies that have ended, to look at and to compare with; not to be changed."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_studies import LONG, STUDY, InThisThread, study

from tether.study import run_study


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of STUDY, study, with study.toml and couette.toml beside it."""
    folder = tmp_path_factory.mktemp("finished")
    run_study(study(folder, STUDY), folder / "study", InThisThread())
    return folder / "study"


@pytest.fixture(scope="session")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of LONG, done in one go in one process."""
    folder = tmp_path_factory.mktemp("uninterrupted")
    run_study(study(folder, LONG), folder / "study", InThisThread())
    return folder / "study"
