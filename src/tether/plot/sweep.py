"""What all pictures of a study share: its keys and quantities, curves through it, and how they are drawn and named.

A study is a dataset. Its dimensions are the swept keys of the configuration, dotted, and `repeat`; a quantity q is the
variables q and q_error of each run and q_mean and q_mean_error over the repeats; a number, such as volume_fraction or
peclet, is one variable of each run, without error. Runs that are missing are nan.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass
from textwrap import fill
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from tether.plot.style import BLUE, GRAY, GREEN, ORANGE, PURPLE, SKY, UNITS, VERMILION, points, put_title

COLORS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY)
"""Of the curves in one picture; no picture has more."""

_CONSTANT = 1e-9  # relative; what differs by less is the same number

_FEW_DECADES = 300.0  # greatest over least place on an axis whose numbers are written out

_LETTER = 0.072  # mean width of a letter in a legend, inches
_LONG = 85  # letters in a line of a legend
_MARKUP = re.compile(r"\\[a-z]+|\\,|[${}_]")  # of formulas, which are short

_WORDS = {
    "viscosity": r"viscosity $\eta$",
    "viscosity_pairwise": r"viscosity $\eta$ of the pairs alone",
    "plain_fluid_viscosity": r"viscosity $\eta$ of the plain fluid",
    "plain_fluid_viscosity_pairwise": r"viscosity $\eta$ of the plain fluid, pairs alone",
    "relative_viscosity": r"relative viscosity $\eta / \eta_{\mathrm{solvent}}$",
    "relative_viscosity_pairwise": r"relative viscosity $\eta / \eta_{\mathrm{solvent}}$ of the pairs alone",
    "N1": "first normal stress difference $N_1$",
    "N2": "second normal stress difference $N_2$",
    "pressure": "pressure $p$",
    "temperature": "temperature $kT$",
    "shear_rate": r"shear rate $\dot\gamma$",
    "volume_fraction": r"volume fraction $\phi$",
    "peclet": "Peclet number Pe",
    "reynolds": "Reynolds number Re",
    "particle_reynolds": "Reynolds number of a body",
    "mach": "Mach number Ma",
    "strain": r"strain $\gamma$",
    "bodies": "number of bodies",
    "count": "number of bodies asked for",
}
"""Of quantities, numbers and the last words of keys, where their names alone would not do."""

_SYMBOLS = {"shear_rate": r"$\dot\gamma$", "volume_fraction": r"$\phi$", "temperature": "$kT$"}

_WITHOUT_UNITS = {
    "relative_viscosity", "relative_viscosity_pairwise", "volume_fraction", "peclet", "reynolds", "particle_reynolds",
    "mach", "strain", "steps", "bodies", "count", "exponent", "seed",
}  # fmt: skip


@dataclass(frozen=True)
class Curve:
    """The part of a study along one key, at one value of each of the others."""

    part: xr.Dataset
    """Without the other keys' dimensions."""
    values: dict[str, Any]
    """Of the other keys, and of those that change with them; by dotted name."""
    label: str
    """The same for the legend, as far as the values differ in the study; may be empty."""
    color: str = BLUE


def swept_keys(study: xr.Dataset) -> list[str]:
    """The dimensions of a study but the repeats."""
    return [str(name) for name in study.dims if name != "repeat"]


def quantities(study: xr.Dataset) -> list[str]:
    """What was measured, with an error."""
    return [str(name).removesuffix("_mean") for name in study.data_vars if str(name).endswith("_mean")]


def numbers(study: xr.Dataset) -> list[str]:
    """What is known of each run without an error."""
    measured = set(quantities(study))
    kinds = ("_mean", "_error")
    names = [str(name) for name in study.data_vars if not str(name).endswith(kinds)]
    return [name for name in names if name not in measured and is_number(study[name])]


def keys(study: xr.Dataset) -> list[str]:
    """The swept keys, and those that change with one of them."""
    return [str(name) for name in study.coords if study[name].ndim == 1 and study[name].dims != ("repeat",)]


def is_number(values: xr.DataArray) -> bool:
    """Whether it holds numbers, not words and not yes or no."""
    return bool(np.issubdtype(values.dtype, np.number))


def mean(study: xr.Dataset, name: str) -> xr.DataArray:
    """Mean over the repeats of a quantity or a number; a key's values."""
    if f"{name}_mean" in study:
        return study[f"{name}_mean"]
    values = study[name]
    return values.mean("repeat") if "repeat" in values.dims else values


