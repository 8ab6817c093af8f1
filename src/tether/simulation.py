"""Simulation: a suspension, and the run that measures it."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tether import measurement, placement
from tether.bodies import Bodies
from tether.box import Box
from tether.config import Configuration, Measure, Output, Reference, Run, Start
from tether.drive import drive
from tether.engines import cpu_engine, default_threads
from tether.errors import InputError, RunError
from tether.files.checkpoint import Checkpoint
from tether.files.trajectory import read_frame
from tether.flows import Flow, Rest, imposed_velocity
from tether.fluid import Fluid
from tether.goal import Goal
from tether.interactions import Interaction
from tether.observe.moment import Moment, moment_of
from tether.observe.observer import Observer, part, under
from tether.observe.observers import observers_of
from tether.observe.stress_profile import StressProfile
from tether.record import Record
from tether.result import Performance, Result

_GENTLE_DISPLACEMENT = 0.05
"""The furthest that a particle moves in a step of the gentle start, in cutoffs."""

_MOST_THREADS = 1024

_PORTION_SECONDS = 0.2
"""About how long the gentle start runs between looks at signals."""

Vectors = NDArray[np.float64]


class Simulation:
    """A suspension in a box, ready to run.

    Units are reduced ones: any consistent mass, length and time; temperature is kT, an energy. Results do not
    depend on `threads`. Raises InputError, one sentence, for values that cannot be.

    Example:
        import tether as tt
        sim = tt.Simulation(box=tt.Box(20, 20, 10), fluid=tt.Fluid(temperature=1.0),
                            bodies=[tt.Bodies(tt.cube(0.25), count=512)], flow=tt.Couette(shear_rate=0.05),
                            timestep=0.005, seed=1)
        result = sim.run(equilibration=20_000, steps=100_000)
        result.viscosity
    """

    def __init__(
        self,
        *,
        box: Box,
        fluid: Fluid,
        bodies: Sequence[Bodies] = (),
        interactions: Sequence[Interaction] = (),
        flow: Flow | None = None,
        timestep: float,
        seed: int = 0,
        verlet_lambda: float = 0.5,
        engine: Literal["cpu", "reference"] = "cpu",
        precision: Literal["mixed", "double"] | None = None,
        start: Start | None = None,
        measure: Measure | None = None,
        output: Output | None = None,
        reference: Reference | None = None,
        threads: int | None = None,
    ) -> None:
        start, output = start or Start(), output or Output()
        if start.file is not None:  # a run's folder keeps the path, and is not where we are
            start = start.changed(file=str(Path(start.file).absolute()))
        self._prepare(
            Configuration(
                seed=seed,
                box=box,
                fluid=fluid,
                bodies=tuple(bodies),
                interactions=tuple(interactions),
                flow=flow or Rest(),
                # How long it runs, `run` says; until then, long enough for one sample.
                run=Run(
                    timestep=timestep,
                    steps=output.series or 1,
                    verlet_lambda=verlet_lambda,
                    engine=engine,
                    precision=precision,
                ),
                start=start,
                measure=measure or Measure(),
                output=output,
                reference=reference or Reference(),
            ),
            threads,
        )

    _begin: int  # the step that the current run began at
    _samples: list[Vectors]
    _open: Vectors  # the sample that is not yet whole: what its steps so far add to it
    _open_steps: int
    _observers: dict[str, Observer]
    _goal: Goal
    _stopped: int | None  # the step at which the means were good enough
    _momentum: Vectors | None  # when measuring began
    _seconds: float

    @classmethod
    def from_configuration(cls, configuration: Configuration, threads: int | None = None) -> Simulation:
        """The simulation of a configuration, at step 0."""
        simulation = cls.__new__(cls)
        simulation._prepare(configuration, threads)
        return simulation

    def _prepare(self, configuration: Configuration, threads: int | None) -> None:
        if threads is not None and not 1 <= threads <= _MOST_THREADS:
            problem = f"threads = {threads} must be from 1 to {_MOST_THREADS}"
            raise InputError(problem, "more only wait for each other", "leave it out to choose")
        self.configuration = configuration
        particles = configuration.solvent_count + configuration.constituent_count
        self.threads = threads or default_threads(particles)
        self.engine = cpu_engine(configuration, self.threads)
        self._is_placed = False
        self._measure_anew()

    # --- what is there ---

    @property
    def step(self) -> int:
        """Steps done, equilibration included."""
        return self.engine.step

    @property
    def time(self) -> float:
        """Time simulated, in units of time."""
        return self.step * self.configuration.run.timestep

    @property
    def positions(self) -> Vectors:
        """Positions inside the box, a copy of shape (n, d): solvent, then constituents body by body."""
        self.place()
        return self.engine.position

    @property
    def velocities(self) -> Vectors:
        """Velocities in the laboratory frame, a copy of shape (n, d)."""
        self.place()
        return self.engine.velocity

    @property
    def species(self) -> NDArray[np.uint8]:
        """0 for solvent, k for constituents of the k-th kind of bodies; a copy of shape (n,)."""
        return self.engine.species

    @property
    def body_index(self) -> NDArray[np.int32]:
        """The body that a particle belongs to, -1 for solvent; shape (n,)."""
        index = [np.full(self.configuration.solvent_count, -1, dtype=np.int32)]
        first = 0
        for bodies, count in zip(self.configuration.bodies, self.configuration.body_counts, strict=True):
            sites = len(bodies.geometry.sites)
            index.append(np.repeat(np.arange(first, first + count, dtype=np.int32), sites))
            first += count
        return np.concatenate(index)

    @property
    def masses(self) -> Vectors:
        """Mass of each particle, shape (n,)."""
        of_species = [self.configuration.fluid.mass, *self.configuration.body_masses]
        return np.array(of_species)[self.species]

    @property
    def state_sha256(self) -> str:
        """SHA-256 of positions, velocities, forces, bases, the box's offset and the step."""
        self.place()
        digest = hashlib.sha256()
        for array in (self.engine.position, self.engine.velocity, self.engine.force, self.engine.bases):
            digest.update(np.ascontiguousarray(array).tobytes())
        digest.update(np.array([self.engine.offset]).tobytes())
        digest.update(np.array([self.engine.step], dtype=np.int64).tobytes())
        return digest.hexdigest()

    # --- running ---

    def run(
        self,
        *,
        equilibration: int = 0,
        steps: int | None = None,
        strain: float | None = None,
        out: str | Path | None = None,
        force: bool = False,
    ) -> Result:
        """Advance by `equilibration` steps, then measure for `steps` (or up to a total `strain`).

        Another call goes on from here and measures anew. With `out` the run writes its folder as `tether run`
        does, checkpoints included. Ctrl-C stops within a second; with `out` nothing is lost then.
        Raises RunError when a particle runs away.
        """
        run = self.configuration.run.changed(equilibration=equilibration, steps=steps, strain=strain)
        self.configuration = self.configuration.changed(run=run)
        self._measure_anew()
        drive(self, Record.create(Path(out), self.configuration, force) if out is not None else None)
        return self.result()

    def place(self) -> None:
        """Place the particles, if they are not yet: bodies, solvent, velocities, and the gentle start."""
        if self._is_placed:
            return
        configuration = self.configuration
        places, speeds = (np.random.default_rng([configuration.seed, stream]) for stream in (1, 2))
        engine = self.engine
        if configuration.start.file is not None:
            frame = read_frame(configuration)
            engine.position, engine.offset = frame.position, frame.offset
            velocity = frame.peculiar_velocity
            if velocity is not None:
                velocity -= self.masses @ velocity / self.masses.sum()
                velocity[:, 0] += imposed_velocity(engine.shear_rate, frame.position[:, 1], configuration.box.size[1])
        else:
            size = np.array(configuration.box.size)
            at = np.mod(placement.positions(configuration, places), size)
            at[at >= size] = 0.0  # a rounding error below 0 comes out as the side itself
            engine.position = at
            engine.velocity = np.zeros_like(at)
            self._start_gently()
            velocity = None
        if velocity is None:
            velocity = placement.velocities(configuration, engine.position, self.masses, engine.shear_rate, speeds)
        engine.velocity = velocity
        engine.place()
        self._is_placed = True

    def _start_gently(self) -> None:
        """The gentle start, in portions, so that Ctrl-C is heard."""
        done, portion = 0, 1
        while done < self.configuration.start.gentle_steps:
            began = time.perf_counter()
            steps = min(portion, self.configuration.start.gentle_steps - done)
            self.engine.start_gently(done, steps, _GENTLE_DISPLACEMENT * self.configuration.fluid.cutoff)
            done += steps
            portion = max(1, round(steps * _PORTION_SECONDS / max(time.perf_counter() - began, 1e-9)))

    @property
    def measured_from(self) -> int:
        """The step that measuring begins at."""
        return self._begin + self.configuration.run.equilibration

    @property
    def end(self) -> int:
        """The step that the current run ends at: the last one, or that at which [measure] stop_when was met."""
        return self._stopped or self.measured_from + self.configuration.steps

    @property
    def is_finished(self) -> bool:
        """Whether the current run is at its end."""
        return self.step >= self.end

    def advance(self, most_steps: int) -> None:
        """Go on by `most_steps`, not beyond the end of equilibration or of the run.

        In whatever portions a run is advanced, it is the same in all bits. Raises RunError when a particle runs away.
        """
        self.place()
        began = time.perf_counter()
        if self.step < self.measured_from:
            self.engine.run(min(most_steps, self.measured_from - self.step))
        else:
            if self._momentum is None:
                self._begin_to_measure()
            last = min(self.step + most_steps, self.end)
            while self.step < last and self.engine.fault is None and not self.is_finished:
                self._measure(min(last, self._next_look()))
        self._seconds += time.perf_counter() - began
        if self.engine.fault is not None:
            raise self._runaway(*self.engine.fault)

    def _begin_to_measure(self) -> None:
        self._momentum = self._peculiar_momentum()
        self._look()

    def _measure(self, step: int) -> None:
        """Go on to a step, not beyond the next look."""
        measured = self.engine.run(step - self.step, 1)
        if self.engine.fault is not None:
            return
        self._sample(measured)
        due = [observer for observer in self._observers.values() if self.step % observer.interval == 0]
        if due:
            moment = self.moment()
            for observer in due:
                observer.sample(moment)
        if self._goal.is_met(self.step, self.result):
            self._stopped = self.step

    def _next_look(self) -> int:
        """The next step at which something is observed, or asked whether the means are good enough."""
        looks = [self.step + o.interval - self.step % o.interval for o in self._observers.values()]
        return min([*looks, *self._goal.next_look(self.step), self.end])

    def _look(self) -> None:
        """Let the core look at the local stress from here on, if it is asked for."""
        profile = self._observers.get("stress_profile")
        if isinstance(profile, StressProfile):
            self.engine.observe_stress(profile.bins, profile.interval)

    def moment(self) -> Moment:
        """The suspension at this step, as observers see it."""
        self.place()
        return moment_of(self.engine, self.configuration, self.masses)

    def series(self) -> xr.Dataset:
        """What has been measured so far, over time. Raises RunError when nothing has been."""
        if not self._samples:
            raise RunError("nothing has been measured yet", "no sample is complete", "run longer")
        samples = self.measured_samples()
        steps = self.measured_from + self.configuration.series_interval * np.arange(1, len(samples) + 1)
        columns = type(self.engine).columns
        return measurement.series(samples, columns, steps, self.configuration, self._freedom())

    def result(self) -> Result:
        """The means so far. Raises RunError when nothing has been measured."""
        series = self.series()
        assert self._momentum is not None
        drift = np.abs(self._peculiar_momentum() - self._momentum).max() / len(self.species)
        return Result(
            configuration=self.configuration,
            series=series,
            freedom=self._freedom(),
            steps=self.step - self.measured_from,
            observers=self._observers,
            momentum_drift=float(drift),
            performance=Performance(
                self._seconds,
                float(len(self.species)) * (self.step - self._begin),
                self.threads,
                self.engine.instruction_set,
            ),
            state_sha256=self.state_sha256,
        )

    def _freedom(self) -> measurement.Freedom:
        return measurement.Freedom.of(self.configuration, self.engine.rotational_freedom)

    def measured_samples(self) -> Vectors:
        """What has been sampled so far, in the engine's columns; shape (n, values)."""
        if len(self._samples) > 1:
            self._samples = [np.concatenate(self._samples)]
        return self._samples[0] if self._samples else np.empty((0, len(self._open)))

    def kinetic_temperature(self) -> float:
        """Kinetic temperature of all particles at this moment; in a driven flow, with the energy of the flow in it."""
        energy = (self.masses[:, None] * self._peculiar_velocities() ** 2).sum()
        return float(energy / self._freedom().all)

    # --- checkpoints ---

    def checkpoint(self) -> Checkpoint:
        """The whole state, and what has been measured."""
        self.place()
        engine = self.engine
        return Checkpoint(
            configuration=self.configuration,
            arrays={
                "position": engine.position,
                "velocity": engine.velocity,
                "force": engine.force,
                "bases": engine.bases,
                "samples": self.measured_samples(),
                "open": self._open,
                "momentum": self._momentum if self._momentum is not None else np.empty(0),
            },
            observed={
                key: array for name, each in self._observers.items() for key, array in under(name, each.state()).items()
            },
            numbers={
                "step": engine.step,
                "begin": self._begin,
                "open_steps": self._open_steps,
                "stopped": self._stopped or 0,
            },
            offset=engine.offset,
            seconds=self._seconds,
            order=engine.order,
        )

    def restore(self, checkpoint: Checkpoint) -> None:
        """Stand exactly where the checkpoint was taken."""
        engine, arrays = self.engine, checkpoint.arrays
        engine.order = checkpoint.order
        engine.position, engine.velocity, engine.force = (arrays[name] for name in ("position", "velocity", "force"))
        engine.bases = arrays["bases"]
        engine.offset = checkpoint.offset
        engine.step = checkpoint.numbers["step"]
        self._begin = checkpoint.numbers["begin"]
        self._samples = [arrays["samples"]] if len(arrays["samples"]) else []
        self._open, self._open_steps = arrays["open"], checkpoint.numbers["open_steps"]
        self._momentum = arrays["momentum"] if len(arrays["momentum"]) else None
        wants_to_stop = self.configuration.measure.stop_when is not None
        self._stopped = (checkpoint.numbers["stopped"] or None) if wants_to_stop else None
        self._set_up()
        for name, observer in self._observers.items():
            observer.restore(part(name, checkpoint.observed))
        if self._momentum is not None:
            self._look()
        self._seconds = checkpoint.seconds
        self._is_placed = True

    def _measure_anew(self) -> None:
        self._begin = self.step
        self._samples = []
        self._open = np.zeros(sum(count for _, count in type(self.engine).columns))
        self._open_steps = 0
        self._momentum = None
        self._seconds = 0.0
        self._stopped = None
        self._set_up()

    def _set_up(self) -> None:
        """Observers that have seen nothing, and the means that are wanted."""
        self.engine.observe_stress(0, 1)
        self._observers = observers_of(self.configuration, self.engine.rotational_freedom)
        self._goal = Goal(self.configuration, self.measured_from)

    def _sample(self, measured: Vectors) -> None:
        """Take the measured steps into samples, step by step in their order: sums do not depend on the portions."""
        interval = self.configuration.series_interval
        for share in np.split(measured / interval, np.arange(interval - self._open_steps, len(measured), interval)):
            self._open = np.add.accumulate(np.vstack([self._open, share]))[-1]
            self._open_steps += len(share)
            if self._open_steps == interval:
                self._samples.append(self._open[None])
                self._open, self._open_steps = np.zeros_like(self._open), 0

    def _peculiar_momentum(self) -> Vectors:
        momentum: Vectors = (self.masses[:, None] * self._peculiar_velocities()).sum(axis=0)
        return momentum

    def _peculiar_velocities(self) -> Vectors:
        v = self.engine.velocity
        height = self.configuration.box.size[1]
        v[:, 0] -= imposed_velocity(self.engine.shear_rate, self.engine.position[:, 1], height)
        return v

    def _runaway(self, step: int, particle: int, speed: float) -> RunError:
        timestep = self.configuration.run.timestep
        kind = "solvent particle" if particle < self.configuration.solvent_count else "constituent"
        return RunError(
            f"{kind} {particle} ran away at step {step}, at a speed of {speed:.3g}",
            f"it would cross half a cutoff in one step, so run.timestep = {timestep:g} is too long for these forces",
            f"try run.timestep = {timestep / 4:.2g}",
            key=("run", "timestep"),
        )

    def __repr__(self) -> str:
        c: Any = self.configuration
        return (
            f"<Simulation in {c.dimension}D: {c.solvent_count} solvent particles, {sum(c.body_counts)} bodies "
            f"(phi = {c.volume_fraction:.4f}), {c.flow.kind}, step {self.step}>"
        )
