"""What is made of series and profiles after a run: viscosities by other routes, moduli, start-up curves.

Arrays in, estimates and labelled arrays out; nothing here knows a configuration or an engine.

green_kubo        viscosity of a run at rest, from the fluctuations of its stress
oscillatory       storage and loss modulus, third harmonic, stress against strain
start_up          stress after a change of the shear rate, averaged over repeats
momentum_balance  viscosity of force-driven flow, from the force and the velocity that it drives
"""
