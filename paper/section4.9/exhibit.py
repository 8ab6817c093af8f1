"""Section 4.9: how long a time step may be, by model

The paper steps by 0.01 in 2D and by 0.001 to 0.005 in 3D, and says that this is long: a model of single particles with
an exponential force (Pan et al. 2010a) had needed 0.0002 to 0.0005 to keep the temperature.

We shear discs in 2D and cubes in 3D ($kT = 1$, rate 0.1, $\\phi \\approx 0.2$), tethered and rigid, and single
particles with an exponential force of three steepnesses $b$, and look for the longest of a few time steps at which the
kinetic temperatures of all particles, solvent and constituents are within 2 % of $kT$. The single particles are as
large as the paper's cubes: their potential is 4.6 $kT$ where the cubes' radial distribution function is 0.01. The
parameters of Pan et al. are not available. With the base of the paper's own words (`newton-euler`) the constituents are
too hot at any time step, and heat slowly: their errors are of the scatter between repeats (docs/findings.md).

At the quick size the box is 7 along each side in 3D and no time step is below 0.002. The time step at which a particle
runs away, about 0.028 for tethered cubes, is not asked for, since a run that fails is no part of a study.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

import pandas as pd

from tether.estimate import Estimate
from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, Verdict, judged, near

OFF = 0.02
"""Relative error of a temperature that is too much."""
PAN = 0.0005
"""The longest time step of Pan et al. (2010a), as the paper has it."""
TEMPERATURES = ("all", "solvent", "constituents")
"""That judge a time step. Those of bodies are in the table: few bodies, large errors, and agitation that is no heat."""
TIMESTEP = "run.timestep"
STEEPNESS = "interactions.0.steepness"
LOOKS = {
    "tethered": (COLORS[0], "o"), "discs": (COLORS[5], "o"), "newton-euler": (COLORS[1], "s"),
    "rigid": (COLORS[2], "D"),
    "single b = 10": (COLORS[3], "^"), "single b = 20": (COLORS[4], "v"), "single b = 30": (COLORS[1], "^"),
}  # fmt: skip


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Temperatures of every model at every time step, and the longest that will do."""
    table = pd.DataFrame([row for name, part in parts.items() for row in _rows(name, part)])
    hours = sum(part.core_hours for part in parts.values())
    longest = pd.DataFrame([_longest(table, model) for model in dict.fromkeys(table["model"])])
    return Findings({"temperature": table, "longest": longest}, _claims(table, longest, hours), _notes(longest))


def panels(findings: Findings) -> list[Panel]:
    """The temperature's error against the time step, of all particles; and what the base makes of the constituents'."""
    table = findings.tables["temperature"]
    return [
        Panel(
            "all particles",
            _STEP,
            "error of the kinetic temperature (%)",
            _series(table, "all", _as_error),
            levels=[(100 * OFF, f"{OFF:.0%}")],
        ),
        Panel(
            "constituents, one base and the other",
            _STEP,
            "kinetic temperature over $kT$",
            _series(table, "constituents", _as_it_is),
            log_y=True,
            levels=[(1.0, "set")],
        ),
    ]


def _rows(part_name: str, part: Part) -> Iterator[dict[str, object]]:
    kT = 1.0
    for _, mean in part.results.means.iterrows():
        model = part_name if part_name != "single" else f"single b = {mean[STEEPNESS]:g}"
        row: dict[str, object] = {"model": model, "timestep": mean[TIMESTEP]}
        for of in (*TEMPERATURES, "body_translation", "body_rotation"):
            if of == "constituents" and part_name == "single":
                continue  # they are the bodies
            if math.isfinite(mean.get(f"temperature_{of}", math.nan)):
                row |= {of: mean[f"temperature_{of}"] / kT, f"{of}_error": mean[f"temperature_{of}_error"] / kT}
        yield row


def _comparisons(table: pd.DataFrame, model: str, timestep: float | None = None) -> list[Comparison]:
    """Of each judging temperature with 1, at a time step or at all."""
    found = []
    for _, row in table[table["model"] == model].iterrows():
        if timestep is not None and not math.isclose(row["timestep"], timestep):
            continue
        for of in TEMPERATURES:
            if math.isfinite(row.get(of, math.nan)):
                measured = _estimate(row, of)
                found.append(near(measured, 1.0, OFF, f"{model}, step {row['timestep']:g}: kT of {of}"))
    return found


def _estimate(row: pd.Series, of: str) -> Estimate:
    error = float(row[f"{of}_error"])
    return Estimate(float(row[of]), error, 0, 1.0, converged=math.isfinite(error))


