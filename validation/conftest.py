"""Results of validation are kept beside it, with how they were made."""

from __future__ import annotations

import json
import platform
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

import tether

_RESULTS = Path(__file__).parent / "results"

Record = Callable[..., None]


@pytest.fixture
def record(request: pytest.FixtureRequest) -> Record:
    """Write what was found to results/NAME.json; the test asserts afterwards, so a failure is on record too."""
    began = time.perf_counter()

    def write(name: str, **found: Any) -> None:
        made = {
            "command": f"python -m pytest 'validation/{request.node.nodeid.removeprefix('validation/')}'",
            "version": tether.__version__,
            "date": datetime.now(UTC).date().isoformat(),
            "seconds": round(time.perf_counter() - began, 1),
            "machine": platform.machine(),
        }
        _RESULTS.mkdir(exist_ok=True)
        (_RESULTS / f"{name}.json").write_text(json.dumps({"made": made, **found}, indent=2) + "\n", encoding="utf-8")

    return write
