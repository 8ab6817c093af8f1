"""Viscosity of a suspension at rest from the fluctuations of its stress (Green-Kubo).

    eta = V/kT integral over t from 0 to infinity of <S_xy(0) S_xy(t)>                                       (1)

with S the TOTAL stress at each instant: kinetic + conservative + dissipative + RANDOM + body. Said of its
spectrum: the integral over all t, negative too, is 2 eta kT/V. Why this holds for DPD, random term included:

The momentum p_k = sum_i m v_x,i exp(-i k y_i) of a wave along y changes by the stress alone, dp_k/dt = i k V
S_k, S_k the x-force through planes normal to y. At rest <|p_k|^2> = N m kT, and a long wave decays by
viscosity, <p_k(t) p_k(0)*> = N m kT exp(-eta k^2 t/rho). So for times short against that decay

    k^2 V^2 <|integral of S_k from 0 to t|^2> = <|p_k(t) - p_k(0)|^2> = 2 N m kT (1 - exp(-eta k^2 t/rho))
                                              -> 2 V eta kT k^2 t,

and with k -> 0 the time integral of S_xy itself diffuses: <(integral of S_xy)^2> = 2 eta kT t/V, Helfand's form
of (1). Nothing was used but conservation of momentum, the canonical velocities and the decay: neither
reversible dynamics nor smooth forces. But S must be all that moves momentum. Each of these says so of DPD:
G. Jung and F. Schmid, J. Chem. Phys. 144, 204104 (2016), doi 10.1063/1.4950760; D. C. Malaspina et al., Phys.
Chem. Chem. Phys. 25, 12025 (2023), doi 10.1039/d2cp04838h; "Green-Kubo
expressions for transport coefficients from dissipative particle dynamics simulations revisited", ibid. (2024), doi
10.1039/d3cp03791f. Without the random term one needs the instantaneous viscosity eta_infinity as a term of its
own, and one of the two stresses with the sign of its dissipative part reversed (M. H. Ernst and R. Brito, Phys.
Rev. E 72, 061102 (2005), doi 10.1103/PhysRevE.72.061102). Leaving it out and doing nothing else is wrong: by a
factor of four in the paper's fluid.

**Interval means.** A sample is the mean of the stress over all steps of an interval h. The mean multiplies the
spectrum by (sin(pi f h)/(pi f h))^2, which is 1 at f = 0, and sampling at h folds onto f = 0 only multiples of 1/h,
where that factor is zero. So the spectrum at zero frequency, and eta, are exactly those of the steps themselves.

**Components.** An isotropic fluid has five independent shear stresses in 3D, xy, xz, yz, (xx - yy)/2 and
(xx + yy - 2 zz)/(2 sqrt 3), and two in 2D, xy and (xx - yy)/2, each of which obeys (1) with the same prefactor: by
rotating the axes, and because their mean is the contraction of the traceless stress of P. J. Daivis and D. J. Evans,
J. Chem. Phys. 100, 541 (1994), doi 10.1063/1.466970. Of S the symmetric part is taken.

**The limit f -> 0** is fitted by STACIE (G. Toraman, D. Fauconnier and T. Verstraelen, J. Chem. Inf. Model. 65, 10445
(2025), doi 10.1021/acs.jcim.5c01475): (p_0 + p_2 f^2)/(1 + q_2 f^2) below a cutoff frequency, which is white noise and
one exponential relaxation of either sign, by the likelihood that each amplitude is gamma distributed about the model,
averaged over cutoffs by how well the two halves of each fitted band agree. The stress of DPD is nearly white (its
random part is), with a low and wide hump or dip of its relaxation, so that the band is wide and the fit good. (With
exp(p_0 + p_2 f^2), which is five times faster, synthetic stresses had biases of half a standard error.) Alone,
STACIE's criterion overlooks a slow component beneath white noise: with half of eta from a relaxation of 50 samples
in 10 000, exp(...) was 16 standard errors too low. So we add one: the mean amplitude of every octave within the band
must be the model's, by a chi-square test at 1 %, else the cutoff is not used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import attrs
import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.signal import fftconvolve
from scipy.special import chdtri, gammainc, ndtri
from stacie import CV2LCriterion, PadeModel, compute_spectrum, estimate_acint

from tether.estimate import Estimate

POINTS_PER_PARAMETER = 10
"""Frequencies below the cutoff, for each parameter of the fit, under which a run is too short: twice what STACIE will
fit at all, half of what it calls ideal."""

GREATEST_RELATIVE_ERROR = 0.25
"""Beyond it the fit's quadratic approximation of its own error does not hold."""

