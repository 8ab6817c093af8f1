"""Hold the pair noise against dieharder, Robert G. Brown's battery of tests for random numbers.

    python validation/noise/run_dieharder.py            about twelve minutes; rewrites dieharder.json
    python validation/noise/run_dieharder.py --quick    one walk, three tests, writes nothing

Needs dieharder (Debian: apt-get install dieharder), g++ and an installed tether. The noise of an engine is a
function of (seed, step, i, j); each walk streams its 64 bits along one of the four while the other three stand
still, where a weak hash shows first. `stream.cpp` compiles the same header as the engines, and its first words
are compared with `tether._core.noise_words` before anything else.

Every test that dieharder itself rates "Good" is run, but for those whose default size costs minutes
(marsaglia_tsang_gcd, rgb_minimum_distance beyond two dimensions, all but two of the lags of rgb_lagged_sum,
rgb_bitdist beyond 4 bits), each on a stretch of the walk of its own. dieharder calls p < 0.000001 or
p > 0.999999 FAILED and 0.005 from either end WEAK: of some 260 assessments of ideal randomness two or three are
WEAK (one in a hundred), and one is FAILED in one run of 2000. The control, a cheap hash of the same inputs, must
be FAILED by most of the tests that it is given.

The exit code is 1 when the noise is FAILED anywhere, when more than ten of its assessments are WEAK, or when the
control passes.
"""

from __future__ import annotations

import argparse
import datetime as dt
import importlib.metadata
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tether import _core

here = Path(__file__).resolve().parent
core = here.parent.parent / "core"

# dieharder's number of a test, and the ntuple that it is run with (None: its own).
tests: tuple[tuple[int, int | None], ...] = (
    *((number, None) for number in (0, 1, 2, 3, 4, 8, 9, 10, 11, 12, 13, 15, 16, 100, 101, 102)),
    *((200, bits) for bits in (1, 2, 3, 4)),
    (201, 2),
    *((202, length) for length in (2, 3, 4, 5)),
    *((203, lag) for lag in (0, 1)),
    *((number, None) for number in (204, 205, 206, 207, 208, 209)),
)
control_tests: tuple[tuple[int, int | None], ...] = ((0, None), (3, None), (8, None), (15, None), (100, None))
walks = ("i", "j", "step", "seed")
most_weak = 10  # 2.6 are expected: more than 10 in one run of 10000, if assessments were independent


def compiled(folder: Path) -> Path:
    program = folder / "stream"
    command = ["g++", "-std=c++20", "-O3", "-I", str(core), str(here / "stream.cpp"), "-o", str(program)]
    subprocess.run(command, check=True)
    return program


def words_of_module(walk: str, start: int, pairs: int) -> np.ndarray:
    """What the stream should begin with, from the module that the engines live in; shape (pairs, 2)."""
    places = np.arange(pairs, dtype=np.uint32)
    one = np.array([start], dtype=np.uint32)
    if walk == "i":
        return _core.noise_words(start, start, places, np.full(pairs, 2**32 - 1 - start, dtype=np.uint32))
    if walk == "j":
        return _core.noise_words(start, start, np.full(pairs, start, dtype=np.uint32), start + 1 + places)
    if walk == "step":
        return np.concatenate([_core.noise_words(start, int(k), one, one + 1) for k in places])
    return np.concatenate([_core.noise_words(int(k), start, one, one + 1) for k in places])


def check_stream(program: Path) -> None:
    pairs = 10_000
    for walk in walks:
        raw = subprocess.run([program, walk, "5", str(pairs)], check=True, capture_output=True).stdout
        if not np.array_equal(np.frombuffer(raw, dtype="<u4").reshape(-1, 2), words_of_module(walk, 5, pairs)):
            raise SystemExit(f"the stream along {walk} differs from tether._core.noise_words")


