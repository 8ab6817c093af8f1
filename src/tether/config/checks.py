"""What has to hold between the tables of a configuration; each check raises a fault that names a key."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pydantic_core import PydanticCustomError

from tether import toml
from tether.bodies import Bodies
from tether.box import Box
from tether.config.measure import Measure
from tether.config.output import Output
from tether.config.run import MOST_STEPS, Run
from tether.explain.values import choose, listed
from tether.flows import Flow, Kolmogorov, Oscillatory, Poiseuille, Stages
from tether.interactions import Interaction
from tether.model import fault
from tether.shapes import Shape

MOST_OF_A_CYCLE = 1 / 8
"""Of an oscillation, that a sample may last."""

MOST_SAMPLES = 5_000_000
MOST_PARTICLES = 10**9
MOST_KINDS = 255


def names(species: Sequence[str], bodies: Sequence[Bodies]) -> None:
    """Every species has a name of its own. species: the solvent's name, then that of each table of bodies."""
    for number, name in enumerate(species):
        first = species.index(name)
        if first != number:
            at = number if bodies[number - 1].name is not None else first
            other = first if at == number else number
            problem = f"= {toml.value(name)} is the name of bodies.{other - 1} too"
            why = "a species is known by its name"
            raise fault(("bodies", at - 1, "name"), problem, why, "give each table a name of its own")


def interactions(listed_pairs: Sequence[Interaction], species: Sequence[str]) -> None:
    """Interactions are between species that there are, each pair once."""
    seen: dict[frozenset[str], int] = {}
    for number, each in enumerate(listed_pairs):
        for place, name in enumerate(each.between):
            if name not in species:
                problem = f"= {toml.value(name)} is no species"
                why = f"there {'is' if len(species) == 1 else 'are'} {listed(species)}"
                raise fault(("interactions", number, "between", place), problem, why, choose(name, species))
        pair = frozenset(each.between)
        if pair in seen:
            problem = f"= {toml.value(each.between)} is there already"
            why = f"interactions.{seen[pair]} is of the same pair, in any order"
            raise fault(("interactions", number, "between"), problem, why, "take one of them out")
        seen[pair] = number


def sides(box: Box, cutoff: float, pairs: Sequence[Interaction]) -> None:
    """Three cells of one cutoff fit along each side, so that a particle meets no two images of another.

    cutoff: the longest of all pairs.
    """
    least = 3 * cutoff
    if not min(box.size) >= least * (1 - 1e-12):  # a side written as 3 cutoffs may round below them
        longest = [number for number, pair in enumerate(pairs) if pair.cutoff == cutoff]
        key = f"interactions.{longest[0]}.cutoff" if longest else "fluid.cutoff"
        problem = f"= {toml.value(box.size)} has a side of {min(box.size):g}, shorter than 3 cutoffs"
        why = "a particle would meet another one and its periodic image"
        raise fault(("box", "size"), problem, why, f"give every side at least {least:g}, or a smaller {key}")


def shapes(box: Box, cutoff: float, bodies: Sequence[Bodies], geometries: Sequence[Shape]) -> None:
    """Bodies are of the box's dimension and do not meet their own images. cutoff: the longest of all pairs."""
    side = min(box.size)
    for number, (each, shape) in enumerate(zip(bodies, geometries, strict=True)):
        if shape.dimension != box.dimension:
            raise _wrong_dimension(number, each, shape.dimension, box.dimension)
        radius = shape.radius if each.model != "single" else each.radius or 0.0
        # A constituent is found as the image nearest to another one of its body; springs stretch by some hundredths.
        reach = max(4.4 * radius, 2 * radius + cutoff)
        if not reach < side:
            sizes = [name for name in ("points", "radius", "length", "semiaxes") if getattr(each, name) is not None]
            problem = f"makes a body of diameter {2 * radius:.3g}, too large for a side of {side:g}"
            why = "a body has to be smaller than half the box, and must not meet its own image"
            remedy = f"give a smaller body, or sides of box.size over {reach:.4g}"
            raise fault(("bodies", number, *(sizes or ["spacing"])), problem, why, remedy)


def _wrong_dimension(number: int, bodies: Bodies, own: int, dimension: int) -> PydanticCustomError:
    why = "the sites of a body are points of the box"
    if bodies.shape in ("points", "ellipsoid"):
        key, of = ("points", "for each site") if bodies.shape == "points" else ("semiaxes", "there")
        problem = f"has {'sites of ' if key == 'points' else ''}{own} numbers and the box has {dimension} dimensions"
        return fault(("bodies", number, key), problem, why, f"give {dimension} numbers {of}, or {own} in box.size")
    problem = f'= "{bodies.shape}" has {own} dimensions and the box has {dimension}'
    fitting = '"triangle", "square", "polygon" or "disc"' if dimension == 2 else '"octahedron", "cube" or "sphere"'
    return fault(("bodies", number, "shape"), problem, why, f"give {fitting}, or {own} numbers in box.size")


