"""The plain fluid at rest, oscillating and starting: fluctuations, diffusion and moduli against its shear viscosity.

Comparisons allow 2.5 combined standard errors, unless another bound is named.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import tether as tt
from tether.theory.diffusion import unbounded_diffusivity

SIGMAS = 2.5
FLUID = tt.Fluid(temperature=1.0)
SHEAR_VISCOSITY = {2: (3.105, 0.012), 3: (2.503, 0.023)}
"""Of an independent program."""
Record = Callable[..., None]


@pytest.mark.parametrize("dimension", [2, 3])
def test_green_kubo(dimension: int, record: Record) -> None:
    """The viscosity from the fluctuations of the stress at rest is that of the sheared fluid, to 3 %."""
    box, timestep, steps = (tt.Box(10, 10), 0.01, 1_000_000) if dimension == 2 else (tt.Box(10, 10, 10), 0.005, 240_000)
    measure = tt.Measure(green_kubo=True)
    simulation = tt.Simulation(box=box, fluid=FLUID, timestep=timestep, seed=41, measure=measure)
    result = simulation.run(equilibration=4000, steps=steps)
    found = result.derived["viscosity_green_kubo"]
    value, error = SHEAR_VISCOSITY[dimension]
    record(f"green_kubo_{dimension}d", viscosity=[found.value, found.error], sheared=[value, error], steps=steps)
    assert found.converged
    assert abs(found.value - value) < SIGMAS * math.hypot(found.error, error)
    assert abs(found.value / value - 1) < 0.03


SEGMENTS = 8


def test_diffusion_and_its_finite_size(record: Record) -> None:
    """D in a box of 10 is 0.116; what periodic images take off it, Yeh and Hummer's 2.84 kT/(6 pi eta L), a box of 20
    shows.

    A particle feels its images once momentum has gone around the box, L^2/(4 pi^2 nu): 16 time units in the larger box.
    So D is the slope of the mean-square displacement from twice that to nearly four times, of each of eight segments of
    a run that are measured anew; their scatter is the error.
    """
    found = {}
    for side in (10, 20):
        measure = tt.Measure(displacement={"every": 55, "solvent": 32_000})
        simulation = tt.Simulation(box=tt.Box(side, side, side), fluid=FLUID, timestep=0.005, seed=42, measure=measure)
        simulation.run(equilibration=2000, steps=55)
        slopes = [late_slope(simulation.run(steps=17_600)) for _ in range(SEGMENTS)]
        found[side] = (float(np.mean(slopes)), float(np.std(slopes, ddof=1) / math.sqrt(SEGMENTS)))
    unbounded = {
        side: unbounded_diffusivity(value, temperature=1.0, viscosity=2.503, box_length=float(side))
        for side, (value, _) in found.items()
    }
    record(
        "diffusion_plain",
        diffusion={str(side): list(d) for side, d in found.items()},
        unbounded={str(side): value for side, value in unbounded.items()},
    )
    error = math.hypot(found[10][1], found[20][1])
    assert abs(found[10][0] - 0.116) < 0.002
    assert found[20][0] - found[10][0] > 2 * error
    assert abs(unbounded[20] - unbounded[10]) < SIGMAS * error


def late_slope(result: tt.Result) -> float:
    """D from lags of 34 to 66 time units."""
    curve = result.observed["displacement"]["msd_solvent"]
    lag = curve["lag"].values
    late = (lag > 34) & (lag < 67)
    return float(np.polyfit(lag[late], curve.values[late], 1)[0] / 6)


@pytest.mark.parametrize("dimension", [2, 3])
def test_slow_oscillation(dimension: int, record: Record) -> None:
    """At low frequency G''/omega is the viscosity within 3 %, and G' is nothing."""
    box, timestep, steps = (tt.Box(10, 10), 0.01, 600_000) if dimension == 2 else (tt.Box(10, 10, 10), 0.005, 200_000)
    flow = tt.Oscillatory(strain_amplitude=1.0, angular_frequency=0.3)
    simulation = tt.Simulation(box=box, fluid=FLUID, flow=flow, timestep=timestep, seed=43)
    result = simulation.run(equilibration=4000, steps=steps)
    viscosity, storage = result.derived["dynamic_viscosity"], result.derived["storage_modulus"]
    value, error = SHEAR_VISCOSITY[dimension]
    record(
        f"oscillation_{dimension}d",
        dynamic_viscosity=[viscosity.value, viscosity.error],
        storage_modulus=[storage.value, storage.error],
        sheared=[value, error],
        configuration=result.configuration.to_toml(),
    )
    assert abs(viscosity.value / value - 1) < 0.03
    assert viscosity.relative_error < 0.015
    assert abs(storage.value) < 0.02 * result.derived["loss_modulus"].value + 3 * storage.error


def test_start_up(record: Record) -> None:
    """The stress reaches its steady value within one time unit of the start, and is gone within one of the stop."""
    rate = 0.5
    flow = tt.Stages(stages=[{"shear_rate": rate, "duration": 5.0}, {"shear_rate": 0.0, "duration": 5.0}])
    simulation = tt.Simulation(box=tt.Box(10, 10), fluid=FLUID, flow=flow, timestep=0.01, seed=44)
    result = simulation.run(equilibration=1000, steps=400_000)
    curve = result.datasets["start_up"]
    viscosity, error = curve["stress"].values / rate, curve["stress_error"].values / rate
    time = curve["time"].values
    value, known = SHEAR_VISCOSITY[2]
    record(
        "start_up_2d",
        time=[round(float(t), 3) for t in time],
        viscosity=[round(float(v), 4) for v in viscosity],
        error=[round(float(e), 4) for e in error],
        repeats=int(curve.sizes["repeat"]),
    )
    for begin, end, expected, allowed in ((1.0, 5.0, value, known), (6.0, 10.0, 0.0, 0.0)):
        part = (time > begin) & (time < end)
        mean = viscosity[part].mean()
        scatter = math.sqrt(float((error[part] ** 2).sum())) / part.sum()
        assert abs(mean - expected) < SIGMAS * math.hypot(scatter, allowed) + 0.01 * value
    soon = (time > 0.5) & (time < 1.0)
    assert np.all(np.abs(viscosity[soon] - value) < 4 * error[soon] + 0.03 * value)
