"""Figures 1 to 5, 9 and 19, sections 4.3 and 4.4: verdicts on made-up numbers that obey the paper, and that do not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy.special import chdtrc
from small_runs import write_couette

from tether.config import load
from tether.paper import Claim, Exhibit, Findings, Verdict
from tether.paper.springs import springs_at_the_end, springs_of_frames
from tether.paper.uniformity import shared_error, uniformity
from tether.record import Record
from tether.shapes import cube, square, triangle
from tether.simulation import Simulation

PAPER = Path(__file__).parents[2] / "paper"
HOLDS = (Verdict.HOLDS, Verdict.REMARK)


def module(name: str) -> ModuleType:
    """A new copy, so that a test may change what is in it."""
    return Exhibit(PAPER / name).module


@dataclass(frozen=True)
class MadeUpPart:
    """What exhibits read of a part."""

    records: Sequence[tuple[dict[str, Any], Any]] = ()
    means: pd.DataFrame = field(default_factory=pd.DataFrame)
    core_hours: float = 0.1

    @property
    def results(self) -> SimpleNamespace:
        return SimpleNamespace(means=self.means)


def claim(findings: Findings | Sequence[Claim], words: str) -> Claim:
    claims = findings.claims if isinstance(findings, Findings) else findings
    (found,) = [each for each in claims if words in each.text]
    return found


# --- what is computed ---


@pytest.mark.parametrize("name", ["fig01", "fig03", "fig04"])
def test_small_bodies_are_round_and_conical(name: str) -> None:
    assert {each.verdict for each in module(name).evaluate({}).claims} <= set(HOLDS)


def test_wide_bodies_are_not() -> None:
    figure_3, figure_4, figure_1 = module("fig03"), module("fig04"), module("fig01")
    figure_3.SHAPES = figure_4.SHAPES = {"triangle": triangle(0.7), "square": square(0.7)}
    assert claim(figure_3.evaluate({}), "round disc").verdict is Verdict.FAILS
    assert claim(figure_4.evaluate({}), "round disc").verdict is Verdict.FAILS
    figure_1.SHAPES = {"square": square(0.5), "cube": cube(0.5)}
    assert claim(figure_1.evaluate({}), "circular disc").verdict is Verdict.FAILS
    assert claim(figure_1.evaluate({}), "0.25 apart").verdict is Verdict.FAILS


def test_the_pore() -> None:
    figure = module("fig09")
    findings = figure.evaluate({})
    failed = [each.text for each in findings.claims if each.verdict is Verdict.FAILS]
    assert failed == ["Hexagonal packing of equal spheres fills 0.71."]  # it is pi/sqrt(18)
    assert float(findings.tables["discs"]["radius"].iloc[-1]) == pytest.approx(2 / math.sqrt(3) - 1, abs=1e-7)
    figure.CENTERS = 1.1 * figure.CENTERS  # not in contact: a larger disc fits
    assert claim(figure.evaluate({}), "6.46 times").verdict is Verdict.FAILS


def test_the_sign_of_the_gyroscopic_term() -> None:
    figure = module("fig02")
    findings = figure.evaluate({})
    assert claim(findings, "I dw/dt").verdict is Verdict.FAILS
    assert claim(findings, "absent").verdict is Verdict.HOLDS
    turning = findings.tables["free_body"]
    assert figure._gyroscopic(turning.assign(sign=-turning["sign"])).verdict in HOLDS  # were it a minus


# --- figure 5 ---


def correlated(runs: int, sets: int, rng: np.random.Generator, bins: int = 20) -> NDArray[np.float64]:
    """Profiles of a conserved density, (sets, runs, bins): long waves fluctuate more, and the mean does not at all."""
    waves = np.fft.rfft(rng.normal(size=(sets, runs, bins)), axis=-1)
    waves *= 1.0 / (1.0 + np.arange(waves.shape[-1]))
    waves[..., 0] = 0.0
    return np.fft.irfft(waves, n=bins, axis=-1)


def test_uniformity_has_its_false_alarm_rate() -> None:
    """5 % of 2000 sets within 4.5 standard errors, a false alarm of 1e-5; the bins' own chi-square is far off."""
    rng = np.random.default_rng(5)
    p, naive = [], []
    for profiles in correlated(4, 2000, rng):
        found = uniformity(profiles)
        p.append(chdtrc(found.freedom, found.chi_square))
        error = profiles.std(axis=0, ddof=1) / 2.0
        naive.append(chdtrc(20, ((profiles.mean(axis=0) / error) ** 2).sum()))
    expected = 0.05 * 2000
    assert abs(np.sum(np.array(p) < 0.05) - expected) < 4.5 * math.sqrt(expected * 0.95)
    assert np.sum(np.array(naive) < 0.05) > 2 * expected


