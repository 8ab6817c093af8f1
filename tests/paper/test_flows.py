"""Figures 16 to 18 and section 4.9: their verdicts on made-up runs that obey what the paper says, and that do not."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from tether.paper import Exhibit, Findings, Verdict
from tether.paper.channel import Channel, half_channels, mean_for_verdict, mean_of_rows
from tether.theory.migration import MigrationProfile

PAPER = Path(__file__).parents[2] / "paper"
RNG = np.random.default_rng(1723)
BINS, HEIGHT, DENSITY = 40, 20.0, 7.456
HALF = HEIGHT / 4


def module(name: str) -> ModuleType:
    return Exhibit(PAPER / name).module


@dataclass(frozen=True)
class MadeUpRecord:
    profiles: xr.Dataset | None = None
    stress: xr.Dataset | None = None
    planes: xr.Dataset | None = None
    told: dict[str, Any] = field(default_factory=dict)

    def datasets(self) -> dict[str, xr.Dataset | None]:
        return {"profiles": self.profiles, "stress_profile": self.planes}

    def series(self) -> xr.Dataset | None:
        return self.stress

    def summary(self) -> dict[str, Any]:
        return self.told


@dataclass(frozen=True)
class MadeUpPart:
    """What exhibits read of a part."""

    records: Sequence[tuple[dict[str, Any], MadeUpRecord]] = ()
    means: pd.DataFrame = field(default_factory=lambda: pd.DataFrame({"volume_fraction": [0.4635]}))
    core_hours: float = 0.1

    @property
    def results(self) -> SimpleNamespace:
        return SimpleNamespace(means=self.means)


def verdicts(findings: Findings, beginning: str) -> list[Verdict]:
    found = [claim.verdict for claim in findings.claims if claim.text.startswith(beginning)]
    assert found, beginning
    return found


# --- channels ---


def profiles(
    force: float, velocity: Callable[[float], float], fraction: Callable[[float], float], noise: float = 1e-3
) -> xr.Dataset:
    """A run's profiles, from functions of the distance from the centerline, whose velocity is for the upper channel."""
    y = (np.arange(BINS) + 0.5) * HEIGHT / BINS
    xi = np.abs(np.where(y > HEIGHT / 2, y - 0.75 * HEIGHT, y - 0.25 * HEIGHT))
    sign = np.where(y > HEIGHT / 2, 1.0, -1.0)

    def noisy(values: Sequence[float]) -> tuple[str, np.ndarray]:
        return "y", np.asarray(values) + noise * RNG.standard_normal(BINS)

    def mean_over_bin(function: Callable[[float], float], middle: float) -> float:
        width = HEIGHT / BINS
        return float(np.mean([function(abs(middle + (part - 2) * width / 5)) for part in range(5)]))

    return xr.Dataset(
        {
            "particle_fraction": noisy([mean_over_bin(fraction, each) for each in xi]),
            "density": noisy(np.full(BINS, DENSITY)),
            "driving_force_density": ("y", sign * DENSITY * force),
            "velocity": noisy(sign * [mean_over_bin(velocity, each) for each in xi]),
            "temperature": noisy(np.ones(BINS)),
        },
        coords={"y": y},
    )


def poiseuille(maximum: float, power: float = 2.0) -> Callable[[float], float]:
    """A parabola for the power 2, blunter for more."""
    return lambda xi: maximum * (1.0 - (xi / HALF) ** power)


def channel_part(by_force: dict[float, xr.Dataset]) -> MadeUpPart:
    return MadeUpPart([({"flow.force": force, "repeat": 0}, MadeUpRecord(run)) for force, run in by_force.items()])


def test_half_channels_begin_at_the_centerline_and_end_at_the_wall() -> None:
    y = (np.arange(16) + 0.5) / 16 * 20.0
    xi = np.abs(np.where(y > 10.0, y - 15.0, y - 5.0))
    assert np.allclose(half_channels(xi), [0.625, 1.875, 3.125, 4.375])
    sign = np.where(y > 10.0, 1.0, -1.0)
    assert np.allclose(half_channels(sign * xi, turns=True), half_channels(xi))
    with pytest.raises(ValueError, match="multiple of four"):
        half_channels(np.zeros(10))


