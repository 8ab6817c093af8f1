"""Pictures: written whole, in both formats, with what they must say; matplotlib's globals left alone."""

from __future__ import annotations

import math
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread
from scipy.stats import chi2

from tether.estimate import Estimate
from tether.measurement import total_stress
from tether.plot import (
    plot_displacement,
    plot_green_kubo,
    plot_lissajous,
    plot_profile,
    plot_profiles,
    plot_radial_distribution,
    plot_relative,
    plot_series,
    plot_start_up,
    plot_stress_profile,
)
from tether.plot.green_kubo import in_bands

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


def test_unsteady_series_show_the_rate_and_no_mean_of_the_stress(tmp_path):
    series = made_up_series(3000, 2, 0.0)
    series["shear_rate"] = ("time", np.sin(series["time"].values))
    stem = tmp_path / "unsteady"
    text = check_pictures(plot_series(series, stem, "oscillating", cycle=2.0 * math.pi), stem)
    assert "thelast4cycles" in text
    assert text.count("runningmean") == 1, "of the temperature"
    assert "imposedrate" in text
    assert "pressure" not in text


def test_the_energy_of_a_driven_flow_is_taken_off(tmp_path):
    series = made_up_series(400, 2, 0.0)
    stem = tmp_path / "driven"
    paths = plot_series(series, stem, "driven", flow_energy={"temperature": 0.5, "pressure": 3.0})
    text = check_pictures(paths, stem)
    assert "runningmean:30.0" in text
    assert "runningmean:0.50" in text


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


def with_errors(variables, coordinates, error=0.01):
    """A dataset in which every variable has an error, the last one's unknown."""
    made = {}
    for name, (dims, values) in variables.items():
        errors = np.full(np.shape(values), error)
        if errors.ndim:
            errors[..., -1] = math.nan
        made |= {name: (dims, values), f"{name}_error": (dims, errors)}
    return xr.Dataset(made, coords=coordinates)


def made_up_profiles(bodies=True):
    y = np.linspace(0.5, 9.5, 10)
    names = ("", "_solvent", "_constituents") if bodies else ("",)
    variables = {f"density{name}": ("y", np.full(10, 4.0)) for name in names}
    variables |= {f"velocity{name}": ("y", np.sin(y)) for name in names}
    variables |= {f"temperature{name}": ("y", np.ones(10)) for name in names}
    variables["temperature_axes"] = (("y", "axis"), np.ones((10, 2)))
    if bodies:
        variables |= {"density_bodies": ("y", np.full(10, 0.2)), "density_bodies_my_rod": ("y", np.full(10, 0.2))}
        variables["particle_fraction"] = ("y", np.full(10, 0.25))
    return with_errors(variables, {"y": y, "axis": ["x", "y"]})


def test_profiles(tmp_path):
    stem = tmp_path / "profiles"
    profiles = made_up_profiles()
    expected = np.sin(profiles["y"].values), "uniform viscosity 5"
    text = check_pictures(plot_profiles(profiles, stem, "squares", expected=expected, temperature=1.0), stem)
    for word in ("uniformviscosity5", "myrod", "mean0.2500", "errornotknown", "alongx", "alongy", "DPDunits"):
        assert word in text
    assert "alongz" not in text
    text = check_pictures(plot_profiles(made_up_profiles(bodies=False), stem, "fluid"), stem)
    assert "allparticles" in text
    assert "particlefraction" not in text


def test_profiles_show_no_temperature_of_rigid_constituents(tmp_path):
    """They have fewer degrees of freedom than the profile counts."""
    profiles, stem = made_up_profiles(), tmp_path / "rigid"
    both, one = (
        check_pictures(plot_profiles(profiles, stem, "rigid", has_rigid=rigid), stem) for rigid in (False, True)
    )
    assert both.count("constituents") == one.count("constituents") + 1
    assert "alongx" not in one


