"""What a run's series and observers tell beside the means of stress and temperature.

Other routes to the viscosity, moduli, structure and motion.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from tether.analysis.momentum_balance import kolmogorov_viscosity, work_viscosity
from tether.analysis.oscillatory import Moduli, lissajous, moduli
from tether.analysis.start_up import start_up
from tether.estimate import Estimate
from tether.flows import Kolmogorov, Oscillatory, Stages
from tether.observe.profiles import Profiles
from tether.observe.stress_profile import StressProfile

if TYPE_CHECKING:
    from tether.analysis.green_kubo import GreenKubo
    from tether.result import Result

_SCALARS = ("diffusion", "spin", "effective_radius", "contact_distance")
"""How the names of scalars begin, in the datasets of observers."""


def estimates(result: Result) -> dict[str, Estimate]:
    """Means that not every run has, by name."""
    found = _of_stress_profile(result)
    if (balance := momentum_balance(result)) is not None:
        found["viscosity_momentum_balance"] = balance
    if (fluctuations := result.fluctuations) is not None:
        found["viscosity_green_kubo"] = fluctuations.viscosity
    if (response := result.response) is not None:
        found["storage_modulus"] = response.storage
        found["loss_modulus"] = response.loss
        found["dynamic_viscosity"] = response.dynamic_viscosity
        found["third_harmonic"] = response.third_harmonic
    for dataset in result.observed.values():
        found |= _scalars(dataset)
    return found


def datasets(result: Result) -> dict[str, xr.Dataset]:
    """Functions of place, distance, lag, phase or frequency, by the name of the file that they go to."""
    found: dict[str, xr.Dataset] = {}
    configuration, time = result.configuration, result.series["time"].values
    if (fluctuations := result.fluctuations) is not None and fluctuations.spectrum.sizes["frequency"] > 0:
        from tether.analysis.green_kubo import running_integral

        interval = configuration.series_interval * configuration.run.timestep
        found["green_kubo"] = fluctuations.spectrum
        found["green_kubo_integral"] = running_integral(
            result.stress_with_noise, interval, configuration.box.volume, configuration.fluid.temperature
        )
    if isinstance(configuration.flow, Oscillatory) and result.response is not None:
        found["lissajous"] = lissajous(
            time, result.stress[:, 0, 1], *_imposed(result), configuration.flow.angular_frequency,
            configuration.series_interval * configuration.run.timestep,
        )  # fmt: skip
    if (curve := start_up_curve(result)) is not None:
        found["start_up"] = curve
    dimension = configuration.dimension
    return {**result.observed, **{name: _described(dataset, dimension) for name, dataset in found.items()}}


_WORDS = {
    "stress": ("{stress}", "shear stress S_xy"),
    "stress_of_repeat": ("{stress}", "shear stress S_xy in each repeat"),
    "strain": ("1", "imposed strain"),
    "shear_rate": ("1/time", "imposed shear rate"),
    "amplitude": ("{stress} time", "spectrum of the shear stress times V/(2 kT): at frequency 0 the viscosity"),
    "model": ("{stress} time", "the fitted model of the spectrum"),
    "weight": ("1", "weight of a frequency in the fit"),
    "correlation": ("{stress}", "autocorrelation of the shear stress times V/kT"),
    "viscosity": ("{stress} time", "its integral up to this time"),
    "stage": ("1", "number of the stage, from 0"),
    "phase": ("radian", "phase of the strain"),
    "time": ("time", "since the start of the cycle, or the upper end of the integral"),
    "lag": ("time", "lag"),
    "frequency": ("1/time", "frequency"),
}
"""Units and description of what the series tells as a function."""


def _described(dataset: xr.Dataset, dimension: int) -> xr.Dataset:
    """The dataset with a unit and a description of every variable."""
    for key in dataset.variables:
        name = str(key)
        known = _WORDS.get(name.removesuffix("_error"))
        if known is None:
            continue
        units, meaning = known[0].format(stress=f"energy/length^{dimension}"), known[1]
        of = "standard error of the " if name.endswith("_error") else ""
        dataset[name].attrs |= {"units": units, "long_name": f"{of}{meaning}"}
    return dataset


def momentum_balance(result: Result) -> Estimate | None:
    """The viscosity that the measured profile of a driven flow has under the force that drives it."""
    flow, profiles = result.configuration.flow, result.observers.get("profiles")
    if not flow.is_driven or not isinstance(profiles, Profiles):
        return None
    height = result.configuration.box.size[1]
    if profiles.samples == 0:
        return None
    rows = profiles.rows("driving_force_density"), profiles.rows("velocity")
    if not np.isfinite(rows[1]).all():  # a bin that is always empty has no velocity
        return None
    if isinstance(flow, Kolmogorov):
        return kolmogorov_viscosity(height, *rows, flow.periods)
    return work_viscosity(height, *rows)


def of_fluctuations(result: Result) -> GreenKubo | None:
    """The viscosity by Green and Kubo, of a run at rest that asks for it."""
    configuration = result.configuration
    if not configuration.measure.green_kubo:
        return None
    from tether.analysis.green_kubo import (
        green_kubo,
    )  # brings in matplotlib, which takes longer to import than all else

    interval = configuration.series_interval * configuration.run.timestep
    return green_kubo(result.stress_with_noise, interval, configuration.box.volume, configuration.fluid.temperature)


def of_oscillation(result: Result) -> Moduli | None:
    """The moduli of a run under oscillating shear that is as long as a cycle."""
    configuration, flow = result.configuration, result.configuration.flow
    if not isinstance(flow, Oscillatory):
        return None
    interval = configuration.series_interval * configuration.run.timestep
    time = np.asarray(result.series["time"].values)
    if len(time) * interval * flow.angular_frequency < 2 * math.pi:
        return None
    return moduli(
        time, result.stress[:, 0, 1], flow.strain_amplitude, flow.angular_frequency, interval,
        steps_per_sample=configuration.series_interval,
    )  # fmt: skip


def start_up_curve(result: Result) -> xr.Dataset | None:
    """Stress against time and strain within the cycle of a flow in stages; None before a whole cycle was measured."""
    configuration, flow = result.configuration, result.configuration.flow
    if not isinstance(flow, Stages):
        return None
    timestep = configuration.run.timestep
    cycle, interval = flow.cycle(timestep), configuration.series_interval
    begin = int(result.series["step"].values[0]) - interval
    first = -(-begin // cycle) * cycle  # cycles count from step 0, measuring may begin within one
    if result.steps - (first - begin) < cycle or (first - begin) % interval:
        return None
    stages = [(stage.shear_rate, stage.steps(timestep) * timestep) for stage in flow.stages]
    time = np.asarray(result.series["time"].values)
    return start_up(time, result.stress[:, 0, 1], stages, interval * timestep, first * timestep)


def _imposed(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Strain and shear rate, means over the samples."""
    return np.asarray(result.series["strain"].values), np.asarray(result.series["shear_rate"].values)


