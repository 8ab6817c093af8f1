"""Formulas that a run is compared with: each with its sign convention, its units and its source.

kinetic            transport coefficients of the plain fluid from kinetic theory, without repulsion
equation_of_state  pressure and sound speed of the plain fluid
diffusion          Stokes-Einstein, and what a periodic box makes of a diffusivity
suspension         relative viscosity against volume fraction
dimensionless      Peclet, Reynolds and Mach numbers of a run, with the sizes that they used
sizes              the pore between touching particles
superposition      the repulsion of a body's constituents together, and how round it is
flows              reverse Poiseuille and Kolmogorov flow of a Newtonian fluid
migration          profiles of volume fraction and velocity after shear-induced migration
arrays             what the formulas take and return: numbers and arrays, numbers giving floats

"the paper" in these modules is N. Phan-Thien, N. Mai-Duy and B. C. Khoo, "A spring model for suspended
particles in dissipative particle dynamics", Journal of Rheology (2014). All formulas take and return reduced
units: any consistent set of mass, length and time, in which temperature is kT, an energy.
"""
