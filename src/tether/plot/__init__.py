"""Pictures of a run, each as PNG and SVG: one file here for each kind of picture.

Colors are Okabe and Ito's, told apart by color-blind readers and in gray print. matplotlib's settings and its
current figure are left as they were, so this can be called from a program with pictures of its own. Errors are
standard errors; an error that is not known is not drawn.
"""

from tether.plot.displacement import plot_displacement
from tether.plot.green_kubo import plot_green_kubo
from tether.plot.lissajous import plot_lissajous
from tether.plot.profile import plot_profile
from tether.plot.profiles import plot_profiles
from tether.plot.radial_distribution import plot_radial_distribution
from tether.plot.relative import plot_relative
from tether.plot.series import plot_series
from tether.plot.start_up import plot_start_up
from tether.plot.stress_profile import plot_stress_profile

__all__ = [
    "plot_displacement",
    "plot_green_kubo",
    "plot_lissajous",
    "plot_profile",
    "plot_profiles",
    "plot_radial_distribution",
    "plot_relative",
    "plot_series",
    "plot_start_up",
    "plot_stress_profile",
]
