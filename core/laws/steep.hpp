// The DPD law with a conservative force that may be steep (Pan, Caswell & Karniadakis 2010, doi 10.1021/la902205x), for
// pairs that have parameters of their own:
//     F_C = a w + a_e (exp(-b r/r_e) - exp(-b)) / (1 - exp(-b))      w = 1 - r/r_e
// with a = 0 or a_e = 0: steep or linear.  Where b goes to 0 the steep force goes to a_e w; it is computed as
// a_e exp(-b r/r_e) (1 - exp(-b w)) / (1 - exp(-b)), which loses no digits there.  Dissipative and random force are those
// of dpd.hpp, within the pair's own cutoff r_e.
#pragma once

#include "laws/dpd.hpp"

namespace tether {

template <class Real>
struct SteepParameters {
    DpdParameters<Real> dpd;  // a, gamma, sigma/sqrt(dt), 1/r_e
    Real cutoff;              // r_e, length
    Real steepness;           // b
    Real height;              // a_e / (1 - exp(-b)), force
};

template <class Weight>
struct SteepDpd {
    Weight weight;
    template <class Real>
    TETHER_DEVICE PairForce<Real> operator()(Pair<Real> const& pair, SteepParameters<Real> const& p) const {
        PairForce<Real> force = Dpd<Weight>{weight}(pair, p.dpd);
        Real const distance = pair.distance * p.dpd.inverse_cutoff, b = p.steepness;
        force.conservative = force.conservative - p.height * exponential(-b * distance) *
                                                      exponential_less_one(-b * (Real(1) - distance));  // steep
        return force;
    }
};

}  // namespace tether
