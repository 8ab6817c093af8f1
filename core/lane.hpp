// What a float, a double and a pack of them share, so that a law is written once for all of them.
//
// Every engine compiles the headers lane, noise and laws/: a scalar one with Real = double, a SIMD one with a pack, a
// CUDA one as device code.  TETHER_DEVICE is the only macro of the core.  On a host it inlines by force: the SIMD engine
// compiles these headers once for each instruction set, and a copy left for the linker might be taken from the wrong one.
#pragma once

#if defined(__CUDACC__) || defined(__CUDACC_RTC__)
#define TETHER_DEVICE __host__ __device__
#else
#define TETHER_DEVICE [[gnu::always_inline]]
#endif

#if !defined(__CUDACC_RTC__)
#include <cmath>
#include <cstdint>
#else
namespace std {
using int32_t = int;
using uint32_t = unsigned int;
using uint64_t = unsigned long long;
}  // namespace std
#endif

namespace tether {

// Found by overload: a pack type brings its own beside these.
TETHER_DEVICE inline double square_root(double x) {
    using namespace std;
    return sqrt(x);
}
TETHER_DEVICE inline float square_root(float x) {
    using namespace std;
    return sqrtf(x);
}
TETHER_DEVICE inline double power(double x, double exponent) {
    using namespace std;
    return pow(x, exponent);
}
TETHER_DEVICE inline float power(float x, float exponent) {
    using namespace std;
    return powf(x, exponent);
}
TETHER_DEVICE inline double exponential(double x) {
    using namespace std;
    return exp(x);
}
TETHER_DEVICE inline float exponential(float x) {
    using namespace std;
    return expf(x);
}
TETHER_DEVICE inline double exponential_less_one(double x) {
    using namespace std;
    return expm1(x);
}
TETHER_DEVICE inline float exponential_less_one(float x) {
    using namespace std;
    return expm1f(x);
}

// A word read as a signed integer (two's complement), as a Real.
template <class Real>
TETHER_DEVICE inline Real signed_value(std::uint32_t word) {
    return Real(static_cast<std::int32_t>(word));
}

}  // namespace tether
