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
        configuration = _lengthened(checkpoint.configuration, configuration, record)
    elif record.summary_path.exists():
        raise InputError(
            f"{folder} has results and no checkpoint",
            "its run has ended and cannot go on without one",
            "see them with tether show, or run the configuration again",
        )  # else stopped before the first one: begin again, in the same bits
    if more_steps > 0:
        steps = configuration.steps + more_steps
        configuration = configuration.resolved()  # the intervals stay those of the shorter run
        configuration = configuration.changed(run=configuration.run.changed(steps=steps, strain=None))
    simulation = Simulation.from_configuration(configuration, threads)
    remarks = []
    if checkpoint is not None:
        simulation.restore(checkpoint)
        if checkpoint.mathematics != mathematics():
            remarks.append(
                f"the checkpoint was written with {checkpoint.mathematics}, this is {mathematics()} (the run goes on "
                "correctly; if it takes pow, log, sin or cos, perhaps not in the same bits)"
            )
    if not trajectory.is_readable(record.trajectory_path):
        aside = trajectory.set_aside(record.trajectory_path).name
        remarks.append(
            f"{record.trajectory_path} is damaged (it cannot be read as GSD); it is kept as {aside}, and a new one "
            "begins here"
        )
    return simulation, record, remarks


def _lengthened(checkpoint: Configuration, written: Configuration, record: Record) -> Configuration:
    """The checkpoint's configuration, as long as the one in config.toml, which differs in nothing else."""
    checkpoint = checkpoint.resolved()
    run = checkpoint.run.changed(steps=written.run.steps, strain=written.run.strain)
    lengthened = checkpoint.changed(run=run, output=checkpoint.output.changed(checkpoint=written.output.checkpoint))
    if lengthened.to_toml() != written.to_toml() or lengthened.steps < checkpoint.steps:
        raise InputError(
            f"{record.configuration_path} is not what this run was made from",
            "on the way only run.steps may grow and output.checkpoint change",
            "put it back as it was, or copy it and run it into another folder",
        )
    return lengthened
