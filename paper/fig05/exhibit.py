r"""Fig. 5: density, temperature and velocity across the channel, at rest, 2D.

The paper (section 4.2) adds 9, 25, 49 and 81 discs of 4 particles to 400 particles of solvent, takes none away, and
finds a solvent density of 4 across the channel (box 10 x 10, kT = 1, no flow, 100 000 steps, 20 x 20 bins). From this
it concludes that the solvent keeps the properties of the pure one at any volume fraction.

We do the same with periodic boundaries and 20 bins across, several times. Two things differ in how it is judged:

- Bins are correlated, in time (bodies take long to diffuse across the box) and with each other (the number of
  particles is fixed: one bin has what others lack). A chi-square from the bins' own errors would be wrong. Since no
  place in a periodic box is different from another, the Fourier modes of a profile are independent; each is tested by
  its scatter from run to run, and their p-values are combined (Fisher). All bins have the same error for the same
  reason, that of the scatter in all of them.
- The mean over the bins cannot be anything but 4: 400 particles in an area of 100. So uniform is all that can be
  tested, and a periodic box at rest is uniform by symmetry. Whether the solvent is as it was is another question,
  which the pressure answers: particles are added, none is taken away, and all have to find room.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict

import numpy as np
import pandas as pd

from tether.paper import COLORS, Claim, Findings, Panel, Part, Series, consistent, judged, near
from tether.paper.claim import Comparison
from tether.paper.numbers import number
from tether.paper.uniformity import shared_error, uniformity

COUNT = "bodies.0.count"
QUANTITIES = ("density_solvent", "density", "temperature", "velocity")


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Profiles of all runs of a count together."""
    bodies, plain = parts["bodies"], parts["plain"]
    hours = sum(each.core_hours for each in parts.values())
    profiles, tests = [], []
    for count in sorted({values[COUNT] for values, _ in bodies.records}):
        records = [record for values, record in bodies.records if values[COUNT] == count]
        runs = [record.datasets()["profiles"] for record in records]
        configuration = records[0].configuration()
        area = float(np.prod(configuration.box.size))
        phi, total = configuration.particle_fraction, configuration.solvent_count + configuration.constituent_count
        columns = {"bodies": count, "phi": phi, "y": runs[0]["y"].to_numpy(), "expected": total / area}
        for name in QUANTITIES:
            of_runs = np.array([run[name].to_numpy() for run in runs])
            columns |= {name: of_runs.mean(axis=0), f"{name}_error": shared_error(of_runs)}
            tests.append({"bodies": count, "phi": phi, "quantity": name, **asdict(uniformity(of_runs))})
        profiles.append(pd.DataFrame(columns))
    profile, test, pressure = pd.concat(profiles), pd.DataFrame(tests), _pressures(bodies, plain)
    return Findings(
        {"profile": profile, "uniformity": test, "pressure": pressure},
        _claims(profile, test, pressure, hours),
        ["Errors are those of one bin; bins are not independent of each other."],
    )


def _pressures(bodies: Part, plain: Part) -> pd.DataFrame:
    """Of the solvent alone and of the suspensions."""
    columns = ["volume_fraction", "pressure", "pressure_error"]
    rows = [
        part.results.means.assign(volume_fraction=lambda each: each["volume_fraction"].fillna(0.0))[columns]
        for part in (plain, bodies)
    ]
    return pd.concat(rows).rename(columns={"volume_fraction": "phi"}).sort_values("phi", ignore_index=True)


