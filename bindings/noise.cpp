#include "noise.hpp"

#include "bindings.hpp"

namespace tether::bindings {

namespace {

PairBits<std::uint32_t> bits_of(StepKey const& key, std::uint32_t i, std::uint32_t j) {
    return pair_bits(particle_word(key, i) + particle_word(key, j));
}

template <class Noise>
nb::ndarray<nb::numpy, double> noise_of(std::uint64_t seed, std::uint64_t step, Ids const& i, Ids const& j) {
    if (i.shape(0) != j.shape(0)) throw std::invalid_argument("i and j must have one length");
    StepKey const key = step_key(seed, step, Stream::run);
    std::vector<double> noise(i.shape(0));
    for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = Noise::template draw<double>(bits_of(key, i(k), j(k)));
    return to_numpy<double>(noise.data(), {noise.size()});
}

}  // namespace

void export_noise(nb::module_& module) {
    module.def(
        "pair_noise",
        [](std::uint64_t seed, std::uint64_t step, Ids const& i, Ids const& j, std::string const& kind) {
            return kind == "gaussian" ? noise_of<GaussianNoise>(seed, step, i, j)
                                      : noise_of<UniformNoise>(seed, step, i, j);
        },
        nb::arg("seed"), nb::arg("step"), nb::arg("i"), nb::arg("j"), nb::arg("kind") = "uniform",
        "Noise of the pairs (i, j), (n,) of mean 0 and variance 1, as the engines draw it.");
    module.def(
        "noise_words",
        [](std::uint64_t seed, std::uint64_t step, Ids const& i, Ids const& j) {
            StepKey const key = step_key(seed, step, Stream::run);
            std::vector<std::uint32_t> words(2 * i.shape(0));
            for (std::size_t k = 0; k < i.shape(0); ++k) {
                auto const bits = bits_of(key, i(k), j(k));
                words[2 * k] = bits.first;
                words[2 * k + 1] = bits.second;
            }
            return to_numpy<std::uint32_t>(words.data(), {i.shape(0), std::size_t{2}});
        },
        nb::arg("seed"), nb::arg("step"), nb::arg("i"), nb::arg("j"),
        "The 64 random bits of each pair as two words, (n, 2).");
    module.def(
        "philox4x32",
        [](std::vector<std::uint32_t> const& counter, std::vector<std::uint32_t> const& key) {
            std::uint32_t const c[4] = {counter.at(0), counter.at(1), counter.at(2), counter.at(3)};
            StepKey const out = philox::four(c, key.at(0), key.at(1));
            return std::vector<std::uint32_t>(out.word, out.word + 4);
        },
        nb::arg("counter"), nb::arg("key"), "Philox4x32-10, to hold against the known answers of its authors.");
    module.def(
        "philox2x32",
        [](std::vector<std::uint32_t> const& counter, std::uint32_t key) {
            auto const out = philox::two(counter.at(0), counter.at(1), key);
            return std::vector<std::uint32_t>{out.first, out.second};
        },
        nb::arg("counter"), nb::arg("key"), "Philox2x32-10, to hold against the known answers of its authors.");
}

}  // namespace tether::bindings
