"""The paper, reproduced: its tables and figures, what they rest on, and what becomes of its claims."""

from tether.paper.claim import Claim, Comparison, Verdict, consistent, exact, judged, near, z_of
from tether.paper.exhibit import Exhibit, Findings, Part, Size, exhibits
from tether.paper.panel import COLORS, Panel, Series, draw_panels

__all__ = [
    "COLORS",
    "Claim",
    "Comparison",
    "Exhibit",
    "Findings",
    "Panel",
    "Part",
    "Series",
    "Size",
    "Verdict",
    "consistent",
    "draw_panels",
    "exact",
    "exhibits",
    "judged",
    "near",
    "z_of",
]
