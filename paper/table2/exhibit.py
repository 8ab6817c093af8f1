"""Table 2: viscosity, diffusion and Stokes-Einstein radii, 3D

The paper compares kinetic theory (eq. 36-37, without repulsion) with simulation, and makes radii of eq. 40. It follows
one body; we follow eight in one box. It does not say how the viscosity was found; we shear the plain fluid, at several
rates. Images of a particle in a periodic box slow it down, by 5 % in a box of 10. The table has D as measured, D in the
box that the paper names for 3D (20 x 20 x 10), and D in a large fluid: to lowest order in size over box the correction
is exact, by the sum over the lattice of images (Yeh and Hummer 2004, doi 10.1021/jp0477147, who have it for a cube).
Radii as the paper makes them take D in its box.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise, product

import numpy as np
import pandas as pd
from scipy.special import erfc

from tether.estimate import Estimate
from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, Verdict, judged, near
from tether.paper.distributions import contact_distance, increases, number
from tether.theory import kinetic
from tether.theory.diffusion import stokes_einstein_radius

KINETIC = {1.0: (2.4023, 0.0870, 0.2537), 0.5: (4.5000, 0.0218, 0.2709), 0.25: (8.9238, 0.0054, 0.2732)}
"""Table 2, kinetic theory, by kT: viscosity, D and radius of a solvent particle."""

SIMULATION = {
    1.0: (2.5106, 0.12, 0.1761, 0.046, 0.4594),
    0.5: (4.5917, 0.031, 0.1864, 0.011, 0.5252),
    0.25: (9.9830, 0.0071, 0.1871, 0.00225, 0.5905),
}
"""Table 2, simulation, by kT: viscosity, D and radius of a solvent particle, D and radius of a body."""

PAPERS_BOX = (20.0, 20.0, 10.0)
"""The paper's 20 x 10 x 20, in our axes."""

LOW_RATE = 0.1
"""The viscosity is that of this rate, or of the next one that there is."""

_VISCOSITY, _SOLVENT, _BODY = 0.02, 0.05, 0.10  # tolerances, relative
_ROUNDING = 0.5 + 1e-9  # of the last digit

