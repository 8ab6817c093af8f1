// What the particles are.  They stand in memory at places; `id` tells which particle stands where.  Ids never change:
// solvent comes first, then the constituents, body by body and site by site, so that (body, site) of a constituent
// follows from its id.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "kernels/kernels.hpp"
#include "memory.hpp"
#include "threads.hpp"
#include "vector.hpp"

namespace tether {

// A vector for each particle, axis by axis, in the order of places.
template <int D>
class Field {
  public:
    explicit Field(std::size_t size = 0) {
        for (Array<double>& column : axis) column.resize(size);
    }
    std::size_t size() const { return axis[0].size(); }
    Vector<D> operator[](std::size_t place) const {
        Vector<D> value;
        for (std::size_t k = 0; k < D; ++k) value[k] = axis[k][place];
        return value;
    }
    void set(std::size_t place, Vector<D> const& value) {
        for (std::size_t k = 0; k < D; ++k) axis[k][place] = value[k];
    }

    std::array<Array<double>, D> axis;
};

template <int D>
struct State {
    Field<D> position;  // inside the box
    Field<D> velocity;  // in the laboratory frame
    Field<D> force;     // at (position, predicted velocity) of the last step
    Array<double> inverse_mass;
    Array<std::uint32_t> id;            // of the particle at a place
    Array<std::uint32_t> place;         // of the particle with an id
    std::vector<std::uint8_t> species;  // by id; 0 is the solvent
    std::vector<double> species_mass;
    std::uint64_t step = 0;

    State(std::vector<std::uint8_t> species_, std::vector<double> species_mass_)
        : position(species_.size()),
          velocity(species_.size()),
          force(species_.size()),
          inverse_mass(species_.size()),
          id(species_.size()),
          place(species_.size()),
          species(std::move(species_)),
          species_mass(std::move(species_mass_)) {
        std::iota(id.begin(), id.end(), 0u);
        take_places(0, size());
    }

    std::size_t size() const { return id.size(); }

    Columns<D> columns() {
        Columns<D> bare{};
        for (std::size_t k = 0; k < D; ++k) {
            bare.position[k] = position.axis[k].data();
            bare.velocity[k] = velocity.axis[k].data();
            bare.force[k] = force.axis[k].data();
        }
        bare.inverse_mass = inverse_mass.data();
        bare.id = id.data();
        return bare;
    }

    // Let the particle that is at from[p] stand at p.
    void reorder(Array<std::uint32_t> const& from, Team& team) {
        spare_.resize(3 * D);
        std::vector<Array<double>*> columns;
        for (Field<D>* field : {&position, &velocity, &force})
            for (Array<double>& column : field->axis) columns.push_back(&column);
        team.each(columns.size() + 1, [&](std::size_t unit) {
            if (unit == columns.size()) {
                spare_id_.resize(size());
                for (std::size_t p = 0; p < size(); ++p) spare_id_[p] = id[from[p]];
                return;
            }
            Array<double>& moved = spare_[unit];
            moved.resize(size());
            for (std::size_t p = 0; p < size(); ++p) moved[p] = (*columns[unit])[from[p]];
            columns[unit]->swap(moved);
        });
        id.swap(spare_id_);
        team.ranges(size(), 4096, [&](std::size_t begin, std::size_t end, std::size_t) { take_places(begin, end); });
    }

  private:
    void take_places(std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            place[id[p]] = static_cast<std::uint32_t>(p);
            inverse_mass[p] = 1.0 / species_mass[species[id[p]]];
        }
    }

    std::vector<Array<double>> spare_;
    Array<std::uint32_t> spare_id_;
};

}  // namespace tether
