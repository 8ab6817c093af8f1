"""Shear thinning in five minutes: the viscosity of discs at three shear rates, from Python."""

import argparse

import tether as tt

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--strain", type=float, default=40.0, help="strain that each rate is measured over")
strain = parser.parse_args().strain

for rate in (0.2, 1.0, 5.0):
    simulation = tt.Simulation(
        box=tt.Box(10, 10),
        fluid=tt.Fluid(temperature=1.0),
        bodies=[tt.Bodies(tt.square(0.25), volume_fraction=0.3289)],
        flow=tt.Couette(shear_rate=rate),
        timestep=0.005,
        seed=1,
    )
    result = simulation.run(equilibration=2000, strain=strain)
    print(f"shear rate {rate:4.1f}   viscosity {result.viscosity}   N1 {result.N1}", flush=True)
