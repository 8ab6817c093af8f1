"""Results: what the runs of a study have found, as a table, as means over repeats, and as a labelled dataset."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from tether import toml
from tether.files.whole import whole
from tether.study.folder import StudyFolder
from tether.study.ledger import extra_repeats
from tether.study.means import SIGNIFICANCE, Mean, chance_of_disagreement, mean_of
from tether.study.study import Point, Study
from tether.study.sweep import Setting
from tether.version import __version__

RELATIVE = {"relative_viscosity": "viscosity", "relative_viscosity_pairwise": "viscosity_pairwise"}
"""Quantities that are another one over its mean in the plain fluid."""

NUMBERS = (
    "steps", "shear_rate", "strain", "bodies", "solvent", "volume_fraction", "particle_fraction", "mass_fraction",
    "momentum_drift", "peclet", "reynolds", "particle_reynolds", "mach",
)  # fmt: skip
"""Of a run, without errors, in the order of the table."""

_PLAIN = "plain_fluid"

_OF_MEANS = ("repeats", *NUMBERS, "repeats_disagree")
"""Columns of a table of means that it has even where no setting has a finished run, but a plain fluid has."""


@dataclass(frozen=True)
class Results:
    """What the finished runs of a study have found."""

    runs: pd.DataFrame
    """A row for each finished run: swept keys, what it was, numbers, quantities each with its error."""
    means: pd.DataFrame
    """A row for each setting with a finished run: swept keys, numbers, mean and error of each quantity."""
    dataset: xr.Dataset
    """The same by swept keys and repeat; NaN where a run is missing."""

    @property
    def disagreement(self) -> str | None:
        """A sentence, if repeats scatter more than their errors allow in more means than chance explains."""
        repeated = self.means[self.means["repeats"] > 1]
        apart = sum(len(names.split(", ")) for names in repeated["repeats_disagree"] if names)
        tested = len(repeated) * len(_quantity_names(dict.fromkeys(self.means)))
        if chance_of_disagreement(apart, tested) >= SIGNIFICANCE:
            return None
        return (
            f"{apart} of {tested} means are over repeats that scatter more than their errors allow (column "
            f"repeats_disagree of means.csv; {SIGNIFICANCE * tested:.1f} are expected by chance); their errors have "
            "been made larger, give the runs more equilibration"
        )

    def write(self, folder: Path) -> list[Path]:
        """Write results.csv and .parquet, means.csv and .parquet, results.nc; returns the paths."""
        paths = []
        for name, table in {"results": self.runs, "means": self.means}.items():
            paths += [folder / f"{name}.csv", folder / f"{name}.parquet"]
            with whole(paths[-2]) as temporary:
                table.to_csv(temporary, index=False)
            with whole(paths[-1]) as temporary:
                table.to_parquet(temporary, index=False)
        paths.append(folder / "results.nc")
        with whole(paths[-1]) as temporary:
            self.dataset.to_netcdf(temporary, engine="h5netcdf")
        return paths


def results_of(study: Study, folder: StudyFolder) -> Results:
    """Gather what has been finished so far. Nothing in it depends on how or where the runs were made."""
    points = [*study.points, *extra_repeats(study, folder)]
    states = folder.states(points)
    done = [point for point in points if states[point.identity].kind == "done"]
    rows = {point.identity: _row(point, folder.summary(point)) for point in done}
    repeats: dict[int, list[Point]] = {}
    for point in done:
        repeats.setdefault(id(point.ensemble), []).append(point)
    runs, means = [], []
    for setting, ensemble, plain in zip(study.settings, study.ensembles, study.plain_fluids, strict=True):
        own = [rows[point.identity] for point in repeats.get(id(ensemble), [])]
        of_plain = [rows[point.identity] for point in repeats.get(id(plain), [])] if plain is not None else []
        relative = _Relative(own, of_plain)
        swept = {name: _scalar(value) for name, value in setting.values.items()}
        # Last again: where the table of all bodies is swept, it takes the place of their number.
        runs += [{**swept, "role": "suspension", **row, **relative.of(row), **swept} for row in own]
        if own:
            means.append({**swept, **_mean_row(own), **relative.means(), **swept})
    plain_rows = _plain_rows(study, rows, repeats)
    table = _ordered(runs + plain_rows, study)
    return Results(table, _ordered(means, study, _OF_MEANS), _dataset(study, runs, means))


def _plain_rows(
    study: Study, rows: Mapping[str, dict[str, Any]], repeats: Mapping[int, list[Point]]
) -> list[dict[str, Any]]:
    """The plain fluids' runs, with those swept keys that tell them apart."""
    found = []
    settings: dict[int, list[Setting]] = {}
    for setting, plain in zip(study.settings, study.plain_fluids, strict=True):
        if plain is not None:
            settings.setdefault(id(plain), []).append(setting)
    for number, shared in settings.items():
        first = shared[0].values
        same = {k: v for k, v in first.items() if all(other.values[k] == v for other in shared)}
        swept = {name: _scalar(value) for name, value in same.items() if not name.startswith("bodies")}
        found += [{**swept, "role": _PLAIN, **rows[point.identity]} for point in repeats.get(number, [])]
    return found


