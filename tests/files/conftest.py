"""Finished runs in two and in three dimensions, to be read with the tools of the trade."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

import tether as tt


@dataclass(frozen=True)
class Finished:
    """A run's folder, and the simulation as it stood at the end."""

    folder: Path
    simulation: tt.Simulation
    result: tt.Result


@pytest.fixture(scope="session", params=[2, 3], ids=["2D", "3D"])
def sheared(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Finished:
    """A sheared suspension, stopped where the box's offset is neither 0 nor half of the box."""
    folder = tmp_path_factory.mktemp("sheared") / "out"
    simulation = tt.Simulation(
        box=tt.Box(6, 5) if request.param == 2 else tt.Box(6, 5, 4),
        fluid=tt.Fluid(temperature=1.0),
        bodies=[
            tt.Bodies(tt.square(0.25) if request.param == 2 else tt.cube(0.25), count=4),
            tt.Bodies(tt.triangle(0.3) if request.param == 2 else tt.octahedron(0.3), count=3, mass=2.0),
        ],
        flow=tt.Couette(shear_rate=1.0),
        timestep=0.005,
        seed=3,
        output=tt.Output(fields=("velocity", "mass", "body"), frames=10, series=5),
        threads=1,
    )
    result = simulation.run(equilibration=20, steps=80, out=folder)
    return Finished(folder, simulation, result)
