// Pair noise: a pure function of (seed, step, the lower id, the higher id), with mean 0 and variance 1.
//
// The generator is Philox (Salmon, Moraes, Dror & Shaw, SC11, doi 10.1145/2063384.2063405), counter-based: no state
// to keep, so the noise of a pair is the same on every engine, for any number of threads and after a restart.  It is
// used twice.  Once a step, Philox4x32-10 with the seed as its key turns the step number into a StepKey; once a pair,
// Philox2x32-10 under that key turns the two ids into 64 bits.  The ids are added (exclusive or) to two more words of
// the step key first, so that two steps whose 32-bit keys happen to agree still walk different counters.
#pragma once

#include "lane.hpp"

namespace tether {

struct StepKey {
    std::uint32_t word[4];
};

// Which part of a run draws: the same seed gives independent noise to each.
enum class Stream : std::uint32_t { run = 0, gentle_start = 1 };

// 64 random bits: a word is a std::uint32_t, or a pack of them that brings its own widening_product and signed_value.
template <class Word>
struct PairBits {
    Word high, low;
};

namespace philox {

constexpr std::uint32_t multiplier_a = 0xD2511F53u, multiplier_b = 0xCD9E8D57u;  // 4x32, table 2 of the reference
constexpr std::uint32_t multiplier = 0xD256D193u;                                // 2x32
constexpr std::uint32_t weyl_a = 0x9E3779B9u, weyl_b = 0xBB67AE85u;              // golden ratio, sqrt(3) - 1
constexpr int rounds = 10;  // the authors' default; 7 pass BigCrush

TETHER_DEVICE inline StepKey four(std::uint32_t const (&counter)[4], std::uint32_t key_a, std::uint32_t key_b) {
    std::uint32_t c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];
    for (int round = 0; round < rounds; ++round) {
        std::uint64_t const a = std::uint64_t{multiplier_a} * c0;
        std::uint64_t const b = std::uint64_t{multiplier_b} * c2;
        c0 = static_cast<std::uint32_t>(b >> 32) ^ c1 ^ key_a;
        c2 = static_cast<std::uint32_t>(a >> 32) ^ c3 ^ key_b;
        c1 = static_cast<std::uint32_t>(b);
        c3 = static_cast<std::uint32_t>(a);
        key_a += weyl_a;
        key_b += weyl_b;
    }
    return {{c0, c1, c2, c3}};
}

template <class Word>
TETHER_DEVICE inline PairBits<Word> two(Word left, Word right, std::uint32_t key) {
    for (int round = 0; round < rounds; ++round) {
        Word high, low;
        widening_product(left, multiplier, high, low);
        left = high ^ right ^ Word(key);
        right = low;
        key += weyl_a;
    }
    return {left, right};
}

}  // namespace philox

// The key of one step's noise: seed in the key, step in the counter.
TETHER_DEVICE inline StepKey step_key(std::uint64_t seed, std::uint64_t step, Stream stream) {
    std::uint32_t const counter[4] = {static_cast<std::uint32_t>(step), static_cast<std::uint32_t>(step >> 32),
                                      static_cast<std::uint32_t>(stream), 0u};
    return philox::four(counter, static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
}

// The bits of the pair of ids `lower` < `higher` at the step of the key.
template <class Word>
TETHER_DEVICE inline PairBits<Word> pair_bits(StepKey const& key, Word lower, Word higher) {
    return philox::two(lower ^ Word(key.word[2]), higher ^ Word(key.word[3]), key.word[0]);
}

// Uniform on (-sqrt 3, sqrt 3): the odd multiples of 2^-32 in (-1, 1) are symmetric about zero, so that the mean over
// all bit patterns is exactly 0; sqrt 3 makes the variance 1 (to 2^-64).  In float they are rounded, to 24 bits, which
// keeps the symmetry.
struct UniformNoise {
    template <class Real, class Word>
    TETHER_DEVICE static Real draw(PairBits<Word> bits) {
        constexpr double scale = 1.7320508075688772 / 2147483648.0;
        return (signed_value<Real>(bits.high) + Real(0.5)) * Real(scale);
    }
};

// Standard normal by Box & Muller (1958): radius from one word (never the logarithm of 0; |noise| < 6.7), angle from
// the other.
struct GaussianNoise {
    template <class Real>
    TETHER_DEVICE static Real draw(PairBits<std::uint32_t> bits) {
        using namespace std;
        constexpr double scale = 1.0 / 4294967296.0;
        constexpr double two_pi = 6.283185307179586;
        double const radius = sqrt(-2.0 * log((bits.high + 0.5) * scale));
        return Real(radius * cos(two_pi * ((bits.low + 0.5) * scale)));
    }
};

}  // namespace tether
