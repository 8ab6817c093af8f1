"""Tables 1 and 2, figures 6 to 8: on made-up results that obey the paper, and on others that do not."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from tether.paper import Claim, Exhibit, Findings, Part, Size, Verdict
from tether.paper.distributions import shell_mean
from tether.record import Record
from tether.study.folder import StudyFolder
from tether.study.results import Results
from tether.study.study import Study
from tether.theory.diffusion import PERIODIC_CUBE
from tether.theory.suspension import einstein, krieger_dougherty

PAPER = Path(__file__).parents[2] / "paper"

MakeRow = Callable[[dict[str, Any]], dict[str, float]]


@cache
def exhibit(name: str) -> Exhibit:
    """One of the paper's."""
    return Exhibit(PAPER / name)


@cache
def study_of(name: str, size: Size, part: str) -> Study:
    """A study of it."""
    return exhibit(name).studies(size)[part]


def made_up(of: Exhibit, part: str, folder: Path, row: MakeRow) -> Part:
    """A quick study of an exhibit whose means are what `row` makes of each setting's values."""
    study = study_of(of.name, "quick", part)
    made = Part(study, StudyFolder.create(folder, study))
    rows = []
    for setting, ensemble in zip(study.settings, study.ensembles, strict=True):
        configuration = ensemble.configuration
        values = {
            "fluid.temperature": configuration.fluid.temperature,
            "count": sum(configuration.body_counts),
            "dimension": configuration.dimension,
            **setting.values,
        }
        rows.append({**setting.values, **row(values)})
    made.__dict__["results"] = Results(pd.DataFrame(), pd.DataFrame(rows), xr.Dataset())  # in place of those of runs
    return made


def with_curves(part: Part, folder: Path, body: str, foot: Callable[[str, float], float]) -> None:
    """Give a part distributions that pass 0.01 at foot(kind, kT), and fall on below it, 0 or less being no foot."""
    q = (np.arange(200) + 0.5) * 0.01
    records = []
    for number, setting in enumerate(part.study.settings):
        temperature = float(setting.values["fluid.temperature"])
        found = xr.Dataset(coords={"r": q}, attrs={"samples": 10_000})
        for kind in ("solvent", body):
            rise = 0.01 * 10.0 ** ((q - foot(kind, temperature)) / 0.05)
            found[f"g_{kind}_solvent"] = ("r", np.minimum(1.0, rise))
            found[f"g_{kind}_solvent_error"] = ("r", np.full(len(q), 1e-4))
        record = Record(folder / f"run{number}")
        record.folder.mkdir(parents=True)
        found.to_netcdf(record.dataset_path("radial_distribution"), engine="h5netcdf")
        records.append(({**setting.values, "repeat": 0}, record))
    part.__dict__["records"] = records


def verdict_of(findings: Findings, *words: str) -> Verdict:
    """Of the one claim that has these words in it."""
    return claim_of(findings, *words).verdict


def claim_of(findings: Findings, *words: str) -> Claim:
    """The one claim that has these words in it."""
    (found,) = (claim for claim in findings.claims if all(word in claim.text for word in words))
    return found


# --- Table 1, figures 6 and 7 ---

BODIES = {2: "square", 3: "cube"}


def printed_foot(table: ModuleType, dimension: int, shift: float = 0.0) -> Callable[[str, float], float]:
    """The feet of Table 1, moved; the solvent at kT = 1 has none."""

    def foot(kind: str, temperature: float) -> float:
        row = table.PRINTED[dimension, temperature]
        if kind != "solvent":
            return float(row[2]) + shift
        return float(row[0]) + shift if temperature < 1.0 else -0.05

    return foot


