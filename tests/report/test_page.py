"""The page alone: it is whole and well formed, loads nothing, and shows what others have written without obeying it."""

from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.figure import Figure
from pages import Page as Read
from plotly import graph_objects as go
from rich.table import Table as RichTable

from tether.errors import InputError
from tether.plot.style import save
from tether.report.page import Badge, Chart, Code, Html, Image, Page, Section, Table, Text, Warnings, of_letters

EVIL = "</script><script>alert('<b>&amp;')</script>"


def everything(folder: Path) -> Page:
    """A page with a part of every kind but the 3D view."""
    pictures = save(Figure(), folder / "picture")
    figure = go.Figure(go.Scatter(x=[1.0, 2.0], y=[3.0, None], name=EVIL))
    return Page("All of it", "what a page can show").add(
        Section(
            "Text", Text("*one* <b>two</b>\n\n| a | b |\n|---|---|\n| 1 | 2 |"), Html("<em>three</em>"),
            badges=[Badge("holds", "good")],
        ),
        Section(
            "Numbers", Table.of(["name", "x<sub>1</sub>"], [["a", "1.0"], ["<b>", "-2"]]), Badge("bad", "bad"),
            Badge("unsure", "unsure"), Warnings(["mind <this>"]),
        ),
        Section("Pictures", Chart(figure, alt="a figure"), Chart(figure.to_dict(), alt="the same"), *(
            Image(path, alt="a picture", caption=EVIL) for path in pictures
        )),
        Section("Shut", Code("a = '<b>'", "this"), Section("Within", Text("deep")), shut=True),
        Section("Text", Text("of the same title")),
    )  # fmt: skip


def test_a_page_is_well_formed_and_loads_nothing(tmp_path: Path) -> None:
    page = Read.read(everything(tmp_path).write(tmp_path / "page.html"))
    assert page.loaded() == []
    assert page.root.all("meta", http_equiv="") or True
    policy = next(
        each for each in page.root.all("meta") if each.attributes.get("http-equiv") == "Content-Security-Policy"
    )
    assert "default-src 'none'" in policy.attributes["content"]
    assert len(page.root.all("html")) == len(page.root.all("title")) == len(page.root.all("h1")) == 1
    names = [each.attributes["id"] for level in ("h2", "h3") for each in page.root.all(level)]
    assert len(set(names)) == len(names) == 6
    links = [each.attributes["href"] for each in page.root.all("nav")[0].all("a")]
    assert links == ["#text", "#numbers", "#pictures", "#shut", "#text-2"]
    assert all(image.attributes["alt"] for image in page.root.all("img"))


def test_the_check_for_loading_finds_what_loads() -> None:
    spoiled = '<link rel="x" href="https://a.b/c"><script src="d.js"></script><style>@import "e"; p{src:url(f)}</style>'
    assert len(Read(f"<html>{spoiled}</html>").loaded()) == 4
    with pytest.raises(AssertionError, match="closes"):
        Read("<p><b></p></b>")


def test_plotly_is_there_once_where_it_is_needed_and_not_elsewhere(tmp_path: Path) -> None:
    scripts = Read(everything(tmp_path).html()).root.all("script")
    assert sum("plotly.js v" in script.text for script in scripts) == 1
    assert not any("tetherViewer=" in script.text for script in scripts)
    plain = Page("No plots").add(Section("Text", Text("words"))).html()
    assert "plotly" not in plain
    assert len(plain) < 30_000


def test_text_of_others_is_shown_and_not_obeyed(tmp_path: Path) -> None:
    page = Read(everything(tmp_path).html())
    assert page.figures[0]["data"][0]["name"] == EVIL
    assert "<b>two</b>" in page.root.all("section")[0].text
    assert EVIL in page.text
    assert not any(script.text.startswith("alert") for script in page.root.all("script"))
    assert page.root.all("code")[-1].text == "a = '<b>'"
    rows = next(table for table in page.tables if table[0] == ["name", "x1"])
    assert rows[1:] == [["a", "1.0"], ["<b>", "-2"]]


def test_figures_lose_their_own_template(tmp_path: Path) -> None:
    assert all("template" not in figure["layout"] for figure in Read(everything(tmp_path).html()).figures)


def test_a_table_of_the_terminal_keeps_its_groups_and_gets_its_letters() -> None:
    terminal = RichTable(title="eta(phi)")
    terminal.add_column("eta_r")
    terminal.add_column("N1", justify="right")
    terminal.add_row("S_xy - 2", "1.0 +- 0.1")
    terminal.add_section()
    terminal.add_row("G''", "-3e-29")
    table = Table.like(terminal)
    assert table.columns == ["η<sub>r</sub>", "N<sub>1</sub>"]
    assert table.caption == "η(φ)"
    assert table.right == [False, True]
    assert table.groups == [[["S<sub>xy</sub> \u2212 2", "1.0 ± 0.1"]], [["G\u2033", "-3e-29"]]]


@pytest.mark.parametrize("words", ["beta", "theta", "phi_x", "x86-64-v4, mixed", "14727424c71e", "N10", "phial"])
def test_letters_are_found_in_no_other_words(words: str) -> None:
    assert of_letters(words).replace("φ", "phi") == words


def test_errors_are_sentences(tmp_path: Path) -> None:
    page = Page("x").add(Section("y", Text("z")))
    with pytest.raises(InputError, match=r"cannot be written \(no such file or directory\); choose another file"):
        page.write(tmp_path / "no" / "page.html")
    with pytest.raises(InputError, match="neither PNG nor SVG"):
        Page("x").add(Section("y", Image(tmp_path / "a.gif", alt="z"))).html()
    with pytest.raises(InputError, match="cannot be read"):
        Page("x").add(Section("y", Image(tmp_path / "a.png", alt="z"))).html()
