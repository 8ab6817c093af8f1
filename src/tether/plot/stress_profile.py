"""Stress across the gradient: in bins, through planes, and what the applied force asks for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from tether.estimate import Estimate
from tether.plot.style import (
    BLUE,
    DASHES,
    GRAY,
    ORANGE,
    SKY,
    UNITS,
    VERMILION,
    legend_above,
    level,
    points,
    put_title,
    save,
    style,
    typeset,
)

_NAMES = (("total", (BLUE, SKY), False), ("pairwise", (VERMILION, ORANGE), True))
"""Colors in bins and through planes, and whether signs are hollow."""


def plot_stress_profile(
    profile: xr.Dataset,
    path_stem: Path,
    title: str,
    *,
    applied: tuple[ArrayLike, ArrayLike] | None = None,
    uniform: Estimate | None = None,
    difference: Estimate | None = None,
) -> list[Path]:
    """S_xy against y, what it is off from the expected one beneath, and the first normal stress difference.

    profile: the dataset of `tether.observe.stress_profile`. applied: heights and the stress there that the balance of
    momentum asks for in a driven flow, shape (n,) each, periodic; or uniform: the mean stress of the whole box in
    steady shear. difference: the mean N1 of the total stress, drawn as a line. Writes path_stem with .png and .svg
    added and returns both paths.
    """
    with style():
        figure = Figure(figsize=(6.8, 7.4), layout="constrained")
        upper, middle, lower = figure.subplots(3, 1, sharex=True, height_ratios=[1.7, 1.0, 1.0])
        put_title(figure, title)
        _shear(upper, profile)
        if applied is not None:
            label = "integral of the applied force"
            upper.plot(*map(np.asarray, applied), color=GRAY, linewidth=1.2, label=label, zorder=2)
        elif uniform is not None:
            level(upper, uniform, GRAY, f"whole box, total: {typeset(uniform)}")
        upper.set_ylabel(f"shear stress $S_{{xy}}$\n({UNITS})")
        legend_above(upper, 2)
        _residual(middle, profile, applied, uniform)
        for name, (color, _), hollow in _names(profile):
            normal = [profile[f"stress_{name}"].sel(normal=axis, force=axis) for axis in "xy"]
            errors = [profile[f"stress_{name}_error"].sel(normal=axis, force=axis) for axis in "xy"]
            # The two errors as if independent; pressure, which both have, makes this an upper bound.
            error = np.hypot(*(each.values for each in errors))
            points(lower, profile["y"].values, (normal[0] - normal[1]).values, error, color, name, hollow=hollow)
        if difference is not None:
            level(lower, difference, GRAY, f"whole box, total: {typeset(difference)}")
        lower.axhline(0.0, color=GRAY, linewidth=0.7, zorder=1)
        lower.set_ylabel(f"$N_1 = S_{{xx}} - S_{{yy}}$\n({UNITS})")
        lower.set_xlabel(f"position along the gradient $y$ ({UNITS})")
        legend_above(lower)
        figure.align_ylabels()
        return save(figure, path_stem)


def _names(profile: xr.Dataset) -> tuple[tuple[str, tuple[str, str], bool], ...]:
    """Both stresses, or only the total, where nothing holds constituents and they are the same."""
    return _NAMES[:1] if profile["stress_total"].equals(profile["stress_pairwise"]) else _NAMES


def _shear(axes: Axes, profile: xr.Dataset) -> None:
    """In bins as discs, through planes, which stand at the bins' edges, as squares."""
    for name, colors, hollow in _names(profile):
        for color, (y, mean, error, marker, where) in zip(colors, _places(profile, name), strict=True):
            points(axes, y, mean, error, color, f"{name}, {where}", marker=marker, hollow=hollow)


def _residual(
    axes: Axes, profile: xr.Dataset, applied: tuple[ArrayLike, ArrayLike] | None, uniform: Estimate | None
) -> None:
    """What the total stress is off from the expected one; from its own mean where nothing is expected."""
    for color, (y, mean, error, marker, where) in zip((BLUE, SKY), _places(profile, "total"), strict=True):
        if applied is not None:
            heights, stress = (np.asarray(each, dtype=np.float64) for each in applied)
            expected = np.interp(y, heights, stress, period=_height(profile))
        else:
            expected = np.full(len(y), uniform.value if uniform is not None else float(np.mean(mean)))
        points(axes, y, mean - expected, error, color, f"total, {where}", marker=marker)
    axes.axhline(0.0, color=GRAY, linewidth=1.0, linestyle=DASHES, zorder=1)
    against = "applied" if applied is not None else "whole box" if uniform is not None else "mean"
    axes.set_ylabel(f"measured\n$-$ {against}")
    legend_above(axes, 2)


def _places(profile: xr.Dataset, name: str) -> list[tuple[np.ndarray, np.ndarray, np.ndarray, str, str]]:
    """Heights, S_xy, error, marker and words for bins and for planes."""
    shear, error = (profile[f"stress_{name}{ending}"].sel(normal="y", force="x") for ending in ("", "_error"))
    through, its_error = (profile[f"stress_{name}_plane_y{ending}"].sel(force="x") for ending in ("", "_error"))
    return [
        (profile["y"].values, shear.values, error.values, "o", "in bins"),
        (profile["plane_y"].values, through.values, its_error.values, "s", "through planes"),
    ]


def _height(profile: xr.Dataset) -> float:
    """Of the box: the bins are equal and the first begins at 0."""
    return float(2.0 * profile["y"].values[0] * profile.sizes["y"])
