"""How small a particle fits between touching equal ones, from geometry (the paper's figure 9).

Three discs of radius a that touch leave a pore whose center is 2 a/sqrt(3) from theirs; four spheres, at the
corners of a tetrahedron, one whose center is sqrt(3/2) a away. A smaller particle in it has what is left of
that distance:

    2D: b = (2/sqrt(3) - 1) a = (2 sqrt(3) - 3)/3 a = 0.1547 a,  a/b = 3/(2 sqrt(3) - 3) = 6.4641
    3D: b = (sqrt(3/2) - 1) a = 0.2247 a,                         a/b = 4.4495

The paper prints 6.46 (section 4.5, after J. A. Elliott, A. Kelly and A. H. Windle, J. Mater. Sci. Lett. 21,
1249 (2002)). In 3D it is the passage between three touching spheres, not the hole behind it, that keeps the
ratio 6.46. A solvent particle that fits does not push the packing apart: a necessary condition only.
"""

from __future__ import annotations

import math

from tether.theory.arrays import Numbers, plain

_DISTANCE = {2: 2.0 / math.sqrt(3.0), 3: math.sqrt(1.5)}
"""From the pore's center to those of the particles around it, over their radius."""


def pore_radius(radius: Numbers, dimension: int) -> Numbers:
    """Radius of the largest disc (sphere) between three (four) touching ones of the given radius; length."""
    return plain((_DISTANCE[dimension] - 1.0) * radius)


def pore_size_ratio(dimension: int) -> float:
    """How many times smaller than its neighbors a particle must be to fit between them: 6.4641 (2D), 4.4495."""
    return 1.0 / (_DISTANCE[dimension] - 1.0)
