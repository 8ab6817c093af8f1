"""Packs give lane by lane what one number after the other gives: law, weights, noise, and every named operation."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from pathlib import Path

import pytest

from tether import _core

HERE = Path(__file__).parent
BASELINE = "the compiler's own choice"
HERE_SETS = [name for name, is_here in _core.instruction_sets() if is_here and platform.machine() == "x86_64"]
CHECKS = (
    *("half power", "square power", "any power", "gaussian noise", "words of noise", "square root", "larger", "where"),
    *("rounded", "lanes below", "first lanes", "store lanes", "transposed", "gather quads", "quad of", "sum"),
    *("signed value", "counting"),
)


def accused(folder: Path, *options: str) -> list[str]:
    """The checks of pack.cpp that found a difference, as it is compiled with the options."""
    compiler = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")
    assert compiler, "tether was built by a C++ compiler; name it in CXX"
    program = folder / "pack"
    fixed = ["-std=c++20", "-O1", "-ffp-contract=off", "-Wno-psabi", f"-I{HERE.parent.parent / 'core'}"]
    subprocess.run([compiler, *fixed, *options, HERE / "pack.cpp", "-o", program], check=True)
    lines = subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()
    return [] if lines == ["the same"] else lines


@pytest.mark.parametrize("instruction_set", [BASELINE, *HERE_SETS])
def test_packs_are_the_same_lane_by_lane(tmp_path: Path, instruction_set: str) -> None:
    assert accused(tmp_path, *([] if instruction_set == BASELINE else [f"-march={instruction_set}"])) == []


def test_every_check_notices_one_bit_of_one_lane(tmp_path: Path) -> None:
    """The control: with the last bit of the last lane wrong in what is expected, no check passes."""
    assert sorted(accused(tmp_path, "-DSPOILED")) == sorted(CHECKS)
