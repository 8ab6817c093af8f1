"""The whole battery of run_dieharder.py, as a validation: about twelve minutes of one core."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


def test_pair_noise_passes_dieharder(tmp_path):
    """No FAILED, few WEAK, and a cheap hash is FAILED; the false-alarm rate is in run_dieharder.py."""
    script = Path(__file__).parent / "run_dieharder.py"
    subprocess.run([sys.executable, script, "--out", tmp_path / "dieharder.json"], check=True)
