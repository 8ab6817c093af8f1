"""Fig. 16: shear stress and first normal stress difference by two routes, 3D at kT = 0.5

The paper compares the stress of the whole volume (Irving and Kirkwood, its eq. 16) with the force on a plane normal to
the gradient, as on a wall: $S_{xz} = F_x/A$ and $N_1 = -F_z/A$ ($z$ is its gradient, our $y$), at $\\phi = 0.4635$.

We measure both routes in the same runs: every pair in every step for the volume, and in every 50th step what crosses 20
planes normal to the gradient and 20 normal to the flow (the method of planes, Todd et al. 1995,
[doi 10.1103/PhysRevE.52.1627](https://doi.org/10.1103/PhysRevE.52.1627)). Pairwise is the paper's stress, total has
what the bodies carry too. The traction on a plane has the isotropic pressure in it. The paper removes it by saying that
the force on the downstream plane vanishes, which is not so in a periodic box; what is right is the difference of the
normal forces on the two planes.

At the quick size the box is 10 along each side, and there are five rates; time steps are shorter where shear is fast.
The stress falls with the rate and the error of $N_1$ does not, so that at low Pe the comparison says little. Both
routes see the same particles: their errors are added as if independent, which makes the error of a difference an upper
bound.
Planes see the velocities of half a step, which makes their kinetic part a little larger (docs/findings.md).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
import xarray as xr

from tether.estimate import Estimate, estimate
from tether.measurement import pairwise_stress, total_stress
from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, judged, near
from tether.record import Record
from tether.study.means import mean_of

KINDS = ("pairwise", "total")
SHEAR_WITHIN = 0.05
"""Of the stress: shear stresses that differ by less agree."""
NORMAL_WITHIN = 0.1
"""Of the shear stress: normal stress differences that differ by less agree."""


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Both routes at every rate."""
    part = parts[""]
    table = pd.DataFrame(list(_rows(part)))
    return Findings({"routes": table}, _claims(table, part.core_hours), _notes(table))


def panels(findings: Findings) -> list[Panel]:
    """S_xy and N1 against Pe, both routes and both stresses."""
    table = findings.tables["routes"]
    return [
        Panel(
            "shear stress", "Pe", "$S_{xy}$ (DPD units)", _series(table, "shear"), log_x=True, log_y=True,
        ),
        Panel(
            "first normal stress difference", "Pe", "$N_1 = S_{xx} - S_{yy}$ (DPD units)", _series(table, "N1"),
            log_x=True, levels=[(0.0, "")],
        ),
    ]  # fmt: skip


# --- numbers ---


def routes(series: xr.Dataset, planes: xr.Dataset, summary: Mapping[str, object]) -> dict[str, Estimate]:
    """S_xy and N1 of a run by both routes, and the traction on planes; each of both stresses."""
    found = {}
    of_planes = {"pairwise": "_pairwise", "total": ""}
    rate = float(summary["shear_rate"])  # type: ignore[arg-type]
    for kind, stress in {"pairwise": pairwise_stress(series).values, "total": total_stress(series).values}.items():
        found[f"shear_volume_{kind}"] = estimate(stress[:, 0, 1])
        found[f"N1_volume_{kind}"] = estimate(stress[:, 0, 0] - stress[:, 1, 1])
        found[f"shear_planes_{kind}"] = rate * _entry(summary[f"viscosity_planes{of_planes[kind]}"])
        found[f"N1_planes_{kind}"] = _entry(summary[f"N1_planes{of_planes[kind]}"])
        for plane, force in (("y", "y"), ("x", "x")):
            # Planes of one run fluctuate together: the mean of their errors bounds that of their mean.
            traction, error = (
                planes[f"stress_{kind}_plane_{plane}{ending}"].sel(force=force).mean().item()
                for ending in ("", "_error")
            )
            found[f"traction_{plane}_{kind}"] = _estimate(traction, error)
    return found


def _entry(entry: object) -> Estimate:
    assert isinstance(entry, dict)
    value, error = (math.nan if entry[key] is None else entry[key] for key in ("value", "error"))
    return _estimate(value, error)


def _estimate(value: float, error: float) -> Estimate:
    return Estimate(value, error, 0, 1.0, converged=math.isfinite(error))


