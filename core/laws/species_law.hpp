// The law between any two species in double precision: for all that is not the fast pair loop.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>
#include <vector>

#include "kernels/kernels.hpp"
#include "laws/steep.hpp"

namespace tether {

// The laws of all pairs of species, which share weights and the kind of noise.
struct LawNumbers {
    LawKind kind;
    double half_exponent;
    NoiseKind noise_kind;
    std::size_t species;             // 1 where all pairs have one law, whatever species there are
    std::vector<PairNumbers> table;  // species by species, symmetric

    // Whether the fast loop needs no table: one law, and that a linear one.
    bool is_plain() const { return species == 1 && table[0].steepness == 0.0; }
    // The species of particles as the table counts them.
    std::vector<std::uint8_t> known(std::vector<std::uint8_t> of_particles) const {
        if (species == 1) std::fill(of_particles.begin(), of_particles.end(), std::uint8_t{0});
        return of_particles;
    }
    double largest_cutoff() const {
        double largest = 0.0;
        for (PairNumbers const& of_pair : table) largest = of_pair.cutoff > largest ? of_pair.cutoff : largest;
        return largest;
    }
};

template <class Real>
SteepParameters<Real> steep_parameters(PairNumbers const& of_pair) {
    // A steepness that rounding cannot tell from 0 is 0.
    bool const is_steep = of_pair.steepness > std::numeric_limits<Real>::epsilon();
    return {{static_cast<Real>(is_steep ? 0.0 : of_pair.repulsion), static_cast<Real>(of_pair.friction),
             static_cast<Real>(of_pair.noise_amplitude), static_cast<Real>(1.0 / of_pair.cutoff)},
            static_cast<Real>(of_pair.cutoff),
            static_cast<Real>(of_pair.steepness),
            static_cast<Real>(is_steep ? of_pair.repulsion / -std::expm1(-of_pair.steepness) : 0.0)};
}

template <class Weight>
class SpeciesLaw {
  public:
    SpeciesLaw(Weight weight, LawNumbers const& law) : weight_(weight), species_(law.species) {
        for (PairNumbers const& of_pair : law.table) table_.push_back(steep_parameters<double>(of_pair));
    }

    double cutoff(std::size_t i, std::size_t j) const { return of(i, j).cutoff; }

    // Zero from the pair's own cutoff on.
    PairForce<double> operator()(Pair<double> const& pair, std::size_t i, std::size_t j) const {
        SteepParameters<double> const& p = of(i, j);
        if (!(pair.distance < p.cutoff)) return {};
        return p.height == 0.0 ? Dpd<Weight>{weight_}(pair, p.dpd) : SteepDpd<Weight>{weight_}(pair, p);
    }

    // -dF_C/dr, force/length: the second derivative of the pair's potential.
    double curvature(double distance, std::size_t i, std::size_t j) const {
        SteepParameters<double> const& p = of(i, j);
        if (!(distance < p.cutoff)) return 0.0;
        double const steep =
            p.height == 0.0 ? 0.0 : p.height * p.steepness * std::exp(-p.steepness * distance * p.dpd.inverse_cutoff);
        return (p.dpd.repulsion + steep) * p.dpd.inverse_cutoff;
    }

  private:
    SteepParameters<double> const& of(std::size_t i, std::size_t j) const { return table_[i * species_ + j]; }

    Weight weight_;
    std::size_t species_;
    std::vector<SteepParameters<double>> table_;
};

using AnySpeciesLaw = std::variant<SpeciesLaw<HalfPower>, SpeciesLaw<SquarePower>, SpeciesLaw<AnyPower>>;

inline AnySpeciesLaw species_law(LawNumbers const& law) {
    if (law.kind == LawKind::half_power) return SpeciesLaw<HalfPower>({}, law);
    if (law.kind == LawKind::square_power) return SpeciesLaw<SquarePower>({}, law);
    return SpeciesLaw<AnyPower>({law.half_exponent}, law);
}

}  // namespace tether
