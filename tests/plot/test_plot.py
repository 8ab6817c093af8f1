"""Pictures: written whole, in both formats, with what they must say; matplotlib's globals left alone."""

from __future__ import annotations

import math
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

from tether.estimate import Estimate
from tether.measurement import total_stress
from tether.plot import plot_profile, plot_relative, plot_series

SVG_TEXT = "{http://www.w3.org/2000/svg}text"


def made_up_series(samples: int, dimension: int, rate: float) -> xr.Dataset:
    generator = np.random.default_rng(1)
    axes = ["x", "y", "z"][:dimension]
    means = {"kinetic": -4.0, "conservative": -28.0, "dissipative": 0.0, "random": 7.0, "body": -1.0}
    variables = {}
    for term, mean in means.items():
        stress = generator.normal(0.0, 0.1, (samples, dimension, dimension)) + mean * np.eye(dimension)
        stress[:, 0, 1] += rate
        variables[f"stress_{term}"] = (("time", "row", "column"), stress)
    variables["temperature"] = (("time",), 1.0 + generator.normal(0.0, 0.01, samples))
    coordinates = {"time": 0.05 * np.arange(1, samples + 1), "row": axes, "column": axes}
    return xr.Dataset(variables, coords=coordinates, attrs={"shear_rate": rate})


def text_of(path) -> str:
    """All words of an SVG, without the spaces between them: formulas are written letter by letter."""
    root = ET.parse(path).getroot()
    return "".join("".join("".join(element.itertext()).split()) for element in root.iter(SVG_TEXT))


def check_pictures(paths, stem) -> str:
    """Both files are there under the right names; the PNG has a drawing on white. Returns the SVG's text."""
    assert [path.name for path in paths] == [f"{stem.name}.png", f"{stem.name}.svg"]
    pixels = imread(paths[0])
    assert pixels.shape[0] > 500
    assert pixels.shape[1] > 500
    assert 0.001 < np.mean(pixels[..., :3].min(axis=2) < 0.9) < 0.5
    return text_of(paths[1])


def test_total_stress_leaves_the_random_term_out():
    series = made_up_series(400, 3, 0.2)
    total = total_stress(series)
    assert total.dims == ("time", "row", "column")
    assert float(total.sel(row="x", column="x").mean()) == pytest.approx(-33.0, abs=0.1)
    assert float(total.sel(row="x", column="y").mean()) == pytest.approx(0.8, abs=0.1)


def test_series_under_shear(tmp_path):
    """A dot in the name stays; the viscosity is S_xy over the rate, of either sign."""
    stem = tmp_path / "rate.0.2"
    paths = plot_series(made_up_series(3000, 2, -0.2), stem, "squares", temperature=1.0)
    text = check_pictures(paths, stem)
    assert "squares" in text
    assert "viscosity4.0" in text
    assert "\N{PLUS-MINUS SIGN}" in text
    assert "meansover0.6" in text


def test_short_series_at_rest(tmp_path):
    text = check_pictures(plot_series(made_up_series(20, 3, 0.0), tmp_path / "rest", "rest"), tmp_path / "rest")
    assert "pressure" in text
    assert "33(tooshortforanerror)" in text
    assert "viscosity" not in text


def test_single_sample(tmp_path):
    stem = tmp_path / "one"
    assert "tooshort" in check_pictures(plot_series(made_up_series(1, 2, 0.0), stem, "one"), stem)


def test_profile(tmp_path):
    y = np.linspace(0.5, 9.5, 10)
    error = np.full(10, 0.01)
    error[3] = math.nan
    stem = tmp_path / "profile"
    text = check_pictures(plot_profile(y, 0.2 * y + 0.01, error, 0.2 * y, stem, "cubes"), stem)
    for word in ("cubes", "imposed", "measured", "DPDunits"):
        assert word in text


def test_relative(tmp_path):
    eta_r = Estimate(2.7, 0.03, samples=1000, inefficiency=3.0, converged=True, blocks=50)
    short = Estimate(2.5, math.nan, samples=10, inefficiency=3.0, converged=False)
    stem = tmp_path / "relative"
    text = check_pictures(plot_relative(0.3333, eta_r, 3, stem, pairwise=short), stem)
    for words in ("Einstein", "Krieger-Dougherty", "thisrun:2.70", "2.5(tooshortforanerror)", "3D"):
        assert words in text


@pytest.mark.parametrize(("phi", "value"), [(0.0099, 0.98), (0.9, 30.0)])
def test_relative_at_the_ends(tmp_path, phi, value):
    eta_r = Estimate(value, 0.05 * value, samples=1000, inefficiency=3.0, converged=True, blocks=50)
    stem = tmp_path / "relative"
    check_pictures(plot_relative(phi, eta_r, 2, stem), stem)


def test_same_bytes_and_globals_left_alone(tmp_path):
    before = dict(mpl.rcParams)
    eta_r = Estimate(2.7, 0.03, samples=1000, inefficiency=3.0, converged=True, blocks=50)
    first = plot_relative(0.3, eta_r, 3, tmp_path / "first")
    second = plot_relative(0.3, eta_r, 3, tmp_path / "second")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
    assert dict(mpl.rcParams) == before
