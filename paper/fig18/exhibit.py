"""Fig. 18: velocity profile of a suspension in reverse Poiseuille flow, 3D

The paper drives a suspension ($\\phi = 0.4635$) with forces of 0.4 and 1 per particle, finds largest velocities of 3.94
and 11.32 (section 4.8), and a profile flatter than the parabola in the middle and steeper at the wall. It does not say
at which temperature and time step.

For a Newtonian fluid the largest velocity is $n g h^2/2\\eta$, so that the printed ones tell the viscosity, with the
density of all particles, on each of which the force acts, and the half-width $h$ of a quarter of the box. We run both
temperatures of the paper, $kT = 1$ and 0.5, in a box of 20 along the gradient ($h = 5$); half that width would give a
quarter of the velocities. At the quick size the box is 10 along the flow and 5 along the vorticity. The runs at
$kT = 1$ are those of fig. 17. Four half-channels a run are laid on each other, and errors are of their scatter, in
claims about twice as large for the tails of Student's t. The viscosities are of momentum balance, without a formula for
the stress, so that pairwise and total make no difference here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tether.paper import COLORS, Claim, Comparison, Findings, Panel, Part, Series, judged, near
from tether.paper.channel import Channel, channels_of, mean_for_verdict, mean_of_rows
from tether.theory.flows import reverse_poiseuille_viscosity

MAXIMA = {0.4: 3.94, 1.0: 11.32}
"""The paper's largest velocity at each force, section 4.8."""
TEMPERATURES = {"warm": 1.0, "cold": 0.5}
WITHIN = 0.05
"""Relative: a largest velocity that far from the paper's is the paper's."""

_LOOKS = {
    (1.0, 0.4): (COLORS[0], "o"), (1.0, 1.0): (COLORS[2], "s"), (0.5, 0.4): (COLORS[3], "^"),
    (0.5, 1.0): (COLORS[4], "D"),
}  # fmt: skip