@pytest.mark.parametrize("same", [False, True])
def test_stress_profile(tmp_path, same):
    places, axes = np.linspace(0.5, 9.5, 10), ["x", "y"]
    variables = {}
    for name in ("total", "pairwise"):
        variables[f"stress_{name}"] = (("y", "normal", "force"), np.ones((10, 2, 2)) * (1.0 if same else len(name)))
        for plane in ("plane_y", "plane_x"):
            variables[f"stress_{name}_{plane}"] = ((plane, "force"), np.ones((10, 2)))
    coordinates = {"y": places, "plane_y": places - 0.5, "plane_x": places, "normal": axes, "force": axes}
    profile, stem = with_errors(variables, coordinates), tmp_path / "stress_profile"
    applied = np.linspace(0.0, 10.0, 11), np.zeros(11)
    text = check_pictures(plot_stress_profile(profile, stem, "squares", applied=applied), stem)
    assert "integraloftheappliedforce" in text
    assert "total,throughplanes" in text
    assert ("pairwise" in text) != same, "where nothing holds constituents the two are one"
    mean = Estimate(1.02, 0.01, samples=1000, inefficiency=3.0, converged=True, blocks=50)
    text = check_pictures(plot_stress_profile(profile, stem, "shear", uniform=mean, difference=mean), stem)
    assert text.count("wholebox,total:1.020") == 2


@pytest.mark.parametrize("bodies", [False, True])
def test_radial_distribution(tmp_path, bodies):
    r = 0.01 * (np.arange(200) + 0.5)
    functions = with_errors({"g_solvent_solvent": ("r", 0.02 + r)}, {"r": r}, error=0.002)
    functions["contact_distance_solvent"] = functions["effective_radius_solvent"] = math.nan
    functions["effective_radius_solvent_by_resolution"] = 0.05
    if bodies:
        g = np.clip(r - 0.6, 0.0, None)
        place = np.linspace(-2.0, 2.0, 8)
        more = {"g_my_rod_solvent": ("r", g), "g_my_rod_my_rod": ("r_bodies", g)}
        more["g_bodies_plane"] = (("separation_y", "separation_x"), np.hypot(*np.meshgrid(place, place)))
        coordinates = {"r": r, "r_bodies": r, "separation_x": place, "separation_y": place}
        functions = functions.merge(with_errors(more, coordinates, error=0.002))
        functions["contact_distance_my_rod"], functions["contact_distance_my_rod_error"] = 0.61, 0.002
        functions["effective_radius_my_rod"], functions["effective_radius_my_rod_error"] = 0.56, 0.002
    stem = tmp_path / "radial"
    text = check_pictures(plot_radial_distribution(functions, stem, "rods", dimension=2), stem)
    assert "solvent:beginsabove0.01,radius0.05byresolution" in text
    assert ("myrod:from0.610on,effectiveradius0.560" in text) == bodies
    assert ("myrod-myrod" in text) == bodies
    assert ("separationalongthegradient" in text) == bodies


@pytest.mark.parametrize("turning", [None, "msd_angle_rod", "orientation_rod"])
def test_displacement(tmp_path, turning):
    lag = np.concatenate([np.arange(16.0), 16.0 * np.arange(1, 8)])
    names = ["solvent"] if turning is None else ["solvent", "rod"]
    variables = {}
    for name in names:
        variables |= {f"msd_{name}": ("lag", 0.4 * lag), f"diffusion_running_{name}": ("lag", np.full(len(lag), 0.1))}
        variables[f"vacf_{name}"] = ("velocity_lag", np.exp(-np.arange(8.0)))
        variables[f"diffusion_{name}"] = ((), 0.1 if name == "solvent" else math.nan)
        variables[f"diffusion_axes_{name}"] = ("axis", np.full(2, 0.1))
    if turning is not None:
        variables[turning] = ("lag", np.exp(-0.1 * lag))
        variables["diffusion_rotational_rod"] = ((), 0.05)
    made = with_errors(variables, {"lag": lag, "velocity_lag": np.arange(8.0), "axis": ["x", "y"]}, error=0.001)
    stem = tmp_path / "displacement"
    text = check_pictures(plot_displacement(made, stem, "rods"), stem)
    assert "=0.1000" in text
    assert ("rod:no" in text) == (turning is not None), "no coefficient for the rod's displacement"
    assert ("0.0500" in text) == (turning is not None), "but one for its rotation"


