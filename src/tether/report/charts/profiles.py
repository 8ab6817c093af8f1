"""Profiles across the gradient: velocity, temperature, density, particle fraction, and stress."""

from __future__ import annotations

import numpy as np
import xarray as xr

from tether.files.trajectory import velocity_profile
from tether.flows import imposed_velocity
from tether.plot.style import BLUE, GRAY, GREEN, ORANGE, SKY, UNITS, VERMILION, colored, words
from tether.record import Record
from tether.report.charts.comparison import Comparison
from tether.report.charts.panel import Panel, Scale, told
from tether.report.page import Chart

_Y = Scale(f"position along the gradient y ({UNITS})")


def velocity_charts(record: Record, comparison: Comparison) -> list[Chart]:
    """Mean velocity of the frames against the imposed one, in steady shear or at rest."""
    configuration, flow = comparison.configuration, comparison.configuration.flow
    if not record.trajectory_path.is_file() or flow.is_driven or (flow.is_sheared and flow.shear_rate == 0):
        return []
    first = int(comparison.over_time["step"][0]) - configuration.series_interval
    found = velocity_profile(record.trajectory_path, configuration, first)
    if found is None:
        return []
    y, velocity, error = found
    imposed = np.asarray(imposed_velocity(flow.shear_rate, y, configuration.box.size[1]))
    panel = Panel("Velocity, from the frames", _Y, Scale(f"velocity u<sub>x</sub> ({UNITS})"))
    panel.line(y, imposed, GRAY, "imposed")
    panel.points(y, velocity, error, BLUE, "measured")
    off = Panel("Velocity less the imposed one", _Y, Scale(f"measured \N{MINUS SIGN} imposed ({UNITS})"))
    off.across(0.0, dash="solid")
    off.points(y, velocity - imposed, error, BLUE)
    return [panel.chart(), off.chart()]


def profile_charts(profiles: xr.Dataset, comparison: Comparison) -> list[Chart]:
    """Of the dataset of `tether.observe.profiles`."""
    endings = ["_solvent", "_constituents"] if "density_constituents" in profiles else [""]
    has_rigid = any(bodies.model == "rigid" for bodies in comparison.configuration.bodies)
    velocity = Panel("Velocity", _Y, Scale(f"velocity u<sub>x</sub> ({UNITS})"))
    _groups(velocity, profiles, "velocity", endings)
    expected = comparison.velocity(profiles)
    if expected is not None:
        velocity.line(profiles["y"].values, expected[0], GRAY, expected[1])
    # Constituents of rigid bodies have fewer degrees of freedom than the profile counts.
    temperature = Panel("Temperature", _Y, Scale(f"temperature kT ({UNITS})"))
    _groups(temperature, profiles, "temperature", [e for e in endings if not (has_rigid and e == "_constituents")])
    wanted = comparison.configuration.fluid.temperature
    temperature.across(wanted, GRAY, f"set: {wanted:g}")
    density = Panel("Number density", _Y, Scale(f"number density ({UNITS})", from_zero=True))
    _groups(density, profiles, "density", endings)
    charts = [velocity.chart(), temperature.chart(), density.chart()]
    if "density_constituents" in profiles:
        charts += [_bodies(profiles), _fraction(profiles)]
    return charts if has_rigid else [*charts, _along_axes(profiles, wanted)]


def _groups(panel: Panel, profiles: xr.Dataset, name: str, endings: list[str]) -> None:
    for ending, color in colored(endings).items():
        label = words(ending.strip("_")) or "all particles"
        _draw(panel, profiles, f"{name}{ending}", color, label, hollow=ending == "_constituents")


def _draw(panel: Panel, profiles: xr.Dataset, name: str, color: str, label: str, *, hollow: bool = False) -> None:
    error = profiles[f"{name}_error"].values
    panel.points(profiles["y"].values, profiles[name].values, error, color, label, hollow=hollow)


def _bodies(profiles: xr.Dataset) -> Chart:
    names = [str(name).removeprefix("density_bodies_") for name in profiles if str(name).startswith("density_bodies_")]
    kinds = [name for name in names if not name.endswith("error")]
    panel = Panel("Number density of bodies", _Y, Scale(f"density of bodies ({UNITS})", from_zero=True))
    for kind, color in list(colored(["solvent", *kinds]).items())[1:]:
        _draw(panel, profiles, f"density_bodies_{kind}", color, words(kind))
    return panel.chart()


def _fraction(profiles: xr.Dataset) -> Chart:
    panel = Panel("Particle fraction", _Y, Scale("particle fraction", from_zero=True))
    _draw(panel, profiles, "particle_fraction", GREEN, "measured")
    mean = float((profiles["particle_fraction"] * profiles["density"]).sum() / profiles["density"].sum())
    panel.across(mean, GRAY, f"mean: {mean:.4f}")
    return panel.chart()