Numbers = Mapping[float, Estimate]


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Coefficients and radii beside those of Table 2."""
    rest, shear = parts["rest"], parts["shear"]
    temperatures = [float(setting.values["fluid.temperature"]) for setting in rest.study.settings]
    rates = _rates(shear)
    eta = {kT: rates[kT][min(rates[kT], key=lambda rate: abs(rate - LOW_RATE))] for kT in temperatures}
    sides = rest.study.ensembles[0].configuration.box.size
    diffusion = {
        name: {kT: _diffusion(rest, kT, kind) for kT in temperatures}
        for name, kind in (("solvent", "solvent"), ("body", "cube"))
    }
    in_papers_box = {
        name: {kT: in_another_box(D[kT], kT, eta[kT], sides, PAPERS_BOX) for kT in temperatures}
        for name, D in diffusion.items()
    }
    radii = {name: {kT: radius(kT, eta[kT], D[kT]) for kT in temperatures} for name, D in in_papers_box.items()}
    by_distribution = {kT: _sizes(rest, kT) for kT in temperatures}
    hours = rest.core_hours + shear.core_hours
    claims = [
        *_kinetic_theory(),
        _own_radii(),
        _viscosities(eta, shear.core_hours),
        *_diffusivities(in_papers_box, rest.core_hours),
        _growth(radii, hours),
        *_against_distribution(radii, by_distribution, hours),
    ]
    tables = {
        "coefficients": _table(temperatures, eta, diffusion, in_papers_box, radii, sides),
        "viscosity": pd.DataFrame(
            [(kT, rate, each.value, each.error) for kT, found in rates.items() for rate, each in found.items()],
            columns=["temperature", "shear_rate", "viscosity", "viscosity_error"],
        ),
    }
    return Findings(tables, claims, [_by_rate(rates)])


# --- what the runs have ---


def _rates(part: Part) -> dict[float, dict[float, Estimate]]:
    """Viscosity of the plain fluid by kT and shear rate."""
    means = part.results.means
    found: dict[float, dict[float, Estimate]] = {}
    for setting in part.study.settings:
        kT, rate = float(setting.values["fluid.temperature"]), float(setting.values["flow.shear_rate"])
        row = means[(means["fluid.temperature"] == kT) & (means["flow.shear_rate"] == rate)]
        known = not row.empty
        value = float(row["viscosity"].iloc[0]) if known else math.nan
        error = float(row["viscosity_error"].iloc[0]) if known else math.nan
        found.setdefault(kT, {})[rate] = number(value, error)
    return found


def _diffusion(part: Part, temperature: float, kind: str) -> Estimate:
    means = part.results.means
    name = f"diffusion_{kind}"
    row = means[means["fluid.temperature"] == temperature]
    if name not in means or row.empty:
        return number(math.nan, math.nan)
    return number(float(row[name].iloc[0]), float(row[f"{name}_error"].iloc[0]))


def _sizes(part: Part, temperature: float) -> tuple[Estimate, Estimate]:
    """Radii of a solvent particle and of a body by g(r); as in Table 1."""
    solvent, body = (contact_distance(part, temperature, kind) for kind in ("solvent", "cube"))
    return 0.5 * solvent, body - (0.5 * solvent if math.isfinite(solvent.value) else 0.0)


def radius(temperature: float, viscosity: Estimate, diffusivity: Estimate) -> Estimate:
    """a = kT / (6 pi eta D), eq. 40; length. Viscosity and D are of independent runs."""
    if not viscosity.value * diffusivity.value > 0.0:
        return number(math.nan, math.nan)
    return temperature / (6.0 * math.pi) / (viscosity * diffusivity)


def drag_of_images(sides: Sequence[float]) -> float:
    """xi of kT xi / (6 pi eta): what a particle's images in a periodic box take from D, mean over the axes; 1/length.

    The trace of the Oseen tensor is a Coulomb potential, so xi is minus the potential at a charge's place of its own
    images in a neutralising background: 2.837297/L in a cube. Ewald's sum.
    """
    box = np.asarray(sides, dtype=np.float64)
    volume, alpha = float(box.prod()), 4.0 / float(box.min())
    cells = np.array([cell for cell in product(range(-3, 4), repeat=3) if any(cell)], dtype=np.float64)
    distance = np.sqrt(((cells * box) ** 2).sum(axis=1))
    waves = np.array([wave for wave in product(range(-12, 13), repeat=3) if any(wave)], dtype=np.float64)
    square = ((2.0 * math.pi * waves / box) ** 2).sum(axis=1)
    near_part = float((erfc(alpha * distance) / distance).sum())
    far_part = 4.0 * math.pi / volume * float((np.exp(-square / (4.0 * alpha**2)) / square).sum())
    return 2.0 * alpha / math.sqrt(math.pi) + math.pi / (alpha**2 * volume) - near_part - far_part


def in_another_box(
    diffusivity: Estimate,
    temperature: float,
    viscosity: Estimate,
    sides: Sequence[float],
    other: Sequence[float] | None,
) -> Estimate:
    """D measured in a box of such sides, as it is in another box, or in a large fluid where that is None."""
    if not math.isfinite(viscosity.value):
        return number(math.nan, math.nan)
    lost = drag_of_images(sides) - (drag_of_images(other) if other is not None else 0.0)
    return diffusivity + lost * temperature / (6.0 * math.pi) / viscosity


# --- what the paper says ---


def _kinetic_theory() -> list[Claim]:
    found = {}
    for kT in KINETIC:
        fluid = {"density": 4.0, "friction": 4.5 / kT, "temperature": kT, "exponent": 0.5}
        eta, D = float(kinetic.viscosity(dimension=3, **fluid)), float(kinetic.diffusivity(dimension=3, **fluid))
        found[kT] = eta, D, float(stokes_einstein_radius(temperature=kT, viscosity=eta, diffusivity=D))
    claims = []
    for column, name in enumerate(("viscosity", "D", "radius of a solvent particle")):
        printed = ", ".join(f"{row[column]:.4f}" for row in KINETIC.values())
        comparisons = [
            near(number(found[kT][column], 0.0), row[column], _ROUNDING * 1e-4, f"kT = {kT:g}")
            for kT, row in KINETIC.items()
        ]
        rule = "eq. 36, 37 and 40, computed, are within half of the last printed digit"
        claims.append(judged(f"Kinetic theory: {name} {printed}", "Table 2", rule, comparisons))
    halves = [
        near(number(found[cold][2] / found[warm][2], 0.0), 2.0, 0.2, f"kT = {cold:g} over {warm:g}")
        for warm, cold in pairwise(KINETIC)
    ]
    inverse = judged(
        "By kinetic theory the size of a solvent particle is inversely proportional to kT", "section 4.4",
        "the radius doubles within 10 % where kT is halved", halves,
    )  # fmt: skip
    if inverse.verdict is Verdict.FAILS:
        inverse = inverse.with_remark(
            "so where the kinetic part of the viscosity dominates; here most of it is dissipative, and the radius "
            "tends to a constant, as the paper's own table has it"
        )
    return [*claims, inverse]


def _own_radii() -> Claim:
    comparisons = []
    for kT, (eta, D, a, body_D, body_a) in SIMULATION.items():
        for name, diffusivity, printed in (("solvent", D, a), ("body", body_D, body_a)):
            computed = float(stokes_einstein_radius(temperature=kT, viscosity=eta, diffusivity=diffusivity))
            comparisons.append(near(number(computed, 0.0), printed, _ROUNDING * 1e-4, f"{name}, kT = {kT:g}"))
    return judged(
        "The radii are kT/(6 pi eta D)", "eq. 40, Table 2",
        "of the printed viscosity and D, within half of the last printed digit of the radius", comparisons,
    )  # fmt: skip


def _viscosities(eta: Numbers, hours: float) -> Claim:
    printed = ", ".join(f"{SIMULATION[kT][0]:.4f}" for kT in eta)
    comparisons = [
        near(each, SIMULATION[kT][0], _VISCOSITY * SIMULATION[kT][0], f"kT = {kT:g}") for kT, each in eta.items()
    ]
    return judged(
        f"Simulation: viscosity {printed}", "Table 2", f"within {_VISCOSITY:.0%}, the shear rate being {LOW_RATE:g}",
        comparisons, hours,
    )  # fmt: skip


def _by_rate(rates: Mapping[float, Mapping[float, Estimate]]) -> str:
    """A note: what the shear rate makes of the plain fluid's viscosity."""
    words = []
    for kT, found in rates.items():
        low, high = min(found), max(found)
        if found[low].value > 0.0 and high > low:
            words.append(f"{found[high] / found[low]} (kT = {kT:g}, rate {high:g} over {low:g})")
    return f"The plain fluid's viscosity, one rate over another: {'; '.join(words) or 'not measured'}."