def assess(program: Path, walk: str, start: int, test: int, ntuple: int | None) -> list[dict[str, object]]:
    """Run one test of the battery on one stretch; a test may give several assessments."""
    command = ["dieharder", "-g", "200", "-d", str(test), "-c", ","]
    command += [] if ntuple is None else ["-n", str(ntuple)]
    for column in ("test_name", "ntuple", "tsamples", "psamples", "pvalues", "assessment"):
        command += ["-D", column]
    with subprocess.Popen([program, walk, str(start)], stdout=subprocess.PIPE) as stream:
        result = subprocess.run(command, stdin=stream.stdout, check=True, capture_output=True, text=True)
        assert stream.stdout is not None
        stream.stdout.close()  # the stream ends when nobody reads it
        stream.terminate()
    assessments: list[dict[str, object]] = []
    for line in result.stdout.splitlines():
        fields = [field.strip() for field in line.split(",")]
        if len(fields) == 6 and fields[5] in ("PASSED", "WEAK", "FAILED"):
            name, tuple_size, samples, repeats, p, verdict = fields
            assessments.append(
                {
                    "walk": walk,
                    "test": test,
                    "name": name,
                    "ntuple": int(tuple_size),
                    "tsamples": int(samples),
                    "psamples": int(repeats),
                    "p": float(p),
                    "assessment": verdict,
                }
            )
    if not assessments:
        raise SystemExit(f"dieharder -d {test} gave no assessment:\n{result.stdout}{result.stderr}")
    return assessments


def version_of_dieharder() -> str:
    banner = subprocess.run(["dieharder", "-l"], check=False, capture_output=True, text=True).stdout
    found = re.search(r"version (\S+)", banner)
    return found.group(1) if found else "unknown"


def main() -> int:
    parser = argparse.ArgumentParser(description="Hold the pair noise against dieharder.")
    parser.add_argument("--quick", action="store_true", help="one walk and three tests; writes nothing")
    parser.add_argument("--out", type=Path, default=here / "dieharder.json", help="where the results go")
    arguments = parser.parse_args()
    quick = arguments.quick
    os.nice(10)
    begin = time.monotonic()
    noise: list[dict[str, object]] = []
    control: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory() as folder:
        program = compiled(Path(folder))
        check_stream(program)
        for walk in walks[:1] if quick else walks:
            for start, (test, ntuple) in enumerate(tests[:1] + tests[5:6] + tests[11:12] if quick else tests):
                noise += assess(program, walk, 1000 + start, test, ntuple)
                print(*noise[-1].values(), flush=True)
        for start, (test, ntuple) in enumerate(control_tests):
            control += assess(program, "control", 1000 + start, test, ntuple)
            print(*control[-1].values(), flush=True)

    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    count = {verdict: sum(a["assessment"] == verdict for a in noise) for verdict in ("PASSED", "WEAK", "FAILED")}
    control_failed = sum(a["assessment"] == "FAILED" for a in control)
    record = {
        "battery": f"dieharder {version_of_dieharder()}",
        "command": "stream WALK START | dieharder -g 200 -d TEST [-n NTUPLE]",
        "tether": importlib.metadata.version("tether"),
        "date": dt.datetime.now(dt.UTC).date().isoformat(),
        "seconds": round(time.monotonic() - begin),
        "processor_seconds": round(usage.ru_utime + usage.ru_stime),
        "assessments": count,
        "control_failed": f"{control_failed} of {len(control)}",
        "noise": noise,
        "control": control,
    }
    if not quick:
        text = json.dumps(record, indent=1)
        text = re.sub(r"\{\s+(\"walk\"[^}]*?)\s+\}", lambda m: "{" + re.sub(r"\s+", " ", m.group(1)) + "}", text)
        arguments.out.write_text(text + "\n")
    print(f"{count}; control FAILED {control_failed} of {len(control)}; {record['processor_seconds']} s of processor")
    sound = count["FAILED"] == 0 and count["WEAK"] <= most_weak and 2 * control_failed > len(control)
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
