"""What stands against the means of a run, said in sentences."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tether.estimate import Estimate, drifts

if TYPE_CHECKING:
    from tether.result import Result

_ENOUGH_STRAIN = 5.0

_DRIFT = 3.5
"""Standard errors between the halves of a run; with ten means tested at once, some 0.5 % of good runs are warned of."""

_OFF = 0.02
"""Relative deviation from the set temperature that is worth a word, if it is beyond _SIGMAS errors."""

_OFF_WITHOUT_ERROR = 0.1
_SIGMAS = 3.0


def warnings_of(result: Result) -> list[str]:
    """Strain too short, means that drift, temperatures that are not the set one, means without an error."""
    found = []
    if result.configuration.flow.shear_rate != 0 and result.strain < _ENOUGH_STRAIN:
        found.append(
            f"the total strain is {result.strain:.3g}, less than {_ENOUGH_STRAIN:g} (the suspension may not have "
            "forgotten its start); run longer or shear faster"
        )
    flow = result.configuration.flow
    is_steady = not flow.is_sheared or flow.shear_rate != 0  # else nothing is stationary
    drifting = [name for name, values in result.over_time.items() if is_steady and _drifts(values)]
    if drifting:
        found.append(
            f"{_listed(drifting)} still {'drifts' if len(drifting) == 1 else 'drift'} (the first half of the run "
            "differs from the second); give it more equilibration"
        )
    found += [
        _off(result, of, temperature)
        for of, temperature in result.temperature.items()
        if temperature is not None and of != "constituents_raw" and _is_off(result, of, temperature)
    ]
    short = [name for name, mean in result.estimates.items() if mean is not None and not mean.converged]
    if short:
        found.append(
            f"the run is too short for an error of {_listed(short)} (it spans too few correlation times); run longer"
        )
    if result.fluctuations is not None:
        found += result.fluctuations.warnings
    if flow.is_driven and not result.flow_is_known:
        found.append(
            "temperatures, pressure and N1 have the energy of the flow in them (its profile has not been measured: no "
            "sample fell into the run); run longer, or give a smaller measure.profiles.every"
        )
    return found


def _drifts(values: NDArray[np.float64]) -> bool:
    z = drifts(values)
    if z is not None:
        return abs(z) > _DRIFT
    # A run that drifts as a whole is too correlated for an error of its halves: do its quarters go one way, and far?
    if len(values) < 8:
        return False
    quarters = np.array([part.mean() for part in np.array_split(values, 4)])
    steps = np.diff(quarters)
    scatter = values.std() / math.sqrt(len(values) / 4)
    return bool((np.all(steps > 0) or np.all(steps < 0)) and abs(quarters[-1] - quarters[0]) > 5 * scatter > 0)


def _is_off(result: Result, of: str, temperature: Estimate) -> bool:
    set_to = result.configuration.fluid.temperature
    off = abs(temperature.value - set_to)
    flow = result.configuration.flow
    is_unsteady = flow.is_sheared and flow.shear_rate == 0
    if not temperature.converged or is_unsteady or (of == "body_translation" and _is_agitated(result)):
        return off > _OFF_WITHOUT_ERROR * set_to  # bodies that meet in shear are agitated beyond kT
    return off > max(_OFF * set_to, _SIGMAS * temperature.error)


def _is_agitated(result: Result) -> bool:
    """Whether bodies are thrown off their paths where they meet."""
    flow = result.configuration.flow
    return flow.is_sheared or flow.is_driven


def _off(result: Result, of: str, temperature: Estimate) -> str:
    fluid = result.configuration.fluid
    bodies = result.configuration.bodies
    if fluid.gamma == 0:
        why, remedy = "without friction nothing holds it", "give fluid.noise or fluid.friction"
    elif of in ("all", "constituents", "body_rotation") and any(
        str(each.base).startswith("newton-euler") for each in bodies
    ):
        why, remedy = "a Newton-Euler base heats its constituents", 'use base = "massless"'
    elif of == "body_translation" and _is_agitated(result):
        why, remedy = "bodies that meet in shear are agitated beyond kT", "shear slower if it is to be heat alone"
    else:
        why = "the time step is too long, or the shear too fast for the thermostat"
        remedy = f"try run.timestep = {result.configuration.run.timestep / 2:g}"
    name = f"the temperature of {of.replace('_', ' ')}"
    return f"{name} is {temperature.value:.3g}, not {fluid.temperature:g} ({why}); {remedy}"


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
