r"""Section 4.6: the ranges of the Reynolds, Mach and Péclet numbers

The paper defines $\mathrm{Ma} = \dot\gamma a/c$ and $\mathrm{Re} = \rho_s\dot\gamma a L/\eta_s$, $L$ being the width
of the channel, and prints their ranges for its shear rates, as well as $\mathrm{Pe} = \dot\gamma a^2/D_0$ of the
lowest rates (captions of figures 10 and 11).

Here they are computed from the paper's own radii and diffusivities (Tables 1 and 2), its $L = 10$, and the viscosity
and the speed of sound of the solvent, measured: $c^2 = \mathrm dp/\mathrm d\rho$ at constant temperature, from the
pressure, the part beyond $nkT$ of which goes as $n^2$. The paper does not say how it got its $c$. No $D_0$ is printed
for two dimensions, so that the Pe of figure 10 cannot be checked. A number agrees where it comes out as printed
within the rounding.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import pandas as pd

from tether.estimate import Estimate
from tether.paper import Claim, Findings, Part, exact, judged, near
from tether.paper.numbers import number
from tether.paper.rheology import NEWTONIAN, plain_table, solvents_of, weighted_mean
from tether.theory.dimensionless import peclet
from tether.theory.equation_of_state import sound_speed_from_pressure

SOURCE = "section 4.6"
DENSITY = 4.0
WIDTH = 10.0
CASES = ((2, 1.0), (2, 0.5), (3, 1.0), (3, 0.5))
RATES = {(2, 1.0): (0.05, 10.0), (2, 0.5): (0.01, 10.0), (3, 1.0): (0.01, 10.0), (3, 0.5): (0.0075, 10.0)}
RADII = {(2, 1.0): 0.3995, (2, 0.5): 0.44, (3, 1.0): 0.605, (3, 0.5): 0.64}
MACH = {(2, 1.0): (0.004, 0.87), (2, 0.5): (0.001, 0.98), (3, 1.0): (0.001, 1.35), (3, 0.5): (0.001, 1.58)}
REYNOLDS = {(2, 1.0): (0.005, 1.02), (2, 0.5): (0.001, 0.65), (3, 1.0): (0.002, 2.91), (3, 0.5): (0.001, 1.78)}
DIFFUSIVITY = {(3, 1.0): 0.046, (3, 0.5): 0.011}
PECLET = {(3, 1.0): 0.07, (3, 0.5): 0.27}
ROUNDING = (0.0005, 0.005)
"""Of the lower end of a range and of the upper one."""


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """The printed ranges beside those of the formulas."""
    tables = {"ranges": ranges_table({d: parts[f"plain{d}"] for d in (2, 3)})}
    return Findings(tables, claims_of(tables, sum(part.core_hours for part in parts.values())))


def ranges_table(plain: Mapping[int, Part]) -> pd.DataFrame:
    """A row for each case: what the numbers are made from, the formulas' upper ends, the printed ones."""
    rows = []
    for dimension, kt in CASES:
        table = plain_table(plain[dimension])
        slow = table[(table["kT"] == kt) & (table["shear_rate"] <= NEWTONIAN)]
        viscosity = solvents_of(plain[dimension])[kt]
        pressure = weighted_mean(slow["pressure"], slow["pressure_error"])
        speed = _sound_speed(pressure, kt)
        rows.append(row_of(dimension, kt, viscosity, speed))
    return pd.DataFrame(rows)


def _sound_speed(pressure: Estimate, kt: float) -> Estimate:
    def speed(of: float) -> float:
        return float(sound_speed_from_pressure(pressure=of, density=DENSITY, temperature=kt, mass=1.0))

    slope = (speed(1.001 * pressure.value) - speed(pressure.value)) / (0.001 * pressure.value)
    return number(speed(pressure.value), abs(slope) * pressure.error)


def row_of(dimension: int, kt: float, viscosity: Estimate, speed: Estimate) -> dict[str, float]:
    """A row of the table."""
    key = (dimension, kt)
    radius, (low, high) = RADII[key], RATES[key]
    words = DENSITY * high * radius * WIDTH / viscosity
    body = DENSITY * high * radius**2 / viscosity * 0.5
    mach = high * radius / speed
    row: dict[str, float] = {"dimension": dimension, "kT": kt, "lowest_rate": low, "highest_rate": high}
    for name, value in (("viscosity", viscosity), ("sound_speed", speed), ("reynolds", words),
                        ("half_body_reynolds", body), ("mach", mach)):  # fmt: skip
        row |= {name: value.value, f"{name}_error": value.error}
    row |= {"reynolds_printed": REYNOLDS[key][1], "mach_printed": MACH[key][1]}
    diffusivity = DIFFUSIVITY.get(key, math.nan)
    row |= {"peclet": float(peclet(low, radius, diffusivity)), "peclet_printed": PECLET.get(key, math.nan)}
    return row


def claims_of(tables: Mapping[str, pd.DataFrame], hours: float) -> list[Claim]:
    """What becomes of the printed numbers."""
    claims = []
    for _, row in tables["ranges"].iterrows():
        claims += [_range(row, "mach", "Ma", MACH, hours), _reynolds(row, hours)]
        if math.isfinite(row["peclet"]):
            claims.append(_peclet(row))
    return claims


def _range(row: pd.Series, name: str, symbol: str, printed: Mapping[tuple[int, float], tuple[float, float]],
           hours: float) -> Claim:  # fmt: skip
    """Both ends of a range, which is in proportion to the rate."""
    ends = printed[int(row["dimension"]), row["kT"]]
    upper = number(row[name], row[f"{name}_error"])
    lower = upper * (row["lowest_rate"] / row["highest_rate"])
    return judged(
        f"{symbol} is from {ends[0]:g} to {ends[1]:g} in {row['dimension']:g}D at kT = {row['kT']:g}", SOURCE,
        "as printed within the rounding, at both ends",
        [near(each, end, step, symbol) for each, end, step in zip((lower, upper), ends, ROUNDING, strict=True)], hours,
    )  # fmt: skip


def _reynolds(row: pd.Series, hours: float) -> Claim:
    claim = _range(row, "reynolds", "Re = rho v L / eta", REYNOLDS, hours)
    half, printed = row["half_body_reynolds"], row["reynolds_printed"]
    if abs(half / printed - 1.0) > 0.03:
        return claim
    return claim.with_remark(
        f"half the Reynolds number of a body, n m rate a^2/(2 eta), is {half:.3g} at the upper end, within 3 % of "
        "what is "
        "printed: L is not in it"
    )


def _peclet(row: pd.Series) -> Claim:
    value, printed = row["peclet"], row["peclet_printed"]
    claim = exact(
        f"Pe = {printed:g} at the lowest rate, {row['lowest_rate']:g}, in 3D at kT = {row['kT']:g}", "caption of "
        "fig. 11",
        value, printed, 0.005,
    )  # fmt: skip
    if math.floor(100.0 * value) / 100.0 == printed:
        return claim.with_remark(f"eq. 18 with Tables 1 and 2 gives {value:.4f}; printed is that cut off, not rounded")
    return claim
