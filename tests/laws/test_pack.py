"""Packs give lane by lane what one number after the other gives: law, weights, noise, and every named operation; the
exponential is right.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from tether import _core

HERE = Path(__file__).parent
BASELINE = "the compiler's own choice"
HERE_SETS = [name for name, is_here in _core.instruction_sets() if is_here and platform.machine() == "x86_64"]
CHECKS = (
    *("half power", "square power", "any power", "gaussian noise", "words of noise", "square root", "larger", "where"),
    *("rounded", "lanes below", "first lanes", "store lanes", "transposed", "gather quads", "quad of", "sum"),
    *("signed value", "counting", "exponential", "exponential less one"),
)


def printed(folder: Path, name: str, *options: str) -> str:
    """What the program of that name prints, as it is compiled with the options."""
    compiler = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")
    assert compiler, "tether was built by a C++ compiler; name it in CXX"
    program = folder / name
    fixed = ["-std=c++20", "-O1", "-ffp-contract=off", "-Wno-psabi", f"-I{HERE.parent.parent / 'core'}"]
    subprocess.run([compiler, *fixed, *options, HERE / f"{name}.cpp", "-o", program], check=True)
    return subprocess.run([program], check=True, capture_output=True, text=True).stdout


def accused(folder: Path, *options: str) -> list[str]:
    """The checks of pack.cpp that found a difference, as it is compiled with the options."""
    lines = printed(folder, "pack", *options).splitlines()
    return [] if lines == ["the same"] else lines


def machine(instruction_set: str) -> list[str]:
    """Options that compile for an instruction set."""
    return [] if instruction_set == BASELINE else [f"-march={instruction_set}"]


@pytest.mark.parametrize("instruction_set", [BASELINE, *HERE_SETS])
def test_packs_are_the_same_lane_by_lane(tmp_path: Path, instruction_set: str) -> None:
    assert accused(tmp_path, *machine(instruction_set)) == []


def test_every_check_notices_one_bit_of_one_lane(tmp_path: Path) -> None:
    """The control: with the last bit of the last lane wrong in what is expected, no check passes."""
    assert sorted(accused(tmp_path, "-DSPOILED")) == sorted(CHECKS)


def test_exponentials_are_right_to_two_units_in_the_last_place(tmp_path: Path) -> None:
    """exp(x) and exp(x) - 1 on [-80, 0], ends included, in float and double, against the C library in the next wider
    precision; and in the same bits on every instruction set, in whose packs the same arguments stand in other lanes.
    """
    texts = [printed(tmp_path, "exponential", *machine(each)) for each in (BASELINE, *HERE_SETS)]
    assert len(set(texts)) == 1
    parts = texts[0].split("\n\n")
    for lines, narrow, wide in zip(parts, (np.float32, np.float64), (float, np.longdouble), strict=True):
        rows = [[float.fromhex(each) for each in line.split()] for line in lines.splitlines()]
        x, value, less = np.array(rows).T
        assert (x.min(), x.max(), value[x == 0.0].max(), np.abs(less[x == 0.0]).max()) == (-80.0, 0.0, 1.0, 0.0)
        for found, function in ((value, np.exp), (less, np.expm1)):
            exact = function(x.astype(wide))
            unit = np.spacing(np.abs(exact.astype(narrow)))
            assert np.abs((found - exact) / unit).max() < 2.0
