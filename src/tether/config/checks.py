"""What has to hold between the tables of a configuration; each check raises a fault that names a key."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pydantic_core import PydanticCustomError

from tether import toml
from tether.bodies import Bodies
from tether.box import Box
from tether.config.output import Output
from tether.config.run import MOST_STEPS, Run
from tether.flows import Couette, Rest
from tether.fluid import Fluid
from tether.model import fault

MOST_PARTICLES = 10**9
MOST_KINDS = 255


def sides(box: Box, fluid: Fluid) -> None:
    """Three cells of one cutoff fit along each side, so that a particle meets no two images of another."""
    least = 3 * fluid.cutoff
    if not min(box.size) >= least * (1 - 1e-12):  # a side written as 3 cutoffs may round below them
        problem = f"= {toml.value(box.size)} has a side of {min(box.size):g}, shorter than 3 cutoffs"
        why = "a particle would meet another one and its periodic image"
        raise fault(("box", "size"), problem, why, f"give every side at least {least:g}, or a smaller fluid.cutoff")


def shapes(box: Box, fluid: Fluid, bodies: Sequence[Bodies]) -> None:
    """Bodies are of the box's dimension and do not meet their own images."""
    for number, each in enumerate(bodies):
        shape = each.geometry
        if shape.dimension != box.dimension:
            raise _wrong_dimension(number, each, box.dimension)
        # A constituent is found as the image nearest to another one of its body; springs stretch by some hundredths.
        reach = max(4.4 * shape.radius, 2 * shape.radius + fluid.cutoff)
        if not reach < min(box.size):
            key = ("bodies", number, "points" if each.shape == "points" else "spacing")
            side = min(box.size)
            problem = f"makes a body of diameter {2 * shape.radius:.3g}, too large for a side of {side:g}"
            why = "a body has to be smaller than half the box, and must not meet its own image"
            remedy = f"give a smaller body, or sides of box.size over {reach:.4g}"
            raise fault(key, problem, why, remedy)


def _wrong_dimension(number: int, bodies: Bodies, dimension: int) -> PydanticCustomError:
    why = "the sites of a body are points of the box"
    if bodies.shape == "points":
        problem = f"has sites of {bodies.geometry.dimension} numbers and the box has {dimension} dimensions"
        remedy = f"give {dimension} numbers for each site, or {bodies.geometry.dimension} in box.size"
        return fault(("bodies", number, "points"), problem, why, remedy)
    problem = f'= "{bodies.shape}" has {bodies.geometry.dimension} dimensions and the box has {dimension}'
    fitting = '"triangle", "square" or "polygon"' if dimension == 2 else '"octahedron" or "cube"'
    remedy = f"give {fitting}, or {bodies.geometry.dimension} numbers in box.size"
    return fault(("bodies", number, "shape"), problem, why, remedy)


def springs(timestep: float, bodies: Sequence[Bodies]) -> None:
    """Velocity Verlet of a spring is stable while omega dt < 2, with omega^2 = H/m."""
    for each in bodies:
        if not timestep < each.longest_timestep:
            springs = f"springs of stiffness {each.stiffness:g} and mass {each.mass:g}"
            problem = f"= {timestep!r} is too long for {springs}"
            why = f"they are unstable from 2 sqrt(mass/stiffness) = {each.longest_timestep:.3g} on"
            shortest = min(other.longest_timestep for other in bodies)
            raise fault(("run", "timestep"), problem, why, f"try {_rounded_down(shortest / 4):g}, or softer springs")


def length(run: Run, flow: Rest | Couette, output: Output) -> None:
    """The run has a number of steps that can be counted and at least one sample."""
    if run.strain is not None and flow.shear_rate == 0:
        problem = f"= {run.strain!r} needs a flow that shears"
        raise fault(
            ("run", "strain"),
            problem,
            "nothing is strained at rest",
            "give run.steps, or a [flow] of couette",
        )
    steps = run.step_count(flow.shear_rate)
    if steps > MOST_STEPS:
        problem = f"= {run.strain!r} takes more than {MOST_STEPS:.0e} steps"
        raise fault(("run", "strain"), problem, "no run lasts so long", "give a smaller strain, or a larger timestep")
    if output.series is not None and output.series > steps:
        problem = f"= {output.series} is more than the {steps} steps of the run"
        why = "a sample is the mean over so many steps, and there would be none"
        raise fault(("output", "series"), problem, why, "give fewer, or leave it out")


def numbers(solvent: int, bodies: Sequence[Bodies], counts: Sequence[int]) -> None:
    """There are particles, and no more than can be."""
    fraction = math.fsum(each.volume_fraction or 0.0 for each in bodies)
    for number, (each, count) in enumerate(zip(bodies, counts, strict=True)):
        key = ("bodies", number, "volume_fraction")
        if each.volume_fraction is not None and not fraction < 1 - 1e-9:
            problem = f"= {each.volume_fraction!r} leaves no room for solvent"
            why = f"the volume fractions of all bodies add up to {fraction:.10g}"
            raise fault(key, problem, why, "give smaller ones, less than 1 together")
        if each.volume_fraction is not None and count == 0:
            problem = f"= {each.volume_fraction!r} is less than half a body"
            why = f"there are {solvent} solvent particles, and numbers of bodies are whole"
            raise fault(key, problem, why, "give a larger one, a larger box, or count = 1")
    particles = solvent + sum(count * each.geometry.sites.shape[0] for each, count in zip(bodies, counts, strict=True))
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


def _rounded_down(number: float) -> float:
    """To one significant digit."""
    unit = 10.0 ** math.floor(math.log10(number))
    return math.floor(number / unit) * unit
