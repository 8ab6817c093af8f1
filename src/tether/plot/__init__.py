"""Pictures of a run and of a study, each as PNG and SVG: one file here for each kind of picture.

Colors are Okabe and Ito's, told apart by color-blind readers and in gray print. matplotlib's settings and its
current figure are left as they were, so this can be called from a program with pictures of its own. Errors are
standard errors; an error that is not known is not drawn.
"""

from tether.plot.against import plot_against
from tether.plot.displacement import plot_displacement
from tether.plot.flow_curve import plot_flow_curve
from tether.plot.green_kubo import plot_green_kubo
from tether.plot.lissajous import plot_lissajous
from tether.plot.normal_stress import plot_normal_stress
from tether.plot.profile import plot_profile
from tether.plot.profiles import plot_profiles
from tether.plot.radial_distribution import plot_radial_distribution
from tether.plot.relative import plot_relative
from tether.plot.relative_curve import plot_relative_curve
from tether.plot.series import plot_series
from tether.plot.start_up import plot_start_up
from tether.plot.stress_profile import plot_stress_profile
from tether.plot.study_pictures import draw_study, fits_of

__all__ = [
    "draw_study",
    "fits_of",
    "plot_against",
    "plot_displacement",
    "plot_flow_curve",
    "plot_green_kubo",
    "plot_lissajous",
    "plot_normal_stress",
    "plot_profile",
    "plot_profiles",
    "plot_radial_distribution",
    "plot_relative",
    "plot_relative_curve",
    "plot_series",
    "plot_start_up",
    "plot_stress_profile",
]
