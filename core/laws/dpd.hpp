// The DPD law (Espanol & Warren 1995, doi 10.1209/0295-5075/30/4/001; Phan-Thien et al. 2014, eq. 4-6 and 11-12).
//
// The force on i from j is along e_ij = r_ij/r, with r_ij = r_i - r_j; a positive magnitude repels:
//     F_C = a w                      w = 1 - r/r_c
//     F_D = -gamma w_D (e_ij . v_ij)
//     F_R = sigma w_R xi / sqrt(dt)  sigma^2 = 2 gamma kT, xi: mean 0, variance 1
// and nothing at or beyond r_c.
#pragma once

#include "laws/weight.hpp"

namespace tether {

// All that a law sees of two particles.
template <class Real>
struct Pair {
    Real distance;   // r, length; below the cutoff
    Real departure;  // e_ij . v_ij, velocity; positive when they move apart
    Real noise;      // xi
};

template <class Real>
struct DpdParameters {
    Real repulsion;        // a, force
    Real friction;         // gamma, force time/length
    Real noise_amplitude;  // sigma/sqrt(dt), force
    Real inverse_cutoff;   // 1/r_c
};

// Magnitudes along e_ij; the sum is the force on i.
template <class Real>
struct PairForce {
    Real conservative, dissipative, random;
    TETHER_DEVICE Real total() const { return conservative + dissipative + random; }
};

template <class Weight>
struct Dpd {
    Weight weight;
    template <class Real>
    TETHER_DEVICE PairForce<Real> operator()(Pair<Real> const& pair, DpdParameters<Real> const& p) const {
        Real const w = Real(1) - pair.distance * p.inverse_cutoff;
        Weights<Real> const of = weight(w);
        return {
            p.repulsion * w,                                // conservative
            -p.friction * of.dissipative * pair.departure,  // dissipative
            p.noise_amplitude * of.random * pair.noise,     // random
        };
    }
};

}  // namespace tether
