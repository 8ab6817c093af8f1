"""Fig. 17: migration in reverse Poiseuille flow, concentration across the channel, 3D

The paper drives a suspension of volume fraction 0.4635 (the caption; the text has 0.43) with forces of 0.4 and 1 per
particle, plots the local concentration after 300 000 steps, and lays eq. 51 (Phillips et al. 1992,
[doi 10.1063/1.858498](https://doi.org/10.1063/1.858498)) through it, with $K_\\eta/K_c = 3.77$ and the viscosity that
it found in the flow. It names neither temperature nor time step; its largest velocities are those of $kT = 1$ in a
channel of half-width 5 (fig. 18).

We take these, in a box of 20 along the gradient, which holds two channels, and a time step of 0.005. At the quick size
the box is 10 along the flow and 5 along the vorticity, and concentrations are means from 40 000 to 160 000 steps; those
from 10 000 to 30 000 beside them show how far they had settled. By symmetry a run has four half-channels: they are laid
on each other, and errors are of their scatter, in claims about twice as large for the tails of Student's t. Bodies take
hundreds of time units to cross a channel. So the quick size decides whether they gather, and where; it does not decide
the concentration in the middle to better than two or three hundredths. Claims on the settled state count how far a
value came from the early runs to the late as an error. Beside the wall, where shear is fastest, the flow heats the
fluid; the notes tell by how much.

The local viscosity is that of momentum balance, the integral of the force over the measured shear rate: no formula for
the stress enters, so that pairwise and total make no difference here. Eq. 51 is drawn in two ways: with that viscosity
and the concentration measured beside the wall (the paper's way), and with Krieger and Dougherty's viscosity at
$\\phi_m = 0.65$ and the box's mean concentration (`tether.theory.migration`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from tether.estimate import Estimate
from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, exact, judged, near
from tether.paper.channel import Channel, channels_of, mean_for_verdict, mean_of_rows
from tether.theory.migration import MigrationProfile

FORCES = (0.4, 1.0)
FLUX_RATIO = 3.77
PHILLIPS = 1.0 / 0.66  # K of Phillips et al.
MAXIMUM_PACKING = 0.65
WALL = {0.4: 0.28, 1.0: 0.32}
"""phi_w of the paper: measured at force 0.4, chosen at force 1."""
APART = 1.0
"""Within this distance of the centerline, a body's diameter or so, a local theory is not asked."""

Rows = NDArray[np.float64]
Channels = Mapping[float, Channel]
"""By force."""


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Profiles of both forces, settled and early, and what the paper says of them."""
    channels = {part: channels_of(parts[part]) for part in ("late", "early")}
    late, early = channels["late"], channels["early"]
    hours = sum(part.core_hours for part in parts.values())
    tables = {
        "profile": pd.DataFrame([row for part in channels for row in _profile_rows(part, channels[part])]),
        "model": pd.DataFrame([row for force, channel in late.items() for row in _model_rows(force, channel)]),
        "numbers": pd.DataFrame([row for part in channels for row in _numbers(part, channels[part])]),
    }
    claims = [
        *_of_migration(late, early, hours),
        *_of_equation_51(late, early, hours),
        _of_phillips(late, early, hours),
        *_of_means(_volume_fraction(parts["late"])),
    ]
    return Findings(tables, claims, _notes(channels))


def panels(findings: Findings) -> list[Panel]:
    """A panel for each force."""
    return [_panel(findings, force) for force in FORCES]


# --- numbers ---


def _center(channel: Channel) -> Rows:
    """In the bins within half a length of the centerline."""
    return channel.near_center(channel.fraction, 0.5)


def _beside_wall(channel: Channel) -> Rows:
    """In the bins within half a length of the wall."""
    return channel.near_wall(channel.fraction, 0.5)


def flux_ratio(fraction: Rows, shear_rate: Rows, viscosity: Rows) -> float:
    """K_eta/K_c for which rate phi eta^K is the most even: minus the slope of ln(rate phi) against ln(eta).

    All at the same distances, (m,). nan where fewer than three of them have a rate and a viscosity above 0.
    """
    there = (shear_rate > 0) & (viscosity > 0) & (fraction > 0)
    if there.sum() < 3:
        return math.nan
    along = np.log(viscosity[there])
    across = np.log(shear_rate[there] * fraction[there])
    along -= along.mean()
    return float(-(along @ across) / (along @ along))


def _flux_ratios(channel: Channel) -> list[float]:
    """By a jackknife over half-channels: the ratio of means, without the noise of each half-channel's slope."""
    there = channel.edges >= APART
    rows = [each[:, there] for each in (channel.fraction_at_edges, channel.shear_rate)]
    stress = (channel.viscosity * channel.shear_rate)[:, there]

    def of(chosen: NDArray[np.bool_]) -> float:
        fraction, rate = (each[chosen].mean(axis=0) for each in rows)
        with np.errstate(divide="ignore", invalid="ignore"):
            return flux_ratio(fraction, rate, stress[chosen].mean(axis=0) / rate)

    return _jackknife(of, len(stress))