def springs(timestep: float, bodies: Sequence[Bodies], masses: Sequence[float]) -> None:
    """Velocity Verlet of a spring is stable while omega dt < 2, with omega^2 = H/m. masses: of one constituent."""
    longest = [each.longest_timestep(mass) for each, mass in zip(bodies, masses, strict=True)]
    for each, mass, limit in zip(bodies, masses, longest, strict=True):
        if not timestep < limit:
            problem = f"= {timestep!r} is too long for springs of stiffness {each.stiffness:g} and mass {mass:.6g}"
            why = f"they are unstable from 2 sqrt(mass/stiffness) = {limit:.3g} on"
            remedy = f"try {_rounded_down(min(longest) / 4):g}, or softer springs"
            raise fault(("run", "timestep"), problem, why, remedy)


def length(run: Run, flow: Flow, output: Output) -> None:
    """The run has a number of steps that can be counted and at least one sample."""
    if run.strain is not None and flow.shear_rate == 0:
        problem = f"= {run.strain!r} needs a flow that shears steadily"
        why = "only strain at a constant rate says how long a run is"
        raise fault(("run", "strain"), problem, why, "give run.steps, or a [flow] of couette")
    for number, stage in enumerate(flow.stages if isinstance(flow, Stages) else ()):
        if stage.steps(run.timestep) == 0:
            problem = f"= {stage.duration!r} is less than half a step"
            why = f"stages last whole steps, of {run.timestep:g} each"
            raise fault(("flow", "stages", number, "duration"), problem, why, "give a longer one, or take it out")
    steps = run.step_count(flow.shear_rate)
    if steps > MOST_STEPS:
        problem = f"= {run.strain!r} takes more than {MOST_STEPS:.0e} steps"
        raise fault(("run", "strain"), problem, "no run lasts so long", "give a smaller strain, or a larger timestep")
    if output.series is not None and output.series > steps:
        problem = f"= {output.series} is more than the {steps} steps of the run"
        why = "a sample is the mean over so many steps, and there would be none"
        raise fault(("output", "series"), problem, why, "give fewer, or leave it out")


def unsteady(run: Run, flow: Flow, interval: int) -> None:
    """Samples resolve the cycle of an oscillation, and no sample spans two stages."""
    if isinstance(flow, Oscillatory):
        least = run.timestep / MOST_OF_A_CYCLE
        if flow.period < least:
            problem = f"= {flow.angular_frequency:g} makes a cycle of {flow.period / run.timestep:.3g} steps"
            why = f"its third harmonic takes {1 / MOST_OF_A_CYCLE:g} samples a cycle"
            raise fault(("flow", "angular_frequency"), problem, why, f"give at most {2 * math.pi / least:.4g}")
        if interval * run.timestep > MOST_OF_A_CYCLE * flow.period:
            most = int(MOST_OF_A_CYCLE * flow.period / run.timestep)
            problem = f"= {interval} leaves too few samples of a cycle of {flow.period:.4g}"
            why = f"its third harmonic takes {1 / MOST_OF_A_CYCLE:g} of them"
            raise fault(("output", "series"), problem, why, f"give at most {most}, or leave it out")
    if isinstance(flow, Stages):
        stages = [stage.steps(run.timestep) for stage in flow.stages]
        if any(length % interval for length in stages):
            problem = f"= {interval} does not divide the stages, of {listed([str(n) for n in stages])} steps"
            why = "a sample would be the mean over two of them"
            raise fault(("output", "series"), problem, why, "give a number that divides them, or leave it out")
        if run.step_count(0.0) // interval > MOST_SAMPLES:
            problem = f"last {listed([str(n) for n in stages])} steps, after an equilibration of {run.equilibration}"
            why = "samples are whole parts of each, and there would be millions of them"
            raise fault(("flow", "stages"), problem, why, "give durations with a large common divisor")


