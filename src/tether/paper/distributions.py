"""Radial distribution functions of an exhibit's runs, put together over repeats: curves, and where they begin.

What g and its contact distance are: `tether.observe.radial_distribution`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tether.config import Configuration
from tether.estimate import Estimate
from tether.observe.radial_distribution import THRESHOLD
from tether.paper.claim import Claim, Comparison, judged, near
from tether.paper.exhibit import Findings, Part
from tether.paper.panel import COLORS, Panel, Series

Array = NDArray[np.float64]

TEMPERATURE = "fluid.temperature"
"""The swept key that tells the curves apart."""

CORE = 0.125
"""Half of the sites' distance of 0.25: what is nearer to a body's center is among its sites, length."""

_FAR = 1.7
"""From here on the solvent has forgotten the particle at the origin, not yet a body, length."""

_FAR_TOLERANCE = 0.02

_FOOT = 1.0
"""Up to where the feet of the curves are shown, length."""


def number(value: float, error: float) -> Estimate:
    """A value with its error, nan where none is known, as an Estimate to compute with."""
    return Estimate(value, error, samples=1, inefficiency=1.0, converged=math.isfinite(error))


def curves(part: Part, body: str) -> pd.DataFrame:
    """g of solvent and of bodies with solvent: temperature, q (length), g_solvent, g_body, and their errors.

    body: the shape, which is the name of its kind. Means over repeats, each of which has the same number of samples.
    pairs_solvent, pairs_body: how many would have been found in the bin if g were 1.
    """
    gathered: dict[float, list[Mapping[str, Array]]] = {}
    for values, record in part.records:
        found = record.datasets()["radial_distribution"]
        names = {"q": "r", "solvent": "g_solvent_solvent", "body": f"g_{body}_solvent"}
        names |= {f"{name}_error": f"{names[name]}_error" for name in ("solvent", "body")}
        curve = {name: np.asarray(found[key].values, dtype=np.float64) for name, key in names.items()}
        curve |= _pairs(part.study.ensembles[0].configuration, curve["q"], int(found.attrs["samples"]))
        gathered.setdefault(float(values[TEMPERATURE]), []).append(curve)
    frames = []
    for temperature, repeats in gathered.items():
        columns: dict[str, float | Array] = {"temperature": temperature, "q": repeats[0]["q"]}
        for name in ("solvent", "body"):
            columns[f"g_{name}"] = np.mean([each[name] for each in repeats], axis=0)
            squares = np.sum([each[f"{name}_error"] ** 2 for each in repeats], axis=0)
            columns[f"g_{name}_error"] = np.sqrt(squares) / len(repeats)
            columns[f"pairs_{name}"] = np.sum([each[f"pairs_{name}"] for each in repeats], axis=0)
        frames.append(pd.DataFrame(columns))
    return pd.concat(frames, ignore_index=True) if frames else pd.DataFrame()


def _pairs(configuration: Configuration, q: Array, samples: int) -> dict[str, Array]:
    """Pairs of solvent and of bodies with solvent in each bin, whose middles are q, if g were 1."""
    edges = np.arange(len(q) + 1) * 2.0 * q[0]
    ball = math.pi * edges**2 if configuration.dimension == 2 else 4.0 / 3.0 * math.pi * edges**3
    share = samples * np.diff(ball) / configuration.box.volume
    solvent, bodies = configuration.solvent_count, sum(configuration.body_counts)
    return {"pairs_solvent": 0.5 * solvent * (solvent - 1) * share, "pairs_body": bodies * solvent * share}


def shell_mean(table: pd.DataFrame, temperature: float, name: str, low: float, high: float) -> Estimate:
    """Mean of g_`name` over the shell low < q < high, every volume in it counting alike; bins taken as independent.

    Its error is no smaller than what one pair makes: that none was found does not mean that there are none. No value,
    where nothing was measured there.
    """
    inside = table[(table["temperature"] == temperature) & (table["q"] > low) & (table["q"] < high)]
    if inside.empty:
        return number(math.nan, math.nan)
    pairs = inside[f"pairs_{name}"].to_numpy()
    weight = pairs / pairs.sum()
    g, error = inside[f"g_{name}"].to_numpy(), inside[f"g_{name}_error"].to_numpy()
    of_blocks = float(np.sqrt(weight**2 @ error**2))
    return number(float(weight @ g), max(of_blocks, 1.0 / float(pairs.sum())))


def contact_distance(part: Part, temperature: float, kind: str) -> Estimate:
    """The distance at which g reaches 0.01, mean over repeats; no value where it does not, or in too short a run."""
    means = part.results.means
    name = f"contact_distance_{kind}"
    if means.empty or name not in means:
        return number(math.nan, math.nan)
    row = means[means[TEMPERATURE] == temperature]
    if row.empty:
        return number(math.nan, math.nan)
    value, error = float(row[name].iloc[0]), float(row[f"{name}_error"].iloc[0])
    return number(value, error)


def increases(values: Mapping[float, Estimate], name: str) -> list[Comparison]:
    """That a size grows from each temperature to the next lower one; temperatures without a size are left out."""
    known = {temperature: values[temperature] for temperature in sorted(values, reverse=True)}
    known = {temperature: value for temperature, value in known.items() if not math.isnan(value.value)}
    return [
        Comparison(known[cold] - known[warm], low=0.0, name=f"{name}, kT = {cold:g} less {warm:g}")
        for warm, cold in pairwise(known)
    ]


def figure_findings(part: Part, body: str, figure: str) -> Findings:
    """Tables and claims of the paper's figures 6 and 7, which differ in nothing but the dimension and the shape."""
    table, temperatures = curves(part, body), sorted({float(s.values[TEMPERATURE]) for s in part.study.settings})
    feet: list[Comparison] = []
    distances = []
    for name, kind in (("solvent", "solvent"), ("body", body)):
        values = {each: contact_distance(part, each, kind) for each in temperatures}
        feet += increases(values, name)
        distances += [(name, each, value.value, value.error) for each, value in values.items()]
    tables = {
        "curves": table,
        "distances": pd.DataFrame(distances, columns=["pair", "temperature", "distance", "distance_error"]),
    }
    return Findings(tables, _claims(table, feet, temperatures, figure, part.core_hours))


