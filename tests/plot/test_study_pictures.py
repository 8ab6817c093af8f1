"""Pictures of a study: whatever was swept and whatever is missing, with what they must say; and the table of fits."""

from __future__ import annotations

import itertools
import math
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

from tether.analysis.packing import LAWS
from tether.errors import InputError
from tether.plot import (
    draw_study,
    fits_of,
    plot_against,
    plot_flow_curve,
    plot_normal_stress,
    plot_relative_curve,
)
from tether.plot.sweep import all_curves, axis_label, curves, direction, mean
from tether.theory.suspension import krieger_dougherty

SVG_TEXT = "{http://www.w3.org/2000/svg}text"
PACKING = {2: 0.91, 3: 0.65}
RATE, PHI, TEMPERATURE = "flow.shear_rate", "bodies.0.volume_fraction", "fluid.temperature"


def made_up_study(swept, *, dimension=2, repeats=2, relative=True, noise=0.01, phi=0.2, rate=0.1):
    """A study as it ends: dims the swept keys, as `swept` has them, and repeat; eta as Krieger and Dougherty say."""
    generator = np.random.default_rng(7)
    shape = [len(values) for values in swept.values()]
    grids = dict(zip(swept, np.meshgrid(*map(np.asarray, swept.values()), indexing="ij"), strict=True))
    phi = np.array(np.broadcast_to(grids.get(PHI, phi), shape) + 0.0004)  # bodies come in whole numbers
    phi[phi < 0.001] = 0.0  # none of them
    rate = np.array(np.broadcast_to(grids.get(RATE, rate), shape))
    kt = np.array(np.broadcast_to(grids.get(TEMPERATURE, 1.0), shape))
    peclet = np.where(phi > 0.0, 3.6 * np.abs(rate) / kt, math.nan)
    plain = 3.1 / kt * (1.0 + 0.2 / (1.0 + 10 * np.abs(rate)))
    true = {
        "viscosity": plain * krieger_dougherty(phi, dimension, PACKING[dimension]),
        "viscosity_pairwise": plain * krieger_dougherty(phi, dimension, 1.5 * PACKING[dimension]),
        "N1": -3.0 * phi * np.abs(rate) ** 1.5,
        "pressure": 100.0 * kt + 10.0 * phi,
    }
    if dimension == 3:
        true["N2"] = -0.3 * true["N1"]
    units = {"viscosity": "energy/length^2 time", "N1": "energy/length^2"}
    dims, study = list(swept), xr.Dataset(attrs={"dimension": dimension, "title": "squares in a dish"})
    for name, value in true.items():
        spread = noise * (0.05 if name.startswith("N") else 1.0) * np.maximum(np.abs(value), 0.1)
        runs = value[..., None] + spread[..., None] * generator.normal(size=(*shape, repeats))
        attrs = {"units": units.get(name, ""), "long_name": name.replace("_", " ")}
        put(study, dims, name, runs, np.broadcast_to(spread[..., None], runs.shape), attrs)
    each = {"shear_rate": rate, "volume_fraction": phi, "peclet": peclet, "strain": 100.0 + 0 * rate}
    for name, value in each.items():
        study[name] = (
            [*dims, "repeat"],
            np.repeat(value[..., None], repeats, -1),
            {"units": "1/time" if name == "shear_rate" else "1"},
        )
    if relative:
        rng, first = np.random.default_rng(8), [dim for dim in dims if dim != PHI]
        of = xr.DataArray(plain, dims=dims).isel({PHI: 0} if PHI in dims else {})
        of = (of * (1.0 + noise * rng.normal(size=of.shape))).transpose(*first)
        of = of.broadcast_like(study["viscosity_mean"]).transpose(*dims)
        error = 0.007 * of
        for name in ("viscosity", "viscosity_pairwise"):
            study[f"plain_fluid_{name}_mean"], study[f"plain_fluid_{name}_mean_error"] = of, error
            runs = study[name] / of
            runs_error = runs * np.hypot(study[f"{name}_error"] / study[name], error / of)
            put(study, dims, f"relative_{name}", runs.values, runs_error.values, {"units": "1"})
    return study.assign_coords({**{key: list(values) for key, values in swept.items()}, "repeat": range(repeats)})


