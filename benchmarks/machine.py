"""What a measurement has to say about where it was made."""

from __future__ import annotations

import os
import platform
import subprocess
import time
from datetime import date
from pathlib import Path

import tether as tt
from benchmarks.lammps_peer import lammps_version
from tether.engines import instruction_set


def machine() -> dict[str, object]:
    """Processor, compiler, versions, date and instruction set, for JSON."""
    return {
        "date": date.today().isoformat(),
        "cpu": cpu(),
        "processors": len(os.sched_getaffinity(0)),
        "compiler": _first_line("g++", "--version"),
        "tether": tt.__version__,
        "commit": _first_line("git", "describe", "--always", "--dirty"),
        "lammps": lammps_version(),
        "instruction_set": instruction_set(),
    }


class OthersShare:
    """The share of the processors' time that went to anything but this process and its children, since it was made."""

    def __init__(self) -> None:
        self._busy, self._began, self._own = _busy(), time.perf_counter(), _own()

    def now(self) -> float | None:
        """From 0 to 1; what runs beside a benchmark slows it down. None where the system does not tell."""
        busy = _busy()
        if busy is None or self._busy is None:
            return None
        available = (time.perf_counter() - self._began) * (os.cpu_count() or 1)
        return max(0.0, (busy - self._busy) - (_own() - self._own)) / available


def _busy() -> float | None:
    """Seconds that all processors together were busy since the machine started."""
    try:
        numbers = Path("/proc/stat").read_text(encoding="ascii").splitlines()[0].split()[1:]
    except OSError:
        return None
    user, nice, system, _idle, _waiting, *others = map(int, numbers)
    return (user + nice + system + sum(others[:3])) / os.sysconf("SC_CLK_TCK")


def _own() -> float:
    """Processor seconds of this process and of its children that have ended."""
    return sum(os.times()[:4])


def cpu() -> str:
    """The processor's name."""
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()


def _first_line(*command: str) -> str | None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(__file__).parent)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.partition("\n")[0]
