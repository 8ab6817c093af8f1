"""How to cite: tether, the paper whose model it implements, and the methods that a run or a study has used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tether.config import Configuration
from tether.report.page import Code, Section, Text
from tether.version import __version__


@dataclass(frozen=True)
class Reference:
    """A publication."""

    text: str
    """Authors, journal, volume, page and year."""
    doi: str


TITLE = "tether: a simulator for the rheology of particulate suspensions"
"""As in CITATION.cff."""

PAPER = Reference(
    "N. Phan-Thien, N. Mai-Duy and B. C. Khoo, A spring model for suspended particles in dissipative particle "
    "dynamics, J. Rheol. 58, 839-867 (2014)",
    "10.1122/1.4874679",
)

_DPD = {
    "dissipative particle dynamics": Reference(
        "R. D. Groot and P. B. Warren, J. Chem. Phys. 107, 4423 (1997)", "10.1063/1.474784"
    ),
    "its temperature": Reference(
        "P. Español and P. Warren, Europhys. Lett. 30, 191 (1995)", "10.1209/0295-5075/30/4/001"
    ),
}
_BLOCKS = Reference("H. Flyvbjerg and H. G. Petersen, J. Chem. Phys. 91, 461 (1989)", "10.1063/1.457480")
_SHEARED_BOX = Reference("A. W. Lees and S. F. Edwards, J. Phys. C 5, 1921 (1972)", "10.1088/0022-3719/5/15/006")
_RIGID = Reference("A. Dullweber, B. Leimkuhler and R. McLachlan, J. Chem. Phys. 107, 5840 (1997)", "10.1063/1.474310")
_POISEUILLE = Reference("J. A. Backer et al., J. Chem. Phys. 122, 154503 (2005)", "10.1063/1.1883163")
_PLANES = Reference(
    "B. D. Todd, D. J. Evans and P. J. Daivis, Phys. Rev. E 52, 1627 (1995)", "10.1103/PhysRevE.52.1627"
)
_CORRELATOR = Reference("J. Ramírez et al., J. Chem. Phys. 133, 154103 (2010)", "10.1063/1.3491098")
_STACIE = Reference(
    "G. Toraman, D. Fauconnier and T. Verstraelen, J. Chem. Inf. Model. (2025)", "10.1021/acs.jcim.5c01475"
)
_OSCILLATION = Reference("K. Hyun et al., Prog. Polym. Sci. 36, 1697 (2011)", "10.1016/j.progpolymsci.2011.02.002")
_KRIEGER = Reference("I. M. Krieger and T. J. Dougherty, Trans. Soc. Rheol. 3, 137 (1959)", "10.1122/1.548848")
_QUEMADA = Reference("D. Quemada, Rheol. Acta 16, 82 (1977)", "10.1007/BF01516932")


def methods_of(configuration: Configuration) -> dict[str, Reference]:
    """What a run has used, and where it is described."""
    flow, measure = configuration.flow, configuration.measure
    rigid = any(bodies.model == "rigid" for bodies in configuration.bodies)
    used = {
        "shear by moving periodic images": (flow.is_sheared, _SHEARED_BOX),
        "reverse Poiseuille flow": (flow.kind == "poiseuille", _POISEUILLE),
        "moduli": (flow.kind == "oscillatory", _OSCILLATION),
        "rotation of rigid bodies": (rigid, _RIGID),
        "stress through planes": (measure.stress_profile is not None, _PLANES),
        "correlation over many lags": (measure.displacement is not None, _CORRELATOR),
        "viscosity from fluctuations": (measure.green_kubo, _STACIE),
    }
    return {
        **_DPD,
        "standard errors": _BLOCKS,
        **{name: reference for name, (is_used, reference) in used.items() if is_used},
    }


LAWS = {"viscosity against volume fraction": _KRIEGER, "the same, another law": _QUEMADA}
"""That a study's viscosities are fitted by."""


def citation(configurations: Sequence[Configuration], *, laws: bool = False) -> Section:
    """How to cite what made these runs; with the laws that were fitted, if any were."""
    methods = {name: reference for each in configurations for name, reference in methods_of(each).items()}
    methods |= LAWS if laws else {}
    listed = "\n".join(f"- {name}: {reference.text}, {_link(reference)}" for name, reference in methods.items())
    return Section(
        "How to cite",
        Text(
            f"If this is of use for a publication, please cite tether and the paper whose model it implements:\n\n"
            f"- tether developers, *{TITLE}*, version {__version__}\n- {PAPER.text}, {_link(PAPER)}\n\n"
            f"Methods used:\n\n{listed}"
        ),
        Code(_bibtex(), "BibTeX"),
    )


def _link(reference: Reference) -> str:
    """A link that is followed by who clicks it; the page itself loads nothing."""
    return f"[doi {reference.doi}](<https://doi.org/{reference.doi}>)"


def _bibtex() -> str:
    return f"""@software{{tether,
  author  = {{{{tether developers}}}},
  title   = {{{TITLE}}},
  version = {{{__version__}}}
}}
@article{{PhanThien2014,
  author  = {{Phan-Thien, N. and Mai-Duy, N. and Khoo, B. C.}},
  title   = {{A spring model for suspended particles in dissipative particle dynamics}},
  journal = {{Journal of Rheology}},
  volume  = {{58}},
  pages   = {{839--867}},
  year    = {{2014}},
  doi     = {{{PAPER.doi}}}
}}"""
