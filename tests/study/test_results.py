"""What comes out: the tables and the dataset say the same, and nothing of where and how it was computed."""

from __future__ import annotations

import json
import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from small_studies import InThisThread, assert_same_study, copy_of, study

from tether.study import Results, Study, results_of, run_study
from tether.study.folder import StudyFolder

RATE, COUNT = "flow.shear_rate", "bodies.0.count"


def results(folder: Path) -> Results:
    found = StudyFolder.open(folder)
    return results_of(found.study(), found)


def change(path: Path, **entries) -> None:
    """Put other numbers into the summary of a run."""
    summary = json.loads(path.read_text())
    path.write_text(json.dumps(summary | entries))


def read(folder: Path, name: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """A table as both files have it. Text that is empty is missing in CSV; pandas may read a digit too few."""
    csv = pd.read_csv(folder / f"{name}.csv")
    texts = {
        column: csv[column].astype(object).fillna("") for column in ("warnings", "repeats_disagree") if column in csv
    }
    return csv.assign(**texts), pd.read_parquet(folder / f"{name}.parquet")


def test_csv_parquet_and_the_dataset_have_the_same_numbers(finished: Path) -> None:
    with xr.open_dataset(finished / "results.nc", engine="h5netcdf") as dataset:
        assert dict(dataset.sizes) == {RATE: 2, COUNT: 2, "repeat": 3}
        for name, of_means in (("results", False), ("means", True)):
            csv, parquet = read(finished, name)
            pd.testing.assert_frame_equal(csv, parquet, check_dtype=False, rtol=1e-14, atol=0.0)
            rows = parquet if of_means else parquet[parquet["role"] == "suspension"]
            assert len(rows) == (4 if of_means else 12)
            compared = 0
            for _, row in rows.iterrows():
                place = {RATE: row[RATE], COUNT: row[COUNT]} | ({} if of_means else {"repeat": row["repeat"]})
                for column, value in row.items():
                    if of_means and column.endswith("_error"):
                        variable = f"{column.removesuffix('_error')}_mean_error"
                    else:
                        variable = f"{column}_mean" if of_means and f"{column}_error" in row else column
                    if variable not in dataset or variable in dataset.coords or (of_means and variable == column):
                        continue
                    assert float(dataset[variable].sel(place)) == pytest.approx(value, rel=0, abs=0, nan_ok=True)
                    compared += 1
            assert compared > 25 * len(rows)


def test_every_variable_has_a_unit_and_a_description(finished: Path) -> None:
    dataset = results(finished).dataset
    for name, variable in dataset.data_vars.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    units = {name: dataset[name].attrs["units"] for name in dataset}
    assert units["viscosity"] == units["viscosity_pairwise_mean_error"] == "energy/length^2 time"
    assert units["plain_fluid_viscosity_mean"] == "energy/length^2 time"
    assert units["N1"] == units["pressure_mean"] == "energy/length^2"
    assert units["relative_viscosity_mean"] == units["volume_fraction"] == "1"
    assert units["shear_rate"] == "1/time"
    assert units["temperature_all"] == "energy"


def test_a_row_says_which_run_it_is(finished: Path) -> None:
    found = results(finished)
    points = StudyFolder.open(finished).study().points
    assert set(found.runs["folder"]) == {f"points/{point.identity}" for point in points}
    seeds = {f"points/{point.identity}": point.configuration.seed for point in points}
    for _, row in found.runs.iterrows():
        assert row["seed"] == seeds[row["folder"]]
        summary = json.loads((finished / row["folder"] / "summary.json").read_text())
        assert row["state_sha256"] == summary["state_sha256"]
        assert row["viscosity"] == summary["viscosity"]["value"]
        assert row["temperature_solvent"] == summary["temperature"]["solvent"]["value"]
        assert row["warnings"] == "; ".join(summary["warnings"])
    assert "performance" not in found.runs
    assert not [name for name in found.runs if "second" in name]


def test_plain_fluids_have_rows_of_their_own_with_what_tells_them_apart(finished: Path) -> None:
    runs = results(finished).runs
    plain = runs[runs["role"] == "plain_fluid"]
    assert len(plain) == 6
    assert sorted(plain[RATE]) == [0.5] * 3 + [1.0] * 3
    assert plain[COUNT].isna().all()
    assert (plain["bodies"] == 0).all()
    assert (plain["volume_fraction"].fillna(0) == 0).all()
    assert plain["relative_viscosity"].isna().all()
    assert len(results(finished).means) == 4, "no means of their own"


def test_missing_runs_are_nan_and_the_others_stay(finished: Path, tmp_path: Path) -> None:
    folder = copy_of(finished, tmp_path / "study")
    runs = results(folder).runs
    # All of the setting (1.0, 3), and the second repeat of (0.5, 2).
    gone = (runs[RATE] == 1.0) & (runs[COUNT] == 3) | (runs[RATE] == 0.5) & (runs[COUNT] == 2) & (runs["repeat"] == 1)
    assert gone.sum() == 4
    for path in runs[gone]["folder"]:
        (folder / path / "summary.json").unlink()
    found = results(folder)
    pd.testing.assert_frame_equal(found.runs, runs[~gone].reset_index(drop=True))
    assert list(found.means["repeats"]) == [2, 3, 3]
    viscosity = found.dataset["viscosity"]
    assert viscosity.shape == (2, 2, 3)
    assert viscosity.isnull().sum() == 4
    assert math.isnan(viscosity.sel({RATE: 0.5, COUNT: 2, "repeat": 1}))
    assert math.isnan(found.dataset["viscosity_mean"].sel({RATE: 1.0, COUNT: 3}))
    assert math.isnan(found.dataset["repeats"].sel({RATE: 1.0, COUNT: 3}))


def test_without_a_plain_fluid_there_is_no_relative_viscosity(finished: Path, tmp_path: Path) -> None:
    folder = copy_of(finished, tmp_path / "study")
    runs = results(folder).runs
    for path in runs[(runs["role"] == "plain_fluid") & (runs[RATE] == 0.5)]["folder"]:
        (folder / path / "summary.json").unlink()
    means = results(folder).means
    assert means[means[RATE] == 0.5]["relative_viscosity"].isna().all()
    assert means[means[RATE] == 1.0]["relative_viscosity"].notna().all()
    for path in runs[runs["role"] == "suspension"]["folder"]:
        (folder / path / "summary.json").unlink()
    found = results(folder)  # only plain fluids are left
    assert len(found.runs) == 3
    assert len(found.means) == 0
    assert found.disagreement is None
    assert found.write(folder)


def spoil(folder: Path, scatter: float) -> Results:
    """Viscosities of 6 +- 0.3 in the suspensions and 3 +- 0.06 in the plain fluids, and how far repeats differ."""
    runs = results(folder).runs
    for _, row in runs.iterrows():
        value, error = (3.0, 0.06) if row["role"] == "plain_fluid" else (6.0, 0.3)
        value += scatter * error * (row["repeat"] - 1)
        names = [name for name in runs if f"{name}_error" in runs and not name.startswith(("relative", "temperature"))]
        entries = {name: {"value": value, "error": error} for name in names}
        change(folder / row["folder"] / "summary.json", **entries)
    return results(folder)


def test_the_error_of_the_relative_viscosity_has_that_of_both(finished: Path, tmp_path: Path) -> None:
    found = spoil(copy_of(finished, tmp_path / "study"), scatter=0.0)
    third = math.sqrt(1 / 3)
    of_mean = 2.0 * math.hypot(0.05 * third, 0.02 * third)
    assert np.allclose(found.means["relative_viscosity"], 2.0, rtol=1e-12)
    assert np.allclose(found.means["relative_viscosity_error"], of_mean, rtol=1e-12)
    assert np.allclose(found.means["plain_fluid_viscosity_error"], 0.06 * third, rtol=1e-12)
    of_run = 2.0 * math.hypot(0.05, 0.02 * third)
    suspensions = found.runs[found.runs["role"] == "suspension"]
    assert np.allclose(suspensions["relative_viscosity_error"], of_run, rtol=1e-12)
    np.testing.assert_allclose(found.dataset["relative_viscosity_mean_error"], of_mean, rtol=1e-12)


def test_repeats_that_disagree_are_named_and_said(finished: Path, tmp_path: Path) -> None:
    """With repeats at -4, 0 and +4 errors chi^2 is 32, its 99 % point 9.2; at -1, 0 and +1 it is 2."""
    apart = spoil(copy_of(finished, tmp_path / "apart"), scatter=4.0)
    for names in apart.means["repeats_disagree"]:
        assert {"viscosity", "N1", "pressure"} <= set(names.split(", "))
    third = math.sqrt(1 / 3)
    assert np.allclose(apart.means["viscosity_error"], 0.3 * third * math.sqrt(32 / 2), rtol=1e-9)
    assert apart.disagreement is not None
    assert "scatter more than their errors allow" in apart.disagreement
    alike = spoil(copy_of(finished, tmp_path / "alike"), scatter=1.0)
    assert set(alike.means["repeats_disagree"]) == {""}
    assert alike.disagreement is None


def test_two_independent_executions_write_the_same_bytes(finished: Path, tmp_path: Path) -> None:
    """Of CSV, Parquet and netCDF alike, whatever else goes on at the same time."""
    asked = study(tmp_path)
    with ThreadPoolExecutor(2) as executor:
        run_study(asked, tmp_path / "study", executor, workers=2)
    assert_same_study(tmp_path / "study", finished)


def test_gathering_again_changes_nothing(finished: Path, tmp_path: Path) -> None:
    folder = copy_of(finished, tmp_path / "study")
    results(folder).write(folder)
    assert_same_study(folder, finished)


@pytest.mark.parametrize(
    ("sweep", "name", "labels"),
    [
        ('flow = [{kind = "couette", shear_rate = 0.5}, {kind = "rest"}]', "flow", 2),
        ("box.size = [[4.0, 4.0], [5.0, 4.0]]", "box.size", 2),
        ('bodies = [[{shape = "square", count = 2}], [{shape = "square", count = 3}], []]', "bodies", 3),
        ('start.bodies = ["lattice", "random"]', "start.bodies", 2),
    ],
)
def test_what_is_no_number_can_be_swept(tmp_path: Path, sweep: str, name: str, labels: int) -> None:
    found = run_study(study(tmp_path, f'base = "couette.toml"\n[sweep]\n{sweep}\n'), tmp_path / "study", InThisThread())
    assert found.dataset.sizes == {name: labels, "repeat": 1}
    assert len(set(found.dataset[name].values)) == labels
    assert found.dataset["pressure"].notnull().all()
    for _, row in found.runs.iterrows():
        assert float(found.dataset["pressure"].sel({name: row[name], "repeat": 0})) == row["pressure"]


def test_keys_that_change_together_are_one_dimension(tmp_path: Path) -> None:
    text = 'base = "couette.toml"\n[[sweep.zip]]\nflow.shear_rate = [0.5, 1.0]\nbodies.0.count = [3, 2]\n'
    found = run_study(study(tmp_path, text), tmp_path / "study", InThisThread())
    assert found.dataset.sizes == {RATE: 2, "repeat": 1}
    assert list(found.dataset[COUNT].values) == [3, 2]
    assert found.dataset[COUNT].dims == (RATE,)
    assert list(found.means[COUNT]) == [3, 2]


def test_a_study_can_be_made_and_run_in_python(tmp_path: Path) -> None:
    base = {
        "box": {"size": [4.0, 4.0]},
        "fluid": {"temperature": 1.0},
        "flow": {"kind": "couette", "shear_rate": 0.5},
        "run": {"timestep": 0.005, "steps": 50},
    }
    asked = Study(base=base, sweep={"flow": {"shear_rate": {"logspace": [0.1, 1.0, 3]}}}, repeats=2)
    with ThreadPoolExecutor(2) as executor:
        found = run_study(asked, tmp_path / "study", executor)
    assert found.dataset["viscosity"].shape == (3, 2)
    assert found.dataset["viscosity"].notnull().all()
    again = run_study(asked, str(tmp_path / "study"), InThisThread())
    xr.testing.assert_identical(again.dataset, found.dataset)