def test_a_parabola_has_its_viscosity_and_its_maximum() -> None:
    eta, force = 9.3, 0.4
    flow = poiseuille(DENSITY * force * HALF**2 / (2 * eta))
    channel = Channel.of([profiles(force, flow, lambda _: 0.4, noise=0.0)])
    assert channel.half_width == pytest.approx(HALF)
    # Means over a bin by five points are a little off in what xi^2 adds to every bin alike, not in the differences,
    # but in the bin of the centerline, whose points lie on both sides.
    assert np.allclose(channel.viscosity[:, 1:], eta, rtol=1e-9)
    assert np.allclose(channel.maximum_velocity, flow(0.0), rtol=1e-3)
    assert channel.shear_rate.shape == channel.fraction_at_edges.shape == (4, 9)


def test_the_mean_over_half_channels_has_the_error_of_their_scatter() -> None:
    mean = mean_of_rows([1.0, 2.0, 3.0, 4.0])
    # sd/sqrt(4) = 0.645, times Student's 1.197 for three degrees of freedom at one sigma.
    assert mean.value == 2.5
    assert mean.error == pytest.approx(0.6455 * 1.197, rel=1e-3)
    assert not mean_of_rows([1.0, 2.0]).converged


def test_verdicts_on_four_half_channels_go_wrong_as_rarely_as_they_say() -> None:
    """2.576 errors miss in 1 of 100 of 4000 cases: 40 +- 6.3; more than 65 has a false alarm of 1e-4."""
    cases = np.random.default_rng(5).standard_normal((4000, 4))
    beyond = {
        mean: sum(abs(e.value) > 2.576 * e.error for e in map(mean, cases)) for mean in (mean_for_verdict, mean_of_rows)
    }
    assert beyond[mean_for_verdict] < 65
    assert beyond[mean_of_rows] > 150  # the control: errors of 68 % have Student's tails


# --- figure 17 ---


def suspension(force: float, ratio: float, mean: float = 0.43) -> xr.Dataset:
    """A steady state of eq. 51, with the velocity that it has."""
    model = MigrationProfile.of_mean(mean, flux_ratio=ratio, half_width=HALF)
    grid = np.linspace(0.0, HALF, 81)
    speed = np.asarray(model.velocity(grid, force_density=DENSITY * force, solvent_viscosity=2.51))
    phi = np.asarray(model.volume_fraction(grid))
    return profiles(
        force, lambda xi: float(np.interp(xi, grid, speed)), lambda xi: float(np.interp(xi, grid, phi)), noise=2e-4
    )


@pytest.mark.parametrize("ratio", [1.52, 2.5])
def test_the_flux_ratio_is_found(ratio: float) -> None:
    fig17 = module("fig17")
    channel = Channel.of([suspension(1.0, ratio)])
    found = mean_of_rows(fig17._flux_ratios(channel))
    assert abs(found.value - ratio) < 0.05 * ratio + 3 * found.error
    local = fig17.local_model(channel, ratio).mean(axis=0)[2:]
    assert np.allclose(local, channel.fraction_at_edges.mean(axis=0)[2:], atol=0.02)


def migration(late: dict[float, xr.Dataset]) -> Findings:
    part = channel_part(late)
    findings: Findings = module("fig17").evaluate({"late": part, "early": part})
    assert len(module("fig17").panels(findings)) == 2
    return findings


def test_migration_is_seen_and_its_absence_too() -> None:
    def bump(center: float, wall: float) -> Callable[[float], float]:
        return lambda xi: center + (wall - center) * xi / HALF

    seen = migration(
        {0.4: profiles(0.4, poiseuille(3.94), bump(0.62, 0.28)), 1.0: profiles(1.0, poiseuille(11.3), bump(0.66, 0.32))}
    )
    assert verdicts(seen, "Bodies migrate") == [Verdict.HOLDS]
    assert verdicts(seen, "Local concentrations") == [Verdict.HOLDS]
    assert verdicts(seen, "The concentration") == [Verdict.HOLDS] * 3
    away = migration(
        {0.4: profiles(0.4, poiseuille(3.94), bump(0.42, 0.44)), 1.0: profiles(1.0, poiseuille(11.3), bump(0.40, 0.46))}
    )
    assert verdicts(away, "Bodies migrate") == [Verdict.FAILS]
    assert verdicts(away, "Local concentrations") == [Verdict.FAILS]
    assert verdicts(away, "The concentration") == [Verdict.FAILS] * 3


