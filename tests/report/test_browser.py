"""Pages in a browser: nothing is complained of, plots and the 3D view are drawn, buttons do what they say.

The browser draws the view without a graphics card, and a page has Plotly to read, so there are few tests that each look
at much, and windows are small.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

DESK = {"width": 640, "height": 480, "deviceScaleFactor": 1, "mobile": False}
PHONE = {"width": 380, "height": 640, "deviceScaleFactor": 1, "mobile": True}

# The view keeps what it has drawn, so its pixels can be told: how many are unlike the corner, how many kinds, and all.
PIXELS = """
const canvas = document.querySelector('.suspension canvas');
const copy = document.createElement('canvas');
[copy.width, copy.height] = [200, 120];
const pen = copy.getContext('2d', { willReadFrequently: true });
pen.drawImage(canvas, 0, 0, copy.width, copy.height);
const pixels = new Uint32Array(pen.getImageData(0, 0, copy.width, copy.height).data.buffer);
const drawn = pixels.filter((pixel) => pixel !== pixels[0]);
return [drawn.length / pixels.length, new Set(drawn).size, pixels.reduce((hash, each) => (hash * 31 + each) | 0, 0)];
"""

# How light the page is, the letters of a plot and the corner of the view, from 0 to 255.
LIGHT = """
const light = (color) => Math.max(...color.match(/\\d+/g).slice(0, 3).map(Number));
const background = document.querySelector('.suspension').viewer.scene.background.getStyle();
const axis = getComputedStyle(document.querySelector('.plot .xtitle')).fill;
return [light(getComputedStyle(document.body).backgroundColor), light(axis), light(background)];
"""


class Screen:
    """A browser with a page in it."""

    def __init__(self, browser: Any) -> None:
        self.browser = browser

    def show(self, path: Path, *, dark: bool = False, phone: bool = False) -> None:
        """Open a page."""
        scheme = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": scheme})
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", PHONE if phone else DESK)
        self.browser.get(path.as_uri())

    def do(self, script: str, *arguments: object) -> Any:
        """What a script returns."""
        return self.browser.execute_script(script, *arguments)

    def wait_for(self, expression: str, seconds: float = 60.0) -> None:
        """Until something is true. The time is for machines that have much else to do."""
        end = time.monotonic() + seconds
        while not self.do(f"return Boolean({expression})"):
            assert time.monotonic() < end, f"waited in vain for {expression}"
            time.sleep(0.02)

    def look_through(self) -> int:
        """Open every section and bring every plot and view into sight; the number of plots."""
        self.do("document.querySelectorAll('details').forEach((each) => { each.open = true; });")
        for place in range(self.do("return document.querySelectorAll('.plot, .suspension').length")):
            each = f"document.querySelectorAll('.plot, .suspension')[{place}]"
            self.do(f"{each}.scrollIntoView({{behavior: 'instant'}})")
            self.wait_for(f"{each}.data ?? {each}.viewer")
        return self.do("return document.querySelectorAll('.plot').length")

    def see_the_view(self) -> None:
        """Bring the view into sight, which is when it is made."""
        self.do("document.querySelector('.suspension').scrollIntoView({behavior: 'instant'})")
        self.wait_for("document.querySelector('.suspension').viewer")

    def click(self, control: str) -> None:
        """A button of the view."""
        self.do("document.querySelector(arguments[0]).click()", f'[data-control="{control}"]')

    def choose_color(self, way: str) -> None:
        self.do(
            "const list = document.querySelector('[data-control=\"color\"]'); list.value = arguments[0];"
            "list.dispatchEvent(new Event('change'))",
            way,
        )

    @property
    def pixels(self) -> int:
        """A number that is equal for equal pixels of the view."""
        return self.do(PIXELS)[2]

    @property
    def told(self) -> str:
        return self.do("return document.querySelector('.told').textContent")

    @property
    def complaints(self) -> list[str]:
        """What the console says since the last time, and what was asked of the network."""
        said = [entry["message"] for entry in self.browser.get_log("browser")]
        entries = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        asked = [each["params"]["request"]["url"] for each in entries if each["method"] == "Network.requestWillBeSent"]
        return said + [url for url in asked if not url.startswith(("file:", "data:", "blob:"))]


@pytest.fixture
def screen(browser: Any) -> Iterator[Screen]:
    made = Screen(browser)
    assert made.complaints is not None  # what was said before is read and gone
    yield made
    browser.get("about:blank")


@pytest.mark.parametrize("names", [("oscillatory", "rest"), ("study",)])
def test_plots_are_drawn_and_nothing_is_complained_of(
    screen: Screen, page_of: Callable[..., Path], names: tuple[str, ...]
) -> None:
    screen.show(page_of(*names))
    plots = screen.look_through()
    counts = screen.do("return [...document.querySelectorAll('.js-plotly-plot')].map((each) => each.data.length)")
    assert len(counts) == plots > 0
    assert all(count > 0 for count in counts)
    drawn = "return [...document.querySelectorAll('.plot')].map((each) => each.querySelectorAll('.trace, .hm').length)"
    assert all(count > 0 for count in screen.do(drawn))
    views = "return [...document.querySelectorAll('.suspension')].every((each) => each.viewer.particles)"
    assert screen.do(views)
    assert screen.complaints == []


@pytest.mark.parametrize("name", ["flat", "solid"])
def test_the_view_draws_and_its_buttons_work(screen: Screen, page_of: Callable[..., Path], name: str) -> None:
    screen.show(page_of(name))
    screen.see_the_view()
    share, colors, first = screen.do(PIXELS)
    assert share > 0.01
    assert colors > 20
    assert screen.told.startswith("frame 1 of 21, time ")
    screen.click("next")
    assert screen.told.startswith("frame 2 of 21, time ")
    assert screen.pixels != first
    screen.click("previous")
    assert screen.pixels == first, "the same frame, the same pixels"
    screen.click("play")
    screen.wait_for("document.querySelector('.suspension').viewer.frame > 0")
    screen.click("play")
    assert not screen.do("return document.querySelector('.suspension').viewer.playing")
    seen = {screen.pixels}
    for way in ("body", "speed", "velocity"):
        screen.choose_color(way)
        assert screen.pixels not in seen, way
        seen.add(screen.pixels)
    assert "DPD units" in screen.do("return document.querySelector('.legend').textContent")
    shares = [screen.do(PIXELS)[0]]
    for part in ("solvent", "box"):
        screen.click(part)
        shares.append(screen.do(PIXELS)[0])
    assert shares[0] > shares[1] > shares[2] > 0.0, "bodies are left"
    assert screen.complaints == []


def test_keys_and_a_drag_move_the_view(screen: Screen, page_of: Callable[..., Path]) -> None:
    from selenium.webdriver import ActionChains, Keys

    screen.show(page_of("solid"))
    screen.see_the_view()
    canvas = screen.do(
        "const canvas = document.querySelector('.suspension canvas');"
        "canvas.scrollIntoView({block: 'center', behavior: 'instant'}); return canvas"
    )
    before = screen.pixels
    ActionChains(screen.browser, duration=10).click_and_hold(canvas).move_by_offset(120, 40).release().perform()
    turned = screen.pixels
    assert turned != before
    ActionChains(screen.browser).send_keys(Keys.ARROW_RIGHT).perform()
    assert screen.told.startswith("frame 2 ")
    ActionChains(screen.browser).send_keys(Keys.ARROW_LEFT).perform()
    assert screen.pixels == turned
    screen.click("reset")
    assert screen.pixels == before


@pytest.mark.parametrize("name", ["flat", "study"])
def test_a_phone_has_no_sideways_scroll(screen: Screen, page_of: Callable[..., Path], name: str) -> None:
    screen.show(page_of(name), phone=True)
    screen.look_through()
    assert screen.do("return [innerWidth, document.documentElement.scrollWidth]") == [380, 380]
    assert screen.complaints == []


def test_dark_is_dark_and_the_button_changes_it(screen: Screen, page_of: Callable[..., Path]) -> None:
    screen.show(page_of("flat"), dark=True)
    screen.look_through()
    page, letters, view = screen.do(LIGHT)
    assert max(page, view) < 60 < 180 < letters
    screen.do("document.getElementById('theme').click()")
    page, letters, view = screen.do(LIGHT)
    assert letters < 60 < 180 < min(page, view)
    assert screen.complaints == []


def test_links_open_shut_sections_code_is_copied_and_nothing_may_be_loaded(
    screen: Screen, page_of: Callable[..., Path]
) -> None:
    screen.show(page_of("flat"))
    screen.do("document.querySelector('a[href=\"#configuration\"]').click()")
    screen.wait_for("document.querySelector('details').open")
    screen.do("document.querySelector('.copy').click()")
    screen.wait_for("['Copied', 'Selected'].includes(document.querySelector('.copy').textContent)")
    assert screen.complaints == []
    screen.do("fetch('http://127.0.0.1:9/').catch(() => { window.refused = true; })")
    screen.wait_for("window.refused")
    assert any("Content Security Policy" in complaint for complaint in screen.complaints)
