// The table of the loops, as the file that includes this is compiled.
#pragma once

#include "kernels/motion.hpp"
#include "kernels/pairs.hpp"

namespace tether {
namespace {

template <int D, class Real>
void add_pairs(Kernels<D>& table, Precision precision) {
    auto const p = static_cast<int>(precision);
    table.record[p] = record<D, Real>;
    auto& uniform = table.pairs[p][0];
    uniform[static_cast<int>(LawKind::half_power)][0] = pairs<D, Real, Dpd<HalfPower>, false>;
    uniform[static_cast<int>(LawKind::half_power)][1] = pairs<D, Real, Dpd<HalfPower>, true>;
    uniform[static_cast<int>(LawKind::square_power)][0] = pairs<D, Real, Dpd<SquarePower>, false>;
    uniform[static_cast<int>(LawKind::square_power)][1] = pairs<D, Real, Dpd<SquarePower>, true>;
    uniform[static_cast<int>(LawKind::any_power)][0] = pairs<D, Real, Dpd<AnyPower>, false>;
    uniform[static_cast<int>(LawKind::any_power)][1] = pairs<D, Real, Dpd<AnyPower>, true>;
    auto& by_species = table.pairs[p][1];
    by_species[static_cast<int>(LawKind::half_power)][0] = pairs<D, Real, SteepDpd<HalfPower>, false>;
    by_species[static_cast<int>(LawKind::half_power)][1] = pairs<D, Real, SteepDpd<HalfPower>, true>;
    by_species[static_cast<int>(LawKind::square_power)][0] = pairs<D, Real, SteepDpd<SquarePower>, false>;
    by_species[static_cast<int>(LawKind::square_power)][1] = pairs<D, Real, SteepDpd<SquarePower>, true>;
    by_species[static_cast<int>(LawKind::any_power)][0] = pairs<D, Real, SteepDpd<AnyPower>, false>;
    by_species[static_cast<int>(LawKind::any_power)][1] = pairs<D, Real, SteepDpd<AnyPower>, true>;
}

template <int D>
Kernels<D> whole_table() {
    Kernels<D> table = motion_table<D>();
    add_pairs<D, float>(table, Precision::mixed);
    add_pairs<D, double>(table, Precision::full);
    return table;
}

}  // namespace
}  // namespace tether
