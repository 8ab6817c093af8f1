"""Comparison: what the pictures of a run draw beside its measurements."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether.analysis.momentum_balance import stress_at_edges
from tether.estimate import Estimate
from tether.flows import Oscillatory, Stages
from tether.plot.pictures import _Pictures


class Comparison(_Pictures):
    """The same as the pictures compare with, so that a page and they agree."""

    @property
    def over_time(self) -> xr.Dataset:
        """The series."""
        return self._series

    def mean(self, name: str) -> Estimate | None:
        """A mean of the summary; None where the run has none."""
        return self._mean(name)

    def flow_energy(self) -> dict[str, float]:
        """What the mean flow of a driven flow adds to "temperature" and "pressure" of the series."""
        return (self._flow_energy() or {}) if self.configuration.flow.is_driven else {}

    def velocity(self, profiles: xr.Dataset) -> tuple[NDArray[np.float64], str] | None:
        """A velocity at each y to compare with, and what it is."""
        return self._expected(profiles)

    def cycle(self) -> float | None:
        """Time after which the flow comes again; None where it does not."""
        flow, timestep = self.configuration.flow, self.configuration.run.timestep
        if isinstance(flow, Oscillatory):
            return 2.0 * math.pi / flow.angular_frequency
        return flow.cycle(timestep) * timestep if isinstance(flow, Stages) else None

    def applied_stress(self) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """Heights from one side of the box to the other, and the S_xy that a driving force asks for there."""
        if not self.configuration.flow.is_driven or "profiles" not in self.datasets:
            return None
        profiles, height = self.datasets["profiles"], self.configuration.box.size[1]
        stress = stress_at_edges(height, profiles["driving_force_density"].values)
        edges = np.arange(len(stress) + 1) * height / len(stress)
        return edges, np.concatenate([stress[-1:], stress])
