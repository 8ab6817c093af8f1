"""Stress in answer to what the flow does: over a cycle of oscillation, after a change of the rate, by fluctuation."""

from __future__ import annotations

import numpy as np
import xarray as xr

from tether.analysis.start_up import steady_stress
from tether.flows import Oscillatory
from tether.plot.green_kubo import in_bands
from tether.plot.style import BLUE, GRAY, UNITS, VERMILION, colored
from tether.report.charts.comparison import Comparison
from tether.report.charts.panel import Panel, Scale, told
from tether.report.page import Chart

_RATE = "\N{GREEK SMALL LETTER GAMMA}\N{COMBINING DOT ABOVE}"
_STRAIN = "\N{GREEK SMALL LETTER GAMMA}"
_STRESS = Scale(f"shear stress S<sub>xy</sub> ({UNITS})")


def lissajous_charts(cycle: xr.Dataset, comparison: Comparison) -> list[Chart]:
    """Mean stress of each phase against strain and against rate, with the ellipse of the linear response."""
    flow = comparison.configuration.flow
    assert isinstance(flow, Oscillatory)
    amplitude, frequency = flow.strain_amplitude, flow.angular_frequency
    storage, loss = comparison.mean("storage_modulus"), comparison.mean("loss_modulus")
    phase = np.linspace(0.0, 2.0 * np.pi, 200)
    lines = {"strain": amplitude * np.sin(phase), "shear_rate": amplitude * frequency * np.cos(phase)}
    scales = {"strain": Scale(f"strain {_STRAIN}"), "shear_rate": Scale(f"shear rate {_RATE} ({UNITS})")}
    charts = []
    for name, line in lines.items():
        panel = Panel(f"Stress against {name.replace('_', ' ')}, {cycle.attrs['cycles']} cycles", scales[name], _STRESS)
        if storage is not None and loss is not None:
            ellipse = amplitude * (storage.value * np.sin(phase) + loss.value * np.cos(phase))
            label = f"linear response, G\N{PRIME} = {told(storage)}, G\N{DOUBLE PRIME} = {told(loss)}"
            panel.line(line, ellipse, GRAY, label)
        panel.points(cycle[name].values, cycle["stress"].values, cycle["stress_error"].values, BLUE, "measured")
        panel.across(0.0, dash="solid", width=0.6)
        panel.upright(0.0)
        charts.append(panel.chart())
    return charts


def start_up_charts(curve: xr.Dataset, comparison: Comparison) -> list[Chart]:
    """Stress against time, and against the strain of each stage that shears, averaged over the cycles."""
    del comparison
    stages = sorted({int(stage) for stage in curve["stage"].values})
    parts = {stage: curve.isel(time=np.flatnonzero(curve["stage"].values == stage)) for stage in stages}
    colors = colored([str(stage) for stage in stages])
    repeats = int(curve.attrs["repeats"])
    of = f"mean of {repeats} cycles" if repeats > 1 else "one cycle, no error known"
    over_time = Panel(f"Stress over the stages, {of}", Scale(f"time since the start of the cycle ({UNITS})"), _STRESS)
    over_strain = Panel("Stress against strain", Scale("strain since the start of the stage"), _STRESS)
    for stage, part in parts.items():
        color, rate = colors[str(stage)], float(part["shear_rate"].values[0])
        label = f"stage {stage + 1}, {_RATE} = {rate:g}"
        stress, error = part["stress"].values, part["stress_error"].values
        over_time.band(part["time"].values, stress, error, color, label)
        if rate != 0.0:
            time = part["time"].values - part["time"].values[0] + 0.5 * float(curve.attrs["interval_time"])
            over_strain.band(np.abs(rate * time), stress, error, color, label)
            steady = steady_stress(curve, stage)
            over_strain.level(steady, color, f"its second half: {told(steady)}")
    for panel in (over_time, over_strain):
        panel.across(0.0, dash="solid", width=0.7)
    return [over_time.chart(), over_strain.chart()]


def green_kubo_charts(spectrum: xr.Dataset, comparison: Comparison) -> list[Chart]:
    """Mean amplitudes of the stress with the fitted model, and the integral of its autocorrelation over time."""
    if spectrum.sizes["frequency"] == 0:  # so few samples have no spectrum
        return []
    viscosity = comparison.mean("viscosity_green_kubo")
    amplitudes = Panel(
        "Spectrum of the stress", Scale(f"frequency f ({UNITS})", "log"),
        Scale(f"spectrum, \N{GREEK SMALL LETTER ETA} at f \N{RIGHTWARDS ARROW} 0 ({UNITS})", from_zero=True),
    )  # fmt: skip
    frequency, amplitude = spectrum["frequency"].values, spectrum["amplitude"].values
    error, model, weight = (spectrum[name].values for name in ("amplitude_error", "model", "weight"))
    # An amplitude scatters in proportion to its expected value: the fit's, where there is one, not its noisy own.
    relative = float(np.median(error / np.where(amplitude > 0, amplitude, np.nan)))
    bands = in_bands(frequency, amplitude, np.where(np.isfinite(model), model, amplitude), relative)
    amplitudes.points(*bands, BLUE, "means over bands")
    fitted = (weight > 0.0) & np.isfinite(model)
    if fitted.any():
        amplitudes.line(frequency[fitted], model[fitted], VERMILION, "fit")
    panels = [amplitudes]
    integral = comparison.datasets.get("green_kubo_integral")
    if integral is not None:
        running = Panel(
            "Running integral of the autocorrelation",
            Scale(f"time ({UNITS})"),
            Scale(f"running integral ({UNITS})", from_zero=True),
        )
        mean, its_error = integral["viscosity"].values, integral["viscosity_error"].values
        running.band(integral["time"].values, mean, its_error, BLUE, "integral")
        panels.append(running)
    if viscosity is not None and np.isfinite(viscosity.value):
        for panel in panels:
            panel.level(viscosity, VERMILION, f"viscosity: {told(viscosity)}")
    return [panel.chart() for panel in panels]