def sizes(folder: Path, shift: float = 0.0, error: float = 0.002) -> Findings:
    """Table 1's evaluation of made-up feet."""
    of = exhibit("table1")
    parts = {}
    for dimension, body in BODIES.items():
        foot = printed_foot(of.module, dimension, shift)

        def row(values: dict[str, Any], foot: Any = foot, body: str = body) -> dict[str, float]:
            found = {}
            for kind in ("solvent", body):
                q = foot(kind, values["fluid.temperature"])
                found[f"contact_distance_{kind}"] = q if q > 0.0 else math.nan
                found[f"contact_distance_{kind}_error"] = error if q > 0.0 else math.nan
            return found

        part = made_up(of, f"{dimension}d", folder / f"{dimension}d", row)
        with_curves(part, folder / f"curves{dimension}", body, foot)
        parts[f"{dimension}d"] = part
    return of.evaluate(parts)


@pytest.fixture(scope="module")
def printed_sizes(tmp_path_factory: pytest.TempPathFactory) -> Findings:
    """Of runs that have found what Table 1 has."""
    return sizes(tmp_path_factory.mktemp("sizes"))


def test_table_1_holds_on_its_own_numbers(printed_sizes: Findings) -> None:
    found = printed_sizes
    for dimension in (2, 3):
        for who in ("solvent particles: g reaches 0.01 at 0.", "a body and the solvent"):
            claims = [claim for claim in found.claims if f"{dimension}D, {who}" in claim.text and "0.25)" in claim.text]
            assert [claim.verdict for claim in claims] == [Verdict.HOLDS]
    assert verdict_of(found, "larger the lower kT") is Verdict.HOLDS
    assert verdict_of(found, "times that of a solvent particle") is Verdict.HOLDS
    assert verdict_of(found, "ratio of the sizes falls") is Verdict.HOLDS


def test_table_1_fails_where_sizes_are_others(tmp_path: Path) -> None:
    found = sizes(tmp_path, shift=-0.045)
    body = claim_of(found, "2D, a body and the solvent")
    assert body.verdict is Verdict.FAILS
    assert "below the printed, by 0.045" in body.remark
    assert verdict_of(found, "times that of a solvent particle") is Verdict.FAILS


def test_a_solvent_without_a_foot_has_no_size(printed_sizes: Findings) -> None:
    claim = claim_of(printed_sizes, "2D, solvent particles", "(kT = 1)")
    assert claim.verdict is Verdict.FAILS
    assert "first bin" in claim.remark


def test_unknown_errors_decide_nothing(tmp_path: Path) -> None:
    found = sizes(tmp_path, error=math.nan)
    assert verdict_of(found, "2D, a body and the solvent") is Verdict.UNDECIDED
    assert verdict_of(found, "larger the lower kT") is Verdict.UNDECIDED


def test_table_1_has_one_radius_that_its_formula_does_not_give(printed_sizes: Findings) -> None:
    claim = claim_of(printed_sizes, "a_C is q less a_S")
    assert claim.verdict is Verdict.FAILS
    assert "2D, kT = 1: 0.395" in claim.remark


@pytest.mark.parametrize(("name", "body"), [("fig06", "square"), ("fig07", "cube")])
@pytest.mark.parametrize("obeys", [True, False])
def test_figures_of_distributions(name: str, body: str, obeys: bool, tmp_path: Path) -> None:
    of = exhibit(name)
    dimension = 2 if body == "square" else 3
    printed = printed_foot(exhibit("table1").module, dimension)

    def foot(kind: str, temperature: float) -> float:
        # The control: sizes that shrink with kT, and bodies that the solvent goes through.
        return printed(kind, temperature) if obeys else 0.1 * temperature

    def row(values: dict[str, Any]) -> dict[str, float]:
        temperature = values["fluid.temperature"]
        found = {f"contact_distance_{kind}": foot(kind, temperature) for kind in ("solvent", body)}
        found = {name: q if q > 0.0 else math.nan for name, q in found.items()}
        return found | {f"{name}_error": 0.002 for name in found}

    part = made_up(of, "", tmp_path / "study", row)
    with_curves(part, tmp_path / "curves", body, foot)
    found = of.evaluate({"": part})
    expected = Verdict.HOLDS if obeys else Verdict.FAILS
    assert verdict_of(found, "feet of the curves") is expected
    assert verdict_of(found, "out of a body's core") is expected
    assert verdict_of(found, "1 far away") is Verdict.HOLDS
    assert len(of.panels(found)) == 4