Rows = NDArray[np.float64]


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Profiles at both temperatures and forces, against the parabola and the printed maxima."""
    channels = {part: channels_of(parts[part]) for part in TEMPERATURES}
    hours = sum(part.core_hours for part in parts.values())
    tables = {
        "profile": pd.DataFrame([row for part in channels for row in _profile_rows(part, channels[part])]),
        "maxima": pd.DataFrame([row for part in channels for row in _maximum_rows(part, channels[part])]),
    }
    claims = [*_of_shape(channels["warm"][0.4], hours), *_of_maxima(channels, hours)]
    return Findings(tables, claims, _notes(channels))


def panels(findings: Findings) -> list[Panel]:
    """The profile at g = 0.4 with the parabola of the same flow rate; all velocities over their largest."""
    profile = findings.tables["profile"]
    warm = profile[(profile["temperature"] == 1.0) & (profile["force"] == 0.4)]
    position = r"distance from the centerline $\xi$ (DPD units)"
    first = Panel(
        "$g = 0.4$, $kT = 1$", position, "velocity $u_x$ (DPD units)",
        [
            Series("measured", warm["distance"], warm["velocity"], warm["velocity_error"], color=COLORS[0]),
            Series(
                "parabola of the same flow rate", warm["distance"], warm["parabola"], kind="dashed", color=COLORS[1]
            ),
        ],
        levels=[(MAXIMA[0.4], "the paper's maximum")],
    )  # fmt: skip
    others = []
    for (temperature, force), (color, marker) in _LOOKS.items():
        chosen = profile[(profile["temperature"] == temperature) & (profile["force"] == force)]
        others.append(
            Series(
                f"$kT = {temperature:g}$, $g = {force:g}$", chosen["distance"], chosen["scaled"],
                chosen["scaled_error"], color=color, marker=marker,
            )
        )  # fmt: skip
    parabola = 1.0 - (warm["distance"] / _half_width(warm["distance"].to_numpy())) ** 2
    others.append(Series("parabola", warm["distance"], parabola, kind="dashed", color=COLORS[1]))
    return [first, Panel("over the largest", position, "$u_x$ over its largest", others)]


def _half_width(middles: Rows) -> float:
    return float(middles[-1] + 0.5 * (middles[1] - middles[0]))


# --- numbers ---


def parabola(channel: Channel) -> Rows:
    """Of the same mean velocity in each half-channel and 0 at the wall: its means over the bins, (n, bins)."""
    edges = np.arange(channel.bins + 1) / channel.bins
    shape = 1.0 - np.diff(edges**3) * channel.bins / 3.0  # the mean of 1 - x^2 over each bin
    return np.asarray(1.5 * channel.velocity.mean(axis=1, keepdims=True) * shape)


def _bluntness(channel: Channel) -> Rows:
    """Mean over maximum, (n,): 2/3 of a parabola, 1 of a plug."""
    return np.asarray(channel.velocity.mean(axis=1) / channel.maximum_velocity)


def _steepness(channel: Channel) -> Rows:
    """The slope between the two bins next to the wall, over that of the parabola of the same mean, (n,)."""
    measured, expected = (each[:, -2] - each[:, -1] for each in (channel.velocity, parabola(channel)))
    return np.asarray(measured / expected)


def _of_shape(channel: Channel, hours: float) -> list[Claim]:
    return [
        judged(
            "The velocity profile is no longer parabolic: it flattens near the center.", "section 4.8, fig. 18",
            "mean over largest velocity at g = 0.4 above the 2/3 of a parabola",
            [Comparison(mean_for_verdict(_bluntness(channel)), 2.0 / 3.0, name="mean over largest")], hours,
        ),
        judged(
            "It steepens near the wall.", "section 4.8, fig. 18",
            "slope next to the wall over that of the parabola of the same flow rate above 1, at g = 0.4",
            [Comparison(mean_for_verdict(_steepness(channel)), 1.0, name="slope over the parabola's")], hours,
        ),
    ]  # fmt: skip


def _of_maxima(channels: Mapping[str, Mapping[float, Channel]], hours: float) -> list[Claim]:
    claims = []
    for force, printed in MAXIMA.items():
        found = {
            part: near(
                mean_for_verdict(channels[part][force].maximum_velocity), printed, WITHIN * printed, f"kT = {kT:g}"
            )
            for part, kT in TEMPERATURES.items()
        }
        claim = judged(
            f"The largest velocity is {printed:g} for g = {force:g}.", "section 4.8",
            f"at kT = 1, in a box of 20 along the gradient, {printed:g} within {WITHIN:.0%}", [found["warm"]], hours,
        )  # fmt: skip
        claims.append(claim.with_remark(f"the paper does not say at which kT: here {found['cold']}"))
    return claims


def _notes(channels: Mapping[str, Mapping[float, Channel]]) -> list[str]:
    channel = channels["warm"][0.4]
    told = []
    for force, printed in MAXIMA.items():
        viscosity = reverse_poiseuille_viscosity(
            maximum_velocity=printed, force=force, density=channel.density.mean(), length=4.0 * channel.half_width
        )
        told.append(f"{viscosity:.3g} (g = {force:g})")
    heat = mean_of_rows(channels["warm"][1.0].near_wall(channels["warm"][1.0].temperature, 0.5))
    return [
        f"The printed maxima tell an apparent viscosity of {' and '.join(told)}, at the density of all particles.",
        f"At g = 1 and kT = 1 the kinetic temperature next to the wall is {heat}.",
        "The series of Pan et al. (2010a), which the paper calls comparable, is not available as numbers.",
    ]


# --- tables ---


def _profile_rows(part: str, channels: Mapping[float, Channel]) -> Iterator[dict[str, object]]:
    for force, channel in channels.items():
        same_rate = parabola(channel).mean(axis=0)
        scaled = channel.velocity / channel.maximum_velocity[:, None]
        for place, xi in enumerate(channel.distance):
            velocity, over = mean_of_rows(channel.velocity[:, place]), mean_of_rows(scaled[:, place])
            yield {
                "temperature": TEMPERATURES[part], "force": force, "distance": xi,
                "velocity": velocity.value, "velocity_error": velocity.error, "parabola": same_rate[place],
                "scaled": over.value, "scaled_error": over.error,
            }  # fmt: skip


def _maximum_rows(part: str, channels: Mapping[float, Channel]) -> Iterator[dict[str, object]]:
    """Largest velocities and what they tell, beside the printed ones."""
    for force, channel in channels.items():
        numbers = {
            "maximum": channel.maximum_velocity,
            "mean_over_maximum": _bluntness(channel),
            "slope_over_parabola": _steepness(channel),
            "apparent_viscosity": reverse_poiseuille_viscosity(
                maximum_velocity=channel.maximum_velocity, force=force, density=channel.density.mean(axis=1),
                length=4.0 * channel.half_width,
            ),
            "viscosity_at_wall": channel.viscosity[:, -1],
        }  # fmt: skip
        row: dict[str, object] = {"temperature": TEMPERATURES[part], "force": force, "paper_maximum": MAXIMA[force]}
        for name, values in numbers.items():
            found = mean_of_rows(values)
            row |= {name: found.value, f"{name}_error": found.error}
        yield row