def _jackknife(of: Callable[[NDArray[np.bool_]], float], number: int) -> list[float]:
    """Pseudo-values of a number that is made from the rows chosen by a mask: independent, and of the right mean."""
    whole = of(np.ones(number, dtype=bool))
    left_out = [of(np.arange(number) != each) for each in range(number)]
    return [number * whole - (number - 1) * each for each in left_out]


def local_model(channel: Channel, ratio: float) -> Rows:
    """Eq. 51 at the edges, for each half-channel, (n, bins - 1): phi_w (h/xi) (eta_w/eta)^(K - 1) with the measured
    viscosity, and h, phi_w and eta_w at the outermost edge. nan where no viscosity could be measured.
    """
    viscosity = np.where(channel.viscosity > 0, channel.viscosity, math.nan)
    wall = channel.fraction_at_edges[:, -1:]
    return np.asarray(wall * channel.edges[-1] / channel.edges * (viscosity[:, -1:] / viscosity) ** (ratio - 1.0))


def _model(channel: Channel, ratio: float) -> MigrationProfile:
    """Eq. 51 with Krieger and Dougherty's viscosity, of the mean concentration that the channel has."""
    mean = float(channel.fraction.mean())
    return MigrationProfile.of_mean(
        mean, flux_ratio=ratio, maximum_packing=MAXIMUM_PACKING, half_width=channel.half_width
    )


def settled(late: Estimate, early: Estimate) -> Estimate:
    """The late value, with how far it came since the early run in its error, beside the scatter.

    An approach exp(-t/T) leaves less to go than it came from steps 10 000-30 000 to 40 000-160 000 where T is up to 500
    time units: the move is a bound, taken as one standard error. nan where either is not known.
    """
    moved = abs(late.value - early.value)
    return replace(late, error=math.hypot(late.error, moved), converged=late.converged and math.isfinite(moved))


# --- claims ---


_SETTLED = "errors hold how far it came since the early run"


def _settled(of: Callable[[Channel], ArrayLike], force: float, late: Channels, early: Channels) -> Estimate:
    """A mean over half-channels, by `settled`."""
    return settled(mean_for_verdict(of(late[force])), mean_for_verdict(of(early[force])))


def _of_migration(late: Channels, early: Channels, hours: float) -> list[Claim]:
    gathered = [
        Comparison(mean_for_verdict(_center(late[force]) - _beside_wall(late[force])), 0.0, name=f"g = {force:g}")
        for force in FORCES
    ]
    centers = {force: mean_for_verdict(_center(late[force])) for force in FORCES}
    return [
        judged(
            "Bodies migrate from the walls to the center of the channel.", "section 4.8, fig. 17",
            "concentration within 0.5 of the centerline minus that within 0.5 of the wall above 0, both forces",
            gathered, hours,
        ),
        judged(
            "Local concentrations are higher at the center as the flow rate is increased.", "section 4.8",
            "concentration within 0.5 of the centerline at g = 1 minus that at g = 0.4 above 0",
            [Comparison(centers[1.0] - centers[0.4], 0.0, name="difference")], hours,
        ),
        judged(
            "The concentration approaches phi_m = 0.65 at the centerline.", "section 4.8",
            f"concentration within 0.5 of the centerline within 10 % of 0.65, both forces; {_SETTLED}",
            [
                near(_settled(_center, force, late, early), MAXIMUM_PACKING, 0.1 * MAXIMUM_PACKING, f"g = {force:g}")
                for force in FORCES
            ],
            hours,
        ),
        judged(
            "The concentration at the wall is 0.28 at g = 0.4.", "section 4.8",
            f"concentration within 0.5 of the wall 0.28 within 0.03; {_SETTLED}",
            [near(_settled(_beside_wall, 0.4, late, early), WALL[0.4], 0.03, "g = 0.4")], hours,
        ),
        judged(
            "The concentration at the wall that fits at g = 1 is 0.32.", "section 4.8",
            f"concentration within 0.5 of the wall 0.32 within 0.03; {_SETTLED}",
            [near(_settled(_beside_wall, 1.0, late, early), WALL[1.0], 0.03, "g = 1")], hours,
        ),
    ]  # fmt: skip


