"""The style of the pictures, `tether.plot.style`, for plots and words in a page."""

from __future__ import annotations

import re
from typing import Any

from tether.plot.style import BLUE, GREEN, ORANGE, PURPLE, SKY, STYLE, VERMILION

_FONTS = ", ".join([*STYLE["font.sans-serif"], "system-ui", "sans-serif"])


def template(*, dark: bool) -> dict[str, Any]:
    """The settings of all plots, for Plotly: light ones are those of the pictures."""
    ink, faint, line = ("#d5d9de", "#31363c", "#8b929a") if dark else ("#1f2328", "#e4e4e4", STYLE["axes.edgecolor"])
    axis = {
        "showgrid": True, "gridcolor": faint, "gridwidth": 0.6, "zeroline": False, "showline": True, "linecolor": line,
        "linewidth": STYLE["axes.linewidth"] + 0.3, "ticks": "outside", "tickcolor": line, "ticklen": 4,
        "automargin": True, "title": {"standoff": 8, "font": {"size": 13}}, "exponentformat": "power",
    }  # fmt: skip
    return {
        "layout": {
            "colorway": [BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY],
            "font": {"family": _FONTS, "size": 12, "color": ink},
            "paper_bgcolor": "rgba(0,0,0,0)",
            "plot_bgcolor": "rgba(0,0,0,0)",
            "xaxis": axis,
            "yaxis": axis,
            "legend": {
                "orientation": "h", "x": 0, "y": 1.02, "xanchor": "left", "yanchor": "bottom",
                "font": {"size": 11.5}, "bgcolor": "rgba(0,0,0,0)",
            },
            "hoverlabel": {"bgcolor": "#22272d" if dark else "#ffffff", "font": {"color": ink}, "bordercolor": line},
            "margin": {"l": 56, "r": 14, "t": 14, "b": 44},
            "hovermode": "closest",
            "height": 340,
            "modebar": {"bgcolor": "#101316" if dark else "#ffffff", "color": line, "activecolor": ink},
        }
    }  # fmt: skip


def of_formulas(text: str) -> str:
    """matplotlib's formulas as the letters and the few tags that Plotly and HTML have."""
    for formula, letters in (
        (r"\dot\gamma", "\N{GREEK SMALL LETTER GAMMA}\N{COMBINING DOT ABOVE}"),
        (r"\gamma", "\N{GREEK SMALL LETTER GAMMA}"),
        (r"\eta", "\N{GREEK SMALL LETTER ETA}"),
        (r"\phi", "\N{GREEK SMALL LETTER PHI}"),
        (r"\,", "\N{NARROW NO-BREAK SPACE}"),
    ):
        text = text.replace(formula, letters)
    text = re.sub(r"\\mathrm\{(\w+)\}", r"\1", text)
    text = re.sub(r"_\{(\w+)\}", r"<sub>\1</sub>", text)
    text = re.sub(r"(?<=\$)(\w)_(\w)", r"\1<sub>\2</sub>", text)
    return text.replace(r"\$", "\0").replace("$", "").replace("\0", "$")