def put(study, dims, name, runs, errors, attrs):
    repeats = runs.shape[-1]
    study[name] = [*dims, "repeat"], runs, attrs
    study[f"{name}_error"] = [*dims, "repeat"], np.array(errors), attrs
    study[f"{name}_mean"] = dims, runs.mean(-1), attrs
    study[f"{name}_mean_error"] = dims, errors.mean(-1) / math.sqrt(repeats), attrs


def text_of(path) -> str:
    """All words of an SVG, without the spaces between them: formulas are written letter by letter."""
    root = ET.parse(path).getroot()
    return "".join("".join("".join(element.itertext()).split()) for element in root.iter(SVG_TEXT))


def check_pictures(paths, stem) -> str:
    """Both files are there under the right names; the PNG has a drawing on white. Returns the SVG's text."""
    assert [path.name for path in paths] == [f"{stem.name}.png", f"{stem.name}.svg"]
    pixels = imread(paths[0])
    assert min(pixels.shape[:2]) > 500
    assert 0.001 < np.mean(pixels[..., :3].min(axis=2) < 0.9) < 0.5
    return text_of(paths[1])


RATES, PHIS = [0.02, 0.05, 0.1, 0.2, 0.5], [0.05, 0.15, 0.25, 0.35]


def test_a_study_of_rates_and_volume_fractions(tmp_path):
    paths = draw_study(made_up_study({RATE: RATES, PHI: PHIS}), tmp_path)
    names = ["relative_viscosity", "flow_curve", "normal_stress"]
    assert [path.name for path in paths] == [f"{name}.{kind}" for name in names for kind in ("png", "svg")]
    relative, flow, normal = (check_pictures(paths[n : n + 2], tmp_path / names[n // 2]) for n in (0, 2, 4))
    for words in ("squaresinadish", "Einstein", "=0.02:", "\N{PLUS-MINUS SIGN}", "hollow:pairsalone", "2D"):
        assert words in relative
    assert "curvesshown" not in relative
    for text in (flow, normal):
        for words in ("=0.35", "PecletnumberPe", "DPDunits"):
            assert words in text
    assert "secondnormal" not in normal


def test_one_curve_has_all_laws(tmp_path):
    study = made_up_study({PHI: [0.05, 0.1, 0.2, 0.3, 0.4]})
    text = check_pictures(plot_relative_curve(study, tmp_path / "curve"), tmp_path / "curve")
    for words in ("Krieger-Dougherty:", "free:", "Quemada:", "pairsalone,Krieger-Dougherty:", "totalstress"):
        assert words in text
    assert "fitsbadly" not in text
    study["viscosity_mean"][[1, 3]] += 0.5
    text = text_of(plot_relative_curve(study, tmp_path / "bad")[1])
    assert "fitsbadly" in text


def test_too_many_curves_are_chosen_evenly_and_the_title_says_so(tmp_path):
    study = made_up_study({TEMPERATURE: [0.25, 0.5, 1.0], RATE: RATES, PHI: [0.0, 0.1, 0.2, 0.3]}, dimension=3)
    paths = draw_study(study, tmp_path)
    assert "6of15curvesshown" in text_of(paths[1])
    assert "6of12curvesshown" in text_of(paths[3])
    assert "secondnormalstress" in text_of(paths[5])
    shown, _ = curves(study, PHI, ["viscosity"])
    assert shown[0].values == {TEMPERATURE: 0.25, RATE: 0.02}
    assert shown[-1].values == {TEMPERATURE: 1.0, RATE: 0.5}
    assert len({each.color for each in shown}) == 6


def test_missing_runs_and_unknown_errors(tmp_path):
    study = made_up_study({RATE: RATES, PHI: PHIS})
    gone = xr.DataArray(np.zeros((5, 4), dtype=bool), dims=(RATE, PHI))
    gone[3], gone[0, 1:], gone[:, 3] = True, True, True
    holes = study.where(~gone)
    paths = draw_study(holes, tmp_path)
    assert "=0.2:" not in text_of(paths[1]), "no run of that rate"
    assert "=0.35" not in text_of(paths[3]), "no run of that volume fraction"
    only = study.where(study[RATE] == 0.2).assign_attrs(title="$ 5")
    title = text_of(plot_relative_curve(only, tmp_path / "only")[1])
    assert "$5" in title
    assert "dot" not in title
    assert "=0.2)" in title, "which one"
    assert [row["points"] for row in fits_of(holes) if row["law"] == "quemada"] == [2, 2, *[4] * 4, 4, 4]
    for name in [name for name in study if name.endswith("_error")]:
        study[name] = xr.full_like(study[name], math.nan)
    (tmp_path / "unknown").mkdir()
    paths = draw_study(study, tmp_path / "unknown")
    assert "errornotknown" in text_of(paths[1])
    assert {row["points"] for row in fits_of(study)} == {0}


def test_rates_of_both_signs_and_rest(tmp_path):
    study = made_up_study({RATE: [-0.2, -0.1, 0.0, 0.1, 0.2], PHI: [0.1, 0.3]})
    text = check_pictures(plot_flow_curve(study, tmp_path / "flow"), tmp_path / "flow")
    assert "negativeshearrate" in text
    assert "negativeshearrate" in text_of(plot_normal_stress(study, tmp_path / "normal")[1])
    assert direction(abs(mean(study, "shear_rate"))) == RATE


@pytest.mark.parametrize(
    ("swept", "options", "names"),
    [
        ({RATE: RATES}, {"relative": False}, ["flow_curve", "normal_stress"]),
        ({RATE: RATES}, {}, ["relative_viscosity", "flow_curve", "normal_stress"]),
        ({}, {}, ["relative_viscosity"]),
        ({TEMPERATURE: [0.5, 1.0]}, {"relative": False}, ["viscosity"]),
        ({RATE: [-0.1, 0.1]}, {"relative": False}, ["viscosity"]),
        ({"bodies.0.shape": ["square", "a $"], PHI: PHIS}, {}, ["relative_viscosity"]),
        ({PHI: PHIS}, {"repeats": 1}, ["relative_viscosity"]),
    ],
)
def test_what_there_is_to_draw(tmp_path, swept, options, names):
    paths = draw_study(made_up_study(swept, **options), tmp_path)
    assert [path.stem for path in paths[::2]] == names


def test_nothing_to_draw_is_said_in_a_sentence(tmp_path):
    study = made_up_study({TEMPERATURE: [0.5, 1.0]}, relative=False)
    with pytest.raises(InputError, match=r"nothing to draw \(no run of it has ended\); run it first"):
        draw_study(study.where(False), tmp_path)
    words = made_up_study({"bodies.0.shape": ["square", "rod"]}, relative=False)
    with pytest.raises(InputError, match="no key with numbers for values is swept"):
        draw_study(words, tmp_path)
    for plot in (plot_relative_curve, plot_flow_curve, plot_normal_stress):
        with pytest.raises(InputError, match="the study has no"):
            plot(study.where(False), tmp_path / "none")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("quantity", "key", "words"),
    [
        ("viscosity", "volume_fraction", ("volumefraction", "DPDunits", "=0.5")),
        ("pressure", RATE, ("shearrate", "pressure")),
        ("N1", "peclet", ("Peclet", "firstnormal")),
        ("peclet", PHI, ("askedfor", "Peclet")),
        ("plain_fluid_viscosity", RATE, ("plainfluid",)),
        ("viscosity", "bodies.0.count", ("askedfor",)),
    ],
)
def test_any_quantity_against_any_key(tmp_path, quantity, key, words):
    study = made_up_study({RATE: RATES, PHI: PHIS}).assign_coords({"bodies.0.count": (PHI, [10, 20, 30, 40])})
    text = check_pictures(plot_against(study, quantity, key, tmp_path / "one.dot"), tmp_path / "one.dot")
    assert all(each in text for each in words)


def test_words_stand_side_by_side(tmp_path):
    study = made_up_study({"bodies.0.shape": ["square", "a $ and another $", "rod " * 20], PHI: PHIS})
    text = text_of(plot_against(study, "viscosity", "bodies.0.shape", tmp_path / "words")[1])
    assert "a$andanother$" in text
    assert "rod" * 8 not in text, "too long to be written out"


def test_unknown_names_are_refused_with_what_there_is(tmp_path):
    study = made_up_study({RATE: RATES})
    with pytest.raises(InputError, match=r"no quantity viscocity \(it has .*viscosity, .*peclet"):
        plot_against(study, "viscocity", RATE, tmp_path / "none")
    with pytest.raises(InputError, match=r"no swept key or number shear \(it has flow.shear_rate, shear_rate,"):
        plot_against(study, "viscosity", "shear", tmp_path / "none")
    with pytest.raises(InputError, match="N1 cannot be drawn against"):
        plot_against(study.assign(N1_mean=study["N1_mean"] * math.nan), "N1", RATE, tmp_path / "none")


def test_the_table_of_fits():
    rows = fits_of(made_up_study({RATE: [0.1, 0.2], PHI: [0.05, 0.1, 0.2, 0.3, 0.4]}, noise=0.001))
    assert len(rows) == 2 * 2 * len(LAWS)
    assert len({tuple(row) for row in rows}) == 1, "the same columns"
    combinations = itertools.product([0.1, 0.2], ["viscosity", "viscosity_pairwise"], LAWS)
    assert [(row[RATE], row["quantity"], row["law"]) for row in rows] == list(combinations)
    row = rows[0]
    assert row["points"] == 6
    assert row["degrees_of_freedom"] == 4
    assert abs(row["maximum_packing"] - 0.91) < 5.0 * row["maximum_packing_error"] < 0.05
    assert math.isnan(row["intrinsic_viscosity"])
    assert "volume fractions up to 0.1" in rows[4]["remark"]


def test_the_table_of_fits_is_empty_without_volume_fractions():
    assert fits_of(made_up_study({RATE: RATES})) == []


def test_a_plain_fluid_among_the_suspensions_counts_once():
    """A study of phi from 0 has the plain fluid's own run there."""
    study = made_up_study({PHI: [0.0, 0.1, 0.2, 0.3]})
    for kind in ("mean", "mean_error"):
        study[f"viscosity_{kind}"][0] = study[f"plain_fluid_viscosity_{kind}"][0]
    assert fits_of(study)[0]["points"] == 4


def test_keys_that_differ_only_in_their_place_are_told_apart():
    first, second = "bodies.0.volume_fraction", "bodies.1.volume_fraction"
    study = made_up_study({first: [0.1, 0.3], second: [0.1, 0.2], RATE: RATES}, relative=False)
    labels = [each.label for each in all_curves(study, RATE)]
    assert labels[0] == "bodies 0 volume fraction = 0.1, bodies 1 volume fraction = 0.1"
    assert len(set(labels)) == 4


def test_axes_have_units_where_there_are_any():
    study = made_up_study({RATE: RATES, TEMPERATURE: [0.5, 1.0]})
    assert axis_label(study, "viscosity") == r"viscosity $\eta$ (DPD units)"
    assert axis_label(study, "shear_rate", magnitude=True) == r"shear rate $|\dot\gamma|$ (DPD units)"
    assert axis_label(study, "volume_fraction") == r"volume fraction $\phi$"
    assert axis_label(study, TEMPERATURE) == "temperature $kT$ (DPD units)"


def test_a_study_from_its_file(tmp_path):
    made_up_study({"bodies.0.shape": ["square", "rod"], PHI: PHIS}).to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as study:
        assert "shape=rod:" in text_of(draw_study(study, tmp_path)[1])
        assert {row["bodies.0.shape"] for row in fits_of(study)} == {"square", "rod"}
