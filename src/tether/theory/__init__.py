"""Formulas that a run is compared with: each with its sign convention, its units and its source.

kinetic            transport coefficients of the plain fluid from kinetic theory, without repulsion
equation_of_state  pressure and sound speed of the plain fluid
suspension         relative viscosity against volume fraction
dimensionless      Peclet, Reynolds and Mach numbers of a run, with the sizes that they used

"the paper" in these modules is N. Phan-Thien, N. Mai-Duy and B. C. Khoo, "A spring model for suspended
particles in dissipative particle dynamics", Journal of Rheology (2014). All formulas take and return reduced
units: any consistent set of mass, length and time, in which temperature is kT, an energy.
"""
