"""Profiles across the gradient: velocity, temperature, density and particle fraction."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from tether.plot.style import (
    DASHES,
    GRAY,
    GREEN,
    UNITS,
    colored,
    legend_above,
    marked,
    points,
    put_title,
    save,
    style,
    words,
)

_POSITION = f"position along the gradient $y$ ({UNITS})"


def plot_profiles(
    profiles: xr.Dataset,
    path_stem: Path,
    title: str,
    *,
    expected: tuple[ArrayLike, str] | None = None,
    temperature: float | None = None,
    has_rigid: bool = False,
) -> list[Path]:
    """Velocity and temperature at the left, densities at the right, with their errors against y.

    profiles: the dataset of `tether.observe.profiles`. expected: a velocity at each y to compare with, shape (y,),
    length/time, and what it is, in a word or two. temperature: the set kT, drawn as a line. has_rigid: there are rigid
    bodies, whose constituents have fewer degrees of freedom than the profile counts; only the solvent's temperature is
    drawn then. Writes path_stem with .png and .svg added and returns both paths.
    """
    kinds = [str(name).removeprefix("density_bodies_") for name in profiles if _is_of_kind(str(name))]
    has_bodies = "density_constituents" in profiles
    rows = 3 if has_bodies else 2
    with style():
        figure = Figure(figsize=(9.0, 2.5 * rows + 0.4), layout="constrained")
        axes = figure.subplots(rows, 2, sharex=True, squeeze=False)
        put_title(figure, title)
        _velocity(axes[0, 0], profiles, expected)
        _temperature(axes[1, 0], profiles, temperature, has_rigid)
        along_axes = axes[rows - 1, 0] if has_bodies else axes[1, 1]
        if has_rigid:
            along_axes.remove()
            axes[1, 0].tick_params(labelbottom=True)
            axes[1, 0].set_xlabel(_POSITION)
        else:
            _temperature_axes(along_axes, profiles, temperature)
        _densities(axes[0, 1], profiles)
        if has_bodies:
            _bodies(axes[1, 1], profiles, kinds)
            _fraction(axes[2, 1], profiles)
        for bottom in axes[-1]:
            bottom.set_xlabel(_POSITION)
        figure.align_ylabels()
        return save(figure, path_stem)


def _velocity(axes: Axes, profiles: xr.Dataset, expected: tuple[ArrayLike, str] | None) -> None:
    for name, color in _groups(profiles).items():
        _draw(axes, profiles, f"velocity{name}", color, words(name.strip("_")) or "all particles", hollow=bool(name))
    if expected is not None:
        line, label = expected
        axes.plot(profiles["y"].values, np.asarray(line), color=GRAY, linewidth=1.2, label=label, zorder=2)
    axes.set_ylabel(f"velocity $u_x$ ({UNITS})")
    legend_above(axes)


def _temperature(axes: Axes, profiles: xr.Dataset, temperature: float | None, has_rigid: bool) -> None:
    for name, color in _groups(profiles).items():
        if has_rigid and name == "_constituents":
            continue
        _draw(axes, profiles, f"temperature{name}", color, words(name.strip("_")) or "all particles")
    if temperature is not None:
        marked(axes, temperature, "set")
    axes.set_ylabel(f"temperature $kT$ ({UNITS})")
    legend_above(axes)


def _temperature_axes(axes: Axes, profiles: xr.Dataset, temperature: float | None) -> None:
    """Along each axis, of all particles: a flow that is not taken off shows along x."""
    along = [str(axis) for axis in profiles["axis"].values]
    width = _spacing(profiles)
    for number, (axis, color) in enumerate(colored(along).items()):
        of_axis = profiles.sel(axis=axis)
        aside = (number - 0.5 * (len(along) - 1)) * 0.2 * width  # side by side, not one upon the other
        y, mean = of_axis["y"].values + aside, of_axis["temperature_axes"].values
        points(axes, y, mean, of_axis["temperature_axes_error"].values, color, f"along {axis}", size=2.8)
    if temperature is not None:
        marked(axes, temperature, "set")
    axes.set_ylabel(f"temperature of all ({UNITS})")
    legend_above(axes)


def _densities(axes: Axes, profiles: xr.Dataset) -> None:
    for name, color in _groups(profiles).items():
        _draw(axes, profiles, f"density{name}", color, words(name.strip("_")) or "all particles")
    axes.set_ylabel(f"number density ({UNITS})")
    legend_above(axes, from_zero=True)


def _bodies(axes: Axes, profiles: xr.Dataset, kinds: list[str]) -> None:
    for kind, color in list(colored(["solvent", *kinds]).items())[1:]:
        _draw(axes, profiles, f"density_bodies_{kind}", color, words(kind))
    axes.set_ylabel(f"density of bodies ({UNITS})")
    legend_above(axes, from_zero=True)


def _fraction(axes: Axes, profiles: xr.Dataset) -> None:
    _draw(axes, profiles, "particle_fraction", GREEN, None)
    mean = float((profiles["particle_fraction"] * profiles["density"]).sum() / profiles["density"].sum())
    axes.axhline(mean, color=GRAY, linewidth=0.9, linestyle=DASHES, zorder=1.5, label=f"mean {mean:.4f}")
    axes.set_ylabel("particle fraction")
    legend_above(axes, from_zero=True)


def _draw(axes: Axes, profiles: xr.Dataset, name: str, color: str, label: str | None, *, hollow: bool = False) -> None:
    y, mean = profiles["y"].values, profiles[name].values
    points(axes, y, mean, profiles[f"{name}_error"].values, color, label, hollow=hollow, size=2.6 if hollow else 3.6)


def _groups(profiles: xr.Dataset) -> dict[str, str]:
    """Colors of solvent and constituents where these are told apart, by the endings of their profiles' names."""
    names = ["_solvent", "_constituents"] if "density_constituents" in profiles else [""]
    return colored(names)


def _is_of_kind(name: str) -> bool:
    return name.startswith("density_bodies_") and not name.endswith("_error")


def _spacing(profiles: xr.Dataset) -> float:
    y: NDArray[np.float64] = profiles["y"].values
    return float(y[1] - y[0])