def error(study: xr.Dataset, name: str) -> xr.DataArray:
    """Standard error of a quantity's mean, nan where it is not known; 0 for numbers, which have none."""
    if f"{name}_mean_error" in study:
        return study[f"{name}_mean_error"]
    return xr.full_like(mean(study, name), np.nan if f"{name}_mean" in study else 0.0, dtype=np.float64)


def is_known(study: xr.Dataset, quantity: str) -> bool:
    """Whether any run tells a quantity."""
    return f"{quantity}_mean" in study and bool(np.isfinite(study[f"{quantity}_mean"]).any())


def direction(x: xr.DataArray) -> str | None:
    """The swept key along which a number changes most; None where it is the same everywhere or nowhere known."""
    values = np.asarray(x.values, dtype=np.float64)
    if not np.isfinite(values).any():
        return None
    # fmin and fmax pass over nan.
    spans = [np.fmax.reduce(values, axis) - np.fmin.reduce(values, axis) for axis in range(values.ndim)]
    widest = [float(np.nanmax(span)) if np.isfinite(span).any() else 0.0 for span in spans]
    if not widest or max(widest) <= _CONSTANT * float(np.nanmax(np.abs(values))):
        return None
    return str(x.dims[int(np.argmax(widest))])


def curves(study: xr.Dataset, along: str | None, wanted: Iterable[str]) -> tuple[list[Curve], str]:
    """Curves along a key, one for each combination of the others at which one of the wanted quantities is known.

    Of more than there are colors, as many are chosen evenly. Returns them and a remark on what was left out, for the
    title; it is empty where nothing was. along None: each run is a curve of one point.
    """
    names = list(wanted)
    found = [curve for curve in all_curves(study, along) if any(_is_known(curve.part, name) for name in names)]
    chosen = found
    if len(found) > len(COLORS):
        chosen = [found[place] for place in np.linspace(0, len(found) - 1, len(COLORS)).round().astype(int)]
    colored = [Curve(each.part, each.values, each.label, color) for each, color in zip(chosen, COLORS, strict=False)]
    return colored, f" ({len(chosen)} of {len(found)} curves shown)" if len(found) > len(chosen) else ""


def all_curves(study: xr.Dataset, along: str | None) -> list[Curve]:
    """Curves along a key, one for each combination of the others, the last key's values changing fastest."""
    others = [key for key in swept_keys(study) if key != along]
    made = []
    for places in itertools.product(*(range(study.sizes[key]) for key in others)):
        part = study.isel(dict(zip(others, places, strict=True)))
        values = {str(name): _item(part[name]) for name in part.coords if part[name].ndim == 0}
        differing = [key for key in others if study.sizes[key] > 1]
        label = ", ".join(f"{symbol(key, others)} = {value_in_words(values.get(key))}" for key in differing)
        made.append(Curve(part, values, label))
    return made


def _is_known(study: xr.Dataset, name: str) -> bool:
    return is_known(study, name) or (name in numbers(study) and bool(np.isfinite(study[name]).any()))


def _item(value: xr.DataArray) -> Any:
    return value.values.item()


def symbol(key: str, beside: Iterable[str] = ()) -> str:
    """A key in as few letters as tell it from the keys beside it."""
    last = key.rpartition(".")[2]
    if sum(other.rpartition(".")[2] == last for other in beside) > 1:
        return key.replace("_", " ").replace(".", " ")
    return _SYMBOLS.get(last, last.replace("_", " "))