def _rows(part: Part) -> Iterator[dict[str, float]]:
    """A row for each rate: means over repeats."""
    by_rate: dict[float, list[Record]] = {}
    for values, record in part.records:
        by_rate.setdefault(values["flow.shear_rate"], []).append(record)
    for rate, records in by_rate.items():
        runs = [routes(each.series(), each.datasets()["stress_profile"], each.summary()) for each in records]
        summaries = [each.summary() for each in records]
        row = {"rate": rate, "Pe": float(np.mean([each["dimensionless"]["peclet"] for each in summaries]))}
        steps = [each["steps"] for each in summaries]
        for name in runs[0]:
            mean = mean_of([run[name].value for run in runs], [run[name].error for run in runs], steps)
            row |= {name: mean.value, f"{name}_error": mean.error}
        yield row


def _of(row: pd.Series, name: str) -> Estimate:
    return _estimate(float(row[name]), float(row[f"{name}_error"]))


# --- claims ---


def _claims(table: pd.DataFrame, hours: float) -> list[Claim]:
    rows = [row for _, row in table.iterrows()]
    claims = []
    for kind in KINDS:
        which = {"pairwise": "of eq. 16", "total": "with what the bodies carry"}[kind]
        claims.append(
            judged(
                f"The force on planes along the flow is the shear stress of the volume ({which}).",
                "section 4.7, fig. 16", f"planes over volume 1 within {SHEAR_WITHIN:.0%} at every rate",
                [near(_ratio(row, kind), 1.0, SHEAR_WITHIN, _name(row)) for row in rows], hours,
            )
        )  # fmt: skip
        claims.append(
            judged(
                f"N1 by planes agrees with N1 of the volume ({which}), the pressure taken out by planes normal to the "
                "flow.",
                "section 4.7, fig. 16",
                f"their difference below {NORMAL_WITHIN:.0%} of the shear stress at every rate",
                [near(_apart(row, kind, f"N1_planes_{kind}"), 0.0, NORMAL_WITHIN, _name(row)) for row in rows], hours,
            )
        )  # fmt: skip
    return [*claims, *_of_pressure(rows, hours)]


def _of_pressure(rows: list[pd.Series], hours: float) -> list[Claim]:
    printed = judged(
        "N1 = -F_z/A, the whole normal force on a plane normal to the gradient (z there).", "section 4.7",
        f"-F_z/A minus N1 of the volume below {NORMAL_WITHIN:.0%} of the shear stress at every rate (eq. 16)",
        [near(_apart(row, "pairwise", "traction_y_pairwise", -1.0), 0.0, NORMAL_WITHIN, _name(row)) for row in rows],
        hours,
    )  # fmt: skip
    downstream = judged(
        "The force along the flow on the downstream plane is 0, as nothing else acts on the fluid.", "section 4.7",
        "F_x/A through planes normal to the flow below 10 % of the shear stress at every rate (eq. 16)",
        [_scaled(row, _of(row, "traction_x_pairwise")) for row in rows], hours,
    )  # fmt: skip
    pressures = [-row["traction_x_pairwise"] for row in rows]
    remark = (
        "a fluid in a periodic box stands under its pressure: -F_x/A through planes normal to the flow is from "
        f"{min(pressures):.3g} to {max(pressures):.3g}; with it taken out the identity is the one tested above"
    )
    return [printed.with_remark(remark), downstream.with_remark(remark)]


def _name(row: pd.Series) -> str:
    return f"rate {row['rate']:g}"


def _ratio(row: pd.Series, kind: str) -> Estimate:
    """Shear stress by planes over that of the volume."""
    return _of(row, f"shear_planes_{kind}") / _of(row, f"shear_volume_{kind}")


def _apart(row: pd.Series, kind: str, name: str, sign: float = 1.0) -> Estimate:
    """A number minus N1 of the volume, in units of the shear stress."""
    return (sign * _of(row, name) - _of(row, f"N1_volume_{kind}")) / _of(row, f"shear_volume_{kind}")


def _scaled(row: pd.Series, measured: Estimate) -> Comparison:
    return near(measured / _of(row, "shear_volume_pairwise"), 0.0, 0.1, _name(row))


def _notes(table: pd.DataFrame) -> list[str]:
    last = table.iloc[-1]
    share = 1.0 - last["shear_volume_pairwise"] / last["shear_volume_total"]
    return [f"At rate {last['rate']:g} eq. 16 leaves out {share:.1%} of the shear stress: what the bodies carry."]


# --- picture ---


def _series(table: pd.DataFrame, name: str) -> list[Series]:
    made = []
    for kind, color in zip(KINDS, COLORS, strict=False):
        key = f"{name}_volume_{kind}"
        made.append(Series(f"volume, {kind}", table["Pe"], table[key], table[f"{key}_error"], kind="band", color=color))
        key = f"{name}_planes_{kind}"
        made.append(
            Series(
                f"planes, {kind}", table["Pe"], table[key], table[f"{key}_error"], color=color, marker="s", hollow=True
            )
        )
    return made