def _of_equation_51(late: Channels, early: Channels, hours: float) -> list[Claim]:
    ratios = {force: _settled(_flux_ratios, force, late, early) for force in FORCES}
    comparisons, means = [], []
    for force in FORCES:
        channel = late[force]
        model = local_model(channel, FLUX_RATIO)
        for name, there in _layers(channel.edges[:-1]):  # at the outermost edge the two agree by construction
            off = mean_for_verdict((model - channel.fraction_at_edges)[:, :-1][:, there].mean(axis=1))
            comparisons.append(near(off, 0.0, 0.05, f"g = {force:g}, {name}"))
        means.append(near(mean_for_verdict(_across(channel, model)), 0.43, 0.01, f"g = {force:g}"))
    fitted = judged(
        "Eq. 51 describes the flow with K_eta/K_c = 3.77.", "section 4.8",
        f"the ratio that makes rate phi eta^K the most even beyond {APART:g} from the centerline is 3.77 within 0.5, "
        f"both forces; {_SETTLED}",
        [near(each, FLUX_RATIO, 0.5, f"g = {force:g}: K") for force, each in ratios.items()], hours,
    )  # fmt: skip
    return [
        fitted.with_remark(_thinning(late)),
        judged(
            "Eq. 51 with the measured viscosity, the wall's concentration and K_eta/K_c = 3.77 agrees with the "
            "concentrations, without adjusting the wall's too.", "section 4.8, fig. 17",
            f"off by less than 0.05 in each layer of width 1 beyond {APART:g} from the centerline, both forces",
            comparisons, hours,
        ),
        judged(
            "The mean of that model over the channel is 0.43 in both cases.", "section 4.8",
            "its mean over the edges between bins 0.43 within 0.01, both forces", means, hours,
        ),
    ]  # fmt: skip


def _layers(distances: Rows) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Layers of width 1 beyond APART, by name, and the distances that lie in them."""
    for layer in np.unique(np.floor(distances[distances >= APART])):
        yield f"xi = {layer:g} to {layer + 1:g}", np.floor(distances) == layer


def _of_phillips(late: Channels, early: Channels, hours: float) -> Claim:
    """With nothing measured but the mean: Krieger and Dougherty's viscosity and the ratio of Phillips et al."""
    comparisons = []
    for force in FORCES:
        model = _model(late[force], PHILLIPS)
        for name, there in _layers(late[force].distance):
            found = settled(*(mean_for_verdict(each[force].fraction[:, there].mean(axis=1)) for each in (late, early)))
            off = found - float(np.mean(model.volume_fraction(late[force].distance[there])))
            comparisons.append(near(off, 0.0, 0.05, f"g = {force:g}, {name}"))
    return judged(
        "The migration agrees with the theory of Phillips et al.", "section 5",
        "off by less than 0.05 in each layer of width 1 beyond 1 from the centerline, of eq. 51 with K_eta/K_c = 1.52, "
        f"Krieger and Dougherty's viscosity (phi_m = 0.65) and the mean of the channel, both forces; {_SETTLED}",
        comparisons, hours,
    )  # fmt: skip


def _across(channel: Channel, at_edges: Rows) -> Rows:
    """Mean over the width of what is known at the edges, (n,), by trapezoids."""
    return np.asarray(np.trapezoid(at_edges, channel.edges, axis=1) / (channel.edges[-1] - channel.edges[0]))


def _thinning(late: Channels) -> str:
    """What the same fit gives where nothing migrates: K = 1/m for a fluid that thins as rate^-m."""
    found = []
    for force in FORCES:
        channel = late[force]
        there = channel.edges >= APART
        rate, viscosity = channel.shear_rate.mean(axis=0)[there], channel.viscosity.mean(axis=0)[there]
        found.append(f"{flux_ratio(np.ones_like(rate), rate, viscosity):.2g} (g = {force:g})")
    return (
        "eq. 51 is of a Newtonian suspension; in a fluid that thins as rate^-m and does not migrate at all the same "
        f"fit gives 1/m, and if phi is left out of it here, {' and '.join(found)}: the number is not one of migration "
        "alone"
    )


def _volume_fraction(part: Part) -> float:
    """Of the whole box, which no migration changes."""
    return float(part.results.means["volume_fraction"].iloc[0])


