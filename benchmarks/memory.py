"""Memory that a simulation takes, measured in a process of its own."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from benchmarks.ours import Ours
from benchmarks.setup import Manner, cubic
from benchmarks.worker import Worker, serve


def bytes_per_particle(particles: int) -> dict[str, float]:
    """Bytes of the plain 3D fluid by which resident memory grew: at its peak, start included, and after a few steps."""
    worker = Worker("benchmarks.memory", str(particles))
    grown = json.loads(worker.ask("build"))
    worker.close()
    return {"particles": particles, **{name: number / particles for name, number in grown.items()}}


def _status(field: str) -> int:
    """Bytes, from a line of the process's status such as `VmRSS: 1234 kB`."""
    for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
        if line.startswith(f"{field}:"):
            return 1024 * int(line.split()[1])
    raise RuntimeError(f"the system does not tell {field}")


def _build(particles: int) -> str:
    before = _status("VmRSS")
    runner = Ours(cubic(particles, 0.5), Manner())
    runner.run(4)
    grown = {"peak": _status("VmHWM") - before, "running": _status("VmRSS") - before}
    runner.close()
    return json.dumps(grown)


if __name__ == "__main__":
    serve(lambda _word, _others: _build(int(sys.argv[1])))
