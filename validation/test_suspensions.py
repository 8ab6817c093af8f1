"""Viscosities, pressures and temperatures against independent values.

The independent values were measured with a separate double-precision program (plain cell lists, the same integrator,
errors from 20 blocks) unless another source is named. Agreement is judged by 2.5 combined standard errors, which a
correct program misses in 1.2 % of comparisons; there are some twenty here, so about one run in five of the whole table
has a miss somewhere. The seeds are fixed: what is committed passed with them and was not chosen for passing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pytest

import tether as tt
from tether import _core

_SIGMAS = 2.5
Precision = Literal["mixed", "double"]
BOTH = pytest.mark.parametrize("precision", ["mixed", "double"])
_FLUID = tt.Fluid(temperature=1.0)


@dataclass(frozen=True)
class Known:
    """An independent value with its error, and how small ours has to be (relative)."""

    value: float
    error: float
    smallest: float

    def agrees(self, found: tt.Estimate) -> bool:
        return abs(found.value - self.value) <= _SIGMAS * math.hypot(found.error, self.error)


@dataclass(frozen=True)
class Case:
    name: str
    box: tt.Box
    timestep: float
    rate: float
    steps: int
    viscosity: Known
    equilibration: int = 2000
    pressure: Known | None = None
    pairwise: float | None = None
    bodies: tuple[tt.Bodies, ...] = ()
    fluid: tt.Fluid = _FLUID

    def run(self, base: str = "massless", seed: int = 11, precision: Precision = "mixed") -> tt.Result:
        bodies = [b.changed(base=base) for b in self.bodies]
        simulation = tt.Simulation(
            box=self.box, fluid=self.fluid, bodies=bodies, flow=tt.Couette(shear_rate=self.rate),
            timestep=self.timestep, seed=seed, precision=precision,
        )  # fmt: skip
        return simulation.run(equilibration=self.equilibration, steps=self.steps)


_SQUARE, _CUBE = tt.Box(10, 10), tt.Box(10, 10, 10)

PLAIN = [
    Case("plain_3d", _CUBE, 0.005, 0.2, 36_000, Known(2.503, 0.023, 0.015), pressure=Known(32.68, 0.01, 0.002)),
    Case("plain_2d", _SQUARE, 0.01, 0.2, 400_000, Known(3.090, 0.023, 0.015), pressure=Known(40.52, 0.01, 0.002)),
]  # fmt: skip

# Bindgen et al., Phys. Fluids 33 (2021), doi 10.1063/5.0055396: kinetic + conservative 0.7410(19), dissipative
# 0.134(5), at this rate; p without an error.
BINDGEN = Case(
    "bindgen", tt.Box(12, 12, 12), 0.005, 0.0669, 450_000, Known(0.875, 0.0054, 0.012),
    pressure=Known(23.66, 0.005, 0.005),
    fluid=tt.Fluid(density=3.0, repulsion=25.0, friction=4.5, temperature=1.0, exponent=2.0),
)  # fmt: skip

SUSPENSIONS = [
    Case(
        "squares_25", _SQUARE, 0.01, 0.2, 100_000, Known(5.17, 0.03, 0.01), pairwise=4.96,
        bodies=(tt.Bodies("square", count=25),),
    ),
    Case(
        "squares_100", _SQUARE, 0.01, 0.2, 60_000, Known(14.84, 0.05, 0.01), pairwise=13.18,
        bodies=(tt.Bodies("square", count=100),),
    ),
    Case("cubes_250", _CUBE, 0.005, 0.2, 14_000, Known(6.64, 0.04, 0.01), pairwise=5.98,
         bodies=(tt.Bodies("cube", count=250),)),
]  # fmt: skip


@BOTH
@pytest.mark.parametrize("case", PLAIN, ids=lambda case: case.name)
def test_plain_fluid(case: Case, precision: Precision, record: Callable[..., None]) -> None:
    """Viscosity and pressure agree, and the kinetic temperature is within 0.3 % of kT."""
    result = case.run(precision=precision)
    record(f"{case.name}_{precision}", **_found(result))
    assert result.viscosity is not None
    assert case.pressure is not None
    assert result.viscosity.relative_error < case.viscosity.smallest
    assert case.viscosity.agrees(result.viscosity)
    assert abs(result.pressure.value / case.pressure.value - 1) < case.pressure.smallest
    temperature = result.temperature["all"]
    assert temperature is not None
    assert abs(temperature.value - 1) < 0.003


def test_bindgen_terms(record: Callable[..., None]) -> None:
    """At rate 0.3, where errors are smaller: the sum within 3 %, the dissipative part as published."""
    result = replace(BINDGEN, rate=0.3, steps=120_000).run(seed=13)
    terms = {
        name: tt.estimate(result.series[f"stress_{name}"].values[:, 0, 1] / 0.3)
        for name in ("kinetic", "conservative", "dissipative")
    }
    record("bindgen_rate_0.3", **_found(result), terms={name: str(term) for name, term in terms.items()})
    assert result.viscosity is not None
    assert abs(result.viscosity.value / BINDGEN.viscosity.value - 1) < 0.03
    assert Known(0.134, 0.005, 0.01).agrees(terms["dissipative"])


def test_bindgen(record: Callable[..., None]) -> None:
    """The pressure is within 0.5 % of the published one; the viscosity is not the published one: docs/findings.md.

    The mean of two runs is 3.8 % below it, 3.9 combined standard errors. What is tested is that it is what we find at
    rate 0.3, too (2.5 errors).
    """
    found = []
    for seed in (11, 12):
        result = BINDGEN.run(seed=seed)
        record(f"bindgen_seed_{seed}", **_found(result))
        assert result.viscosity is not None
        assert result.viscosity.relative_error < BINDGEN.viscosity.smallest
        assert BINDGEN.pressure is not None
        assert abs(result.pressure.value / BINDGEN.pressure.value - 1) < BINDGEN.pressure.smallest
        found.append(result.viscosity.value)
    assert result.viscosity is not None
    mean = Known(sum(found) / 2, result.viscosity.error / math.sqrt(2), 1.0)
    assert mean.agrees(tt.Estimate(0.850, 0.004, 0, 1.0, converged=True))


@BOTH
@pytest.mark.parametrize("case", SUSPENSIONS, ids=lambda case: case.name)
def test_suspension(case: Case, precision: Precision, record: Callable[..., None]) -> None:
    """Total and pairwise viscosity agree, errors are under 1 %, and all five temperatures are within 1.5 % of kT.

    As everywhere in this file a comparison allows 2.5 errors of what was measured. For the translation of cubes it
    matters: see test_translation_under_shear.
    """
    result = case.run(precision=precision)
    record(f"{case.name}_{precision}", **_found(result))
    assert result.viscosity is not None
    assert result.viscosity_pairwise is not None
    assert result.viscosity.relative_error < case.viscosity.smallest
    assert case.viscosity.agrees(result.viscosity)
    assert case.pairwise is not None
    assert Known(case.pairwise, case.viscosity.error, 0.01).agrees(result.viscosity_pairwise)
    for name, temperature in result.temperature.items():
        assert temperature is not None, name
        assert abs(temperature.value - 1) < 0.015 + _SIGMAS * temperature.error, name
    assert result.viscosity_random is not None
    assert abs(result.viscosity_random.value) < 4 * result.viscosity_random.error


@pytest.mark.parametrize("rate", [0.0, 0.2, 0.4, 0.8])
def test_translation_under_shear(rate: float, record: Callable[..., None]) -> None:
    """At rest every temperature is kT within 1 %; under shear the bodies' translation is more than heat.

    Bodies that meet in shear are thrown off their streamlines, and these velocities count in the mean square about
    the imposed profile. They grow with the rate; the rest of the system stays at kT. docs/findings.md has the table.
    """
    flow = tt.Couette(shear_rate=rate) if rate else tt.Rest()
    simulation = tt.Simulation(
        box=_CUBE, fluid=_FLUID, bodies=[tt.Bodies("cube", count=250)], flow=flow, timestep=0.005, seed=12
    )
    result = simulation.run(equilibration=2000, steps=10_000)
    record(f"cubes_250_rate_{rate:g}", **_found(result))
    temperature = {name: e for name, e in result.temperature.items() if e is not None}
    for name, e in temperature.items():
        heated = name == "body_translation" and rate > 0
        allowed = 0.01 + 0.2 * rate**2 + _SIGMAS * e.error  # viscous heat, which the thermostat takes out, is rate^2
        assert heated or abs(e.value - 1) < allowed, name
    if rate >= 0.4:
        translation = temperature["body_translation"]
        assert translation.value - 1 > 4 * translation.error


@pytest.mark.parametrize("case", SUSPENSIONS, ids=lambda case: case.name)
def test_newton_euler_base(case: Case, record: Callable[..., None]) -> None:
    """The paper's way of moving the base heats the constituents, and nothing else: docs/findings.md."""
    result = case.run("newton-euler")
    record(f"{case.name}_newton-euler", **_found(result))
    temperature = {name: e for name, e in result.temperature.items() if e is not None}
    assert temperature["constituents"].value > 1.5
    assert abs(temperature["solvent"].value - 1) < 0.02
    assert abs(temperature["body_translation"].value - 1) < 0.05