def _row(point: Point, summary: Mapping[str, Any]) -> dict[str, Any]:
    """What a run was, and what it found, without what depends on where and how fast it ran."""
    dimensionless, particles = summary["dimensionless"], summary["particles"]
    known = {**summary, **dimensionless, **particles}
    row: dict[str, Any] = {
        "repeat": point.repeat,
        "seed": summary["seed"],
        "folder": f"points/{point.identity}",
        **{name: known.get(name) for name in NUMBERS},
    }
    for name, entry in _quantities(summary).items():
        row[name], row[f"{name}_error"] = entry["value"], entry["error"]
    row["warnings"] = "; ".join(summary["warnings"])
    row["version"] = summary["version"]
    row["state_sha256"] = summary["state_sha256"]
    return row


def _quantities(summary: Mapping[str, Any]) -> dict[str, dict[str, float | None]]:
    """Whatever has a value and an error, by name."""
    found = {f"temperature_{of}": entry for of, entry in summary["temperature"].items() if _is_entry(entry)}
    return {**found, **{name: entry for name, entry in summary.items() if _is_entry(entry)}}


def _is_entry(entry: Any) -> bool:
    return isinstance(entry, dict) and entry.keys() == {"value", "error"}


def _quantity_names(row: Mapping[str, Any]) -> list[str]:
    return [name for name in row if f"{name}_error" in row]


class _Relative:
    """Viscosities of a setting over that of its plain fluid."""

    def __init__(self, own: Sequence[dict[str, Any]], plain: Sequence[dict[str, Any]]) -> None:
        self._own = own
        self._plain = {name: _mean(plain, name) for name in RELATIVE.values()} if plain else {}

    def of(self, row: Mapping[str, Any]) -> dict[str, float | None]:
        """Of one run."""
        found: dict[str, float | None] = {}
        for name, of in RELATIVE.items():
            if of in self._plain and row.get(of) is not None:
                error = math.nan if row[f"{of}_error"] is None else row[f"{of}_error"]
                found[name], found[f"{name}_error"] = _over(row[of], error, self._plain[of])
        return found

    def means(self) -> dict[str, float]:
        """Of the mean over repeats, and the plain fluid's own means."""
        found: dict[str, float] = {}
        for name, of in RELATIVE.items():
            if of not in self._plain:
                continue
            mean, plain = _mean(self._own, of), self._plain[of]
            found[name], found[f"{name}_error"] = _over(mean.value, mean.error, plain)
            found[f"{_PLAIN}_{of}"], found[f"{_PLAIN}_{of}_error"] = plain.value, plain.error
        return found


def _over(value: float, error: float, plain: Mean) -> tuple[float, float]:
    """value / plain with its error, to first order and taken to be independent."""
    ratio = value / plain.value
    return ratio, abs(ratio) * math.hypot(error / value, plain.error / plain.value)


def _mean(rows: Sequence[Mapping[str, Any]], name: str) -> Mean:
    values, errors = (
        [math.nan if row.get(key) is None else row[key] for row in rows] for key in (name, f"{name}_error")
    )
    return mean_of(values, errors, [row["steps"] for row in rows])