GREATEST_SCORE = 2.0
"""Of STACIE's two checks, cost and cutoff, in standard deviations: a fit beyond it is not trusted (STACIE's advice)."""

SHORTEST_SERIES = 100
"""Samples; under this no spectrum is fitted at all."""

_PARAMETERS = 3
_CUTOFF_SPACING = 1.0  # twice STACIE's own, for half the time
_MOST_POINTS = 10_000  # of a fitted band: an error of 0.6 % in 3D, after a few seconds
_SIGNIFICANCE = 0.01  # of the test octave by octave


@dataclass(frozen=True)
class GreenKubo:
    """Viscosity of a run at rest, and the spectrum behind it."""

    viscosity: Estimate
    """Its error is one standard error of the fit, cutoffs included; nan, and not converged, where the run was too
    short or the fit failed its checks: `warnings` says which."""
    spectrum: xr.Dataset
    """dims frequency (1/time): `amplitude`, in units of viscosity, eta at f -> 0; `amplitude_error`, of one amplitude;
    `model` and `weight`, the fit and how much of it each frequency was, nan and 0 beyond the band."""
    cutoff: float
    """Mean cutoff frequency of the fit, 1/time; nan without one."""
    points: float
    """Frequencies that the fit used."""
    cost_score: float
    """How badly the model fits, in standard deviations of what a true model gives; nan without a fit."""
    cutoff_score: float
    """How badly the two halves of the band agree, likewise."""
    warnings: list[str]
    """What stands against the viscosity, a sentence each."""


