"""Interactions: laws of force between two species that differ from the fluid's, and the table of all pairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from tether.fluid import Fluid
from tether.model import Model, fault

PairTable = npt.NDArray[np.float64]


class Interaction(Model):
    """The law of force between two species; what it does not say is as in [fluid].

    With r in units of the cutoff r_e of the pair, the conservative force on i along e_ij is, for r < 1,

        linear       F = a_e (1 - r)
        exponential  F = a_e (exp(-b r) - exp(-b)) / (1 - exp(-b))

    The second is that of Pan, Caswell & Karniadakis 2010 (doi 10.1021/la902205x) for bodies of a single particle; it
    goes over into the first as b goes to 0. Both are positive, repulsive. Friction and noise act with the fluid's
    exponent and temperature, within r_e.
    """

    between: tuple[str, ...] = Field(
        strict=False,
        min_length=2,
        max_length=2,
        examples=[["solvent", "colloid"]],
        description='Names of the two species, in any order. "solvent" and names of [[bodies]]; they may be equal.',
    )
    law: Literal["linear", "exponential"] = Field(
        default="linear",
        description="Law of the conservative force. Linear, as the fluid's, or exponential, which rises steeply near "
        "the center.",
    )
    repulsion: float | None = Field(
        default=None,
        ge=0,
        examples=[18.75],
        description="Repulsion a_e, the force at no distance, in units of energy / length. The fluid's if not given.",
    )
    steepness: float | None = Field(
        default=None,
        gt=0,
        le=1000,
        examples=[20.0],
        description="Steepness b of the exponential law, a pure number. Only for it; towards 0 it becomes linear.",
    )
    cutoff: float | None = Field(
        default=None,
        gt=0,
        examples=[1.0],
        description="Range r_e of the forces of this pair, in units of length. The fluid's if not given.",
    )
    friction: float | None = Field(
        default=None,
        ge=0,
        examples=[4.5],
        description="Friction gamma of this pair, in units of mass / time. Give friction or noise, or neither to take "
        "the fluid's.",
    )
    noise: float | None = Field(
        default=None,
        ge=0,
        examples=[3.0],
        description="Amplitude sigma of the random force of this pair, in units of force * time^(1/2). Give friction "
        "or noise, or neither to take the fluid's; sigma^2 = 2 gamma kT makes one from the other.",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.law == "linear" and self.steepness is not None:
            why = "the linear law has none"
            raise fault("steepness", 'does not go with law = "linear"', why, 'take it out, or give law = "exponential"')
        if self.law == "exponential" and self.steepness is None:
            why = 'law = "exponential" needs it'
            raise fault("steepness", "is missing", why, "give it, for example steepness = 20.0")
        if self.friction is not None and self.noise is not None:
            why = "sigma^2 = 2 gamma kT makes one from the other"
            raise fault("noise", f"= {self.noise!r} is given beside friction", why, "give one of them, or neither")
        return self

    def completed(self, fluid: Fluid) -> Interaction:
        """The same law with what it takes from the fluid written out."""
        is_open = self.friction is None and self.noise is None
        return self.changed(
            repulsion=fluid.repulsion if self.repulsion is None else self.repulsion,
            cutoff=fluid.cutoff if self.cutoff is None else self.cutoff,
            friction=fluid.friction if is_open else self.friction,
            noise=fluid.noise if is_open else self.noise,
        )


@dataclass(frozen=True)
class PairParameters:
    """The law of every pair of species: symmetric arrays of shape (species, species), the solvent first."""

    repulsion: PairTable
    """a_e, in units of energy / length."""
    steepness: PairTable
    """b, a pure number; 0 is the linear law."""
    friction: PairTable
    """gamma, in units of mass / time."""
    noise: PairTable
    """sigma, in units of force * time^(1/2); sigma^2 = 2 gamma kT of each pair."""
    cutoff: PairTable
    """r_e, in units of length."""
    is_uniform: bool
    """Whether every pair has the fluid's law."""

    @property
    def largest_cutoff(self) -> float:
        """The longest range of any pair, in units of length."""
        return float(self.cutoff.max())


def pair_parameters(fluid: Fluid, species: Sequence[str], interactions: Sequence[Interaction]) -> PairParameters:
    """The fluid's law for every pair of species, but for the pairs of the interactions, whose species are all known."""
    fluids = np.array([fluid.repulsion, 0.0, fluid.gamma, fluid.sigma, fluid.cutoff])
    table = np.tile(fluids, (len(species), len(species), 1))
    for interaction in interactions:
        # A fluid with this pair's amplitudes makes one from the other.
        pair = fluid
        if interaction.friction is not None or interaction.noise is not None:
            pair = fluid.changed(friction=interaction.friction, noise=interaction.noise)
        of_pair = [
            fluid.repulsion if interaction.repulsion is None else interaction.repulsion,
            interaction.steepness or 0.0,
            pair.gamma,
            pair.sigma,
            fluid.cutoff if interaction.cutoff is None else interaction.cutoff,
        ]
        first, second = (species.index(name) for name in interaction.between)
        table[first, second] = table[second, first] = of_pair
    for_each = np.moveaxis(table, 2, 0).copy()
    for_each.setflags(write=False)
    repulsion, steepness, friction, noise, cutoff = for_each
    is_uniform = bool((table == fluids).all())
    return PairParameters(repulsion, steepness, friction, noise, cutoff, is_uniform)
