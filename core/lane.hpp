// What a float, a double and a pack of them share, so that a law is written once for all of them.
//
// Every engine compiles the headers lane, noise and laws/: a scalar one with Real = double, a SIMD one with a pack, a
// CUDA one as device code.  TETHER_DEVICE is the only macro of the core.
#pragma once

#if defined(__CUDACC__) || defined(__CUDACC_RTC__)
#define TETHER_DEVICE __host__ __device__
#else
#define TETHER_DEVICE
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

// Found by overload: a pack type brings its own square_root and power beside these.
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

}  // namespace tether