def _longest(table: pd.DataFrame, model: str) -> dict[str, object]:
    """The longest time step up to which every judging temperature is within OFF, and the longest that was run."""
    longest = math.nan
    steps = sorted(table.loc[table["model"] == model, "timestep"])
    for timestep in steps:
        if judged("", "", "", _comparisons(table, model, timestep)).verdict is not Verdict.HOLDS:
            break
        longest = timestep
    return {"model": model, "longest": longest, "tried_up_to": steps[-1]}


# --- claims ---


def _claims(table: pd.DataFrame, longest: pd.DataFrame, hours: float) -> list[Claim]:
    rule = f"kinetic temperatures of all particles, solvent and constituents within {OFF:.0%} of kT"
    three = [each for step in (0.001, 0.002, 0.005) for each in _comparisons(table, "tethered", step)]
    claims = [
        judged(
            "A time step of 0.01 will do in 2D.", "section 4.9", f"{rule} at 0.01",
            _comparisons(table, "discs", 0.01), hours,
        ),
        judged(
            "Time steps of 0.001 to 0.005 will do in 3D.", "section 4.9",
            f"{rule} at those of 0.001, 0.002 and 0.005 that were run", three, hours,
        ),
        judged(
            "The same with the base of the paper's own words.", "sections 3.3 and 4.9",
            f"kinetic temperature of constituents within {OFF:.0%} of kT at 0.005 (newton-euler)",
            [each for each in _comparisons(table, "newton-euler", 0.005) if each.name.endswith("constituents")], hours,
        ),
    ]  # fmt: skip
    single = [model for model in dict.fromkeys(table["model"]) if model.startswith("single")]
    needs = judged(
        f"Single particles with an exponential force need time steps of 0.0002 to {PAN:g} to keep the temperature.",
        "section 4.9",
        f"kinetic temperature of all particles off by more than {OFF:.0%} at 0.005, ten times as long, for each of "
        "three steepnesses",
        [_off(table, model, 0.005) for model in single], hours,
    )  # fmt: skip
    return [*claims, needs.with_remark(_longest_words(longest, single))]


def _off(table: pd.DataFrame, model: str, timestep: float) -> Comparison:
    row = table[(table["model"] == model) & (table["timestep"].sub(timestep).abs() < 1e-9)].iloc[0]
    measured = _estimate(row, "all")
    distance = Estimate(abs(measured.value - 1.0), measured.error, 0, 1.0, converged=measured.converged)
    return Comparison(distance, OFF, name=f"{model}: error of kT")


def _longest_words(longest: pd.DataFrame, single: list[str]) -> str:
    """What the models can do, side by side."""
    by_model = longest.set_index("model")
    told = [
        f"{model} {_word(by_model.loc[model])}" for model in ["tethered", "rigid", *single] if model in by_model.index
    ]
    return f"the longest time steps within {OFF:.0%} are: {', '.join(told)}; those of Pan et al.'s forces are not known"


def _word(row: pd.Series) -> str:
    if not math.isfinite(row["longest"]):
        return "none"
    return f"{row['longest']:g}" + (" or longer" if row["longest"] == row["tried_up_to"] else "")


def _notes(longest: pd.DataFrame) -> list[str]:
    return [f"{row['model']}: longest time step {_word(row)}." for _, row in longest.iterrows()]


_STEP = r"time step $\Delta t$ (DPD units)"


def _as_error(chosen: pd.DataFrame, of: str) -> tuple[pd.Series, pd.Series]:
    """Relative error of a temperature in %, and its own error; not of the heated base, which would hide the others."""
    there = chosen["model"] != "newton-euler"
    return (100 * (chosen[of] - 1.0)).where(there), 100 * chosen[f"{of}_error"]


def _as_it_is(chosen: pd.DataFrame, of: str) -> tuple[pd.Series, pd.Series]:
    """A temperature over kT, of tethered bodies."""
    return chosen[of].where(chosen["model"] != "rigid"), chosen[f"{of}_error"]


def _series(
    table: pd.DataFrame, of: str, shown: Callable[[pd.DataFrame, str], tuple[pd.Series, pd.Series]]
) -> list[Series]:
    """Each model that has something to show."""
    made = []
    for model, (color, marker) in LOOKS.items():
        chosen = table[table["model"] == model]
        y, error = shown(chosen, of)
        if not y.isna().all():
            made.append(Series(model, chosen["timestep"], y, error, color=color, marker=marker))
    return made