def _of_means(volume_fraction: float) -> list[Claim]:
    text = exact("The suspension has a volume fraction of 43 %.", "section 4.8", volume_fraction, 0.43, 0.005)
    claims = [text.with_remark("the caption of fig. 17 has 0.4635, which is what 1728 cubes in the paper's box make")]
    for force in FORCES:
        model = MigrationProfile(WALL[force], FLUX_RATIO, MAXIMUM_PACKING)
        claim = exact(
            f"Eq. 51 with a wall at {WALL[force]:g} and K_eta/K_c = 3.77 has the mean 0.43 (g = {force:g}), with "
            "Krieger and Dougherty's viscosity.", "section 4.8", model.mean, 0.43, 0.005,
        )  # fmt: skip
        other = MigrationProfile(WALL[force], PHILLIPS, MAXIMUM_PACKING).mean
        claims.append(
            claim.with_remark(
                f"the ratio of Phillips et al., 1.52, gives {other:.3f}; the paper took a viscosity that it measured, "
                "and prints none"
            )
        )
    return claims


def _notes(channels: Mapping[str, Channels]) -> list[str]:
    notes = []
    for force in FORCES:
        early, late = (mean_of_rows(_center(channels[part][force])) for part in ("early", "late"))
        heat = mean_of_rows(channels["late"][force].near_wall(channels["late"][force].temperature, 0.5))
        notes.append(
            f"g = {force:g}: the concentration in the middle was {early} in the early run and {late} in the late one; "
            f"the kinetic temperature beside the wall is {heat}, of 1 that is set."
        )
    notes.append("The paper's own points are not available as numbers; eq. 51 is drawn instead.")
    return notes


# --- tables ---


def _profile_rows(part: str, channels: Channels) -> Iterator[dict[str, object]]:
    for force, channel in channels.items():
        for place, xi in enumerate(channel.distance):
            row: dict[str, object] = {"run": part, "force": force, "distance": xi}
            for name in ("fraction", "density", "velocity", "temperature"):
                found = mean_of_rows(getattr(channel, name)[:, place])
                row |= {name: found.value, f"{name}_error": found.error}
            yield row


def _model_rows(force: float, channel: Channel) -> Iterator[dict[str, object]]:
    """At the edges between bins: viscosity and rate by momentum balance, and eq. 51 in three ways."""
    local = local_model(channel, FLUX_RATIO)
    with_law = {f"krieger_dougherty_{ratio:.2f}": _model(channel, ratio) for ratio in (FLUX_RATIO, PHILLIPS)}
    for place, xi in enumerate(channel.edges):
        row: dict[str, object] = {"force": force, "distance": xi}
        for name, rows in {"shear_rate": channel.shear_rate, "viscosity": channel.viscosity, "local": local}.items():
            found = mean_of_rows(rows[:, place])
            row |= {name: found.value, f"{name}_error": found.error}
        yield row | {name: float(profile.volume_fraction(xi)) for name, profile in with_law.items()}


def _numbers(part: str, channels: Channels) -> Iterator[dict[str, object]]:
    for force, channel in channels.items():
        found = {
            "center": mean_of_rows(_center(channel)),
            "wall": mean_of_rows(_beside_wall(channel)),
            "mean": mean_of_rows(channel.fraction.mean(axis=1)),
            "flux_ratio": mean_of_rows(_flux_ratios(channel)),
        }
        for name, each in found.items():
            yield {"run": part, "force": force, "quantity": name, "value": each.value, "error": each.error}


# --- picture ---


def _panel(findings: Findings, force: float) -> Panel:
    profile, model = (findings.tables[name] for name in ("profile", "model"))
    of_force = profile[profile["force"] == force]
    early, late = (of_force[of_force["run"] == part] for part in ("early", "late"))
    model = model[model["force"] == force]
    local = model[model["distance"] >= APART]
    return Panel(
        f"$g = {force:g}$",
        r"distance from the centerline $\xi$ (DPD units)",
        r"volume fraction $\phi$",
        [
            Series("measured", late["distance"], late["fraction"], late["fraction_error"], color=COLORS[0]),
            Series(
                "measured early", early["distance"], early["fraction"], early["fraction_error"],
                color=COLORS[5], marker="s", hollow=True,
            ),
            Series(
                "eq. 51, measured viscosity, 3.77", local["distance"], local["local"], local["local_error"],
                kind="band", color=COLORS[1],
            ),
            Series(
                "eq. 51, Krieger-Dougherty, 3.77", model["distance"], model["krieger_dougherty_3.77"],
                kind="dashed", color=COLORS[2],
            ),
            Series(
                "the same, 1.52 (Phillips et al.)", model["distance"], model["krieger_dougherty_1.52"],
                kind="line", color=COLORS[3],
            ),
        ],
        y_range=(0.2, 0.75),
        levels=[(MAXIMUM_PACKING, r"$\phi_m$")],
    )  # fmt: skip
