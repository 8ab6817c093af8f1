// The table of the loops, as the file that includes this is compiled.
#pragma once

#include "kernels/motion.hpp"
#include "kernels/pairs.hpp"

namespace tether {
namespace {

template <int D>
Kernels<D> motion_table() {
    return {kick<D>, drift<D>, wrap<D>, runaway<D>, motion<D>, {}, {}};
}

template <int D, class Real>
void add_pairs(Kernels<D>& table, Precision precision) {
    auto const p = static_cast<int>(precision);
    table.record[p] = record<D, Real>;
    auto& of_law = table.pairs[p];
    of_law[static_cast<int>(LawKind::half_power)][0] = pairs<D, Real, HalfPower, false>;
    of_law[static_cast<int>(LawKind::half_power)][1] = pairs<D, Real, HalfPower, true>;
    of_law[static_cast<int>(LawKind::square_power)][0] = pairs<D, Real, SquarePower, false>;
    of_law[static_cast<int>(LawKind::square_power)][1] = pairs<D, Real, SquarePower, true>;
    of_law[static_cast<int>(LawKind::any_power)][0] = pairs<D, Real, AnyPower, false>;
    of_law[static_cast<int>(LawKind::any_power)][1] = pairs<D, Real, AnyPower, true>;
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
