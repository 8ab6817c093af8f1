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
from tether.config import Configuration, Measure, Output, Reference, Run, Start, load
from tether.errors import InputError, RunError, TetherError
from tether.estimate import Estimate, estimate
from tether.flows import Couette, Kolmogorov, Oscillatory, Poiseuille, Rest, Stages
from tether.fluid import Fluid
from tether.interactions import Interaction
from tether.result import Result
from tether.shapes import Shape, cube, disc, ellipsoid, octahedron, points, polygon, rod, sphere, square, triangle
from tether.simulation import Simulation
from tether.study import Study, run_study
from tether.version import __version__

__all__ = [
    "Bodies",
    "Box",
    "Configuration",
    "Couette",
    "Estimate",
    "Fluid",
    "InputError",
    "Interaction",
    "Kolmogorov",
    "Measure",
    "Oscillatory",
    "Output",
    "Poiseuille",
    "Reference",
    "Rest",
    "Result",
    "Run",
    "RunError",
    "Shape",
    "Simulation",
    "Stages",
    "Start",
    "Study",
    "TetherError",
    "__version__",
    "cube",
    "disc",
    "ellipsoid",
    "estimate",
    "load",
    "octahedron",
    "points",
    "polygon",
    "rod",
    "run_study",
    "sphere",
    "square",
    "triangle",
]
