// What a pair loop is to an engine.
#pragma once

#include "box.hpp"
#include "kernels/kernels.hpp"
#include "memory.hpp"
#include "observe/virial.hpp"
#include "state.hpp"
#include "stopwatch.hpp"
#include "threads.hpp"

namespace tether {

template <int D>
class PairForces {
  public:
    virtual ~PairForces() = default;

    // Note what the loop needs of the particles at places [begin, end), with velocities v + prediction F/m.
    virtual void note(Columns<D> const& particles, Box<D> const& box, StepKey const& key, double prediction,
                      std::size_t begin, std::size_t end) = 0;
    // Set state.force to the DPD forces on the noted particles; return their virials, zero unless `stress`.
    virtual PairVirial<D> compute(bool stress, State<D>& state, Box<D> const& box, Team& team, Stopwatch& watch) = 0;
    // Places in an order in which neighbors in space are neighbors in memory; empty if the loop does not care.
    virtual Array<std::uint32_t> const& order() const = 0;
};

}  // namespace tether
