"""Storage and loss modulus of a suspension under oscillatory shear, and what is not linear in its answer.

The strain is gamma(t) = gamma_0 sin(omega t), the shear rate gamma_0 omega cos(omega t). With the stress positive in
tension the first harmonic of S_xy (the random term left out, whose mean is zero) defines

    S_xy(t) = gamma_0 (G' sin(omega t) + G'' cos(omega t)) + gamma_0 (G_3' sin(3 omega t) + G_3'' cos(3 omega t)) + ...

G' storage, in phase with the strain; G'' loss, in phase with the rate, positive and eta omega for a Newtonian
fluid; eta' = G''/omega and eta'' = G'/omega are the real and minus the imaginary part of the complex viscosity (R. B.
Bird, R. C. Armstrong and O. Hassager, Dynamics of Polymeric Liquids, vol. 1, 2nd ed., 1987, section 3.4). I_3/I_1 =
sqrt(G_3'^2 + G_3''^2)/sqrt(G'^2 + G''^2) tells how far the answer is from linear (K. Hyun et al., Prog. Polym. Sci. 36,
1697 (2011), doi 10.1016/j.progpolymsci.2011.02.002); even harmonics vanish by symmetry.

A sample is the mean of the stress over an interval h, so what is fitted to it is the mean of sin and cos over that
interval, exactly: over the m steps that end at times t - h + h/m, ..., t it is

    mean of sin(a t') = sin(a (t - h (1 - 1/m)/2)) D,    D = sin(a h/2)/(m sin(a h/(2 m))),

likewise cos, and for m -> infinity D = sin(a h/2)/(a h/2). The fit is by least squares over whole cycles. Its
coefficients are weighted sums of the samples; their errors come from blocking the weighted residuals, so all
correlations in time within and between cycles are in them, and a handful of cycles has an error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether.estimate import Estimate, estimate

MINIMUM_SAMPLES_OF_A_CYCLE = 8
"""A third harmonic needs more than six samples in a cycle."""


@dataclass(frozen=True)
class Moduli:
    """First and third harmonic of the stress under oscillatory shear; moduli are stresses (energy/length^d)."""

    storage: Estimate
    """G', in phase with the strain."""
    loss: Estimate
    """G'', in phase with the rate; eta omega of a Newtonian fluid."""
    third_storage: Estimate
    """G_3', of sin(3 omega t); zero in the limit of small strain, of either sign."""
    third_loss: Estimate
    """G_3'', of cos(3 omega t)."""
    third_harmonic: Estimate
    """I_3/I_1, without unit. Never negative, so noise alone lifts it: under two errors it says nothing."""
    dynamic_viscosity: Estimate
    """eta' = G''/omega: the viscosity, at low frequency."""
    complex_viscosity: Estimate
    """|eta*| = sqrt(G'^2 + G''^2)/omega."""
    mean_stress: Estimate
    """The stress that does not oscillate: zero by symmetry."""
    cycles: int
    """Whole cycles in the fit."""
    strain_amplitude: float
    angular_frequency: float


def moduli(
    time: NDArray[np.float64],
    stress: NDArray[np.float64],
    strain_amplitude: float,
    angular_frequency: float,
    interval_time: float,
    first_time: float = 0.0,
    *,
    steps_per_sample: int | None = None,
    skipped_cycles: int = 0,
    unit: str = "",
) -> Moduli:
    """Moduli from the shear stress under the strain strain_amplitude sin(omega (time - first_time)).

    time: ends of the samples' intervals, (n,), at distances interval_time. stress: S_xy without its random term, means
    over the intervals, (n,). angular_frequency: omega, 1/time. steps_per_sample: steps in an interval, each of which
    was measured; None for a mean over continuous time. skipped_cycles: cycles left out at the start, while the flow
    settles.
    """
    times, samples, cycles = _whole_cycles(time, stress, angular_frequency, interval_time, first_time, skipped_cycles)
    parts = [np.ones_like(times)]
    for order in (1, 3):
        parts += averaged_wave(times - first_time, order * angular_frequency, interval_time, steps_per_sample)
    basis = np.stack(parts, axis=1)
    weights = np.linalg.pinv(basis)  # (5, n): the fit's coefficients are weights @ samples
    coefficients = weights @ samples
    scale = np.array([1.0] + 4 * [1.0 / strain_amplitude])
    # To first order a coefficient is the mean of these, so blocking them gives its error.
    influence = scale * (coefficients + len(samples) * weights.T * (samples - basis @ coefficients)[:, None])

    def measured(function: Callable[[NDArray[np.float64]], float], its_unit: str) -> Estimate:
        return _of_coefficients(function, scale * coefficients, influence, its_unit)

    return Moduli(
        storage=measured(lambda g: g[1], unit),
        loss=measured(lambda g: g[2], unit),
        third_storage=measured(lambda g: g[3], unit),
        third_loss=measured(lambda g: g[4], unit),
        third_harmonic=measured(lambda g: math.hypot(g[3], g[4]) / math.hypot(g[1], g[2]), ""),
        dynamic_viscosity=measured(lambda g: g[2] / angular_frequency, f"{unit} time" if unit else ""),
        complex_viscosity=measured(
            lambda g: math.hypot(g[1], g[2]) / angular_frequency, f"{unit} time" if unit else ""
        ),
        mean_stress=measured(lambda g: g[0], unit),
        cycles=cycles,
        strain_amplitude=strain_amplitude,
        angular_frequency=angular_frequency,
    )


