r"""Section 4.3: the spring forces.

The paper looks at one disc: the spring forces on its constituents oscillate about zero with a magnitude of the order
of 10 (over a = 18.75), their sum is of the order of 1e-9, and so "can be shown to have no contributions to the stress
tensor".

We take one square in a box of 10 x 10 at kT = 1, at rest (the massless base is fitted to the constituents of every
frame), the last states of runs with both bases in full precision, for the sums, and sheared suspensions (rate 0.2)
for the stress.

A sum that vanishes does not make the stress vanish. The stress has the first moment of the forces,
$-\frac1V\sum(\mathbf r_i - \mathbf X)\mathbf F_i$, which does not depend on the origin just because the sum is zero.
It is what the base carries from one side of the body to the other: seen from the body, a spring force has a mean,
against what constituents and solvent do to each other. Only in the laboratory, where bodies turn, is the mean zero.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tether.estimate import Estimate, estimate, estimate_function
from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, judged, near
from tether.paper.numbers import mean, number
from tether.paper.springs import Springs, springs_at_the_end, springs_of_frames
from tether.record import Record

REPULSION = 18.75
COUNT, BASE = "bodies.0.count", "bodies.0.base"
SOURCE = "section 4.3"


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """One body in time, sums in full precision, and the stress."""
    single = [springs_of_frames(record) for _, record in parts["single"].records]
    trace = springs_of_frames(parts["trace"].records[0][1])
    means, magnitude, sums, stress = (
        _means(single),
        _magnitudes(single, parts["bases"]),
        _sums(parts["bases"]),
        _stress(parts["shear"]),
    )
    claims = [
        _oscillates(trace, parts["trace"]),
        _zero_mean(means, magnitude, parts["single"].core_hours),
        _of_order_10(magnitude, parts["single"].core_hours + parts["bases"].core_hours),
        _sum_vanishes(sums),
        _adds_nothing(stress, parts["shear"].core_hours),
    ]
    time = pd.DataFrame({"time": trace.time - trace.time[0]})
    for i in range(trace.force.shape[2]):
        time[f"x_{i + 1}"] = trace.force[:, 0, i, 0] / REPULSION
    tables = {"trace": time, "means": means, "magnitude": magnitude, "sums": sums, "stress": stress}
    return Findings(tables, claims, ["Forces are over a = 18.75, the largest repulsion of a pair."])


def _means(single: Sequence[Springs]) -> pd.DataFrame:
    """Mean force on each constituent, in the laboratory and outward from the center of the body."""
    rows = []
    for i in range(single[0].force.shape[2]):
        for axis, name in enumerate("xy"):
            found = mean([estimate(run.force[:, 0, i, axis] / REPULSION) for run in single])
            rows.append({"constituent": i + 1, "component": name, "mean": found.value, "error": found.error})
        found = mean([estimate(run.radial[:, 0, i] / REPULSION) for run in single])
        rows.append({"constituent": i + 1, "component": "outward", "mean": found.value, "error": found.error})
    found = mean([estimate(run.radial[:, 0].mean(axis=-1) / REPULSION) for run in single])
    rows.append({"constituent": 0, "component": "outward of all", "mean": found.value, "error": found.error})
    return pd.DataFrame(rows)


def _magnitudes(single: Sequence[Springs], bases: Part) -> pd.DataFrame:
    """Root mean square of the force on a constituent, and the largest one seen."""
    found = mean([estimate((run.magnitude[:, 0] ** 2).mean(axis=-1)) for run in single])
    largest = max(float(run.magnitude.max()) for run in single)
    rows = [_magnitude("massless", 1, found, largest)]
    for (base, count), states in _states(bases).items():
        if count > 1 and base == "newton-euler":
            of_runs = [number(float((state.magnitude**2).mean()), math.nan) for state in states]
            rows.append(_magnitude(base, count, mean(of_runs), max(float(state.magnitude.max()) for state in states)))
    return pd.DataFrame(rows)


def _magnitude(base: str, count: int, square: Estimate, largest: float) -> dict[str, object]:
    root = math.sqrt(square.value)
    return {
        "base": base,
        "bodies": count,
        "rms": root / REPULSION,
        "error": 0.5 * square.error / root / REPULSION,
        "largest": largest / REPULSION,
    }


def _states(bases: Part) -> dict[tuple[str, int], list[Springs]]:
    """The last states of all repeats, by base and number of bodies."""
    found: dict[tuple[str, int], list[Springs]] = {}
    for values, record in bases.records:
        found.setdefault((values[BASE], values[COUNT]), []).append(springs_at_the_end(record))
    return found


def _sums(bases: Part) -> pd.DataFrame:
    """The largest sum of the forces on a body, over all bodies and runs, and how many those are."""
    return pd.DataFrame(
        [
            {
                "base": base,
                "bodies": count,
                "seen": sum(state.sum.shape[1] for state in states),
                "largest_sum": max(float(np.linalg.norm(state.sum, axis=-1).max()) for state in states) / REPULSION,
            }
            for (base, count), states in _states(bases).items()
        ]
    )


def _stress(shear: Part) -> pd.DataFrame:
    """Parts of the springs in shear stress and pressure, in per cent of the total."""
    found: dict[float, list[tuple[Estimate, Estimate]]] = {}
    for _, record in shear.records:
        phi = record.configuration().particle_fraction
        found.setdefault(phi, []).append((_share(record, "xy"), _share(record, "trace")))
    rows = []
    for phi, shares in found.items():
        shear_stress, pressure = (mean([each[k] for each in shares]) for k in (0, 1))
        rows.append((phi, shear_stress.value, shear_stress.error, pressure.value, pressure.error))
    return pd.DataFrame(rows, columns=["phi", "shear_stress", "shear_stress_error", "pressure", "pressure_error"])


def _share(record: Record, of: str) -> Estimate:
    """body/total, in per cent, of a component or of the trace, with the correlation between the two."""
    series = record.series()
    terms = [f"stress_{term}" for term in ("kinetic", "conservative", "dissipative", "body")]

    def taken(name: str) -> NDArray[np.float64]:
        stress = series[name].to_numpy()
        return stress[:, 0, 1] if of == "xy" else np.trace(stress, axis1=1, axis2=2)

    columns = np.column_stack([taken(name) for name in terms])
    return estimate_function(lambda means: 100.0 * float(means[-1] / means.sum()), columns)


def _oscillates(trace: Springs, part: Part) -> Claim:
    """Changes of sign about the mean in a unit of time, of each component of each force."""
    force = trace.force[:, 0].reshape(len(trace.time), -1)
    about = force - force.mean(axis=0)
    changes = (np.diff(np.sign(about), axis=0) != 0).sum(axis=0) / (trace.time[-1] - trace.time[0])
    configuration = part.records[0][1].configuration()
    free = math.sqrt(3000.0 / configuration.body_masses[0]) / math.pi
    rate = number(float(changes.mean()), float(changes.std(ddof=1) / math.sqrt(len(changes))))
    return judged(
        "The spring forces oscillate.",
        SOURCE,
        f"they change sign as often as a free oscillator of the springs, {free:.3g} times a unit of time, within half",
        [near(rate, free, 0.5 * free, "changes of sign")],
    )


def _zero_mean(means: pd.DataFrame, magnitude: pd.DataFrame, hours: float) -> Claim:
    tenth = 0.1 * float(magnitude["rms"].iloc[0])
    laboratory = means[means["component"].isin(["x", "y"])]
    comparisons = [
        near(number(row.mean_, row.error), 0.0, tenth, f"{row.component} of {row.constituent}")
        for row in laboratory.rename(columns={"mean": "mean_"}).itertuples()
    ]
    claim = judged(
        "The spring forces have zero mean.",
        SOURCE,
        "mean force on each constituent along x and y, over a, within a tenth of the root mean square",
        comparisons,
        hours,
    )
    outward = means[means["component"] == "outward of all"].iloc[0]
    seen = number(outward["mean"], outward["error"])
    if math.isfinite(seen.error) and abs(seen.value) > 5.0 * seen.error:
        return claim.with_remark(
            f"in the laboratory; seen from the body it is {seen} along the outward direction, and that makes a stress"
        )
    return claim


def _of_order_10(magnitude: pd.DataFrame, hours: float) -> Claim:
    comparisons = [
        Comparison(
            number(row.rms, row.error),
            math.sqrt(10.0),
            10.0 * math.sqrt(10.0),
            f"{row.base}, largest {row.largest:.1f}",
        )
        for row in magnitude.itertuples()
    ]
    return judged(
        "Their magnitude is of the order of 10, over a.",
        SOURCE,
        "root mean square over a nearer to 10 than to 1 or 100, on a logarithmic scale (3.16 to 31.6)",
        comparisons,
        hours,
    )


def _sum_vanishes(sums: pd.DataFrame) -> Claim:
    limit = math.sqrt(10.0) * 1e-9
    claim = judged(
        "The sum of the spring forces on a body is very small, of the order of 1e-9.",
        SOURCE,
        "the largest sum over a, of all bodies and runs, is below 3.2e-9",
        [
            Comparison(number(row.largest_sum), high=limit, name=f"{row.base}, {row.bodies} bodies")
            for row in sums.itertuples()
        ],
    )
    largest = float(sums["largest_sum"].max())
    if largest < 1e-9 / math.sqrt(10.0):
        return claim.with_remark(
            f"smaller still, {largest:.1g}: it is rounding, which adds up over a run with a Newton-Euler base"
        )
    return claim


def _adds_nothing(stress: pd.DataFrame, hours: float) -> Claim:
    comparisons = [
        near(
            number(row.shear_stress, row.shear_stress_error), 0.0, 1.0, f"% of the shear stress at phi = {row.phi:.4f}"
        )
        for row in stress.itertuples()
    ]
    claim = judged(
        "The spring forces do not make any contributions to the stress tensor.",
        f"{SOURCE}, conclusions",
        "their first moment is within 1 % of the total shear stress at each volume fraction (rate 0.2)",
        comparisons,
        hours,
    )
    last = stress.iloc[-1]
    pressure = number(last["pressure"], last["pressure_error"])
    return claim.with_remark(
        f"their sum is 0, their first moment is not; of the pressure it is {pressure} % at phi = {last['phi']:.4f}"
    )


def panels(findings: Findings) -> list[Panel]:
    """Forces over time, their means, and the share of the stress."""
    trace, means, stress = (findings.tables[name] for name in ("trace", "means", "stress"))
    shown = trace[trace["time"] <= 1.0]
    lines = [
        Series(f"constituent {k + 1}", shown["time"], shown[f"x_{k + 1}"], kind="line", color=COLORS[k])
        for k in range(4)
    ]
    points = []
    for color, marker, name in zip(COLORS, "o^s", ("x", "y", "outward"), strict=False):
        of = means[means["component"] == name]
        words = "outward, seen from the body" if name == "outward" else f"along {name}"
        points.append(Series(words, of["constituent"], of["mean"], of["error"], color=color, marker=marker))  # type: ignore[arg-type]
    shares = [
        Series(
            "of the shear stress", stress["phi"], stress["shear_stress"], stress["shear_stress_error"], color=COLORS[0]
        ),
        Series(
            "of the pressure", stress["phi"], stress["pressure"], stress["pressure_error"], color=COLORS[1], marker="s"
        ),
    ]
    return [
        Panel("Along x, one disc", "time", "spring force / $a$", lines, levels=[(0.0, "")]),
        Panel("Mean over time, one disc", "constituent", "mean spring force / $a$", points, levels=[(0.0, "")]),
        Panel(
            "First moment", r"volume fraction $\phi$", "share of the springs (%)", shares, levels=[(0.0, "the paper")]
        ),
    ]