def test_lissajous(tmp_path):
    phase = np.linspace(0.1, 6.2, 40)
    cycle = with_errors(
        {
            "stress": ("phase", np.cos(phase)),
            "strain": ("phase", np.sin(phase)),
            "shear_rate": ("phase", np.cos(phase)),
        },
        {"phase": phase},
    )
    cycle.attrs["cycles"] = 7
    loss = Estimate(1.02, 0.01, samples=1000, inefficiency=3.0, converged=True, blocks=50)
    short = Estimate(0.03, math.nan, samples=10, inefficiency=3.0, converged=False)
    stem = tmp_path / "lissajous"
    paths = plot_lissajous(
        cycle, stem, "squares", strain_amplitude=1.0, angular_frequency=1.0, storage=short, loss=loss
    )
    text = check_pictures(paths, stem)
    for words in ("linearresponse", "1.020", "(tooshortforanerror)", "7cycles"):
        assert words in text


@pytest.mark.parametrize("repeats", [1, 5])
def test_start_up(tmp_path, repeats):
    rate = np.repeat([0.5, 0.0, -0.5], 20)
    table = np.random.default_rng(1).normal(2.0 * rate, 0.1, (repeats, 60))
    error = table.std(axis=0, ddof=1) / math.sqrt(repeats) if repeats > 1 else np.full(60, math.nan)
    curve = xr.Dataset(
        {"stress": ("time", table.mean(axis=0)), "stress_error": ("time", error),
         "stress_of_repeat": (("repeat", "time"), table)},
        coords={"time": 0.1 * (np.arange(60) + 0.5), "strain": ("time", np.cumsum(rate)),
                "stage": ("time", np.repeat([0, 1, 2], 20)), "shear_rate": ("time", rate)},
        attrs={"repeats": repeats, "interval_time": 0.1},
    )  # fmt: skip
    stem = tmp_path / "start_up"
    text = check_pictures(plot_start_up(curve, stem, "squares"), stem)
    assert ("onecycle,noerrorknown" in text) == (repeats == 1)
    assert text.count("stage") - text.count("thestage") == 2, "the stage at rest has no strain"


@pytest.mark.parametrize("fitted", [False, True])
def test_green_kubo(tmp_path, fitted):
    frequency = 0.01 * np.arange(1, 500)
    amplitude = np.random.default_rng(1).exponential(2.5, len(frequency))
    model = np.where(frequency < 1.0, 2.5, math.nan) if fitted else np.full(len(frequency), math.nan)
    spectrum = xr.Dataset(
        {"amplitude": ("frequency", amplitude), "amplitude_error": ("frequency", amplitude),
         "model": ("frequency", model), "weight": ("frequency", np.isfinite(model).astype(float))},
        coords={"frequency": frequency},
    )  # fmt: skip
    time = np.arange(1.0, 20.0)
    integral = xr.Dataset(
        {"viscosity": ("time", 0 * time + 2.5), "viscosity_error": ("time", 0.01 * time)}, {"time": time}
    )
    viscosity = Estimate(2.503, 0.02, samples=1000, inefficiency=3.0, converged=True, blocks=50) if fitted else None
    stem = tmp_path / "green_kubo"
    text = check_pictures(plot_green_kubo(spectrum, integral if fitted else None, stem, "fluid", viscosity), stem)
    assert text.count("viscosity2.503") == (2 if fitted else 0)
    assert "meansoverbands" in text


def test_amplitudes_are_averaged_over_bands_with_honest_errors():
    """Of white noise: the band means scatter about the truth by their own errors; 40 bands, chi-square at 1e-4."""
    frequency = 0.001 * np.arange(1, 20001)
    amplitude = np.random.default_rng(3).gamma(
        2.5, 1.0 / 2.5, len(frequency)
    )  # five components: ten degrees of freedom
    relative = math.sqrt(1.0 / 2.5)
    _, mean, error = in_bands(frequency, amplitude, np.ones(len(frequency)), relative)
    chi_square = float((((mean - 1.0) / error) ** 2).sum())
    assert chi2.sf(chi_square, len(mean)) > 1e-4
    assert chi2.sf(float((((mean - 1.1) / error) ** 2).sum()), len(mean)) < 1e-4, "a shift of a tenth is seen"


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
