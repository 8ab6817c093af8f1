// Weight functions of the dissipative and random forces (Phan-Thien et al. 2014, eq. 9 and 12):
//     w_D = w^s,   w_R = sqrt(w_D) = w^(s/2),   with w = 1 - r/r_c.
// s = 1/2 and s = 2 need no power function.
#pragma once

#include "lane.hpp"

namespace tether {

template <class Real>
struct Weights {
    Real dissipative, random;
};

struct HalfPower {  // s = 1/2
    template <class Real>
    TETHER_DEVICE Weights<Real> operator()(Real w) const {
        Real const root = square_root(w);
        return {root, square_root(root)};
    }
};

struct SquarePower {  // s = 2
    template <class Real>
    TETHER_DEVICE Weights<Real> operator()(Real w) const {
        return {w * w, w};
    }
};

struct AnyPower {
    double half_exponent;  // s/2
    template <class Real>
    TETHER_DEVICE Weights<Real> operator()(Real w) const {
        Real const random = power(w, Real(half_exponent));
        return {random * random, random};
    }
};

}  // namespace tether