def test_equation_51_is_judged_by_its_ratio_and_its_profile() -> None:
    obeys = migration({force: suspension(force, 3.77) for force in (0.4, 1.0)})
    assert verdicts(obeys, "Eq. 51 with the measured viscosity") == [Verdict.HOLDS]
    assert verdicts(obeys, "The mean of that model") != [Verdict.FAILS]
    other = migration({force: suspension(force, 1.52) for force in (0.4, 1.0)})
    assert verdicts(other, "Eq. 51 describes the flow") == [Verdict.FAILS]
    assert verdicts(other, "Eq. 51 with the measured viscosity") == [Verdict.FAILS]
    assert verdicts(other, "The migration agrees") == [Verdict.HOLDS]
    flat = migration({force: profiles(force, poiseuille(4.0), lambda _: 0.43) for force in (0.4, 1.0)})
    assert verdicts(flat, "The migration agrees") == [Verdict.FAILS]


def test_what_still_moves_is_not_settled() -> None:
    fig17 = module("fig17")
    late, early = (mean_of_rows(center + np.array([-0.01, 0.0, 0.0, 0.01])) for center in (0.6, 0.5))
    assert fig17.settled(late, early).error == pytest.approx(math.hypot(late.error, 0.1))
    assert math.isnan(fig17.settled(late, mean_of_rows([math.nan])).error)


def test_the_printed_means_are_computed() -> None:
    findings = migration({force: suspension(force, 1.52) for force in (0.4, 1.0)})
    assert verdicts(findings, "The suspension has") == [Verdict.FAILS]
    assert verdicts(findings, "Eq. 51 with a wall") == [Verdict.FAILS] * 2


# --- figure 18 ---


def velocity(power: float, maxima: tuple[float, float]) -> Findings:
    warm, cold = (
        channel_part(
            {
                force: profiles(force, poiseuille(scale * maximum, power), lambda _: 0.46)
                for force, maximum in zip((0.4, 1.0), maxima, strict=True)
            }
        )
        for scale in (1.0, 0.5)
    )
    findings: Findings = module("fig18").evaluate({"warm": warm, "cold": cold})
    assert len(module("fig18").panels(findings)) == 2
    return findings


def test_a_blunt_profile_is_told_from_a_pointed_one() -> None:
    blunt, pointed = velocity(2.6, (3.94, 11.32)), velocity(1.6, (3.0, 9.0))
    for text in ("The velocity profile", "It steepens"):
        assert verdicts(blunt, text) == [Verdict.HOLDS]
        assert verdicts(pointed, text) == [Verdict.FAILS]
    assert verdicts(blunt, "The largest velocity") == [Verdict.REMARK] * 2
    assert verdicts(pointed, "The largest velocity") == [Verdict.FAILS] * 2


def test_a_parabola_is_not_called_blunt() -> None:
    findings = velocity(2.0, (3.94, 11.32))
    assert verdicts(findings, "The velocity profile") != [Verdict.HOLDS]
    assert verdicts(findings, "It steepens") != [Verdict.HOLDS]


# --- figure 16 ---


def sheared(rate: float, *, planes_off: float = 0.0, pressure: float = 90.0) -> tuple[dict[str, Any], MadeUpRecord]:
    """A run whose stress is known: S_xy = 10 rate pairwise, 11 rate in total, N1 = -rate."""
    samples = 2000
    mean = np.diag([-pressure - rate, -pressure, -pressure])
    mean[0, 1] = mean[1, 0] = 10.0 * rate
    held = np.zeros((3, 3))
    held[0, 1] = held[1, 0] = rate
    names = ("kinetic", "conservative", "dissipative", "body")
    stress = {
        f"stress_{name}": (
            ("time", "row", "column"),
            (mean if name == "conservative" else held if name == "body" else 0.0 * mean)
            + 0.05 * rate * RNG.standard_normal((samples, 3, 3)),
        )
        for name in names
    }
    planes = {}
    for kind in ("pairwise", "total"):
        for plane, row in (("y", 1), ("x", 0)):
            key = f"stress_{kind}_plane_{plane}"
            planes[key] = ((f"plane_{plane}", "force"), np.tile(mean[row], (5, 1)))
            planes[f"{key}_error"] = ((f"plane_{plane}", "force"), np.full((5, 3), 0.01 * rate))
    entry = {"error": 0.01}
    told = {
        "shear_rate": rate, "steps": 1000, "dimensionless": {"peclet": 30.0 * rate},
        "viscosity_planes_pairwise": {"value": 10.0 * (1 + planes_off), **entry},
        "viscosity_planes": {"value": 11.0 * (1 + planes_off), **entry},
        "N1_planes_pairwise": {"value": -rate * (1 + 20 * planes_off), "error": 0.01 * rate},
        "N1_planes": {"value": -rate * (1 + 20 * planes_off), "error": 0.01 * rate},
    }  # fmt: skip
    coordinates = {"force": list("xyz")}
    return {"flow.shear_rate": rate, "repeat": 0}, MadeUpRecord(
        stress=xr.Dataset(stress), planes=xr.Dataset(planes, coords=coordinates), told=told
    )