def _claims(profile: pd.DataFrame, test: pd.DataFrame, pressure: pd.DataFrame, hours: float) -> list[Claim]:
    percent = pressure["pressure"] / pressure["pressure"].iloc[0]
    rises = [
        near(
            number(row.pressure / pressure["pressure"].iloc[0], _relative_error(row, pressure.iloc[0])),
            1.0,
            0.05,
            f"pressure over the solvent's, phi = {row.phi:.4f}",
        )
        for row in pressure.iloc[1:].itertuples()
    ]
    total = profile.groupby("bodies")["expected"].first()
    return [
        judged(
            "The solvent density is about 4 across the channel for 9, 25, 49 and 81 bodies.",
            "fig. 5, section 4.2",
            "every bin within 10 % of 4",
            _bins(profile, "density_solvent", dict.fromkeys(total.index, 4.0), 0.1),
            hours,
        ).with_remark(
            f"its mean cannot be anything else; the pressure rises to {percent.iloc[-1]:.2f} times the solvent's"
        ),
        _uniform(test, "density_solvent", "The solvent density is uniform across the channel."),
        judged(
            "The density of the entire system is uniform.",
            "fig. 5",
            "every bin within 2 % of N/V",
            _bins(profile, "density", total, 0.02),
            hours,
        ),
        _uniform(test, "density", "The density of the entire system is uniform, by all bins together."),
        judged(
            "The temperature is kT = 1 across the channel.",
            "fig. 5",
            "every bin within 2 % of 1",
            _bins(profile, "temperature", dict.fromkeys(total.index, 1.0), 0.02),
            hours,
        ),
        _uniform(test, "velocity", "The velocity is zero across the channel."),
        judged(
            "The solvent keeps the properties of the pure solvent at any volume fraction.",
            "section 4.2, conclusions",
            "the pressure of the suspension is that of the solvent alone within 5 %",
            rises,
            hours,
        ),
    ]


def _relative_error(row: object, plain: pd.Series) -> float:
    """Of a ratio of pressures."""
    pressure, error = row.pressure, row.pressure_error  # type: ignore[attr-defined]
    return float(pressure / plain["pressure"] * np.hypot(error / pressure, plain["pressure_error"] / plain["pressure"]))


def _bins(profile: pd.DataFrame, name: str, expected: Mapping[int, float], tolerance: float) -> list[Comparison]:
    """Each bin against its expected value, with a relative tolerance."""
    return [
        near(
            number(value, error),
            expected[count],
            tolerance * expected[count],
            f"{name} of {count} bodies at y = {y:.4g}",
        )
        for count, y, value, error in profile[["bodies", "y", name, f"{name}_error"]].itertuples(index=False)
    ]


def _uniform(test: pd.DataFrame, name: str, text: str) -> Claim:
    of = test[test["quantity"] == name]
    known = of["chi_square"].notna().all()
    return consistent(
        text,
        "fig. 5, section 4.2",
        "Fourier modes of the profiles, each by its scatter over the runs, of all numbers of bodies: p at least 5 %",
        float(of["chi_square"].sum()),
        int(of["freedom"].sum()) if known else 0,
    )


def panels(findings: Findings) -> list[Panel]:
    """Four quantities, all numbers of bodies in each."""
    profile = findings.tables["profile"]
    labels = {
        "density_solvent": ("Solvent", "number density (1/length$^2$)"),
        "density": ("All particles", "number density (1/length$^2$)"),
        "temperature": ("Temperature", "$kT$ (energy)"),
        "velocity": ("Velocity", "$u_x$ (length/time)"),
    }
    found = []
    for name, (title, label) in labels.items():
        series = []
        for color, (count, of) in zip(COLORS, profile.groupby("bodies"), strict=False):
            text = f"{count} bodies, $\\phi$ = {of['phi'].iloc[0]:.4f}"
            series.append(Series(text, of["y"], of[name], of[f"{name}_error"], color=color))
        levels = {"density_solvent": [(4.0, "4")], "temperature": [(1.0, "1")], "velocity": [(0.0, "0")]}.get(name, [])
        limits: dict[str, tuple[float, float]] = {"density_solvent": (3.8, 4.2), "temperature": (0.97, 1.03)}
        found.append(Panel(title, "$y$ (length)", label, series, levels=levels, y_range=limits.get(name)))
    return found
