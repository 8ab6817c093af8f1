"""The series as xarray reads it, and the checkpoint as HDF5."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr

import tether as tt
from tether.files.checkpoint import Checkpoint
from tether.files.whole import whole


def test_series_opens_in_plain_xarray(sheared: Any) -> None:
    with xr.open_dataset(sheared.folder / "series.nc") as series:
        series.load()
    d = sheared.simulation.configuration.dimension
    axes = list("xyz"[:d])
    assert dict(series.sizes) == {"time": 16, "row": d, "column": d, "axis": 2 * d - 3, "other_axis": 2 * d - 3}
    assert list(series["row"].values) == axes
    assert list(series["column"].values) == axes
    assert series["time"].values == pytest.approx(0.005 * np.arange(25, 101, 5))
    assert list(series["step"].values) == list(range(25, 101, 5))
    for term in ("kinetic", "conservative", "dissipative", "random", "body"):
        assert series[f"stress_{term}"].dims == ("time", "row", "column")
        assert series[f"stress_{term}"].dtype == np.float64
        assert np.isfinite(series[f"stress_{term}"].values).all()
    for name, variable in series.data_vars.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    assert series.attrs["version"] == tt.__version__
    assert series.attrs["shear_rate"] == 1.0
    assert series.attrs["timestep"] == 0.005
    assert series.attrs["steps_per_sample"] == 5
    assert "shear_rate = 1.0" in series.attrs["configuration"]
    xr.testing.assert_identical(series, sheared.result.series)


def test_the_numbers_of_the_result_come_from_the_series(sheared: Any) -> None:
    d = sheared.simulation.configuration.dimension
    with xr.open_dataset(sheared.folder / "series.nc") as series:
        terms = ("kinetic", "conservative", "dissipative", "body")
        total = sum(series[f"stress_{term}"] for term in terms).mean("time")
    result = sheared.result
    assert float(total.sel(row="x", column="y")) == pytest.approx(result.viscosity.value)
    normal = [float(total.sel(row=axis, column=axis)) for axis in "xyz"[:d]]
    assert -np.mean(normal) == pytest.approx(result.pressure.value)
    assert normal[0] - normal[1] == pytest.approx(result.N1.value)
    assert (result.N2 is None) == (d == 2)
    if d == 3:
        assert normal[1] - normal[2] == pytest.approx(result.N2.value)


# The checkpoint


def test_a_checkpoint_is_read_as_it_was_written(sheared: Any, tmp_path: Path) -> None:
    written = sheared.simulation.checkpoint()
    written.write(tmp_path / "checkpoint.h5")
    read = Checkpoint.read(tmp_path / "checkpoint.h5")
    assert read.configuration.to_toml() == written.configuration.to_toml()
    assert read.numbers == written.numbers
    assert read.offset == written.offset
    assert read.arrays.keys() == written.arrays.keys()
    for name, array in written.arrays.items():
        assert np.array_equal(read.arrays[name], array), name
    assert [each.name for each in tmp_path.iterdir()] == ["checkpoint.h5"]
    with h5py.File(tmp_path / "checkpoint.h5") as file:
        assert file["position"].dtype == np.float64
        assert file.attrs["version"] == tt.__version__


def test_every_flipped_bit_is_noticed(tmp_path: Path) -> None:
    """One in every 97th byte of the file in turn. (HDF5 itself notices few, and some crash it.)"""
    simulation = tt.Simulation(box=tt.Box(3, 3), fluid=tt.Fluid(temperature=1.0, density=1.0), timestep=0.005)
    simulation.run(steps=10)
    path = tmp_path / "checkpoint.h5"
    simulation.checkpoint().write(path)
    bits = path.read_bytes()
    for place in range(0, len(bits), 97):
        path.write_bytes(bits[:place] + bytes([bits[place] ^ 0x10]) + bits[place + 1 :])
        with pytest.raises(tt.InputError, match=r"checkpoint\.h5 is damaged .*; resume from another") as caught:
            Checkpoint.read(path)
        assert "\n" not in str(caught.value)


def test_a_file_is_written_as_a_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("former")

    def interrupted() -> None:
        with whole(path) as temporary:
            temporary.write_text("half of")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text() == "former"
    with whole(path) as temporary:
        temporary.write_text("new")
        assert path.read_text() == "former"
    assert path.read_text() == "new"
    assert [each.name for each in tmp_path.iterdir()] == ["file"]