def by_two_routes(**how: float) -> Findings:
    part = MadeUpPart([sheared(rate, **how) for rate in (0.1, 1.0, 10.0)])
    findings: Findings = module("fig16").evaluate({"": part})
    assert len(module("fig16").panels(findings)) == 2
    return findings


def test_routes_that_agree_hold_and_those_that_do_not_fail() -> None:
    agree, apart = by_two_routes(), by_two_routes(planes_off=0.1)
    for text in ("The force on planes", "N1 by planes"):
        assert verdicts(agree, text) == [Verdict.HOLDS] * 2
        assert verdicts(apart, text) == [Verdict.FAILS] * 2


def test_the_pressure_is_what_the_printed_identity_lacks() -> None:
    with_pressure, without = by_two_routes(), by_two_routes(pressure=0.0)
    for text in ("N1 = -F_z/A", "The force along the flow"):
        assert verdicts(with_pressure, text) == [Verdict.FAILS]
    # Without a pressure both forces are those of N1: -F_z/A = 0 there, and N1 is a tenth of the shear stress.
    assert without.tables["routes"]["traction_y_pairwise"].abs().max() < 1e-9


# --- section 4.9 ---


def temperatures(steps: Sequence[float], of_all: Sequence[float], **swept: float) -> pd.DataFrame:
    rows = []
    for step, value in zip(steps, of_all, strict=True):
        row = {"run.timestep": step, **swept}
        for name in ("all", "solvent", "constituents"):
            row |= {f"temperature_{name}": value, f"temperature_{name}_error": 0.001}
        rows.append(row)
    return pd.DataFrame(rows)


def time_steps(single: Sequence[float], tethered: Sequence[float]) -> Findings:
    steps = (0.005, 0.01, 0.02)
    of_single = [temperatures(steps, single, **{"interactions.0.steepness": b}) for b in (10.0, 20.0, 30.0)]
    parts = {
        "tethered": MadeUpPart(means=temperatures(steps, tethered)),
        "discs": MadeUpPart(means=temperatures(steps, tethered)),
        "newton-euler": MadeUpPart(means=temperatures((0.005,), (2.5,))),
        "rigid": MadeUpPart(means=temperatures(steps, (1.0, 1.0, 1.0))),
        "single": MadeUpPart(means=pd.concat(of_single)),
    }
    findings: Findings = module("section4.9").evaluate(parts)
    assert len(module("section4.9").panels(findings)) == 2
    return findings


def test_the_longest_time_step_is_found() -> None:
    findings = time_steps(single=(1.0, 1.05, 1.5), tethered=(1.0, 1.001, 1.012))
    longest = findings.tables["longest"].set_index("model")["longest"]
    assert longest["tethered"] == 0.02
    assert longest["single b = 10"] == 0.005
    assert math.isnan(longest["newton-euler"])


def test_time_steps_are_judged_by_model() -> None:
    needs = time_steps(single=(1.04, 1.2, 2.0), tethered=(1.0, 1.0, 1.0))
    assert verdicts(needs, "A time step of 0.01") == [Verdict.HOLDS]
    assert verdicts(needs, "Time steps of 0.001") == [Verdict.HOLDS]
    assert verdicts(needs, "Single particles") == [Verdict.REMARK]
    assert verdicts(needs, "The same with the base") == [Verdict.FAILS]
    does_not = time_steps(single=(1.0, 1.0, 1.0), tethered=(1.05, 1.1, 1.2))
    assert verdicts(does_not, "A time step of 0.01") == [Verdict.FAILS]
    assert verdicts(does_not, "Single particles") == [Verdict.FAILS]