def measure(measured: Measure, box: Box, flow: Flow, radial_range: float) -> None:
    """What is measured exists in this flow and this box."""
    functions = measured.radial_distribution
    if functions is not None and radial_range > min(box.size) / 3 * (1 + 1e-12):
        problem = f"= {radial_range!r} is more than a third of the smallest side, {min(box.size):g}"
        why = "beyond it a particle may be met twice"
        remedy = f"give at most {_rounded_down(min(box.size) / 3):g}, or leave it out"
        raise fault(("measure", "radial_distribution", "range"), problem, why, remedy)
    if functions is not None and functions.width > radial_range / 2:
        problem = f"= {functions.width!r} leaves fewer than two bins of the range of {radial_range:.3g}"
        remedy = f"give at most {_rounded_down(radial_range / 2):g}"
        raise fault(("measure", "radial_distribution", "width"), problem, "there would be no function", remedy)
    _check_bins(measured, flow)
    if measured.green_kubo and (flow.is_sheared or flow.is_driven):
        why = "fluctuations tell the viscosity of a suspension at rest only"
        raise fault(("measure", "green_kubo"), "= true needs a suspension at rest", why, 'give [flow] kind = "rest"')
    targets = measured.stop_when.targets if measured.stop_when is not None else {}
    for name in targets:
        if name.startswith("viscosity") and flow.shear_rate == 0:
            why = "without a steady shear there is no such mean"
            remedy = "stop for the pressure, or shear steadily"
            raise fault(("measure", "stop_when", name), "needs a steady shear", why, remedy)


def _check_bins(measured: Measure, flow: Flow) -> None:
    """Bins of profiles are fine enough for the balance of momentum in the flow."""
    if measured.profiles is None:
        return
    bins, key = measured.profiles.bins, ("measure", "profiles", "bins")
    if isinstance(flow, Kolmogorov) and bins < 4 * flow.periods:
        problem = f"= {bins} are too few for {flow.periods} waves"
        raise fault(key, problem, "a wave takes four", f"give at least {4 * flow.periods}, or leave it out")
    if isinstance(flow, Poiseuille) and bins % 2:
        problem = f"= {bins} has a bin in the middle, where the force changes its sign"
        raise fault(key, problem, "the force has to be even within a bin", "give an even number")


def numbers(solvent: int, box: Box, bodies: Sequence[Bodies], counts: Sequence[int], sites: Sequence[int]) -> None:
    """There are particles, and no more than can be; bodies have less volume than the box. sites: of one body each."""
    fraction = math.fsum(each.volume_fraction or 0.0 for each in bodies)
    for number, (each, count) in enumerate(zip(bodies, counts, strict=True)):
        key = ("bodies", number, "volume_fraction")
        if each.volume_fraction is not None and not fraction < 1 - 1e-9:
            problem = f"= {each.volume_fraction!r} leaves no room for solvent"
            why = f"the volume fractions of all bodies add up to {fraction:.10g}"
            raise fault(key, problem, why, "give smaller ones, less than 1 together")
        if each.volume_fraction is not None and count == 0:
            volume = each.volume_in(box.dimension)
            of = f"there are {solvent} solvent particles" if volume is None else f"a body has a volume of {volume:.4g}"
            problem = f"= {each.volume_fraction!r} is less than half a body"
            raise fault(
                key, problem, f"{of}, and numbers of bodies are whole", "give a larger one, a larger box, or count = 1"
            )
    particles = solvent + sum(count * each for count, each in zip(counts, sites, strict=True))
    if particles < 2:
        problem = f"makes {particles or 'no'} particle in this box"
        why = "solvent = density * volume, and a fluid has at least two particles"
        raise fault(("fluid", "density"), problem, why, "give a larger density or box.size")
    if len(bodies) > MOST_KINDS:
        problem = f"has {len(bodies)} tables"
        raise fault(("bodies",), problem, f"a run has at most {MOST_KINDS} kinds of bodies", "put like bodies together")
    if particles > MOST_PARTICLES:
        culprit = ("box", "size") if solvent > MOST_PARTICLES else ("bodies",)
        problem = f"asks for {particles:.3g} particles" if particles < 1e18 else "asks for over 1e18 particles"
        why = f"a run has at most {MOST_PARTICLES:.0e}, and solvent = density * volume"
        raise fault(culprit, problem, why, "look for a typing error, or give a smaller box, density or count")
    _room(box, bodies, counts)


def _room(box: Box, bodies: Sequence[Bodies], counts: Sequence[int]) -> None:
    volumes = [count * (each.volume_in(box.dimension) or 0.0) for each, count in zip(bodies, counts, strict=True)]
    if not math.fsum(volumes) < box.volume:
        largest = max(range(len(volumes)), key=volumes.__getitem__)
        problem = f"= {counts[largest]} makes bodies of a volume of {volumes[largest]:.4g}"
        why = f"all bodies together would fill the box, whose volume is {box.volume:.4g}"
        name = "count" if bodies[largest].count is not None else "volume_fraction"
        raise fault(("bodies", largest, name), problem, why, "give fewer or smaller bodies, or a larger box")


def _rounded_down(number: float) -> float:
    """To one significant digit."""
    unit = 10.0 ** math.floor(math.log10(number))
    return math.floor(number / unit) * unit
