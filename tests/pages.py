"""What the tests of pages share: runs to report on, and reading a page without a browser."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

FRAMES = "\n[output.frames]\nsteps = 10\n"
SOLID = [("size = [4.0, 4.0]", "size = [3.0, 3.0, 3.0]"), ('shape = "square"', 'shape = "cube"')]
OSCILLATORY = 'flow = {kind = "oscillatory", strain_amplitude = 0.5, angular_frequency = 6.3}'
STAGES = 'flow = {kind = "stages", stages = [{shear_rate = 0.5, duration = 0.2}, {shear_rate = 0.0, duration = 0.2}]}'
POISEUILLE = 'flow = {kind = "poiseuille", force = 0.5}'
REST = 'flow = {kind = "rest"}'
STUDY = """\
base = "couette.toml"
repeats = 2
relative = true

[sweep]
flow.shear_rate = [0.5, -1.0]
bodies.0.count = [2, 3]
"""

# Runs that between them have every dataset, by name: changes of the file in small_runs, and options.
RUNS: dict[str, tuple[list[tuple[str, str]], list[str]]] = {
    "flat": (
        [("steps = 200\n", f"steps = 200\n{FRAMES}")],
        ["seed=4", 'start.bodies="random"', "measure.profiles=true"],
    ),
    "solid": ([*SOLID, ("steps = 200\n", f"steps = 200\n{FRAMES}")], []),
    "oscillatory": ([("steps = 200", "steps = 1000")], [OSCILLATORY]),
    "stages": ([("steps = 200", "steps = 400")], [STAGES]),
    "driven": ([], [POISEUILLE, "measure.profiles=true", "measure.stress_profile=true"]),
    "rest": (
        [("steps = 200", "steps = 2000")],
        [REST, "measure.radial_distribution={every = 20}", "measure.displacement=true", "measure.green_kubo=true"],
    ),
}


# Reading a page

VOID = {"meta", "link", "input", "img", "br", "hr", "col", "wbr"}
LOADING = {"src", "srcset", "data", "poster", "action", "formaction", "background", "manifest"}


@dataclass
class Element:
    """An element and what is in it."""

    tag: str
    attributes: dict[str, str]
    parts: list[Element | str] = field(default_factory=list)

    @property
    def text(self) -> str:
        return "".join(part if isinstance(part, str) else part.text for part in self.parts)

    def all(self, tag: str, **wanted: str) -> list[Element]:
        """Elements of this kind within it, class_ and type among what they must have."""
        found = []
        for part in self.parts:
            if isinstance(part, Element):
                names = {key.rstrip("_"): value for key, value in wanted.items()}
                if part.tag == tag and all(
                    value in part.attributes.get(key, "").split() for key, value in names.items()
                ):
                    found.append(part)
                found += part.all(tag, **wanted)
        return found


class Page(HTMLParser):
    """A page, of which every element must be closed in its place."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.root = Element("page", {})
        self._open = [self.root]
        self.feed(text)
        self.close()
        assert len(self._open) == 1, f"never closed: {[each.tag for each in self._open[1:]]}"

    @classmethod
    def read(cls, path: Path) -> Page:
        return cls(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        made = Element(tag, {name: value or "" for name, value in attributes})
        self._open[-1].parts.append(made)
        if tag not in VOID:
            self._open.append(made)

    def handle_endtag(self, tag: str) -> None:
        assert self._open[-1].tag == tag, f"</{tag}> closes <{self._open[-1].tag}> in line {self.getpos()[0]}"
        self._open.pop()

    def handle_data(self, text: str) -> None:
        self._open[-1].parts.append(text)

    @property
    def text(self) -> str:
        return self.root.text

    @property
    def figures(self) -> list[dict[str, Any]]:
        """Plotly's figures, read as strictly as JSON is defined."""
        plots = self.root.all("figure", class_="chart")
        return [_strictly(plot.all("script", type="application/json")[0].text) for plot in plots]

    @property
    def views(self) -> list[dict[str, Any]]:
        """Descriptions of suspensions."""
        return [_strictly(each.all("script")[0].text) for each in self.root.all("div", class_="suspension")]

    @property
    def tables(self) -> list[list[list[str]]]:
        """Rows of cells, headings first."""
        return [
            [[cell.text.strip() for cell in row.all("th") + row.all("td")] for row in table.all("tr")]
            for table in self.root.all("table")
        ]

    def loaded(self) -> list[str]:
        """What a browser would fetch from elsewhere for this page; links that a reader follows are none of it."""
        found = []

        def look(element: Element) -> None:
            for name, value in element.attributes.items():
                loads = name in LOADING or (name == "href" and element.tag != "a")
                if loads and not value.startswith(("data:", "#")):
                    found.append(f"<{element.tag} {name}={value}>")
            if element.tag == "style":
                found.extend(re.findall(r"@import[^;]*|url\((?!['\"]?data:)[^)]*\)", element.text))
            for part in element.parts:
                if isinstance(part, Element):
                    look(part)

        look(self.root)
        return found


def _strictly(text: str) -> Any:
    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is no JSON")

    return json.loads(text, parse_constant=refuse)
