"""How fast tether is, and how fast LAMMPS is on the same particles: `python -m benchmarks`."""
