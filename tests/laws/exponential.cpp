// The exponential of packs, and the same less one, at many points of [-80, 0], for test_pack.py: prints argument and both
// values, in hexadecimal, first in float, then in double.
#include <cmath>
#include <cstdio>

#include "kernels/pairs.hpp"

using namespace tether;

namespace {

template <class Real>
void print() {
    constexpr int N = law_lanes<Real>, points = 8192;
    for (int begin = 0; begin < points; begin += N) {
        Pack<Real, N> x;
        for (int k = 0; k < N; ++k) {
            int const point = begin + k;
            // Evenly spread, near 0, around half-integer multiples of ln 2 (where the reduction jumps), and the ends.
            Real const even = static_cast<Real>(-80.0 * point / (points - 1.0));
            Real const small = -std::ldexp(Real(1), -point % 60);
            Real const jump = static_cast<Real>(-0.34657359027997264 * (point % 230)) + even * Real(1e-6);
            x.lanes[k] = point % 3 == 0 ? even : point % 3 == 1 ? small : jump;
        }
        if (begin == 0) x.lanes[0] = Real(0), x.lanes[1] = Real(-80);
        Pack<Real, N> const value = exponential(x), less = exponential_less_one(x);
        for (int k = 0; k < N; ++k)
            std::printf("%a %a %a\n", static_cast<double>(x.lanes[k]), static_cast<double>(value.lanes[k]),
                        static_cast<double>(less.lanes[k]));
    }
}

}  // namespace

int main() {
    print<float>();
    std::puts("");
    print<double>();
}
