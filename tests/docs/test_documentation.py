"""The code in README.md and docs/ runs, and the configurations there are valid."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tether.config import load
from tether.study import Study

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]

BOX = "[box]\nsize = [5.0, 5.0, 5.0]\n"
FLUID = "[fluid]\ntemperature = 1.0\n"
RUN = "[run]\ntimestep = 0.005\nsteps = 40\n"


def blocks(language: str) -> list[object]:
    """Fenced blocks of a language on all pages, each named by its page and its number there."""
    fence = re.compile(rf"^```{language}\n(.*?)^```", re.MULTILINE | re.DOTALL)
    return [
        pytest.param(text, id=f"{page.relative_to(ROOT)}-{number}")
        for page in PAGES
        for number, text in enumerate(fence.findall(page.read_text("utf-8")))
    ]


def shortened(code: str) -> str:
    """The same code with a run of 20 steps."""
    code = re.sub(r"\bequilibration=[\d_]+", "equilibration=10", code)
    return re.sub(r"\bsteps=[\d_]+", "steps=20", code)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that holds the results `couette` of a small run, which the pages speak of."""
    folder = tmp_path_factory.mktemp("documentation")
    bodies_and_flow = '[[bodies]]\ncount = 4\n[flow]\nkind = "couette"\nshear_rate = 0.2\n'
    (folder / "couette.toml").write_text(BOX + FLUID + bodies_and_flow + RUN, "utf-8")
    tether = Path(sys.executable).parent / "tether"
    subprocess.run([tether, "run", "couette.toml", "--out", "couette", "--quiet"], cwd=folder, check=True)
    return folder


@pytest.mark.parametrize("code", blocks("python"))
def test_python_runs(code: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    exec(compile(shortened(code), "documentation", "exec"), {"__name__": "documentation"})


@pytest.mark.parametrize("text", blocks("toml"))
def test_configurations_are_valid(text: str, folder: Path, tmp_path: Path) -> None:
    """Whole files as they stand; fragments together with the smallest tables that they lack. Studies vary a small file.

    Fragments of studies are those that sweep.
    """
    if re.search(r"^base = |^\[+sweep", text, re.MULTILINE):
        path = tmp_path / "study.toml"
        path.write_text(text if "base =" in text else f'base = "couette.toml"\n{text}', "utf-8")
        shutil.copy(folder / "couette.toml", tmp_path)
        assert Study.read(path).points
        return
    given = set(re.findall(r"^\[+(\w+)\]+", text, re.MULTILINE))
    lacking = [table for name, table in {"box": BOX, "fluid": FLUID, "run": RUN}.items() if name not in given]
    path = tmp_path / "documentation.toml"
    path.write_text("\n".join([text, *lacking]), "utf-8")
    load(path)


def test_there_is_code_to_test() -> None:
    """A change of the fences' style must not empty the tests above."""
    assert len(blocks("python")) >= 5
    assert len(blocks("toml")) >= 5
