// What the particles are: arrays in the order of the particles' ids.  Solvent comes first, then the constituents,
// body by body and site by site, so that (body, site) of a constituent follows from its id.
#pragma once

#include <cstdint>
#include <vector>

#include "vector.hpp"

namespace tether {

template <int D>
struct State {
    std::vector<Vector<D>> position;    // inside the box
    std::vector<Vector<D>> velocity;    // in the laboratory frame
    std::vector<Vector<D>> force;       // at (position, predicted velocity) of the last step
    std::vector<std::uint8_t> species;  // 0 is the solvent
    std::vector<double> species_mass;
    std::uint64_t step = 0;

    std::size_t size() const { return position.size(); }
    double mass(std::size_t i) const { return species_mass[species[i]]; }
};

}  // namespace tether
