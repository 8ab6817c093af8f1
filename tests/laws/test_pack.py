"""The headers of law, weights and noise compile for packs, as the SIMD engine to come will ask of them."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

HERE = Path(__file__).parent


def test_law_weights_and_noise_compile_for_packs_and_agree_lane_by_lane(tmp_path: Path) -> None:
    compiler = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")
    assert compiler, "tether was built by a C++ compiler; name it in CXX"
    program = tmp_path / "pack"
    options = ["-std=c++20", "-O1", "-ffp-contract=off", f"-I{HERE.parent.parent / 'core'}"]
    subprocess.run([compiler, *options, HERE / "pack.cpp", "-o", program], check=True)
    assert subprocess.run([program], check=True, capture_output=True, text=True).stdout == "the same\n"
