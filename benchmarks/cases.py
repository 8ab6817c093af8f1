"""The rows of the table: what is measured, against what, and what we aim at."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fnmatch import fnmatchcase

from benchmarks.setup import Manner, Setup, cubic

NARROWER_SET = "x86-64-v3"
"""The instruction set that is measured beside the widest: most processors have it."""


@dataclass(frozen=True)
class Lammps:
    """The peer, as what a group is measured against."""

    setup: Setup


@dataclass(frozen=True)
class Case:
    """A row of the table."""

    name: str
    setup: Setup
    manner: Manner
    least_ratio: float | None = None
    """What we aim at: our speed over that of the baseline."""
    least_speed: float | None = None
    """What we aim at, in million particle-steps per second."""

    @property
    def detail(self) -> str:
        """Precision and the instruction set asked for."""
        return f"{self.manner.precision} / {self.manner.instruction_set or 'widest'}"

    def matches(self, pattern: str) -> bool:
        """Whether name and detail contain the pattern, which may have wildcards."""
        return fnmatchcase(f"{self.name} {self.detail}", f"*{pattern}*")


@dataclass(frozen=True)
class Group:
    """Cases that are measured in turns with one baseline."""

    cases: tuple[Case, ...]
    baseline: Lammps | Case | None

    def only(self, pattern: str) -> Group:
        """The cases that match."""
        return replace(self, cases=tuple(case for case in self.cases if case.matches(pattern)))


def groups(pattern: str, is_quick: bool, narrower_set: bool) -> list[Group]:
    """Those with a case that matches. Quick: without the largest. narrower_set: whether the processor has it."""
    chosen = [
        *_against_lammps(narrower_set),
        *_threads(),
        *_stress_and_bodies(),
        *_measurements(),
        *_flat(),
        *_sizes([2_000, 16_000, 64_000] if is_quick else [2_000, 16_000, 64_000, 256_000, 1_000_000, 2_000_000]),
    ]
    return [group for whole in chosen if (group := whole.only(pattern)).cases]


SIZES = "sizes, s = 1/2"


def _against_lammps(narrower_set: bool) -> list[Group]:
    made = []
    for exponent, shown, pair, aims in (
        (2.0, "2", "dpd", {None: 7.0, NARROWER_SET: 4.0}),
        (0.5, "1/2", "dpd/ext", {None: 12.0}),
    ):
        for particles in (16_000, 256_000):
            setup = cubic(particles, exponent)
            cases = tuple(
                Case(
                    f"3D, {particles}, s = {shown}; LAMMPS {pair}",
                    setup,
                    Manner(precision, instruction_set),
                    least_ratio=aim if precision == "mixed" else 0.5 * aim,
                )
                for precision in ("mixed", "double")
                for instruction_set, aim in aims.items()
                if instruction_set is None or narrower_set
            )
            made.append(Group(cases, Lammps(setup)))
    return made


def _threads() -> list[Group]:
    made = []
    for particles, aim in ((256_000, 1.85), (16_000, 1.6)):
        setup = cubic(particles, 0.5)
        one = Case("one thread", setup, Manner())
        two = Case(f"two threads / one, {particles}", setup, Manner(threads=2), least_ratio=aim)
        apart = Case(f"two processes / one (machine's limit), {particles}", setup, Manner(processes=2))
        alone = Case("one process", setup, Manner(processes=1))
        made += [Group((two,), one), Group((apart,), alone)]
    return made


def _stress_and_bodies() -> list[Group]:
    setup = cubic(16_000, 0.5)
    stress = Case("stress every step / without, 16000", setup, Manner(interval=1), least_ratio=0.8)
    made = [Group((stress,), Case("without", setup, Manner()))]
    for fraction, cubes, density in ((0.3333, 250, 6.0), (0.4949, 490, 7.92)):
        suspension = Setup((10.0, 10.0, 10.0), shear_rate=0.2, cubes=cubes)
        fluid = replace(suspension, cubes=0, density=density)
        name = f"suspension, phi = {fraction} / plain fluid of density {density:g}"
        case = Case(name, suspension, Manner(), least_ratio=0.8)
        made.append(Group((case,), Case("plain fluid", fluid, Manner())))
    return made


MEASURES = ("profiles", "stress_profile", "radial_distribution", "displacement")


def _measurements() -> list[Group]:
    """Each table of [measure] with its defaults, and all of them, against the engine alone."""
    made = []
    for name, setup in (
        ("3D, 250 cubes", Setup((10.0, 10.0, 10.0), shear_rate=0.2, cubes=250)),
        ("3D, 16000", cubic(16_000, 0.5, shear_rate=0.2)),
        ("2D, 1600", Setup((20.0, 20.0), timestep=0.01, shear_rate=0.2)),
        ("2D, 400", Setup((10.0, 10.0), timestep=0.01, shear_rate=0.2)),
    ):
        cases = [Case(f"{name}, stress / bare engine", setup, Manner(measures=()))]
        cases += [Case(f"{name}, stress and {of} / bare engine", setup, Manner(measures=(of,))) for of in MEASURES]
        cases.append(Case(f"{name}, all measurements / bare engine", setup, Manner(measures=MEASURES), least_ratio=0.6))
        made.append(Group(tuple(cases), Case("bare engine", setup, Manner())))
    return made


def _flat() -> list[Group]:
    return [
        Group((Case(f"2D, {particles}, s = 1/2", setup, Manner(), least_speed=aim),), None)
        for particles, side, aim in ((1600, 20.0, 20.0), (400, 10.0, 12.0))
        for setup in [Setup((side, side), timestep=0.01)]
    ]


def _sizes(sizes: list[int]) -> list[Group]:
    return [Group((Case(f"{SIZES}, {particles}", cubic(particles, 0.5), Manner()),), None) for particles in sizes]
