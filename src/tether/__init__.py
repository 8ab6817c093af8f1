"""tether: the rheology of particulate suspensions by dissipative particle dynamics.

import tether as tt
sim = tt.Simulation(box=tt.Box(20, 20, 10), fluid=tt.Fluid(temperature=1.0),
                    bodies=[tt.Bodies(tt.cube(0.25), count=512)], flow=tt.Couette(shear_rate=0.05),
                    timestep=0.005, seed=1)
result = sim.run(equilibration=20_000, steps=100_000)
result.viscosity
"""

from tether.bodies import Bodies
from tether.box import Box
from tether.config import Configuration, Output, Reference, Run, Start, load
from tether.errors import InputError, RunError, TetherError
from tether.estimate import Estimate, estimate
from tether.flows import Couette, Rest
from tether.fluid import Fluid
from tether.result import Result
from tether.shapes import Shape, cube, octahedron, points, polygon, square, triangle
from tether.simulation import Simulation
from tether.version import __version__

__all__ = [
    "Bodies",
    "Box",
    "Configuration",
    "Couette",
    "Estimate",
    "Fluid",
    "InputError",
    "Output",
    "Reference",
    "Rest",
    "Result",
    "Run",
    "RunError",
    "Shape",
    "Simulation",
    "Start",
    "TetherError",
    "__version__",
    "cube",
    "estimate",
    "load",
    "octahedron",
    "points",
    "polygon",
    "square",
    "triangle",
]
