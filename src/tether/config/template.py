"""A commented file to start from."""

from __future__ import annotations

from string import Template
from typing import Literal

from tether.errors import InputError

_FILE = Template("""\
# A run of tether: `tether run` followed by the name of this file.
# Reduced (DPD) units: mass, length and energy are 1 for the fluid of the paper.

seed = 1                         # the same seed gives the same run, bit for bit

[box]
size = $size

[fluid]
density = 4.0                    # solvent particles per unit of $volume; bodies do not lower it
repulsion = 18.75                # a, of the force a (1 - r/r_c)
noise = 3.0                      # sigma; or friction = 4.5: sigma^2 = 2 gamma kT makes one from the other
temperature = 1.0                # kT
exponent = 0.5                   # s of the dissipative weight (1 - r/r_c)^s
cutoff = 1.0                     # r_c
mass = 1.0
# random = "uniform"             # or "gaussian"

[[bodies]]                       # one such table a kind of body; none is a plain fluid
shape = "$shape"$shapes
spacing = 0.25                   # between nearest sites
count = $count                      # or volume_fraction = 0.2
model = "tethered"
base = "massless"                # or "newton-euler", the paper's own algorithm
stiffness = 3000.0               # of the springs that hold the constituents
mass = 1.0                       # of one constituent

[flow]
$flow
[run]
timestep = $timestep
equilibration = $equilibration            # steps before anything is measured
$length
# verlet_lambda = 0.5            # of the modified velocity Verlet scheme

# [start]
# bodies = "lattice"             # or "random"
# file = "other/trajectory.gsd"  # take the particles from a frame of this file
# frame = -1                     # the last one

# [output]
# checkpoint = { seconds = 60 }  # or { steps = 10000 }
# frames = { steps = 1000 }      # of the trajectory; if not given, about 100 in all
# series = 10                    # steps per sample of the series
# fields = ["velocity"]          # of a frame, besides position and species; also "mass", "body"

# [reference]                    # what you know, for the Peclet, Reynolds and Mach numbers
# radius = 0.605
# diffusivity = 0.03
# viscosity = 2.5
# sound_speed = 5.4
""")

_DIMENSIONS = {
    2: {
        "size": "[20.0, 20.0]              # x flow, y gradient; a third number, z, makes it 3D",
        "volume": "area",
        "shape": "square",
        "shapes": '                 # or "triangle", "polygon" with sides = n, "points" with points = [...]',
        "count": "100",
        "timestep": "0.01",
        "equilibration": "2000 ",
    },
    3: {
        "size": "[10.0, 10.0, 10.0]        # x flow, y gradient, z vorticity; two numbers make it 2D",
        "volume": "volume",
        "shape": "cube",
        "shapes": '                   # or "octahedron", "points" with points = [...]',
        "count": "125",
        "timestep": "0.005",
        "equilibration": "4000 ",
    },
}

_FLOWS = {
    "couette": {
        "flow": 'kind = "couette"                 # or "rest"\nshear_rate = 0.2                 # of either sign\n',
        "length": "strain = 20.0                    # or steps = 20000",
    },
    "rest": {
        "flow": 'kind = "rest"                    # or "couette", with a shear_rate\n',
        "length": "steps = 20000                    # or, in a flow that shears, strain = 20.0",
    },
}


def template(flow: Literal["rest", "couette"] = "couette", dimension: Literal[2, 3] = 3) -> str:
    """A valid configuration with comments, TOML text. Raises InputError."""
    if flow not in _FLOWS:
        raise InputError(f"{flow!r} is no flow", "", 'give "rest" or "couette"', key=("flow", "kind"))
    if dimension not in _DIMENSIONS:
        raise InputError(f"there is nothing in {dimension!r} dimensions", "", "give 2 or 3", key=("box", "size"))
    return _FILE.substitute(_DIMENSIONS[dimension] | _FLOWS[flow])
