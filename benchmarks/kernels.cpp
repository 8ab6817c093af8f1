// Noise and law alone: nanoseconds a pair, on packs of the register's width and numbers that stay in the nearest cache.
//
// Prints a line "NAME NANOSECONDS" for each, the least of several turns.  Compiled by kernels.py with the flags of the
// core, for one instruction set.
#include <chrono>
#include <cstdio>

#include "laws/dpd.hpp"
#include "noise.hpp"
#include "simd/pack.hpp"

namespace tether {

// As the pair loop has it: the words of a pack, read as signed numbers.
template <class Real, int N>
TETHER_DEVICE inline Real signed_value(Words<N> word) {
    return {__builtin_convertvector(same_bits<std::int32_t>(word).lanes, decltype(Real::lanes))};
}

}  // namespace tether

namespace {

using namespace tether;

constexpr int pairs = 1024, repeats = 200, turns = 25;

template <class Real>
constexpr int lanes = register_bytes / sizeof(Real) > 4 ? register_bytes / sizeof(Real) : 4;

template <class Real>
struct Columns {
    alignas(64) std::uint32_t word[pairs];
    alignas(64) Real distance[pairs], departure[pairs], noise[pairs], out[pairs];
    Columns() {
        for (std::uint32_t k = 0; k < pairs; ++k) {
            word[k] = stirred(k + 1u);
            distance[k] = static_cast<Real>((k + 0.5) / pairs);
            departure[k] = static_cast<Real>(1.5 - 3.0 * k / pairs);
            noise[k] = static_cast<Real>((k % 7) * 0.5 - 1.5);
        }
    }
};

// Nanoseconds a pair of work(column, first pair of a pack).
template <class Real, class Work>
void time_of(char const* name, char const* precision, Columns<Real>& columns, Work const& work) {
    double least = 1e300;
    for (int turn = 0; turn < turns; ++turn) {
        auto const began = std::chrono::steady_clock::now();
        for (int r = 0; r < repeats; ++r) {
            for (int k = 0; k < pairs; k += lanes<Real>) work(columns, k);
            asm volatile("" : : "r"(&columns) : "memory");  // the next repeat does it all again
        }
        std::chrono::duration<double, std::nano> const took = std::chrono::steady_clock::now() - began;
        double const each = took.count() / (double{repeats} * pairs);
        least = each < least ? each : least;
    }
    std::printf("%s_%s %.6f\n", name, precision, least);
}

template <class Weight, class Real>
void time_law(char const* name, char const* precision, Columns<Real>& columns) {
    using Reals = Pack<Real, lanes<Real>>;
    DpdParameters<Reals> const parameters{Reals(18.75), Reals(4.5), Reals(42.0), Reals(1.0)};
    Dpd<Weight> const law{};
    time_of(name, precision, columns, [&](Columns<Real>& c, int k) {
        Pair<Reals> const pair{load<Real, lanes<Real>>(c.distance + k), load<Real, lanes<Real>>(c.departure + k),
                               load<Real, lanes<Real>>(c.noise + k)};
        store(c.out + k, law(pair, parameters).total());
    });
}

template <class Real>
void time_all(char const* precision) {
    using Reals = Pack<Real, lanes<Real>>;
    static Columns<Real> columns;
    time_of("noise", precision, columns, [](Columns<Real>& c, int k) {
        auto const bits = pair_bits(load<std::uint32_t, lanes<Real>>(c.word + k));
        store(c.out + k, UniformNoise::draw<Reals>(bits));
    });
    time_law<HalfPower>("law_half_power", precision, columns);
    time_law<SquarePower>("law_square_power", precision, columns);
}

}  // namespace

int main() {
    time_all<float>("mixed");
    time_all<double>("double");
}
