"""Fig. 6: radial distribution functions of solvent and bodies, 2D

The paper shows g(q) about a solvent particle and about one suspended disc at kT = 1, 0.5 and 0.25, in bins of 0.01, and
reads sizes off where g becomes 0.01 (Table 1). We take several bodies in one box, which are as good as one for as many
times its run, and all solvent particles; shells have their exact volume. The lower panels have the feet of the curves,
where the sizes come from, on a logarithmic axis. The runs are those of Table 1.
"""

from __future__ import annotations

from collections.abc import Mapping

from tether.paper import Findings, Panel, Part
from tether.paper.distributions import figure_findings, figure_panels


def evaluate(parts: Mapping[str, Part]) -> Findings:
    """Curves, and where they begin."""
    return figure_findings(parts[""], "square", "fig. 6")


def panels(findings: Findings) -> list[Panel]:
    """Solvent and bodies, as they are and their feet."""
    return figure_panels(findings, "square")