def test_finding_no_pair_is_known_to_one_pair() -> None:
    table = pd.DataFrame({"temperature": 1.0, "q": [0.005, 0.015], "g_body": 0.0, "g_body_error": 0.0})
    found = shell_mean(table.assign(pairs_body=[20.0, 60.0]), 1.0, "body", 0.0, 0.1)
    assert found.value == 0.0
    assert found.error == pytest.approx(1.0 / 80.0)


# --- Table 2 ---


def coefficients(folder: Path, factor: float = 1.0, relative_error: float = 0.001) -> Findings:
    """Table 2's evaluation of its own numbers times a factor, D as it would be in our box."""
    of = exhibit("table2")
    module, table_1 = of.module, exhibit("table1").module
    foot = printed_foot(table_1, 3)

    def rest(values: dict[str, Any]) -> dict[str, float]:
        kT = values["fluid.temperature"]
        eta, solvent, _, body, _ = module.SIMULATION[kT]
        images = module.drag_of_images((10.0, 10.0, 10.0)) - module.drag_of_images(module.PAPERS_BOX)
        lost = images * kT / (6.0 * math.pi * eta)
        found = {"diffusion_solvent": factor * solvent - lost, "diffusion_cube": factor * body - lost}
        found |= {f"contact_distance_{kind}": foot(kind, kT) for kind in ("solvent", "cube")}
        found = {name: value if value > 0.0 else math.nan for name, value in found.items()}
        return found | {f"{name}_error": relative_error * value for name, value in found.items()}

    def shear(values: dict[str, Any]) -> dict[str, float]:
        eta = factor * module.SIMULATION[values["fluid.temperature"]][0]
        return {"viscosity": eta, "viscosity_error": relative_error * eta}

    parts = {"rest": made_up(of, "rest", folder / "rest", rest), "shear": made_up(of, "shear", folder / "shear", shear)}
    return of.evaluate(parts)


def test_table_2_holds_on_its_own_numbers(tmp_path: Path) -> None:
    found = coefficients(tmp_path)
    for words in ("Simulation: viscosity", "D of the solvent", "D of the body", "larger bodies and smaller solvent"):
        assert verdict_of(found, words) is Verdict.HOLDS
    assert sum("Kinetic theory:" in claim.text and claim.verdict is Verdict.HOLDS for claim in found.claims) == 3
    assert verdict_of(found, "kT/(6 pi eta D)") is Verdict.HOLDS
    assert verdict_of(found, "inversely proportional") is Verdict.FAILS
    assert len(exhibit("table2").panels(found)) == 3


def test_table_2_fails_on_other_numbers(tmp_path: Path) -> None:
    found = coefficients(tmp_path, factor=1.3)
    for words in ("Simulation: viscosity", "D of the solvent", "D of the body"):
        assert verdict_of(found, words) is Verdict.FAILS


def test_images_in_a_cube_are_those_of_yeh_and_hummer() -> None:
    images = exhibit("table2").module.drag_of_images
    assert images((10.0, 10.0, 10.0)) == pytest.approx(PERIODIC_CUBE / 10.0, rel=1e-6)
    # A flat box's own images are nearer than a large cube's and farther than a small one's.
    assert PERIODIC_CUBE / 20.0 < images((20.0, 20.0, 10.0)) < PERIODIC_CUBE / 10.0


# --- figure 8 ---


