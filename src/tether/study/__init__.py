"""Studies: from one run to a flow curve, on a laptop or a cluster."""

from tether.study.results import Results, results_of
from tether.study.run import run_study
from tether.study.study import Study

__all__ = ["Results", "Study", "results_of", "run_study"]
