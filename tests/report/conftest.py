"""Runs and a study to report on, none of which is changed, and a browser."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pages import RUNS, STUDY
from small_runs import tether, write_couette
from small_studies import InThisThread, study

from tether.report.write import report
from tether.study import run_study


@pytest.fixture(scope="session")
def run_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of a finished run, by its name in RUNS."""
    top = tmp_path_factory.mktemp("runs")

    def made(name: str) -> Path:
        folder = top / name
        if not folder.exists():
            changes, settings = RUNS[name]
            options = [each for setting in settings for each in ("--set", setting)]
            outcome = tether("run", write_couette(top, changes, f"{name}.toml"), "--out", folder, "--quiet", *options)
            assert outcome.code == 0, outcome
        return folder

    return made


@pytest.fixture(scope="session")
def study_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a finished study of negative and positive rates."""
    top = tmp_path_factory.mktemp("study")
    run_study(study(top, STUDY), top / "out", InThisThread())
    return top / "out"


@pytest.fixture(scope="session")
def page_of(
    run_of: Callable[[str], Path], study_folder: Path, tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., Path]:
    """The page of runs by their names, and of the study by its own; several make one page."""
    top = tmp_path_factory.mktemp("pages")

    def made(*names: str) -> Path:
        path = top / f"{'-'.join(names)}.html"
        if not path.exists():
            report([study_folder if name == "study" else run_of(name) for name in names], path)
        return path

    return made


@pytest.fixture(scope="session")
def browser() -> Iterator[object]:
    """Chromium without a window and with WebGL in software."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed; make setup")
    programs = {name: shutil.which(name) for name in ("chromium", "chromedriver")}
    missing = [name for name, path in programs.items() if path is None]
    if missing:
        pytest.skip(f"no {' and no '.join(missing)}; apt-get install chromium chromium-driver")
    options = webdriver.ChromeOptions()
    options.binary_location = programs["chromium"]
    for option in (
        "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader", "--no-first-run", "--disable-extensions", "--disable-component-update",
        "--disable-background-networking",
    ):  # fmt: skip
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options, webdriver.ChromeService(programs["chromedriver"]))
    try:
        yield driver
    finally:
        driver.quit()