def dilute(
    folder: Path, law: Callable[[float, dict[str, Any]], float], relative_error: float = 1e-4, seed: int = 1
) -> Findings:
    """Figure 8's evaluation of eta_r = law(phi, values), with noise of the relative error that it is told."""
    of = exhibit("fig08")
    generator = np.random.default_rng(seed)
    parts = {}
    for part in ("mass", "temperature", "rate"):

        def row(values: dict[str, Any]) -> dict[str, float]:
            constituents = 4 * values["count"]
            phi = constituents / (constituents + 400.0)
            plain = 3.0 / values["fluid.temperature"]
            found = {"volume_fraction": phi}
            for name in ("viscosity", "viscosity_pairwise"):
                eta = plain * law(phi, values) * (1.0 + relative_error * generator.standard_normal())
                pairs = {name: eta, f"plain_fluid_{name}": plain, f"relative_{name}": eta / plain}
                found |= pairs | {f"{key}_error": relative_error * value for key, value in pairs.items()}
            return found

        parts[part] = made_up(of, part, folder / part, row)
    return of.evaluate(parts)


def test_dilute_suspensions_that_obey_einstein(tmp_path: Path) -> None:
    """Errors are so small, 60 of them to the nearest bound, that no seed would do otherwise."""
    found = dilute(tmp_path, lambda phi, _: krieger_dougherty(phi, 2))
    for words in ("below phi = 2.5 %, pairwise", "mass of the constituents", "kT makes", "shear rate makes"):
        claims = [claim for claim in found.claims if words in claim.text]
        assert {claim.verdict for claim in claims} == {Verdict.HOLDS}
    assert verdict_of(found, "one for low volume fractions") is Verdict.HOLDS
    assert verdict_of(found, "Only with the volume fraction") is Verdict.HOLDS
    assert len(exhibit("fig08").panels(found)) == 4


def test_dilute_suspensions_that_do_not(tmp_path: Path) -> None:
    def law(phi: float, values: dict[str, Any]) -> float:
        return 1.0 + (2.5 + values.get("bodies.0.mass", 1.0)) * phi

    found = dilute(tmp_path, law)
    assert verdict_of(found, "below phi = 2.5 %, total") is Verdict.FAILS
    assert verdict_of(found, "mass of the constituents", "total") is Verdict.FAILS


def test_large_errors_do_not_make_slopes_alike(tmp_path: Path) -> None:
    found = dilute(tmp_path, lambda phi, _: einstein(phi, 2), relative_error=0.01)
    assert verdict_of(found, "mass of the constituents", "total") is Verdict.UNDECIDED


def test_slopes_share_their_plain_fluid() -> None:
    """A plain fluid that is off moves all slopes alike: their mean gains little, their difference has none of it."""
    slopes_of = exhibit("fig08").module.slopes_of
    rows = [
        {
            "temperature": 1.0, "mass": mass, "shear_rate": 1.0, "volume_fraction": 0.02, "viscosity": 3.0 * 1.04,
            "viscosity_error": 1e-3, "plain_fluid_viscosity": 3.0, "plain_fluid_viscosity_error": 1e-2,
        }
        for mass in (1.0, 2.0)
    ]  # fmt: skip
    slopes = slopes_of(pd.DataFrame(rows), "total")
    assert slopes.value == pytest.approx([2.0, 2.0])
    own, shared = 1e-3 / (3.0 * 0.02), 1e-2 * 1.04 / (3.0 * 0.02)
    assert slopes.estimate(0).error == pytest.approx(math.hypot(own, shared), rel=1e-6)
    assert slopes.difference(1, 0).error == pytest.approx(math.sqrt(2.0) * own, rel=1e-6)
    assert slopes.mean().error == pytest.approx(math.hypot(own / math.sqrt(2.0), shared), rel=1e-6)


# --- all ---


@pytest.mark.parametrize("size", ["smoke", "quick", "full"])
def test_the_runs_of_tables_and_figures_are_the_same(size: Size) -> None:
    def runs(name: str, part: str) -> set[str]:
        return {point.identity for point in study_of(name, size, part).points}

    assert runs("table1", "2d") == runs("fig06", "")
    assert runs("table1", "3d") == runs("fig07", "") == runs("table2", "rest")