def _of_stress_profile(result: Result) -> dict[str, Estimate]:
    profile, rate = result.observers.get("stress_profile"), result.configuration.flow.shear_rate
    if not isinstance(profile, StressProfile) or profile.samples == 0:
        return {}
    found = {}
    if rate != 0:
        found["viscosity_planes"] = profile.plane_stress("y", "x") / rate
        found["viscosity_planes_pairwise"] = profile.plane_stress("y", "x", "pairwise") / rate
        found["N1_planes"] = profile.first_normal_stress_difference()
        found["N1_planes_pairwise"] = profile.first_normal_stress_difference("pairwise")
    found["temperature_configurational"] = profile.configurational_temperature()
    return {
        name: mean for name, mean in found.items() if math.isfinite(mean.value)
    }  # no repulsion, no such temperature


def _scalars(dataset: xr.Dataset) -> dict[str, Estimate]:
    """The variables without dimensions, each with its error."""
    found = {}
    for name, variable in dataset.data_vars.items():
        error = dataset.get(f"{name}_error")
        if variable.dims or error is None or not str(name).startswith(_SCALARS):
            continue
        value, uncertain = float(variable), float(error)
        if math.isfinite(value):
            found[str(name)] = Estimate(value, uncertain, 0, math.nan, converged=math.isfinite(uncertain))
    return found