def _along_axes(profiles: xr.Dataset, wanted: float) -> Chart:
    """A flow that is not taken off shows along x."""
    panel = Panel("Temperature along each axis", _Y, Scale(f"temperature of all ({UNITS})"))
    along = [str(axis) for axis in profiles["axis"].values]
    y = profiles["y"].values
    for number, (axis, color) in enumerate(colored(along).items()):
        of_axis = profiles.sel(axis=axis)
        aside = (number - 0.5 * (len(along) - 1)) * 0.2 * float(y[1] - y[0])  # side by side, not one upon the other
        error = of_axis["temperature_axes_error"].values
        panel.points(y + aside, of_axis["temperature_axes"].values, error, color, f"along {axis}", size=5.0)
    panel.across(wanted, GRAY, f"set: {wanted:g}")
    return panel.chart()


def stress_charts(profile: xr.Dataset, comparison: Comparison) -> list[Chart]:
    """S_xy, what it is off from the expected one, and N1, of the dataset of `tether.observe.stress_profile`."""
    # Nothing holds constituents where both are the same.
    names = ["total"] if profile["stress_total"].equals(profile["stress_pairwise"]) else ["total", "pairwise"]
    applied = comparison.applied_stress()
    viscosity, rate = comparison.mean("viscosity"), comparison.configuration.flow.shear_rate
    uniform = viscosity * rate if viscosity is not None else None
    shear = Panel("Shear stress", _Y, Scale(f"shear stress S<sub>xy</sub> ({UNITS})"))
    for name, colors in zip(names, ((BLUE, SKY), (VERMILION, ORANGE)), strict=False):
        for color, (where, y, mean, error, marker) in zip(colors, _places(profile, name), strict=True):
            label = f"{name}, {where}"
            shear.points(y, mean, error, color, label, marker=marker, hollow=name == "pairwise")
    if applied is not None:
        shear.line(*applied, GRAY, "integral of the applied force")
    elif uniform is not None:
        shear.level(uniform, GRAY, f"whole box, total: {told(uniform)}")
    against = "applied" if applied is not None else "whole box" if uniform is not None else "mean"
    off = Panel("Total shear stress less the expected one", _Y, Scale(f"measured \N{MINUS SIGN} {against} ({UNITS})"))
    off.across(0.0)
    for color, (where, y, mean, error, marker) in zip((BLUE, SKY), _places(profile, "total"), strict=True):
        if applied is not None:
            expected = np.interp(y, *applied, period=comparison.configuration.box.size[1])
        else:
            expected = np.full(len(y), uniform.value if uniform is not None else float(np.mean(mean)))
        off.points(y, mean - expected, error, color, where, marker=marker)
    return [shear.chart(), off.chart(), _normal(profile, names, comparison)]


def _places(profile: xr.Dataset, name: str) -> list[tuple[str, np.ndarray, np.ndarray, np.ndarray, str]]:
    """Words, heights, S_xy, error and marker for bins and for the planes between them."""
    shear, error = (profile[f"stress_{name}{ending}"].sel(normal="y", force="x") for ending in ("", "_error"))
    through, its_error = (profile[f"stress_{name}_plane_y{ending}"].sel(force="x") for ending in ("", "_error"))
    return [
        ("in bins", profile["y"].values, shear.values, error.values, "o"),
        ("through planes", profile["plane_y"].values, through.values, its_error.values, "s"),
    ]


def _normal(profile: xr.Dataset, names: list[str], comparison: Comparison) -> Chart:
    panel = Panel(
        "First normal stress difference",
        _Y,
        Scale(f"N<sub>1</sub> = S<sub>xx</sub> \N{MINUS SIGN} S<sub>yy</sub> ({UNITS})"),
    )
    for name, color in zip(names, (BLUE, VERMILION), strict=False):
        along = [profile[f"stress_{name}"].sel(normal=axis, force=axis).values for axis in "xy"]
        errors = [profile[f"stress_{name}_error"].sel(normal=axis, force=axis).values for axis in "xy"]
        # The two errors as if independent; pressure, which both have, makes this an upper bound.
        error = np.hypot(*errors)
        panel.points(profile["y"].values, along[0] - along[1], error, color, name, hollow=name == "pairwise")
    difference = comparison.mean("N1")
    if difference is not None:
        panel.level(difference, GRAY, f"whole box, total: {told(difference)}")
    panel.across(0.0, dash="solid", width=0.7)
    return panel.chart()
