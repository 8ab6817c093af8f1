// Writes the random words of pair noise to standard output, for a battery of statistical tests to read: what the engines draw, from the
// same header, walked along one of its inputs while the others stand still.
//
//     stream i|j|step|seed|control START [PAIRS]
//
// Two little-endian 32-bit words a pair, without end unless PAIRS are asked for.  START chooses where the others stand.  `control` walks
// along i through a cheap hash that a battery worth its name must fail.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "noise.hpp"

namespace {

// One turn of a linear congruential generator (Numerical Recipes' constants) over the inputs folded together by exclusive or.
tether::PairBits<std::uint32_t> cheap_hash(std::uint32_t seed, std::uint32_t step, std::uint32_t i, std::uint32_t j) {
    std::uint32_t const word = 1664525u * (seed ^ step ^ i ^ j) + 1013904223u;
    return {word, 1664525u * word + 1013904223u};
}

}  // namespace

int main(int count, char** arguments) {
    if (count < 3) return 2;
    std::string_view const walk = arguments[1];
    if (walk != "i" && walk != "j" && walk != "step" && walk != "seed" && walk != "control") return 2;
    auto const start = static_cast<std::uint32_t>(std::strtoul(arguments[2], nullptr, 10));
    std::uint64_t const pairs = count > 3 ? std::strtoull(arguments[3], nullptr, 10) : ~std::uint64_t{0};

    std::uint64_t seed = walk == "seed" ? 0 : start, step = walk == "step" ? 0 : start;
    std::uint32_t i = start, j = start + 1;
    if (walk == "i" || walk == "control") {  // i walks below a j at the far end
        i = 0;
        j = ~start;
    }

    std::vector<tether::PairBits<std::uint32_t>> block(4096);
    tether::StepKey key = tether::step_key(seed, step, tether::Stream::run);
    for (std::uint64_t done = 0; done < pairs;) {
        std::size_t filled = 0;
        for (; filled < block.size() && done < pairs; ++filled, ++done) {
            if (walk == "control") {
                block[filled] = cheap_hash(start, start, i++, j);
                continue;
            }
            block[filled] = tether::pair_bits(tether::particle_word(key, i) + tether::particle_word(key, j));
            if (walk == "i") ++i;
            if (walk == "j") ++j;
            if (walk == "step") key = tether::step_key(seed, ++step, tether::Stream::run);
            if (walk == "seed") key = tether::step_key(++seed, step, tether::Stream::run);
        }
        if (std::fwrite(block.data(), sizeof(tether::PairBits<std::uint32_t>), filled, stdout) != filled)
            return 0;  // the reader has had enough
    }
    return 0;
}