def value_in_words(value: Any) -> str:
    """A value of a key for a label, cut where it is long."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return f"{value:.6g}"
    text = str(value).lower() if isinstance(value, bool) else str(value)
    short = text if len(text) <= 28 else f"{text[:27]}\N{HORIZONTAL ELLIPSIS}"
    return short.replace("$", r"\$")  # matplotlib would take it for the beginning of a formula


def axis_label(study: xr.Dataset, name: str, *, magnitude: bool = False) -> str:
    """What stands along an axis, with its unit. magnitude: that of a number that has a sign."""
    last = name.rpartition(".")[2]
    attributes = next((study[each].attrs for each in (name, f"{name}_mean") if each in study), {})
    label = _WORDS.get(last) or attributes.get("long_name") or name.replace("_", " ")
    if name in keys(study) and last == "volume_fraction":
        label = f"{label} asked for"
    if magnitude:
        label = label.replace("$", "$|", 1)[::-1].replace("$", "$|", 1)[::-1]
    bare = last in _WITHOUT_UNITS or attributes.get("units") == "1" or (name in study and not is_number(study[name]))
    return label if bare else f"{label} ({UNITS})"


def quantity_in_words(quantity: str) -> str:
    """A quantity for a title."""
    words = _WORDS.get(quantity, quantity).partition(" $")[0].replace("_", " ")
    tail = " of the pairs alone" if quantity.endswith("_pairwise") else ""
    return f"{words[0].upper()}{words[1:]}{tail}"


def title(study: xr.Dataset, what: str, remark: str = "") -> str:
    """What is drawn, of which study; a remark may have formulas."""
    of = str(study.attrs.get("title", "")).removeprefix("tether: ").replace("$", r"\$")
    return f"{what}, {study.attrs['dimension']}D{': ' if of else ''}{of}{remark}"


def head(figure: Figure, study: xr.Dataset, what: str, remark: str = "") -> None:
    """The title above a picture."""
    put_title(figure, title(study, what, remark))


def rates_and_peclet(study: xr.Dataset) -> dict[str, xr.DataArray]:
    """|shear rate|, and Pe where there is one: what flow curves stand against, by the name of the number."""
    found = {"shear_rate": abs(mean(study, "shear_rate"))}
    if "peclet" in study and bool((mean(study, "peclet") > 0.0).any()):
        found["peclet"] = mean(study, "peclet")
    return found


def draw_against_rate(axes: Axes, curve: Curve, against: str, quantity: str) -> None:
    """A quantity of one curve against |shear rate| or Pe, on a logarithmic scale; rest, at 0, is not on it.

    Discs where the flow goes along x above, triangles where the rate is negative.
    """
    x = rates_and_peclet(curve.part).get(against)
    if x is None:
        return
    place, rate, value, deviation = points_of(
        x, mean(curve.part, "shear_rate"), mean(curve.part, quantity), error(curve.part, quantity)
    )
    seen = np.isfinite(value) & (place > 0.0)
    label: str | None = curve.label
    for signed, marker in ((rate >= 0.0, "o"), (rate < 0.0, "v")):
        here = seen & signed
        if not here.any():
            continue
        joined = np.flatnonzero(here)[np.argsort(place[here], kind="stable")]
        axes.plot(place[joined], value[joined], color=curve.color, linewidth=0.8, alpha=0.45, zorder=2)
        points(axes, place[here], value[here], deviation[here], curve.color, label, marker=marker, size=4.4)
        label = None


def points_of(*arrays: xr.DataArray) -> tuple[NDArray[np.float64], ...]:
    """Arrays of one common shape, (n,); a single number is one point."""
    broadcast = xr.broadcast(*arrays)
    return tuple(np.atleast_1d(np.asarray(each.values, dtype=np.float64)) for each in broadcast)


def logarithmic(axis: Axis) -> None:
    """Plain numbers at 1, 2 and 5 along a logarithmic axis of few decades, powers of ten along a longer one."""
    low, high = axis.get_view_interval()
    if high < _FEW_DECADES * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def explain_signs(axes: Axes, study: xr.Dataset) -> None:
    """What triangles are, in the legend, where there are any."""
    if bool((mean(study, "shear_rate") < 0.0).any()):
        axes.plot([], [], color=GRAY, marker="v", markersize=4.4, linestyle="none", label="negative shear rate")


def legend_below(figure: Figure, columns: int) -> None:
    """One legend for all axes beneath the picture, where it covers nothing; each label once, points before lines."""
    entries: dict[str, Any] = {}
    for axes in figure.axes:
        named = zip(*axes.get_legend_handles_labels(), strict=True)
        for handle, label in sorted(named, key=lambda entry: not isinstance(entry[0], ErrorbarContainer)):
            entries.setdefault(label, handle)
    if not entries:
        return
    labels = [fill(label, _LONG) for label in entries]
    fitting = (n for n in range(min(columns, len(labels)), 0, -1) if _width(labels, n) <= figure.get_figwidth())
    figure.legend(
        list(entries.values()), labels, loc="outside lower center", ncols=next(fitting, 1), columnspacing=1.6,
        handletextpad=0.5,
    )  # fmt: skip


def _width(labels: list[str], columns: int) -> float:
    """About that of a legend, inches: matplotlib fills one column after the other."""
    rows = -(-len(labels) // columns)
    letters = [len(_MARKUP.sub("", label)) for label in labels]
    return sum(0.6 + max(letters[place : place + rows]) * _LETTER for place in range(0, len(letters), rows))
