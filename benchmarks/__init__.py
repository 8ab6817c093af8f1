"""How fast tether is: `python -m benchmarks`."""
