"""Tethered, rigid and single-particle bodies side by side: temperatures, and how long a time step may be."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

import tether as tt

Record = Callable[..., None]
BOX = tt.Box(7, 7, 7)
FLUID = tt.Fluid(temperature=1.0)
OFF = 0.02
TIMESTEPS = (0.0005, 0.001, 0.002, 0.003, 0.005, 0.007, 0.01, 0.014, 0.02, 0.028, 0.04)


def steep(steepness: float) -> list[tt.Interaction]:
    """Forces whose potential is 4.6 kT, where g = 0.01, at 0.6 from the solvent like the paper's cube (Table 1), and
    at 1.1 between two bodies: a_e r_e/b exp(-b r/r_e) = 4.6 kT.
    """
    made = []
    for pair, cutoff, contact in ((["solvent", "colloid"], 1.0, 0.6), (["colloid", "colloid"], 1.6, 1.1)):
        repulsion = 4.6 * steepness / cutoff * math.exp(steepness * contact / cutoff)
        made.append(
            tt.Interaction(between=pair, law="exponential", repulsion=repulsion, steepness=steepness, cutoff=cutoff)
        )
    return made


COLLOIDS = [tt.Bodies(model="single", name="colloid", radius=0.6, count=43)]
MODELS: dict[str, dict[str, Any]] = {
    "tethered": {"bodies": [tt.Bodies("cube", count=43)]},
    "rigid": {"bodies": [tt.Bodies("cube", count=43, model="rigid")]},
    **{f"single_b_{b:g}": {"bodies": COLLOIDS, "interactions": steep(b), "precision": "double"} for b in (10, 20, 30)},
}


def off(model: str, timestep: float) -> float | None:
    """The largest error of a kinetic temperature, per degree of freedom, two standard errors taken off; None when a
    particle runs away. All, solvent, constituents, translation and rotation of bodies count.
    """
    settings = MODELS[model]
    try:
        simulation = tt.Simulation(
            box=BOX, fluid=FLUID, flow=tt.Couette(shear_rate=0.1), timestep=timestep, seed=61, **settings
        )
        result = simulation.run(equilibration=int(4 / timestep), steps=int(120 / timestep))
    except tt.TetherError:
        return None
    temperatures = [t for name, t in result.temperature.items() if t is not None and name != "constituents_raw"]
    return max(abs(t.value - 1) - 2 * (t.error if t.converged else 0.01) for t in temperatures)


@pytest.mark.parametrize("model", MODELS)
def test_longest_timestep(model: str, record: Record) -> None:
    """The longest of TIMESTEPS up to which no kinetic temperature is further than 2 % (and two errors) from kT."""
    found = {}
    longest = 0.0
    for timestep in TIMESTEPS:
        found[str(timestep)] = error = off(model, timestep)
        if error is None or error > OFF:
            break
        longest = timestep
    record(f"timestep_{model}", longest=longest, off=found)
    assert longest >= (0.005 if not model.startswith("single") else 0.0005)


@pytest.mark.parametrize(("shape", "box", "raw"), [("square", tt.Box(10, 10), 3 / 8), ("cube", BOX, 6 / 24)])
def test_rigid_temperatures(shape: str, box: tt.Box, raw: float, record: Record) -> None:
    """1.00 per degree of freedom; the raw count over constituents is 3/8 in 2D and 6/24 in 3D."""
    simulation = tt.Simulation(
        box=box, fluid=FLUID, bodies=[tt.Bodies(shape, count=25, model="rigid")],
        timestep=0.01 if box.dimension == 2 else 0.005, seed=62,
    )  # fmt: skip
    result = simulation.run(equilibration=4000, steps=200_000 if box.dimension == 2 else 30_000)
    record(f"rigid_{shape}", temperature={name: [t.value, t.error] for name, t in result.temperature.items() if t})
    for name, temperature in result.temperature.items():
        assert temperature is not None
        expected = raw if name == "constituents_raw" else 1.0
        assert abs(temperature.value / expected - 1) < 0.01 + 2.5 * temperature.error / expected, name