def _diffusivities(found: Mapping[str, Numbers], hours: float) -> list[Claim]:
    claims = []
    for name, column, tolerance in (("solvent", 1, _SOLVENT), ("body", 3, _BODY)):
        printed = ", ".join(f"{SIMULATION[kT][column]:g}" for kT in found[name])
        comparisons = [
            near(each, SIMULATION[kT][column], tolerance * SIMULATION[kT][column], f"kT = {kT:g}")
            for kT, each in found[name].items()
        ]
        claims.append(
            judged(
                f"Simulation: D of the {name} {printed}",
                "Table 2",
                f"as it is in the paper's box, within {tolerance:.0%}",
                comparisons,
                hours,
            )
        )
    return claims


def _growth(radii: Mapping[str, Numbers], hours: float) -> Claim:
    comparisons = [each for name, found in radii.items() for each in increases(found, name)]
    return judged(
        "The Stokes-Einstein size increases as kT is reduced, in simulations too", "section 4.4",
        "every radius is larger than that at the next higher kT", comparisons, hours,
    )  # fmt: skip


def _against_distribution(
    radii: Mapping[str, Numbers], by_distribution: Mapping[float, tuple[Estimate, Estimate]], hours: float
) -> list[Claim]:
    """What section 4.4 says of the two ways to a size, which here come from the same runs."""
    larger = [
        Comparison(own[index] - radii[name][kT], low=0.0 if name == "body" else -math.inf,
                   high=math.inf if name == "body" else 0.0, name=f"{name}, kT = {kT:g}")
        for kT, own in by_distribution.items()
        for index, name in enumerate(("solvent", "body"))
        if math.isfinite(own[index].value)
    ]  # fmt: skip
    shares = {kT: _share(radii["body"][kT], own[1]) for kT, own in by_distribution.items()}
    solvent = {kT: _share(radii["solvent"][kT], own[0]) for kT, own in by_distribution.items()}
    closer = increases(shares, "body")
    closer += [
        Comparison(_apart(solvent[kT]) - _apart(shares[kT]), low=0.0, name=f"solvent's less body's, kT = {kT:g}")
        for kT in shares
        if math.isfinite(solvent[kT].value)
    ]
    return [
        judged(
            "g(r) predicts larger bodies and smaller solvent particles than Stokes-Einstein", "section 4.4",
            "radius by g less that by eq. 40, above 0 for bodies and below 0 for the solvent", larger, hours,
        ),
        judged(
            "The two agree the better the larger the particle is", "section 4.4",
            "for bodies radius by eq. 40 over that by g increases as kT falls; its logarithm is further from 0 for the "
            "solvent than for bodies", closer, hours,
        ),
    ]  # fmt: skip


