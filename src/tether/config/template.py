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
model = "tethered"               # or "rigid", without the next two; or "single": one particle, with a radius
base = "massless"                # or "newton-euler", the paper's own algorithm
stiffness = 3000.0               # of the springs that hold the constituents
mass = 1.0                       # of one constituent
# effective_radius = 0.6         # to count the bodies' volume by, not their particles

# [[interactions]]               # one such table a pair of species whose forces are not as in [fluid]
# between = ["solvent", "$shape"]
# law = "linear"                 # or "exponential", with steepness = 20.0
# repulsion = 18.75
# cutoff = 1.0
# noise = 3.0                    # or friction = 4.5

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

# [measure]                      # beside stress and temperature; every: steps between samples
# profiles = { bins = 20, every = 50 }                 # density, velocity, temperature across y
# stress_profile = { bins = 20, every = 100 }          # stress across y and through planes
# radial_distribution = { width = 0.01, every = 200 }  # g(r) and effective sizes
# displacement = { every = 50, solvent = 2000 }        # diffusion, of at most so many solvent particles
$measure

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
        "shapes": '                 # or "triangle", "polygon", "disc", "ellipsoid", "rod", "points"',
        "count": "100",
        "timestep": "0.01",
        "equilibration": "2000 ",
    },
    3: {
        "size": "[10.0, 10.0, 10.0]        # x flow, y gradient, z vorticity; two numbers make it 2D",
        "volume": "volume",
        "shape": "cube",
        "shapes": '                   # or "octahedron", "sphere", "ellipsoid", "rod", "points"',
        "count": "125",
        "timestep": "0.005",
        "equilibration": "4000 ",
    },
}

_FLOWS = {
    "couette": {
        "flow": 'kind = "couette"                 # or $others\nshear_rate = 0.2                 # of either sign\n',
        "length": "strain = 20.0                    # or steps = 20000",
        "measure": "# stop_when = { viscosity = 0.01 }                     # end the run at this relative error",
    },
    "rest": {
        "flow": 'kind = "rest"                    # or $others\n',
        "length": "steps = 20000                    # or, in a flow that shears steadily, strain = 20.0",
        "measure": "# green_kubo = true                                    # the viscosity, from fluctuations",
    },
    "oscillatory": {
        "flow": 'kind = "oscillatory"             # or $others\n'
        "strain_amplitude = 0.5           # the strain is 0.5 sin(omega t)\n"
        "angular_frequency = 1.0          # omega; a cycle lasts 2 pi / omega\n",
        "length": "steps = 40000                    # some tens of cycles",
    },
    "stages": {
        "flow": 'kind = "stages"                  # or $others\n'
        "stages = [                       # gone through again and again; stress is averaged over the times\n"
        "    { shear_rate = 0.5, duration = 10.0 },\n"
        "    { shear_rate = 0.0, duration = 10.0 },\n"
        "]\n",
        "length": "steps = 40000                    # ten times and more",
    },
    "poiseuille": {
        "flow": 'kind = "poiseuille"              # or $others\n'
        "force = 0.05                     # on every particle: + in the upper half of the box, - in the lower one\n",
        "length": "steps = 40000",
    },
    "kolmogorov": {
        "flow": 'kind = "kolmogorov"              # or $others\n'
        "force = 0.05                     # g of g sin(2 pi periods y/L_y), on every particle\n"
        "periods = 1                      # number of waves across the box\n",
        "length": "steps = 40000",
    },
}

_STOP = "# stop_when = { pressure = 0.001 }                     # end the run at this relative error"
"""The line of [measure] for flows that have no other mean of their own to stop for."""


def template(flow: str = "couette", dimension: Literal[2, 3] = 3) -> str:
    """A valid configuration with comments, TOML text. flow: any kind. Raises InputError."""
    if flow not in _FLOWS:
        raise InputError(f"{flow!r} is no flow", "", f"give {_listed(list(_FLOWS))}", key=("flow", "kind"))
    if dimension not in _DIMENSIONS:
        raise InputError(f"there is nothing in {dimension!r} dimensions", "", "give 2 or 3", key=("box", "size"))
    words = {"measure": _STOP} | _DIMENSIONS[dimension] | _FLOWS[flow]
    words["flow"] = Template(words["flow"]).substitute(others=_listed([kind for kind in _FLOWS if kind != flow], ", "))
    return _FILE.substitute(words)


def _listed(kinds: list[str], last: str = " or ") -> str:
    quoted = [f'"{kind}"' for kind in kinds]
    return ", ".join(quoted[:-1]) + last + quoted[-1]