def _claims(
    table: pd.DataFrame, feet: Sequence[Comparison], temperatures: Sequence[float], figure: str,
    core_hours: float,
) -> list[Claim]:  # fmt: skip
    core = [
        Comparison(shell_mean(table, each, "body", 0.0, CORE), high=THRESHOLD, name=f"g at kT = {each:g}")
        for each in temperatures
    ]
    far = [
        near(shell_mean(table, each, "solvent", _FAR, math.inf), 1.0, _FAR_TOLERANCE, f"solvent, kT = {each:g}")
        for each in temperatures
    ]
    return [
        judged(
            "Particles are the larger the lower kT: the feet of the curves move out", f"section 4.4, {figure}",
            "the distance at which g reaches 0.01 grows from each kT to the next lower one, for solvent and bodies",
            feet, core_hours,
        ),
        judged(
            "Sites 0.25 apart keep the solvent out of a body's core", f"section 4.1, {figure}",
            f"mean g of body and solvent over q < {CORE:g} is below {THRESHOLD:g}", core, core_hours,
        ),
        judged(
            "g is the density of neighbors over that of the fluid, 1 far away", f"eq. 39, {figure}",
            f"mean g of the solvent over q > {_FAR:g} is within {_FAR_TOLERANCE:g} of 1", far, core_hours,
        ),
    ]  # fmt: skip


def figure_panels(findings: Findings, body: str) -> list[Panel]:
    """Solvent left and bodies right as the paper has them; below, the feet of the curves on a logarithmic axis."""
    table = findings.tables["curves"]
    panels = []
    for log in (False, True):
        for name, title in (("solvent", "Solvent and solvent"), ("body", f"Center of a {body} and solvent")):
            panels.append(
                Panel(
                    title, "distance $q$ ($r_c$)", "radial distribution function $g$",
                    [_curve(table, each, name, color, log) for each, color in _colored(table)],
                    log_y=log, y_range=(1e-4, 3.0) if log else None,
                    levels=[(THRESHOLD, "0.01: taken for not zero")] if log else [(1.0, "")],
                )
            )  # fmt: skip
    return panels


def _colored(table: pd.DataFrame) -> list[tuple[float, str]]:
    temperatures = [] if table.empty else sorted(set(table["temperature"]), reverse=True)
    return list(zip(temperatures, COLORS, strict=False))


def _curve(table: pd.DataFrame, temperature: float, name: str, color: str, log: bool) -> Series:
    rows = table[(table["temperature"] == temperature) & (table["q"] < (_FOOT if log else math.inf))]
    g, error = rows[f"g_{name}"].to_numpy(), rows[f"g_{name}_error"].to_numpy()
    if log:
        g = np.where(g > 0.0, g, np.nan)  # none was found there: no place on a logarithmic axis
    return Series(f"$kT$ = {temperature:g}", rows["q"].to_numpy(), g, error, kind="band", color=color)