def shear_components(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """The independent shear stresses of an isotropic fluid, (5, n) in 3D and (2, n) in 2D, from stress (n, d, d).

    3D: xy, (xx - yy)/2, xz, yz, (xx + yy - 2 zz)/(2 sqrt 3); 2D: the first two. The sum of their squares is half
    the contraction of the symmetric traceless stress with itself.
    """
    if stress.ndim != 3 or stress.shape[1:] not in ((2, 2), (3, 3)):
        raise ValueError(f"stress has the shape {stress.shape} (not samples by d by d); give (n, 2, 2) or (n, 3, 3)")
    if not np.isfinite(stress).all():
        raise ValueError("a sample of the stress is not finite (so neither is any mean); find the step where it began")
    s = 0.5 * (stress + stress.transpose(0, 2, 1))
    components = [s[:, 0, 1], 0.5 * (s[:, 0, 0] - s[:, 1, 1])]
    if stress.shape[1] == 3:
        third = (s[:, 0, 0] + s[:, 1, 1] - 2.0 * s[:, 2, 2]) / (2.0 * math.sqrt(3.0))
        components += [s[:, 0, 2], s[:, 1, 2], third]
    return np.array(components)


def green_kubo(
    stress: NDArray[np.float64], interval_time: float, volume: float, temperature: float, *, unit: str = ""
) -> GreenKubo:
    """eta = V/(2 kT) times the spectrum of the shear stress at f -> 0 (see the module).

    stress: (n, d, d), energy/length^d, the TOTAL with the random term, means over intervals of all steps.
    interval_time: of one sample. volume: of the box (its area in 2D). temperature: kT, an energy; what the
    thermostat was set to, or better what was measured: eta goes as 1/kT.
    """
    components = shear_components(stress)
    _check(interval_time, volume, temperature)
    if components.shape[1] < SHORTEST_SERIES or not components.std(axis=1).all():
        return _without_fit(components.shape[1], unit)
    # Zero frequency is left out: in a box that isn't cubic the mean of xx - yy need not be zero.
    spectrum = compute_spectrum(
        components, prefactors=volume / temperature, timestep=interval_time, include_zero_freq=False
    )
    try:
        fit = estimate_acint(
            spectrum,
            PadeModel([0, 2], [2]),
            neff_max=_MOST_POINTS,
            fcut_spacing=_CUTOFF_SPACING,
            cutoff_criterion=_EveryOctave(),
        )
    except ValueError:  # no cutoff passed
        return _without_fit(components.shape[1], unit, spectrum)
    warnings = _warnings(fit)
    viscosity = Estimate(
        value=float(fit.acint),
        error=math.nan if warnings else float(fit.acint_std),
        samples=components.shape[1],
        inefficiency=2.0 * float(fit.acint) / (interval_time * float(spectrum.variance)),
        converged=not warnings,
        unit=unit,
        blocks=0 if warnings else int(fit.neff),
    )
    return GreenKubo(
        viscosity=viscosity,
        spectrum=_labelled(spectrum, fit),
        cutoff=float(fit.fcut),
        points=float(fit.neff),
        cost_score=float(fit.props["cost_zscore"]),
        cutoff_score=float(fit.props["criterion_zscore"]),
        warnings=warnings,
    )


def running_integral(
    stress: NDArray[np.float64],
    interval_time: float,
    volume: float,
    temperature: float,
    *,
    longest: float | None = None,
    blocks: int = 20,
) -> xr.Dataset:
    """V/kT times the stress autocorrelation and its integral up to a time, for plots; dims time.

    stress: as for `green_kubo`. The run is cut into `blocks`, whose scatter gives the standard errors. longest:
    greatest lag, a tenth of a block unless given. Of interval means the trapezoidal sum h (C_0/2 + C_1 + ... + C_K) is
    the integral of the correlation of the steps with a weight that is 1 up to K h and falls to 0 at (K + 1) h,
    so it stands at the time (K + 1/2) h. It has the exact limit. The mean of the run is taken off, which lowers
    the integral up to t by the fraction 2 t/(length of the run), at most 1 % unless `longest` is given.
    """
    components = shear_components(stress)
    _check(interval_time, volume, temperature)
    length = components.shape[1] // blocks
    lags = max(1, length // 10) if longest is None else max(1, round(longest / interval_time))
    if 2 * lags > length:
        raise ValueError(
            f"a block of {length} samples is too short for {lags} lags (it must have twice as many);"
            " give a shorter longest time or fewer blocks"
        )
    deviation = (components - components.mean(axis=1, keepdims=True))[:, : blocks * length]
    pieces = deviation.reshape(len(components), blocks, length)
    products = fftconvolve(pieces, pieces[..., ::-1], axes=2)[..., length - 1 : length - 1 + lags]
    correlation = volume / temperature * (products / (length - np.arange(lags))).mean(axis=0)  # (blocks, lags)
    integral = interval_time * (np.cumsum(correlation, axis=1) - 0.5 * correlation[:, :1])
    return xr.Dataset(
        {
            "correlation": ("lag", correlation.mean(axis=0)),
            "correlation_error": ("lag", _standard_error(correlation)),
            "viscosity": ("time", integral.mean(axis=0)),
            "viscosity_error": ("time", _standard_error(integral)),
        },
        coords={"lag": interval_time * np.arange(lags), "time": interval_time * (np.arange(lags) + 0.5)},
        attrs={"title": "running Green-Kubo integral", "blocks": blocks},
    )


@attrs.define
class _EveryOctave(CV2LCriterion):  # type: ignore[misc]
    """STACIE's own criterion, and no octave of the band whose mean amplitude is not the model's.

    An amplitude is the model times a chi-square with its degrees of freedom, divided by these; so is the mean of an
    octave with all of its degrees of freedom. Each is turned into a normal score; the sum of squares is chi-square
    with at most as many degrees of freedom as there are octaves.
    """

    def __call__(self, spectrum: Any, model: Any, props: dict[str, Any]) -> dict[str, Any]:
        result: dict[str, Any] = super().__call__(spectrum, model, props)
        within = int(np.searchsorted(spectrum.freqs, props["fcut"]))
        ratio = spectrum.amplitudes[:within] / model.compute(spectrum.freqs[:within], props["pars"])[0]
        freedom = spectrum.ndofs[:within]
        starts = 2 ** np.arange(max(1, within).bit_length()) - 1  # 1, 2, 4, ... frequencies
        starts = starts[starts < within]
        if len(starts) == 0:
            return result
        freedom_of_octave = np.add.reduceat(freedom, starts)
        chi_square = np.add.reduceat(freedom * ratio, starts)
        tail = gammainc(0.5 * freedom_of_octave, 0.5 * chi_square)
        scores = ndtri(np.clip(tail, 1e-15, 1.0 - 1e-15))
        if scores @ scores > chdtri(len(starts), _SIGNIFICANCE):
            return result | {"criterion": np.inf, "msg": "an octave is not the model's"}
        return result


def _warnings(fit: Any) -> list[str]:
    found = []
    needed = POINTS_PER_PARAMETER * _PARAMETERS
    if fit.neff < needed:
        found.append(
            f"the Green-Kubo viscosity rests on {fit.neff:.0f} frequencies, fewer than {needed} (the run is short"
            " against the slowest relaxation of its stress); measure more steps"
        )
    if not float(fit.acint_std) < GREATEST_RELATIVE_ERROR * float(fit.acint):
        found.append(
            f"the Green-Kubo viscosity is uncertain by more than {100 * GREATEST_RELATIVE_ERROR:.0f} %"
            " (an error that large cannot be trusted itself); measure more steps"
        )
    if max(fit.props["cost_zscore"], fit.props["criterion_zscore"]) > GREATEST_SCORE:
        found.append(
            "the spectrum of the stress at low frequencies is not the fitted one (the fit is more than"
            f" {GREATEST_SCORE:g} standard deviations off); measure more steps, or look at the spectrum"
        )
    return found


def _without_fit(samples: int, unit: str, spectrum: Any = None) -> GreenKubo:
    """What is said of a series too short, or of a spectrum that nothing fits."""
    problem = (
        f"the Green-Kubo viscosity has no value (a stress of {samples} samples has no spectrum that can be fitted);"
        " measure more steps"
    )
    return GreenKubo(
        viscosity=Estimate(math.nan, math.nan, samples, math.nan, converged=False, unit=unit),
        spectrum=_labelled(spectrum, None),
        cutoff=math.nan,
        points=0.0,
        cost_score=math.nan,
        cutoff_score=math.nan,
        warnings=[problem],
    )


def _labelled(spectrum: Any, fit: Any) -> xr.Dataset:
    """STACIE's spectrum and fit with names."""
    frequency = np.empty(0) if spectrum is None else spectrum.freqs
    amplitude = np.empty(0) if spectrum is None else spectrum.amplitudes
    freedom = np.empty(0) if spectrum is None else spectrum.ndofs
    model, weight = np.full(len(frequency), math.nan), np.zeros(len(frequency))
    if fit is not None:
        model[: fit.ncut] = fit.props["amplitudes_model"][0]
        weight[: fit.ncut] = fit.props["weights"]
    return xr.Dataset(
        {
            "amplitude": ("frequency", amplitude),
            "amplitude_error": ("frequency", amplitude * np.sqrt(2.0 / freedom)),
            "model": ("frequency", model),
            "weight": ("frequency", weight),
        },
        coords={"frequency": ("frequency", frequency, {"units": "1/time"})},
        attrs={"title": "spectrum of the shear stress, V/(2 kT) times"},
    )


def _check(interval_time: float, volume: float, temperature: float) -> None:
    for name, value in (("interval_time", interval_time), ("volume", volume), ("temperature", temperature)):
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} = {value} is not a positive number (the viscosity is scaled by it); give one")


def _standard_error(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the mean over the first axis."""
    error: NDArray[np.float64] = rows.std(axis=0, ddof=1) / math.sqrt(len(rows))
    return error