def test_shared_error() -> None:
    """Of 400 bins of unit variance, nine runs: 1/3 within 4 standard errors of 3200 degrees of freedom."""
    profiles = np.random.default_rng(6).normal(size=(9, 400))
    assert shared_error(profiles) == pytest.approx(1 / 3, rel=4 * math.sqrt(1 / (2 * 3200)))
    assert math.isnan(shared_error(profiles[:1]))
    assert uniformity(profiles[:1]).freedom == 0


@dataclass(frozen=True)
class MadeUpProfiles:
    profiles: xr.Dataset
    bodies: int

    def datasets(self) -> dict[str, xr.Dataset]:
        return {"profiles": self.profiles}

    def configuration(self) -> SimpleNamespace:
        constituents = 4 * self.bodies
        return SimpleNamespace(
            box=SimpleNamespace(size=(10.0, 10.0)), solvent_count=400, constituent_count=constituents,
            particle_fraction=constituents / (400 + constituents),
        )  # fmt: skip


def channel(wave: float = 0.0, heat: float = 0.0, pressure: float = 1.0) -> Findings:
    """Figure 5 of made-up runs: a wave in the solvent, too high a temperature, a pressure over that of the solvent."""
    rng = np.random.default_rng(55)
    y = np.linspace(0.25, 9.75, 20)
    records: list[tuple[dict[str, Any], MadeUpProfiles]] = []
    for bodies in (9, 81):
        noise = {name: correlated(6, 1, rng)[0] for name in ("density_solvent", "density", "temperature", "velocity")}
        for run in range(6):
            values = {
                "density_solvent": 4.0 + 0.1 * noise["density_solvent"][run] + wave * np.sin(2 * np.pi * y / 10),
                "density": 4.0 + 0.04 * bodies + 0.02 * noise["density"][run],
                "temperature": 1.0 + heat + 0.005 * noise["temperature"][run],
                "velocity": 0.01 * noise["velocity"][run],
            }
            profiles = xr.Dataset({name: ("y", value) for name, value in values.items()}, coords={"y": y})
            records.append(({"bodies.0.count": bodies}, MadeUpProfiles(profiles, bodies)))
    columns = ["volume_fraction", "pressure", "pressure_error"]
    suspensions = pd.DataFrame([(0.08, 40.5 * pressure, 0.02), (0.45, 40.5 * pressure, 0.02)], columns=columns)
    plain = pd.DataFrame([(math.nan, 40.5, 0.02)], columns=columns)
    found: Findings = module("fig05").evaluate(
        {"bodies": MadeUpPart(records, suspensions), "plain": MadeUpPart(means=plain)}
    )
    return found


def test_a_uniform_channel() -> None:
    assert {each.verdict for each in channel().claims} <= set(HOLDS)


def test_a_channel_that_is_not() -> None:
    assert claim(channel(wave=0.2), "solvent density is uniform").verdict is Verdict.FAILS
    assert claim(channel(wave=0.8), "about 4").verdict is Verdict.FAILS
    assert claim(channel(heat=0.1), "temperature").verdict is Verdict.FAILS
    assert claim(channel(pressure=2.0), "properties").verdict is Verdict.FAILS


# --- figure 19 ---


def temperatures(model: str, constituents: float, growth: float = 0.0) -> MadeUpPart:
    """All particles and constituents, 1 + growth phi; the raw count is 3/8."""
    rows = []
    for bodies in (4, 100):
        phi = 4 * bodies / (400 + 4 * bodies)
        rows.append(
            {
                "bodies": bodies, "solvent": 400, "volume_fraction": phi,
                "temperature_all": 1.0 + growth * phi, "temperature_all_error": 0.001,
                "temperature_constituents": constituents, "temperature_constituents_error": 0.002,
                "temperature_constituents_raw": 0.375 * constituents, "temperature_constituents_raw_error": 0.001,
            }
        )  # fmt: skip
    return MadeUpPart(means=pd.DataFrame(rows), records=[({}, model)])


def test_temperature_of_each_model() -> None:
    parts = {
        "tethered": temperatures("tethered", 1.0),
        "newton-euler": temperatures("newton-euler", 3.9, growth=2.9),
        "rigid": temperatures("rigid", 1.0),
    }
    findings = module("fig19").evaluate(parts)
    by_words = {each.text: each.verdict for each in findings.claims}
    assert [verdict for text, verdict in by_words.items() if "massless base" in text] == [Verdict.REMARK, Verdict.HOLDS]
    assert claim(findings, "Newton-Euler").verdict is Verdict.FAILS
    assert claim(findings, "degrees of freedom").verdict is Verdict.FAILS  # a frozen disc is not cold
    assert claim(findings, "were free").verdict in HOLDS  # but counted raw it seems so
    table = findings.tables["temperature"]
    raw = table[(table["model"] == "rigid_raw") & (table["bodies"] == 100)]["all"].item()
    assert raw == pytest.approx(100 * ((800 + 300 - 2) / (1600 - 2) - 1))


