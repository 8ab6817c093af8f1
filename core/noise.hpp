// Pair noise: a pure function of (seed, step, the two ids), whichever comes first, with mean 0 and variance 1.
//
// No state is kept, so the noise of a pair is the same on every engine, for any number of threads and after a restart.
// Three stages:
//   once a step      Philox4x32-10 with the seed as its key turns the step number into a StepKey;
//   once a particle  Philox2x32-10 under that key turns the id into a word;
//   once a pair      the words of the two particles are added and stirred.
// Philox (Salmon, Moraes, Dror & Shaw, SC11, doi 10.1145/2063384.2063405) is counter-based and passes BigCrush.  Given
// ideal bits of the particles, the noises of any pairs that form no closed loop (i j, j k, ..., k i) are independent and
// uniform exactly: adding an ideal word makes the sum ideal, and stirring is one to one.  Around a loop the sums are
// bound to each other, and independence rests on the stirring, which tests examine.
#pragma once

#include "lane.hpp"

namespace tether {

struct StepKey {
    std::uint32_t word[4];
};

// Which part of a run draws: the same seed gives independent noise to each.
enum class Stream : std::uint32_t { run = 0, gentle_start = 1 };

// Two random words of a pair; a word is a std::uint32_t, or a pack of them.
template <class Word>
struct PairBits {
    Word first, second;
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

TETHER_DEVICE inline PairBits<std::uint32_t> two(std::uint32_t left, std::uint32_t right, std::uint32_t key) {
    for (int round = 0; round < rounds; ++round) {
        std::uint64_t const product = std::uint64_t{multiplier} * left;
        left = static_cast<std::uint32_t>(product >> 32) ^ right ^ key;
        right = static_cast<std::uint32_t>(product);
        key += weyl_a;
    }
    return {left, right};
}

}  // namespace philox

// One to one on 32-bit words, each bit of the result depending on every bit of x: two multiplications and three shifts
// (C. Wellons' search for the least biased such function: nullprogram.com/blog/2018/07/31, bias 0.107).
template <class Word>
TETHER_DEVICE inline Word stirred(Word x) {
    x = x ^ (x >> 16);
    x = x * Word(0x21F0AAADu);
    x = x ^ (x >> 15);
    x = x * Word(0xD35A2D97u);
    return x ^ (x >> 15);
}

// The key of one step's noise: seed in the key, step in the counter.
TETHER_DEVICE inline StepKey step_key(std::uint64_t seed, std::uint64_t step, Stream stream) {
    std::uint32_t const counter[4] = {static_cast<std::uint32_t>(step), static_cast<std::uint32_t>(step >> 32),
                                      static_cast<std::uint32_t>(stream), 0u};
    return philox::four(counter, static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
}

// The word of one particle at the step of the key.  The other words of the key are added to id and counter, so that two
// steps whose 32-bit keys happen to agree still walk different counters.
TETHER_DEVICE inline std::uint32_t particle_word(StepKey const& key, std::uint32_t id) {
    return philox::two(id ^ key.word[2], key.word[3], key.word[0]).first;
}

// The bits of a pair, from the sum of its particles' words.
template <class Word>
TETHER_DEVICE inline PairBits<Word> pair_bits(Word sum) {
    Word const first = stirred(sum);
    return {first, stirred(first + Word(philox::weyl_a))};
}

template <class Real>
TETHER_DEVICE inline Real gaussian(std::uint32_t for_radius, std::uint32_t for_angle) {
    using namespace std;
    constexpr double scale = 1.0 / 4294967296.0;
    constexpr double two_pi = 6.283185307179586;
    double const radius = sqrt(-2.0 * log((for_radius + 0.5) * scale));
    return Real(radius * cos(two_pi * ((for_angle + 0.5) * scale)));
}

// Uniform on (-sqrt 3, sqrt 3): the odd multiples of 2^-32 in (-1, 1) are symmetric about zero, so that the mean over
// all bit patterns is exactly 0; sqrt 3 makes the variance 1 (to 2^-64).  In float they are rounded, to 24 bits, which
// keeps the symmetry.
struct UniformNoise {
    template <class Real, class Word>
    TETHER_DEVICE static Real draw(PairBits<Word> bits) {
        constexpr double scale = 1.7320508075688772 / 2147483648.0;
        return (signed_value<Real>(bits.first) + Real(0.5)) * Real(scale);
    }
};

// Standard normal by Box & Muller (1958): radius from one word (never the logarithm of 0; |noise| < 6.7), angle from
// the other.  Packs bring their own `gaussian`.
struct GaussianNoise {
    template <class Real, class Word>
    TETHER_DEVICE static Real draw(PairBits<Word> bits) {
        return gaussian<Real>(bits.first, bits.second);
    }
};

}  // namespace tether