def averaged_wave(
    time: NDArray[np.float64], angular_frequency: float, interval_time: float, steps: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Means of sin(a t') and cos(a t') over the intervals that end at `time`; formula: see the module.

    steps: at which the interval is sampled, the last at `time`; None for all of it.
    """
    half = 0.5 * angular_frequency * interval_time
    if steps is None:
        lag, damping = half, math.sin(half) / half
    else:
        lag, damping = half * (1.0 - 1.0 / steps), math.sin(half) / (steps * math.sin(half / steps))
    phase = angular_frequency * time - lag
    return damping * np.sin(phase), damping * np.cos(phase)


def lissajous(
    time: NDArray[np.float64],
    stress: NDArray[np.float64],
    strain: NDArray[np.float64],
    shear_rate: NDArray[np.float64],
    angular_frequency: float,
    interval_time: float,
    first_time: float = 0.0,
    *,
    bins: int = 64,
    skipped_cycles: int = 0,
) -> xr.Dataset:
    """Stress against strain and rate over a cycle: means of all samples whose middle falls in a bin of the phase.

    time, stress: as for `moduli`; strain, shear_rate: means over the same intervals, (n,). Returns the variables
    stress, strain and shear_rate with their standard errors from the scatter between cycles (nan with one cycle), dims
    phase, middles of the bins from 0 to 2 pi. Bins that no sample falls in are left out.
    """
    times, table, _ = _whole_cycles(
        time,
        np.stack([stress, strain, shear_rate], axis=1),
        angular_frequency,
        interval_time,
        first_time,
        skipped_cycles,
    )
    turns = angular_frequency * (times - 0.5 * interval_time - first_time) / (2.0 * math.pi)
    cycle = np.floor(turns + 1e-9).astype(np.int64)  # 1e-9: a sample at a bin's very edge stands in the same each time
    phase_bin = np.floor((turns - cycle) * bins + 1e-6).astype(np.int64).clip(0, bins - 1)
    cycle -= cycle.min()
    cell = (cycle, phase_bin)
    count = np.zeros((cycle.max() + 1, bins))
    np.add.at(count, cell, 1.0)
    filled = count.sum(axis=0) > 0
    phase = 2.0 * math.pi * (np.arange(bins) + 0.5) / bins
    made: dict[str, tuple[str, NDArray[np.float64]]] = {}
    for name, column in zip(("stress", "strain", "shear_rate"), table.T, strict=True):
        total = np.zeros_like(count)
        np.add.at(total, cell, column)
        mean, error = _mean_over_cycles(total, count)
        made[name], made[f"{name}_error"] = ("phase", mean[filled]), ("phase", error[filled])
    return xr.Dataset(
        made,
        coords={"phase": ("phase", phase[filled], {"units": "radian"})},
        attrs={"title": "one cycle of oscillatory shear", "cycles": len(count)},
    )


def _mean_over_cycles(
    total: NDArray[np.float64], count: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean of each bin and its standard error from the means of the cycles that reached it; (cycles, bins) both."""
    reached = (count > 0).sum(axis=0)
    mean = total.sum(axis=0) / np.maximum(count.sum(axis=0), 1.0)
    deviation = np.where(count > 0, total / np.maximum(count, 1.0) - mean, 0.0)
    variance = (deviation**2).sum(axis=0) / np.maximum(reached - 1, 1) / np.maximum(reached, 1)
    return mean, np.where(reached > 1, np.sqrt(variance), math.nan)


def _of_coefficients(
    function: Callable[[NDArray[np.float64]], float],
    coefficients: NDArray[np.float64],
    influence: NDArray[np.float64],
    unit: str,
) -> Estimate:
    """function(coefficients), its error to first order by blocking slopes . influence.

    Slopes are central differences over one naive standard error of each coefficient, as in `estimate_function`.
    """
    steps = influence.std(axis=0) / math.sqrt(len(influence))
    value = float(function(coefficients))
    linear = np.full(len(influence), value)
    for index, step in enumerate(steps):
        if step == 0.0:
            continue
        shift = np.zeros_like(coefficients)
        shift[index] = step
        slope = (function(coefficients + shift) - function(coefficients - shift)) / (2.0 * step)
        linear += slope * (influence[:, index] - coefficients[index])
    return replace(estimate(linear, unit), value=value)


def _whole_cycles(
    time: NDArray[np.float64],
    columns: NDArray[np.float64],
    angular_frequency: float,
    interval_time: float,
    first_time: float,
    skipped_cycles: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Times and columns of the samples of all whole cycles after the skipped ones, and how many these are.

    Where a cycle is no whole number of samples the last is cut to the nearest one.
    """
    period = 2.0 * math.pi / angular_frequency
    if period < MINIMUM_SAMPLES_OF_A_CYCLE * interval_time * (1.0 - 1e-9):
        raise ValueError(
            f"a cycle of {period:.4g} has fewer than {MINIMUM_SAMPLES_OF_A_CYCLE} samples at an interval of"
            f" {interval_time:.4g} (its third harmonic would be lost); take samples at shorter intervals"
        )
    begin = first_time + skipped_cycles * period
    kept = np.flatnonzero(time - interval_time >= begin - 1e-6 * interval_time)
    cycles = math.floor((len(kept) * interval_time + 1e-6 * interval_time) / period)
    if cycles < 1:
        raise ValueError(
            f"the run has no whole cycle of {period:.4g} after {skipped_cycles} skipped ones (it ends at"
            f" {float(time[-1]) if len(time) else 0.0:.4g}); measure for longer"
        )
    kept = kept[: round(cycles * period / interval_time)]
    return time[kept], columns[kept], cycles