@pytest.mark.parametrize("case", SUSPENSIONS, ids=lambda case: case.name)
def test_lagged_newton_euler_base(case: Case, record: Callable[..., None]) -> None:
    """Forces from the previous step are no cure: bodies heat in translation too, until a particle runs away or not."""
    try:
        result = case.run("newton-euler-lagged")
    except tt.RunError as error:
        record(f"{case.name}_newton-euler-lagged", failed=str(error))
        return
    record(f"{case.name}_newton-euler-lagged", **_found(result))
    temperature = {name: e for name, e in result.temperature.items() if e is not None}
    assert temperature["constituents"].value > 1.5
    assert temperature["body_translation"].value > 1.5


def test_drift(record: Callable[..., None]) -> None:
    """Momentum, and energy without a thermostat, over 10^5 steps: mixed precision drifts no more than double.

    The scheme's own energy error at this time step hides what rounding adds, so the two agree within the scatter of
    the energy at an instant, and the momentum of both stays at rounding.
    """
    found: dict[str, dict[str, float]] = {}
    for precision in ("mixed", "double"):
        sim = tt.Simulation(
            box=tt.Box(5, 5, 5),
            fluid=tt.Fluid(temperature=0.25, noise=0.0),
            timestep=0.002,
            seed=5,
            precision=precision,
        )
        sim.place()
        kinetic, potential = [], []
        for _ in range(100):
            sim.engine.run(1000)
            separation = _core.neighbor_pairs(sim.positions, [5.0] * 3)[1]
            potential.append(0.5 * 18.75 * float(((1.0 - (separation**2).sum(axis=1) ** 0.5) ** 2).sum()))
            kinetic.append(0.5 * float((sim.velocities**2).sum()))
        energy = np.add(kinetic, potential) / len(sim.species)
        slope = float(np.polyfit(np.arange(100) / 100, energy, 1)[0])
        momentum = float(np.abs(sim.velocities.sum(axis=0)).max()) / len(sim.species)
        scatter = float(energy.std())
        found[precision] = {"energy": float(energy[0]), "drift": slope, "scatter": scatter, "momentum": momentum}
    record("drift", particles=len(sim.species), steps=100_000, per_particle=found)
    for precision, of in found.items():
        assert of["momentum"] < 1e-13, precision
        assert abs(of["drift"]) < 1e-3 * of["energy"], precision


def _found(result: tt.Result) -> dict[str, object]:
    summary = result.as_dict()
    summary["performance"]["particle_steps_per_second"] = round(summary["performance"]["particle_steps_per_second"])
    return {"configuration": result.configuration.to_toml(), "summary": summary}
