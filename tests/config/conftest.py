"""A folder with a good couette.toml in it, to be spoiled."""

from __future__ import annotations

from pathlib import Path

import pytest

COUETTE = """\
seed = 1

[box]
size = [10.0, 10.0, 10.0]

[fluid]
density = 4.0
repulsion = 18.75
noise = 3.0
temperature = 1.0
exponent = 0.5
cutoff = 1.0

[[bodies]]
shape = "cube"
spacing = 0.25
count = 125
base = "massless"
stiffness = 3000.0

[flow]
kind = "couette"
shear_rate = 0.2

[run]
timestep = 0.005
equilibration = 4000
steps = 20000

[output]
checkpoint = { seconds = 60 }
"""


@pytest.fixture
def couette() -> str:
    """The text of the file."""
    return COUETTE


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with the file couette.toml."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "couette.toml").write_text(COUETTE)
    return tmp_path
