"""One viscosity by many routes: the stress of the volume, the force through planes, the momentum that a force drives.

Comparisons within a table are judged together: of k none may be further off than a false alarm of 1 % over the table
allows (Bonferroni; errors are combined and taken as normal). Errors are at most 1.5 %.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest
from scipy.stats import f as fisher
from scipy.stats import norm

import tether as tt
from tether.observe.blocks import Means
from tether.observe.profiles import Profiles
from tether.observe.stress_profile import StressProfile

FALSE_ALARM = 0.01
BOX = tt.Box(10, 10)
FLUID = tt.Fluid(temperature=1.0)
MEASURE = tt.Measure(profiles={"bins": 20, "every": 5}, stress_profile={"bins": 20, "every": 5})
Record = Callable[..., None]


def run(flow: object, squares: int, steps: int, seed: int, model: str = "tethered") -> tt.Result:
    bodies = [tt.Bodies("square", count=squares, model=model)] if squares else []
    simulation = tt.Simulation(
        box=BOX, fluid=FLUID, bodies=bodies, flow=flow, timestep=0.01, seed=seed, measure=MEASURE
    )
    return simulation.run(equilibration=10_000, steps=steps)


# The force is such that the shear rate is at most about that of the shear flow.
CASES = {
    0: {"rate": 0.2, "kolmogorov": 0.1, "poiseuille": 0.06, "steps": 600_000},
    25: {"rate": 0.2, "kolmogorov": 0.14, "poiseuille": 0.08, "steps": 600_000},
    64: {"rate": 0.2, "kolmogorov": 0.2, "poiseuille": 0.12, "steps": 600_000},
}


@pytest.mark.parametrize("squares", CASES)
def test_viscosities(squares: int, record: Record) -> None:
    """All routes agree but the pairwise one; and in driven flow S_xy(y) is the integral of the force, bin by bin."""
    case = CASES[squares]
    steps = int(case["steps"])
    sheared = run(tt.Couette(shear_rate=case["rate"]), squares, steps, 31)
    found = {"total": sheared.viscosity, "planes": sheared.derived["viscosity_planes"]}
    profiles = {}
    flows = {
        "kolmogorov": tt.Kolmogorov(force=case["kolmogorov"]),
        "poiseuille": tt.Poiseuille(force=case["poiseuille"]),
    }
    for kind, flow in flows.items():
        driven = run(flow, squares, steps, 32)
        found[kind] = driven.derived["viscosity_momentum_balance"]
        profiles[kind] = {name: force_balance(driven, name) for name in ("total", "pairwise")}
        profiles[kind]["pressure"] = str(driven.pressure)
        profiles[kind]["greatest shear rate"] = greatest_rate(driven)
        profiles[kind]["particle fraction"] = spread(driven)
    pairwise = {
        "pairwise": sheared.viscosity_pairwise,
        "planes, pairwise": sheared.derived["viscosity_planes_pairwise"],
    }
    record(
        f"routes_{squares}_squares",
        viscosity={name: [e.value, e.error] for name, e in {**found, **pairwise}.items() if e is not None},
        N1={"total": str(sheared.N1), "planes": str(sheared.derived["N1_planes"])},
        force_balance=profiles,
        configuration=sheared.configuration.to_toml(),
    )
    pairs = list(combinations(found, 2))
    limit = norm.isf(FALSE_ALARM / (2 * len(pairs) * len(CASES)))
    for first, second in pairs:
        a, b = found[first], found[second]
        assert a is not None
        assert b is not None
        assert abs(a.value - b.value) < limit * math.hypot(a.error, b.error), (first, second)
    for name, e in found.items():
        assert e is not None
        assert e.relative_error < 0.015, name
    for kind in ("kolmogorov", "poiseuille"):
        assert profiles[kind]["total"]["planes p-value"] > FALSE_ALARM / (4 * len(CASES)), kind
        assert profiles[kind]["total"]["bins p-value"] > FALSE_ALARM / (4 * len(CASES)), kind
    if squares == 64:  # the control: without what the bodies bear the balance does not close
        assert min(profiles[kind]["pairwise"]["planes p-value"] for kind in ("kolmogorov", "poiseuille")) < 1e-4


def test_local_stress_at_half(record: Record) -> None:
    """At phi = 0.5 the total stress is the integral of the force, in bins and at planes; the pairwise is not."""
    driven = run(tt.Kolmogorov(force=0.25), 100, 300_000, 33)
    balance = {name: force_balance(driven, name) for name in ("total", "pairwise")}
    viscosity = driven.derived["viscosity_momentum_balance"]
    record(
        "local_stress_100_squares",
        force_balance=balance,
        viscosity=[viscosity.value, viscosity.error],
        greatest_shear_rate=greatest_rate(driven),
        particle_fraction=spread(driven),
    )
    assert balance["total"]["planes p-value"] > FALSE_ALARM / 2
    assert balance["total"]["bins p-value"] > FALSE_ALARM / 2
    assert balance["pairwise"]["planes p-value"] < 1e-4


def force_balance(result: tt.Result, name: str) -> dict[str, float]:
    """S_xy(y) against minus the integral of the force, at planes and in bins: slope, and p-value of Hotelling's T^2.

    The stress is fixed up to a constant: it is taken off by one bin less. The force is as it acted in the same run.
    """
    stress, profiles = result.observers["stress_profile"], result.observers["profiles"]
    assert isinstance(stress, StressProfile)
    assert isinstance(profiles, Profiles)
    width = BOX.size[1] / stress.bins
    force = profiles.rows("driving_force_density").mean(axis=0)
    edges = -width * np.concatenate([[0.0], np.cumsum(force)[:-1]])
    middles = edges - 0.5 * width * force
    found = {}
    for where, measured, expected in (
        ("planes", stress.through_planes("y", name)[:, 0], edges),
        ("bins", stress.in_bins(name)[:, 1, 0], middles),
    ):
        found[f"{where} p-value"] = agreement(measured, expected)
        off = expected - expected.mean()
        found[f"{where} slope"] = float((measured.value @ off) / (off @ off))
    return found


def agreement(measured: Means, expected: np.ndarray) -> float:
    """p-value of Hotelling's T^2 that the means are the expected ones but for a constant, in eight pairs of bins.

    Neighboring bins are put together, so that there are many more blocks than differences to be tested.
    """
    groups = 9
    parts = np.array_split(np.arange(len(expected)), groups)
    average = np.array([[1 / len(p) if k in p else 0.0 for k in range(len(expected))] for p in parts])
    rows = measured.deviation @ average.T
    off = (measured.value - expected) @ average.T
    length = max(1, len(rows) // 64)
    blocks = rows[: len(rows) // length * length].reshape(-1, length, groups).mean(axis=1)
    differences, z = np.diff(blocks, axis=1), np.diff(off)
    n, k = differences.shape
    covariance = np.cov(differences.T) / n
    square = float(z @ np.linalg.solve(covariance, z))
    return float(fisher.sf((n - k) * square / (k * (n - 1)), k, n - k))


def greatest_rate(result: tt.Result) -> float:
    profile = result.observed["profiles"]
    return float(np.abs(np.gradient(profile["velocity"].values, profile["y"].values)).max())


def spread(result: tt.Result) -> list[float] | None:
    """Least and greatest particle fraction over the bins."""
    profile = result.observed["profiles"]
    if "particle_fraction" not in profile:
        return None
    fraction = profile["particle_fraction"].values
    return [float(fraction.min()), float(fraction.max())]
