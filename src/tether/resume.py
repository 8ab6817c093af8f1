"""Going on with a run from its folder."""

from __future__ import annotations

from pathlib import Path

from tether.config import Configuration
from tether.engines import mathematics
from tether.errors import InputError
from tether.files import trajectory
from tether.files.checkpoint import Checkpoint
from tether.record import Record
from tether.simulation import Simulation


def resume(folder: Path, threads: int | None = None, more_steps: int = 0) -> tuple[Simulation, Record, list[str]]:
    """The simulation of a folder where its checkpoint left it, and remarks for the user. Nothing is written yet.

    more_steps: measured steps to add to the run's length. Raises InputError for what cannot be resumed.
    """
    record = Record.open(folder)
    checkpoint = None
    configuration = record.configuration()
    if record.checkpoint_path.exists():
        checkpoint = Checkpoint.read(record.checkpoint_path)
        configuration = _lengthened(checkpoint, configuration, record)
    elif record.summary_path.exists():
        raise InputError(
            f"{folder} has results and no checkpoint",
            "its run has ended and cannot go on without one",
            "see them with tether show, or run the configuration again",
        )  # else stopped before the first one: begin again, in the same bits
    if more_steps > 0:
        done = _steps_to_the_goal(checkpoint) if checkpoint is not None else 0
        configuration = configuration.resolved()  # the intervals stay those of the shorter run
        run = configuration.run.changed(steps=(done or configuration.steps) + more_steps, strain=None)
        # Who asks for so many steps wants them, whatever the errors are.
        measure = configuration.measure.changed(stop_when=None) if done else configuration.measure
        configuration = configuration.changed(run=run, measure=measure)
    simulation = Simulation.from_configuration(configuration, threads)
    remarks = []
    if checkpoint is not None:
        simulation.restore(checkpoint)
        if checkpoint.mathematics != mathematics():
            remarks.append(
                f"the checkpoint was written with {checkpoint.mathematics}, this is {mathematics()} (the run goes on "
                "correctly; if it takes pow, log, sin, cos or exp, perhaps not in the same bits)"
            )
    if not trajectory.is_readable(record.trajectory_path):
        aside = trajectory.set_aside(record.trajectory_path).name
        remarks.append(
            f"{record.trajectory_path} is damaged (it cannot be read as GSD); it is kept as {aside}, and a new one "
            "begins here"
        )
    return simulation, record, remarks


def _lengthened(checkpoint: Checkpoint, written: Configuration, record: Record) -> Configuration:
    """The checkpoint's configuration, as long as the one in config.toml, which differs in nothing else.

    A run that had reached its [measure] stop_when may have been made to go on without it.
    """
    former = checkpoint.configuration.resolved()
    run = former.run.changed(steps=written.run.steps, strain=written.run.strain)
    lengthened = former.changed(run=run, output=former.output.changed(checkpoint=written.output.checkpoint))
    least, done = former.steps, _steps_to_the_goal(checkpoint)
    if done and written.measure.stop_when is None:
        lengthened, least = lengthened.changed(measure=former.measure.changed(stop_when=None)), done
    if lengthened.to_toml() != written.to_toml() or lengthened.steps < least:
        raise InputError(
            f"{record.configuration_path} is not what this run was made from",
            "on the way only run.steps may grow and output.checkpoint change",
            "put it back as it was, or copy it and run it into another folder",
        )
    return lengthened


def _steps_to_the_goal(checkpoint: Checkpoint) -> int:
    """Measured steps of a run that ended because its means were good enough; 0 of any other."""
    stopped, begin = checkpoint.numbers["stopped"], checkpoint.numbers["begin"]
    return stopped - begin - checkpoint.configuration.run.equilibration if stopped else 0
