// The pairs' part of the stress.
#pragma once

#include <array>

#include "vector.hpp"

namespace tether {

template <int D>
using Tensor = std::array<std::array<double, D>, D>;

// Sums over pairs of (force magnitude / distance) times the independent components of r_ij r_ij, a row for each of
// the law's terms.
template <int D>
struct PairVirial {
    static constexpr std::size_t components = D * (D + 1) / 2;
    std::array<std::array<double, components>, 3> term{};

    PairVirial() = default;
    // From 3 times `components` numbers, term by term.
    explicit PairVirial(double const* values) {
        for (auto& sums : term)
            for (double& sum : sums) sum = *values++;
    }

    void add(Vector<D> const& separation, double conservative, double dissipative, double random) {
        std::size_t c = 0;
        for (std::size_t k = 0; k < D; ++k)
            for (std::size_t l = k; l < D; ++l, ++c) {
                double const product = separation[k] * separation[l];
                term[0][c] += conservative * product;
                term[1][c] += dissipative * product;
                term[2][c] += random * product;
            }
    }
    PairVirial& operator+=(PairVirial const& b) {
        for (std::size_t t = 0; t < 3; ++t)
            for (std::size_t c = 0; c < components; ++c) term[t][c] += b.term[t][c];
        return *this;
    }
    Tensor<D> tensor(std::size_t t) const {
        Tensor<D> full{};
        std::size_t c = 0;
        for (std::size_t k = 0; k < D; ++k)
            for (std::size_t l = k; l < D; ++l, ++c) full[k][l] = full[l][k] = term[t][c];
        return full;
    }
};

}  // namespace tether
