"""From what the engine sampled to a labelled series of physical quantities.

A sample is the mean over an interval of steps of what `core/observe/sample.hpp` takes at every step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether.config import Configuration
from tether.version import __version__

STRESS_TERMS = ("kinetic", "conservative", "dissipative", "random", "body")
"""Terms of the stress. The random term's mean is zero: it is kept, and left out of every sum."""


def pairwise_stress(series: xr.Dataset) -> xr.DataArray:
    """Kinetic + conservative + dissipative stress (the paper's eq. 16), dims (time, row, column)."""
    return series["stress_kinetic"] + series["stress_conservative"] + series["stress_dissipative"]


def total_stress(series: xr.Dataset) -> xr.DataArray:
    """Pairwise + body stress, dims (time, row, column); positive in tension."""
    return pairwise_stress(series) + series["stress_body"]


def freedom_of_constituents(configuration: Configuration, rotational: Sequence[int]) -> list[int]:
    """Degrees of freedom that the constituents of one body of each kind have together.

    d for each, or those of the center and of the rotation of a rigid body. rotational: rotational degrees of freedom of
    one body of each kind (the engine counts them).
    """
    d = configuration.dimension
    return [
        d + turns if bodies.model == "rigid" else d * len(shape.sites)
        for bodies, shape, turns in zip(configuration.bodies, configuration.geometries, rotational, strict=True)
    ]


@dataclass(frozen=True)
class Freedom:
    """Degrees of freedom behind each kinetic temperature.

    A particle has d of them, the constituents of a rigid body together those of its center and of its rotation. Total
    momentum is conserved, so a group of particles with a share f of the total mass M has d f fewer: <m v^2> =
    d kT (1 - m/M) of one particle. A force along x that acts on every particle differently leaves the total momentum
    as it is, too.
    """

    all: float
    solvent: float
    constituents: float
    constituents_raw: float
    """As if constituents of rigid bodies were as free as others: what the paper's fig. 19 seems to count."""
    body_translation: float
    body_rotation: float

    @classmethod
    def of(cls, configuration: Configuration, rotational: Sequence[int]) -> Freedom:
        """rotational: as `freedom_of_constituents` takes them."""
        d = configuration.dimension
        solvent = configuration.solvent_count
        counts = configuration.body_counts
        of_bodies = 1 - solvent * configuration.fluid.mass / configuration.total_mass  # share of the mass
        of_one = freedom_of_constituents(configuration, rotational)
        free = sum(count * freedom for count, freedom in zip(counts, of_one, strict=True))
        return cls(
            all=d * solvent + free - d,
            solvent=d * (solvent - 1 + of_bodies),
            constituents=free - d * of_bodies,
            constituents_raw=d * configuration.constituent_count - d * of_bodies,
            body_translation=d * (sum(counts) - of_bodies),
            body_rotation=sum(count * turns for count, turns in zip(counts, rotational, strict=True)),
        )


def series(
    samples: NDArray[np.float64],
    columns: Sequence[tuple[str, int]],
    steps: NDArray[np.int64],
    configuration: Configuration,
    freedom: Freedom,
) -> xr.Dataset:
    """Samples as a dataset: one variable a term, with labelled dimensions and units.

    samples: shape (n, values), in the engine's order of `columns`. steps: the last step of each sample, (n,).
    """
    d = configuration.dimension
    axes = list("xyz"[:d])
    turns = list("z") if d == 2 else list("xyz")
    parts = dict(
        zip(
            [name for name, _ in columns],
            np.split(samples, np.cumsum([width for _, width in columns])[:-1], axis=1),
            strict=True,
        )
    )
    stress_unit = "energy/length^3" if d == 3 else "energy/length^2"
    made: dict[str, tuple[tuple[str, ...], NDArray[np.float64], dict[str, str]]] = {}
    for term in STRESS_TERMS:
        made[f"stress_{term}"] = (
            ("time", "row", "column"),
            parts[f"stress_{term}"].reshape(-1, d, d),
            {"units": stress_unit, "long_name": f"stress, {term} term, positive in tension"},
        )
    thermal = {
        "temperature": (parts["thermal_solvent"] + parts["thermal_constituents"], freedom.all),
        "temperature_solvent": (parts["thermal_solvent"], freedom.solvent),
        "temperature_constituents": (parts["thermal_constituents"], freedom.constituents),
        "temperature_constituents_raw": (parts["thermal_constituents"], freedom.constituents_raw),
        "temperature_body_translation": (parts["thermal_translation"], freedom.body_translation),
    }
    if freedom.constituents_raw == freedom.constituents:
        del thermal["temperature_constituents_raw"]
    for name, (twice_energy, count) in thermal.items():
        if count > 0:
            of = name.removeprefix("temperature").replace("_", " ").strip() or "all particles"
            made[name] = (
                ("time",),
                twice_energy[:, 0] / count,
                {"units": "energy", "long_name": f"kinetic temperature of {of}"},
            )
    if configuration.bodies:
        inertia = parts["inertia"].reshape(-1, len(turns), len(turns))
        made["spin_energy"] = (
            ("time",), parts["spin_energy"][:, 0],
            {"units": "energy", "long_name": "sum over bodies of L . omega"},
        )  # fmt: skip
        made["spin"] = (
            ("time", "axis"), parts["spin"], {"units": "1/time", "long_name": "sum over bodies of omega"},
        )  # fmt: skip
        made["angular_momentum"] = (
            ("time", "axis"), parts["angular_momentum"],
            {"units": "mass length^2/time", "long_name": "sum over bodies of L about their centers"},
        )  # fmt: skip
        made["inertia"] = (
            ("time", "axis", "other_axis"), inertia,
            {"units": "mass length^2", "long_name": "sum over bodies of the moment of inertia"},
        )  # fmt: skip
    made["momentum"] = (
        ("time", "row"), parts["momentum"],
        {"units": "mass length/time", "long_name": "total momentum against the imposed profile"},
    )  # fmt: skip
    if configuration.flow.is_sheared and configuration.flow.shear_rate == 0:
        strain = configuration.flow.strain(steps, configuration.run.timestep)
        before = configuration.flow.strain(steps - configuration.series_interval, configuration.run.timestep)
        duration = configuration.series_interval * configuration.run.timestep
        made["strain"] = ("time",), strain, {"units": "1", "long_name": "imposed strain at the end of the interval"}
        made["shear_rate"] = (
            ("time",), (strain - before) / duration, {"units": "1/time", "long_name": "imposed shear rate, its mean"},
        )  # fmt: skip
    time = steps * configuration.run.timestep
    return xr.Dataset(
        made,
        coords={
            "time": ("time", time, {"units": "time", "long_name": "end of the sample's interval"}),
            "step": ("time", steps),
            "row": axes,
            "column": axes,
            "axis": turns,
            "other_axis": turns,
        },
        attrs={
            "title": "tether: stress and temperatures over time",
            "version": __version__,
            "configuration": configuration.to_toml(),
            "timestep": configuration.run.timestep,
            "shear_rate": configuration.flow.shear_rate,
            "steps_per_sample": configuration.series_interval,
        },
    )
