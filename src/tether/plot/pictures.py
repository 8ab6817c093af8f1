"""All pictures of a run's folder."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether.analysis.momentum_balance import stress_at_edges
from tether.config import Configuration
from tether.errors import InputError
from tether.estimate import Estimate
from tether.files.trajectory import velocity_profile
from tether.flows import Couette, Kolmogorov, Oscillatory, Poiseuille, Stages, imposed_velocity
from tether.measurement import total_stress
from tether.plot.displacement import plot_displacement
from tether.plot.green_kubo import plot_green_kubo
from tether.plot.lissajous import plot_lissajous
from tether.plot.profile import plot_profile
from tether.plot.profiles import plot_profiles
from tether.plot.radial_distribution import plot_radial_distribution
from tether.plot.series import plot_series
from tether.plot.start_up import plot_start_up
from tether.plot.stress_profile import plot_stress_profile
from tether.record import Record


def draw(record: Record) -> list[Path]:
    """Draw whatever there is to draw, and return the paths. Raises InputError when there is nothing, or it is damaged.

    Of a run that has not ended, this is the series and the profile of the frames.
    """
    pictures = _Pictures(record)
    drawn = [*pictures.series(), *pictures.profile()]
    drawing: dict[str, Callable[[xr.Dataset, Path], list[Path]]] = {
        "profiles": pictures.profiles,
        "stress_profile": pictures.stress_profile,
        "radial_distribution": pictures.radial_distribution,
        "displacement": pictures.displacement,
        "lissajous": pictures.lissajous,
        "start_up": pictures.start_up,
        "green_kubo": pictures.green_kubo,
    }
    for name, draw_one in drawing.items():
        if name in pictures.datasets:
            drawn += draw_one(pictures.datasets[name], record.folder / name)
    return drawn


def title_of(configuration: Configuration) -> str:
    """What was run, in a line."""
    kind = "Plain fluid" if not configuration.bodies else "Suspension"
    phi = f", phi = {configuration.volume_fraction:.4f}" if configuration.bodies else ""
    return f"{kind} in {configuration.dimension}D{phi}, {_flow(configuration)}"


def _flow(configuration: Configuration) -> str:
    match configuration.flow:
        case Couette(shear_rate=rate):
            return f"shear rate {rate:g}"
        case Oscillatory(strain_amplitude=amplitude, angular_frequency=frequency):
            return f"oscillating shear, amplitude {amplitude:g}, frequency {frequency:g}"
        case Stages():
            return "shear in stages"
        case Poiseuille(force=force):
            return f"reverse Poiseuille flow, force {force:g}"
        case Kolmogorov(force=force, periods=periods):
            return f"Kolmogorov flow, force {force:g}" + (f", {periods} waves" if periods > 1 else "")
        case _:
            return "at rest"


class _Pictures:
    """What a folder holds, and the pictures made from it."""

    def __init__(self, record: Record) -> None:
        self.folder = record.folder
        self.configuration = record.configuration()
        self.title = title_of(self.configuration)
        self._series = record.series()
        if self._series.sizes["time"] < 2:
            raise InputError(
                f"{self.folder} has a series of one sample",
                "nothing can be drawn over time",
                "make it longer by tether resume",
            )
        self._trajectory = record.trajectory_path
        # What observers found belongs to the end of the run, and so does what it is compared with.
        has_ended = record.summary_path.is_file()
        self._summary: dict[str, Any] = record.summary() if has_ended else {}
        self.datasets = record.datasets() if has_ended else {}

    def series(self) -> list[Path]:
        flow, timestep = self.configuration.flow, self.configuration.run.timestep
        cycle = None
        if isinstance(flow, Oscillatory):
            cycle = 2.0 * math.pi / flow.angular_frequency
        elif isinstance(flow, Stages):
            cycle = flow.cycle(timestep) * timestep
        energy = self._flow_energy() if flow.is_driven else None
        # A run that has not ended has no profiles yet to take the flow off by.
        title = f"{self.title}; energy of the flow included" if flow.is_driven and energy is None else self.title
        return plot_series(
            self._series, self.folder / "series", title, temperature=self.configuration.fluid.temperature,
            flow_energy=energy, cycle=cycle,
        )  # fmt: skip

    def profile(self) -> list[Path]:
        """Of steady shear; at rest too, where it should be zero. Elsewhere the frames' mean has no imposed profile."""
        flow = self.configuration.flow
        if not self._trajectory.is_file() or flow.is_driven or (flow.is_sheared and flow.shear_rate == 0):
            return []
        first = int(self._series["step"][0]) - self.configuration.series_interval
        found = velocity_profile(self._trajectory, self.configuration, first)
        if found is None:
            return []
        y, velocity, error = found
        imposed = imposed_velocity(flow.shear_rate, y, self.configuration.box.size[1])
        return plot_profile(y, velocity, error, np.asarray(imposed), self.folder / "profile", self.title)

    def profiles(self, dataset: xr.Dataset, stem: Path) -> list[Path]:
        return plot_profiles(
            dataset, stem, self.title, expected=self._expected(dataset),
            temperature=self.configuration.fluid.temperature,
            has_rigid=any(bodies.model == "rigid" for bodies in self.configuration.bodies),
        )  # fmt: skip

    def stress_profile(self, dataset: xr.Dataset, stem: Path) -> list[Path]:
        applied = None
        if self.configuration.flow.is_driven and "profiles" in self.datasets:
            profiles = self.datasets["profiles"]
            height, bins = self.configuration.box.size[1], profiles.sizes["y"]
            stress = stress_at_edges(height, profiles["driving_force_density"].values)
            # From one side of the box to the other, whose last edge is the first.
            edges = np.arange(bins + 1) * height / bins
            applied = edges, np.concatenate([stress[-1:], stress])
        viscosity, rate = self._mean("viscosity"), self.configuration.flow.shear_rate
        uniform = viscosity * rate if viscosity is not None else None
        difference = self._mean("N1")
        return plot_stress_profile(dataset, stem, self.title, applied=applied, uniform=uniform, difference=difference)

    def radial_distribution(self, dataset: xr.Dataset, stem: Path) -> list[Path]:
        return plot_radial_distribution(dataset, stem, self.title, dimension=self.configuration.dimension)

    def displacement(self, dataset: xr.Dataset, stem: Path) -> list[Path]:
        return plot_displacement(dataset, stem, self.title)

    def lissajous(self, dataset: xr.Dataset, stem: Path) -> list[Path]:
        flow = self.configuration.flow
        assert isinstance(flow, Oscillatory)
        return plot_lissajous(
            dataset, stem, self.title, strain_amplitude=flow.strain_amplitude,
            angular_frequency=flow.angular_frequency, storage=self._mean("storage_modulus"),
            loss=self._mean("loss_modulus"),
        )  # fmt: skip

    def start_up(self, dataset: xr.Dataset, stem: Path) -> list[Path]:
        return plot_start_up(dataset, stem, self.title)

    def green_kubo(self, dataset: xr.Dataset, stem: Path) -> list[Path]:
        if dataset.sizes["frequency"] == 0:  # so few samples have no spectrum
            return []
        integral = self.datasets.get("green_kubo_integral")
        return plot_green_kubo(dataset, integral, stem, self.title, self._mean("viscosity_green_kubo"))

    def _mean(self, name: str) -> Estimate | None:
        entry = self._summary.get(name)
        if entry is None or entry["value"] is None:
            return None
        error = math.nan if entry["error"] is None else float(entry["error"])
        return Estimate(float(entry["value"]), error, 0, math.nan, converged=math.isfinite(error))

    def _flow_energy(self) -> dict[str, float] | None:
        """What the means of the series have in them that the summary, where the flow is taken off, has not."""
        if not self._summary:
            return None
        stress = total_stress(self._series)
        pressure = -float(np.trace(stress.mean("time").values)) / stress.sizes["row"]
        kinetic = float(self._series["temperature"].mean())
        return {
            "temperature": kinetic - float(self._summary["temperature"]["all"]["value"]),
            "pressure": pressure - float(self._summary["pressure"]["value"]),
        }

    def _expected(self, profiles: xr.Dataset) -> tuple[NDArray[np.float64], str] | None:
        """The imposed velocity, or in a driven flow that of a fluid of even viscosity under the force applied."""
        flow, height, y = self.configuration.flow, self.configuration.box.size[1], profiles["y"].values
        if not flow.is_driven:
            steady = not flow.is_sheared or flow.shear_rate != 0
            return (np.asarray(imposed_velocity(flow.shear_rate, y, height)), "imposed") if steady else None
        viscosity = self._mean("viscosity_momentum_balance")
        if viscosity is None:
            return None
        edges = stress_at_edges(height, profiles["driving_force_density"].values)
        # Means over bins of u, du/dy = S_xy/eta with S_xy linear within each bin, differ from bin to bin by this:
        step = (np.roll(edges, 1) + 4.0 * edges + np.roll(edges, -1)) / 6.0 * (height / len(y)) / viscosity.value
        velocity = np.concatenate([[0.0], np.cumsum(step[:-1])])
        weight = profiles["density"].values
        velocity += np.average(profiles["velocity"].values, weights=weight) - np.average(velocity, weights=weight)
        return velocity, f"uniform viscosity {viscosity.value:.3g}"
