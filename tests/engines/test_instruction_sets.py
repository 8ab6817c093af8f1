"""Which engine, precision and instruction set a run gets, how it is chosen and said, and that no two are mixed up."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from small_runs import assert_one_sentence, assert_same_run, summary, tether, write_couette
from suspensions import engine

import tether as tt
from tether import _core
from tether.engines import instruction_set
from tether.errors import InputError

CORE = Path(__file__).parent.parent.parent / "core"
VARIABLE = "TETHER_INSTRUCTION_SET"
HERE = [name for name, is_here in _core.instruction_sets() if is_here]


# Choice


def test_without_a_word_it_is_the_widest_that_is_here(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert instruction_set() == HERE[0]
    assert engine([4.0, 4.0], [0]).instruction_set == HERE[0]


@pytest.mark.parametrize("name", HERE)
def test_the_environment_chooses(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv(VARIABLE, name)
    assert instruction_set() == name
    simulation = tt.Simulation(box=tt.Box(4.0, 4.0), fluid=tt.Fluid(temperature=1.0), timestep=0.005, seed=1)
    assert simulation.engine.instruction_set == name


@pytest.mark.parametrize("name", ["x86-64-v9", "avx2"])
def test_an_unknown_one_is_refused_in_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv(VARIABLE, name)
    with pytest.raises(InputError, match=f"{VARIABLE} = {name} cannot be used"):
        instruction_set()
    outcome = tether("run", write_couette(tmp_path), "--out", tmp_path / "out")
    assert_one_sentence(outcome, 2, f"{VARIABLE} = {name} cannot be used", HERE[0], "unset it")
    assert not (tmp_path / "out").exists()
    # The reference needs none.
    options = ["--quiet", "--set", "run.engine=reference"]
    assert tether("run", write_couette(tmp_path), "--out", tmp_path / "out", *options).code == 0


def test_the_core_refuses_what_it_was_not_built_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    with pytest.raises(ValueError, match='was not built for "x86-64-v9"'):
        engine([4.0, 4.0], [0], instruction_set="x86-64-v9")
    for name in [name for name, is_here in _core.instruction_sets() if not is_here]:
        with pytest.raises(ValueError, match=f"this processor does not have {name}"):
            engine([4.0, 4.0], [0], instruction_set=name)
    assert engine([4.0, 4.0], [0], pairs="reference").instruction_set == ""


# What is said


@pytest.mark.parametrize("name", HERE)
def test_info_says_engine_instruction_set_and_threads(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv(VARIABLE, name)
    outcome = tether("info")
    assert (outcome.code, outcome.err) == (0, "")
    lines = {line[:15].strip(): line[15:].strip() for line in outcome.out.splitlines()}
    assert lines["tether"] == tt.__version__
    assert lines["engine"].startswith("cpu")
    assert lines["instruction set"].lstrip().startswith(f"{name}, of ")
    assert all(each in lines["instruction set"] for each, _ in _core.instruction_sets())
    assert lines["threads"].startswith(f"{len(os.sched_getaffinity(0))}, ")


@pytest.mark.parametrize(
    ("lines", "engine_name", "precision"),
    [
        ("", "cpu", "mixed"),
        ('precision = "double"\n', "cpu", "double"),
        ('engine = "cpu"\nprecision = "mixed"\n', "cpu", "mixed"),
        ('engine = "reference"\n', "reference", "double"),
        ('engine = "reference"\nprecision = "double"\n', "reference", "double"),
    ],
)
def test_engine_and_precision_of_a_run(tmp_path: Path, lines: str, engine_name: str, precision: str) -> None:
    """They work, stand in summary.json, and a resumed run keeps them: it goes on in the same bits."""
    config = write_couette(tmp_path, [("[run]\n", f"[run]\n{lines}")])
    quiet = ["--quiet", "--set", "output.series=10", "--set", "output.frames=40"]
    assert tether("run", config, "--out", tmp_path / "out", *quiet).code == 0
    performance = summary(tmp_path / "out")["performance"]
    assert (performance["engine"], performance["precision"]) == (engine_name, precision)
    assert performance["instruction_set"] == (None if engine_name == "reference" else instruction_set())
    assert tether("run", config, "--out", tmp_path / "short", *quiet, "--set", "run.steps=120").code == 0
    assert tether("resume", tmp_path / "short", "--quiet", "--steps", 80).code == 0
    assert_same_run(tmp_path / "out", tmp_path / "short")


def test_the_three_engines_are_three() -> None:
    """The control of the test above: none passes for another, in the bits of the positions."""
    ends = []
    for options in ({}, {"precision": "double"}, {"engine": "reference"}):
        simulation = tt.Simulation(
            box=tt.Box(4.0, 4.0), fluid=tt.Fluid(temperature=1.0), timestep=0.005, seed=1, **options
        )
        simulation.run(equilibration=0, steps=20)
        ends.append(simulation.positions)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        assert np.abs(ends[i] - ends[j]).max() > 0.0


def test_mixed_precision_of_the_reference_is_refused_in_one_sentence(tmp_path: Path) -> None:
    config = write_couette(tmp_path, [("[run]\n", '[run]\nengine = "reference"\nprecision = "mixed"\n')])
    line = config.read_text().splitlines().index("[run]") + 1
    outcome = tether("run", config, "--out", tmp_path / "out")
    assert_one_sentence(outcome, 2, f"couette.toml, line {line}", 'precision = "mixed"', "leave precision out")
    assert not (tmp_path / "out").exists()


# The linker


def symbols(folder: Path, text: str) -> list[list[str]]:
    """Letter (of nm) and name of each symbol that is defined when the text is compiled for AVX-512. Optimized less than
    in the build, which leaves rather more functions standing by themselves.
    """
    compiler = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")
    assert compiler, "tether was built by a C++ compiler; name it in CXX"
    source, made = folder / "kernels.cpp", folder / "kernels.o"
    source.write_text(text, encoding="utf-8")
    wide = ["-march=x86-64-v4"] if platform.machine() == "x86_64" else []
    options = ["-std=c++20", *wide, "-O1", "-fPIC", "-ffp-contract=off", "-Wno-psabi", f"-I{CORE}"]
    subprocess.run([compiler, *options, "-c", source, "-o", made], check=True)
    listed = subprocess.run(["nm", "-C", "--defined-only", made], check=True, capture_output=True, text=True).stdout
    return [line.split(maxsplit=2)[1:] for line in listed.splitlines()]


def test_kernels_leave_nothing_for_the_linker_to_choose(tmp_path: Path) -> None:
    """A function that two files define inline is taken from one of them: from the one that was compiled for AVX-512,
    perhaps, on a processor without it. A file of kernels defines no such (weak) symbol, and two global ones.
    """
    template = (CORE / "kernels" / "table.cpp.in").read_text(encoding="utf-8")
    found = symbols(tmp_path, template.replace("@name@", "a test").replace("@symbol@", "of_a_test"))
    assert [name for kind, name in found if kind in "WwVvu"] == []
    assert sorted(name for kind, name in found if kind.isupper()) == [
        "tether::kernels_2d_of_a_test()",
        "tether::kernels_3d_of_a_test()",
    ]


def test_an_inline_function_is_noticed(tmp_path: Path) -> None:
    """The control: without forced inlining a function of a header stays, and is weak."""
    text = "inline int fell(int x) { return x > 0 ? fell(x - 2) * x : 1; }\nint user(int x) { return fell(x); }\n"
    assert ["W", "fell(int)"] in symbols(tmp_path, text)