def _mean_row(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Means over repeats: numbers plainly, quantities with their errors, and those on which repeats disagree."""
    row: dict[str, Any] = {"repeats": len(rows)}
    for name in NUMBERS:
        known = [each[name] for each in rows if each[name] is not None]
        row[name] = sum(known) / len(known) if known else None
    apart = []
    for name in _quantity_names({key: None for each in rows for key in each}):
        mean = _mean(rows, name)
        row[name], row[f"{name}_error"] = mean.value, mean.error
        if not mean.agree:
            apart.append(name)
    row["repeats_disagree"] = ", ".join(apart)
    return row


def _ordered(rows: Sequence[dict[str, Any]], study: Study, always: Sequence[str] = ()) -> pd.DataFrame:
    """A table whose columns come in the order of the first rows that have them, numbers as numbers."""
    names = [name for axis in study.axes for name in axis.names]
    last = ("warnings", "repeats_disagree", "version", "state_sha256")
    seen = list(dict.fromkeys([*names, *always, *(key for row in rows for key in row)]))
    columns = [key for key in seen if key not in last] + [key for key in last if key in seen]
    table = pd.DataFrame(rows, columns=columns)
    for name in columns:
        if table[name].dtype == object:
            numbers = pd.to_numeric(table[name], errors="coerce")
            if numbers.notna().sum() == table[name].notna().sum():
                table[name] = numbers.astype(np.float64)
    return table


def _dataset(study: Study, runs: Sequence[dict[str, Any]], means: Sequence[dict[str, Any]]) -> xr.Dataset:
    """The tables by swept keys and repeat."""
    axes, dimension = study.axes, study.ensembles[0].configuration.dimension
    dims = tuple(axis.name for axis in axes)
    shape = tuple(len(axis) for axis in axes)
    repeats = max([row["repeat"] + 1 for row in runs], default=1)
    places = {tuple(_scalar(v) for v in each.values.values()): each.places for each in study.settings}
    swept = [name for axis in axes for name in axis.names]

    def gridded(rows: Sequence[dict[str, Any]], name: str, by_repeat: bool) -> NDArray[np.float64]:
        grid = np.full((*shape, repeats) if by_repeat else shape, math.nan)
        for row in rows:
            if (value := row.get(name)) is not None:
                place = places[tuple(row[key] for key in swept)]
                grid[(*place, row["repeat"]) if by_repeat else place] = value
        return grid

    variables: dict[str, Any] = {}
    quantities = _quantity_names({key: None for row in runs for key in row})
    for name in [*(name for name in NUMBERS if name not in swept), *quantities]:
        about = _about(name, dimension)
        variables[name] = ((*dims, "repeat"), gridded(runs, name, True), about)
        if name in quantities:
            words = {"units": about["units"], "long_name": f"standard error of the {about['long_name']}"}
            variables[f"{name}_error"] = ((*dims, "repeat"), gridded(runs, f"{name}_error", True), words)
    for name in _quantity_names({key: None for row in means for key in row}):
        about = _about(name, dimension)
        for key, of in {"": "mean over repeats of the", "_error": "standard error of the mean of the"}.items():
            grid = gridded(means, f"{name}{key}", False)
            variables[f"{name}_mean{key}"] = (dims, grid, {**about, "long_name": f"{of} {about['long_name']}"})
    variables["repeats"] = (dims, gridded(means, "repeats", False), {"units": "1", "long_name": "finished runs"})
    coordinates: dict[str, Any] = {"repeat": np.arange(repeats)}
    for axis in axes:
        for name, values in zip(axis.names, axis.values, strict=True):
            coordinates[name] = (axis.name, _coordinate(values), {"long_name": name})
    attributes = {"title": "tether: a study", "version": __version__, "dimension": dimension, "study": study.to_toml()}
    return xr.Dataset(variables, coordinates, attributes)


def _coordinate(values: Sequence[Any]) -> NDArray[Any]:
    plain = [_scalar(value) for value in values]
    return np.array(plain if not any(isinstance(value, str) for value in plain) else [str(v) for v in plain])


def _scalar(value: Any) -> Any:
    """A swept value as a table's entry: numbers as they are, lists and tables as they are written."""
    return value if isinstance(value, int | float | str) and not isinstance(value, bool) else toml.value(value)


_STRESS = re.compile(r"N[12]|pressure|.*modulus")
_VISCOSITY = re.compile(r"(plain_fluid_)?(dynamic_)?viscosity")


def _about(name: str, dimension: int) -> dict[str, str]:
    """Unit and description of a quantity, for the dataset."""
    stress = f"energy/length^{dimension}"
    if name.startswith("relative_"):
        units = "1"
    elif _VISCOSITY.match(name):
        units = f"{stress} time"
    elif _STRESS.match(name):
        units = stress
    elif name.startswith("temperature"):
        units = "energy"
    elif name.startswith("diffusion_rotational"):
        units = "1/time"
    elif name.startswith("diffusion"):
        units = "length^2/time"
    elif name.startswith(("spin", "shear_rate")):
        units = "1/time"
    elif name.startswith(("effective_radius", "contact_distance")):
        units = "length"
    elif name == "momentum_drift":
        units = "mass length/time"
    else:
        units = "1"
    return {"units": units, "long_name": name.replace("_", " ")}