def _share(hydrodynamic: Estimate, own: Estimate) -> Estimate:
    """Radius by eq. 40 over that by g(r)."""
    return hydrodynamic / own if own.value > 0.0 else number(math.nan, math.nan)


def _apart(share: Estimate) -> Estimate:
    """|ln share|."""
    if not share.value > 0.0:
        return number(math.nan, math.nan)
    return number(abs(math.log(share.value)), share.error / share.value)


# --- tables and pictures ---


def _table(
    temperatures: Sequence[float], eta: Numbers, diffusion: Mapping[str, Numbers], in_papers_box: Mapping[str, Numbers],
    radii: Mapping[str, Numbers], sides: Sequence[float],
) -> pd.DataFrame:  # fmt: skip
    rows = []
    for kT in temperatures:
        row: dict[str, float] = {"temperature": kT, "viscosity": eta[kT].value, "viscosity_error": eta[kT].error}
        row["viscosity_printed"], row["viscosity_kinetic_theory"] = SIMULATION[kT][0], KINETIC[kT][0]
        for name, column in (("solvent", 1), ("body", 3)):
            unbounded = in_another_box(diffusion[name][kT], kT, eta[kT], sides, None)
            of = {
                f"diffusion_{name}": diffusion[name][kT],
                f"diffusion_{name}_in_papers_box": in_papers_box[name][kT],
                f"diffusion_{name}_unbounded": unbounded,
                f"radius_{name}": radii[name][kT],
                f"radius_{name}_unbounded": radius(kT, eta[kT], unbounded),
            }
            for key, each in of.items():
                row[key], row[f"{key}_error"] = each.value, each.error
            row[f"diffusion_{name}_printed"] = SIMULATION[kT][column]
            row[f"radius_{name}_printed"] = SIMULATION[kT][column + 1]
        rows.append(row)
    return pd.DataFrame(rows)


def panels(findings: Findings) -> list[Panel]:
    """Viscosity, diffusion coefficients and radii against kT, ours and the printed."""
    table = findings.tables["coefficients"]
    both = ("solvent", "body")
    named = {f"diffusion_{name}_in_papers_box": (name, f"diffusion_{name}_printed") for name in both}
    return [
        _panel(table, "Viscosity", r"viscosity $\eta$", {"viscosity": ("solvent", "viscosity_printed")}, True),
        _panel(table, "Diffusion, in the paper's box", "$D$ ($r_c^2$/time)", named, True),
        _panel(
            table, "Stokes-Einstein radii", "radius ($r_c$)",
            {f"radius_{name}": (name, f"radius_{name}_printed") for name in both}, False,
        ),
    ]  # fmt: skip


def _panel(table: pd.DataFrame, title: str, ylabel: str, shown: Mapping[str, tuple[str, str]], log: bool) -> Panel:
    series = []
    kT = table["temperature"].to_numpy()
    for color, (key, (name, printed)) in zip(COLORS, shown.items(), strict=False):
        series.append(Series(name, kT, table[key].to_numpy(), table[f"{key}_error"].to_numpy(), color=color))
        series.append(Series(f"{name}, the paper", kT, table[printed].to_numpy(), color=color, marker="s", hollow=True))
    return Panel(title, "temperature $kT$ (energy)", ylabel, series, log_y=log)
