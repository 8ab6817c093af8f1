"""Page: one HTML file that holds everything it shows: no network, no other file.

    Page("Title").add(Section("Results", Text("*Markdown*"), Table(...), Chart(figure, alt="..."))).write(path)

A page is a list of sections, a section a list of parts: text, plots, tables, pictures, code, verdicts, a 3D view, and
sections within it. Its Content-Security-Policy forbids a browser to load anything. The scripts that it needs, Plotly
and the 3D view, are in it once, with their licences, and only where something needs them.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

from jinja2 import Environment, PackageLoader, StrictUndefined
from markdown_it import MarkdownIt
from markupsafe import Markup

from tether.errors import InputError
from tether.files.whole import whole
from tether.version import __version__

if TYPE_CHECKING:
    from rich.table import Table as RichTable

    from tether.report.suspension import Suspension


@dataclass(frozen=True)
class Text:
    """Prose in Markdown; HTML in it is shown as it is written, not obeyed."""

    markdown: str

    @property
    def html(self) -> Markup:
        """Rendered."""
        return Markup(MarkdownIt("commonmark", {"html": False}).enable("table").render(self.markdown))


@dataclass(frozen=True)
class Html:
    """Prose in HTML, put into the page as it is: not for what others have written."""

    fragment: str

    @property
    def html(self) -> Markup:
        """The fragment."""
        return Markup(self.fragment)


@dataclass(frozen=True)
class Badge:
    """A verdict in a word or two."""

    words: str
    verdict: Literal["good", "bad", "unsure", "plain"] = "plain"


@dataclass(frozen=True)
class Chart:
    """An interactive plot. Neighbors stand side by side where there is room."""

    figure: Any
    """A Plotly figure, or the dictionary of one. The page gives it its own template, a light or a dark one."""
    alt: str
    """What it shows, for who does not see it."""
    title: str = ""
    """May have the tags <sub> and <sup>, as in `caption`."""
    caption: str = ""
    wide: bool = False
    """Whether it takes all of the width."""

    @property
    def json(self) -> Markup:
        """The figure, as it may stand in a script element."""
        figure = self.figure if isinstance(self.figure, dict) else self.figure.to_plotly_json()
        layout = {name: value for name, value in figure["layout"].items() if name != "template"}
        return for_script({"data": figure["data"], "layout": layout})


Cell = str | Badge
"""Of a table: text, which may have the tags <sub> and <sup>, or a verdict."""


@dataclass(frozen=True)
class Table:
    """Rows in groups, with a line between these. Columns that hold numbers are aligned right."""

    columns: Sequence[str]
    """May have the tags <sub> and <sup>."""
    groups: Sequence[Sequence[Sequence[Cell]]]
    right: Sequence[bool] = ()
    """Of each column, whether it is aligned right; none if not given."""
    caption: str = ""

    @classmethod
    def of(cls, columns: Sequence[str], rows: Sequence[Sequence[Cell]], caption: str = "") -> Table:
        """One group; columns in which every cell begins like a number are aligned right."""
        right = [all(_is_number(row[place]) for row in rows) for place in range(len(columns))]
        return cls(columns, [rows], right, caption)

    @classmethod
    def like(cls, table: RichTable) -> Table:
        """The same as a table of the terminal, with the letters and signs that it has not."""
        cells = [[of_letters(str(cell)) for cell in column.cells] for column in table.columns]
        groups: list[list[list[Cell]]] = [[]]
        for row, place in zip(zip(*cells, strict=True), table.rows, strict=True):
            groups[-1].append(list(row))
            if place.end_section:
                groups.append([])
        right = [column.justify == "right" for column in table.columns]
        headings = [of_letters(str(column.header)).replace("_", " ") for column in table.columns]
        return cls(headings, [group for group in groups if group], right, of_letters(str(table.title or "")))


@dataclass(frozen=True)
class Image:
    """A picture, PNG or SVG, which becomes a part of the page."""

    path: Path
    alt: str
    caption: str = ""

    @property
    def source(self) -> str:
        """As a data URL. Raises InputError when it cannot be read or is of another kind."""
        kind = {".png": "image/png", ".svg": "image/svg+xml", ".jpg": "image/jpeg"}.get(self.path.suffix)
        if kind is None:
            raise InputError(f"{self.path} is no picture for a page", "it is neither PNG nor SVG", "give one of these")
        try:
            content = self.path.read_bytes()
        except OSError as error:
            why = (error.strerror or str(error)).lower()
            raise InputError(f"{self.path} cannot be read", why, "draw it first") from None
        return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


@dataclass(frozen=True)
class Code:
    """Text in letters of one width, with a button that copies it."""

    text: str
    title: str = ""
    """What it is, for the button."""


@dataclass(frozen=True)
class Warnings:
    """What stands against the numbers, a sentence each."""

    sentences: Sequence[str]


@dataclass(frozen=True)
class View:
    """A suspension that turns and moves."""

    suspension: Suspension
    alt: str

    @property
    def json(self) -> Markup:
        """Its description, as it may stand in a script element."""
        return for_script(self.suspension.description)


class Section:
    """A title, and what stands beneath it. May be shut at first, and hold other sections."""

    def __init__(self, title: str, *parts: Part, badges: Sequence[Badge] = (), shut: bool = False) -> None:
        self.title = title
        self.parts: list[Part] = list(parts)
        self.badges = list(badges)
        self.shut = shut
        self.name = ""
        """Of the place in the page; given by it."""

    def add(self, *parts: Part) -> Self:
        """Put parts at its end."""
        self.parts += parts
        return self

    @property
    def runs(self) -> Iterator[tuple[str, list[Part]]]:
        """Kinds of parts and parts; neighboring plots, and neighboring verdicts, together."""
        kept: list[Part] = []
        kind = ""
        for part in self.parts:
            own = type(part).__name__.lower()
            if kept and (own != kind or own not in ("chart", "badge")):
                yield kind, kept
                kept = []
            kind = own
            kept.append(part)
        if kept:
            yield kind, kept


Part = Text | Html | Badge | Chart | Table | Image | Code | Warnings | View | Section


@dataclass
class Page:
    """Sections beneath a title."""

    title: str
    lead: str = ""
    """A line beneath the title."""
    sections: list[Section] = field(default_factory=list)

    def add(self, *sections: Section) -> Self:
        """Put sections at its end."""
        self.sections += sections
        return self

    def html(self) -> str:
        """The whole page."""
        self._name(self.sections, set())
        has_charts, has_views = self._has(Chart), self._has(View)
        scripts = [_plotly()] if has_charts else []
        scripts += [_own("viewer.js")] if has_views else []
        page: str = _template().render(
            page=self, version=__version__, style=Markup(_own("page.css")), script=Markup(_own("page.js")),
            scripts=[Markup(each) for each in scripts], templates=_templates() if has_charts else None,
            has_charts=has_charts, has_views=has_views,
        )  # fmt: skip
        return page

    def write(self, path: Path) -> Path:
        """Write it and return the path. Raises InputError when it cannot be written."""
        try:
            with whole(path) as temporary:
                temporary.write_text(self.html(), encoding="utf-8")
        except OSError as error:
            why = (error.strerror or str(error)).lower()
            raise InputError(f"{path} cannot be written", why, "choose another file with --out") from None
        return path

    def _has(self, kind: type[Part]) -> bool:
        def within(parts: Sequence[Part]) -> bool:
            return any(isinstance(part, kind) or (isinstance(part, Section) and within(part.parts)) for part in parts)

        return within(self.sections)

    def _name(self, sections: Sequence[Section], taken: set[str]) -> None:
        """Give every section a name of its own."""
        for section in sections:
            plain = re.sub(r"[^a-z0-9]+", "-", section.title.lower()).strip("-") or "section"
            number = 1
            while (name := plain if number == 1 else f"{plain}-{number}") in taken:
                number += 1
            taken.add(name)
            section.name = name
            self._name([part for part in section.parts if isinstance(part, Section)], taken)


_LETTERS = {
    r" \+- ": " \N{PLUS-MINUS SIGN} ",
    r"\beta\b|\beta(?=_)": "\N{GREEK SMALL LETTER ETA}",
    r"\bphi\b|\bphi(?=_)": "\N{GREEK SMALL LETTER PHI}",
    r"\bchi\^2": "\N{GREEK SMALL LETTER CHI}<sup>2</sup>",
    r"(?<=\bG)''": "\N{DOUBLE PRIME}",
    r"(?<=\bG)'": "\N{PRIME}",
    r"\b([A-Z]|\w(?=_[mr]\b))_([a-z]{1,2})\b": r"\1<sub>\2</sub>",
    r"\bN([12])\b": r"N<sub>\1</sub>",
    r"(?<= )- (?=[A-Z\d])": "\N{MINUS SIGN} ",
}
"""What a terminal writes for letters and signs that it may not have."""


def of_letters(text: str) -> str:
    """Text of the terminal with the signs that a page has: +-, eta, S_xy, N1, G'."""
    for written, meant in _LETTERS.items():
        text = re.sub(written, meant, text)
    return text


def for_script(value: Any) -> Markup:
    """JSON that may stand in a script element: no text in it can end the element."""
    from plotly.utils import PlotlyJSONEncoder

    text = json.dumps(value, cls=PlotlyJSONEncoder, separators=(",", ":"))
    for letter in "<>&\u2028\u2029":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return Markup(text)


def _is_number(cell: Cell) -> bool:
    return isinstance(cell, str) and (cell[:1] in "-\N{MINUS SIGN}0123456789" or cell in ("", "nan"))


@cache
def _own(name: str) -> str:
    return files("tether.report").joinpath(name).read_text(encoding="utf-8")


@cache
def _plotly() -> str:
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs()).replace("</script", r"<\/script")


@cache
def _templates() -> Markup:
    from tether.report.style import template

    return for_script({"light": template(dark=False), "dark": template(dark=True)})


@cache
def _template() -> Any:
    environment = Environment(
        loader=PackageLoader("tether.report", ""), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    environment.filters["tags"] = _with_tags
    return environment.get_template("page.html")


def _with_tags(text: str) -> Markup:
    """Escaped, but for the tags that symbols have."""
    escaped = str(Markup.escape(text))
    return Markup(re.sub(r"&lt;(/?su[bp])&gt;", r"<\1>", escaped))