def test_a_massless_base_that_heats() -> None:
    parts = {
        "tethered": temperatures("tethered", 1.2, growth=0.2),
        "newton-euler": temperatures("newton-euler", 1.0),
        "rigid": temperatures("rigid", 1.0, growth=-0.3),
    }
    findings = module("fig19").evaluate(parts)
    assert [each.verdict for each in findings.claims[:4]] == [
        Verdict.FAILS, Verdict.HOLDS, Verdict.FAILS, Verdict.REMARK,
    ]  # fmt: skip


# --- section 4.3 ---


def test_springs_of_a_run(tmp_path: Path) -> None:
    """Frames in single precision tell the springs of the last state, and their first moment is the body's stress."""
    path = write_couette(
        tmp_path,
        [
            ('kind = "couette"\nshear_rate = 0.5', 'kind = "rest"'),
            ("steps = 200", "steps = 200\n[output]\nframes = 10\nseries = 1"),
        ],
    )
    simulation = Simulation.from_configuration(load(path), threads=1)
    simulation.run(equilibration=40, steps=200, out=tmp_path / "run")
    record = Record.open(tmp_path / "run")
    end, frames = springs_at_the_end(record), springs_of_frames(record)
    assert end.force.shape == (1, 3, 4, 2)
    assert np.abs(end.sum).max() < 1e-9 * 18.75
    assert np.abs(frames.force[-1] - end.force[0]).max() < 1e-3 * end.magnitude.max()
    assert frames.time[-1] == pytest.approx(end.time[0])
    stress = -np.einsum("tbpi,tbpj->ij", end.arm, end.force) / 16.0
    assert stress == pytest.approx(record.series()["stress_body"].to_numpy()[-1], abs=1e-6 * np.abs(stress).max())


def test_springs_against_the_paper() -> None:
    section = module("section4.3")
    sums = pd.DataFrame({"base": ["massless"], "bodies": [1], "largest_sum": [1e-12]})
    assert section._sum_vanishes(sums).verdict is Verdict.REMARK
    assert section._sum_vanishes(sums.assign(largest_sum=1e-3)).verdict is Verdict.FAILS
    rms = pd.DataFrame({"base": ["massless"], "bodies": [1], "rms": [4.0], "error": [0.05], "largest": [12.0]})
    assert section._of_order_10(rms, 0.1).verdict is Verdict.HOLDS
    assert section._of_order_10(rms.assign(rms=1.0), 0.1).verdict is Verdict.FAILS
    means = pd.DataFrame(
        {
            "constituent": [1, 1, 0],
            "component": ["x", "y", "outward of all"],
            "mean": [0.01, -0.02, -1.1],
            "error": 0.02,
        }
    )
    seen = section._zero_mean(means, rms, 0.1)
    assert seen.verdict is Verdict.REMARK
    assert "-1.100" in seen.remark
    assert section._zero_mean(means.assign(mean=[0.01, 0.9, -1.1]), rms, 0.1).verdict is Verdict.FAILS
    stress = pd.DataFrame(
        {"phi": [0.5], "shear_stress": [11.0], "shear_stress_error": [0.2], "pressure": -4.5, "pressure_error": 0.1}
    )
    assert section._adds_nothing(stress, 0.1).verdict is Verdict.FAILS
    assert section._adds_nothing(stress.assign(shear_stress=0.1), 0.1).verdict in HOLDS


# --- section 4.4 ---


def masses(viscosity_of: str) -> Findings:
    """Relative viscosities that follow Einstein's law of a fraction."""
    rows = []
    for mass in (0.5, 1.0, 4.0):
        particle, heavy = 36 / 436, 36 * mass / (36 * mass + 400)
        viscosity = 1.0 + 2.2 * {"particle": particle, "mass": heavy}[viscosity_of]
        row = {
            "bodies.0.count": 9, "bodies.0.mass": mass, "solvent": 400,
            "particle_fraction": particle, "mass_fraction": heavy,
        }  # fmt: skip
        for kind in ("relative_viscosity_pairwise", "relative_viscosity"):
            row |= {kind: viscosity, f"{kind}_error": 0.003}
        rows.append(row)
    found: Findings = module("section4.4-mass").evaluate({"": MadeUpPart(means=pd.DataFrame(rows))})
    return found


@pytest.mark.parametrize(("fraction", "verdict"), [("particle", Verdict.HOLDS), ("mass", Verdict.FAILS)])
def test_which_fraction_tells_the_viscosity(fraction: str, verdict: Verdict) -> None:
    findings = masses(fraction)
    for words in ("whatever the mass", "particle fraction that has"):
        assert {each.verdict for each in findings.claims if words in each.text} == {verdict}
    assert claim(findings, "mass fraction is eq. 45").verdict is Verdict.HOLDS
    assert claim(findings, "(1 - [MF]) N_S m_S").verdict is Verdict.FAILS
