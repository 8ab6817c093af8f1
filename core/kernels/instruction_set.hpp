// The instruction sets that the loops were compiled for, and which of them this processor has.
#pragma once

#include <string>
#include <vector>

#include "kernels/kernels.hpp"

namespace tether {

struct InstructionSet {
    std::string name;  // as compilers call it: x86-64-v4, x86-64-v3, x86-64-v2; arm64
    bool is_here;      // this processor has it
    Kernels<2> (*kernels_2d)();
    Kernels<3> (*kernels_3d)();
};

// All that were compiled, the widest first.
std::vector<InstructionSet> const& instruction_sets();

// The one of that name, or the widest that is here for an empty name.  Throws std::invalid_argument.
InstructionSet const& instruction_set(std::string const& name);

template <int D>
Kernels<D> kernels_of(InstructionSet const& set) {
    if constexpr (D == 2)
        return set.kernels_2d();
    else
        return set.kernels_3d();
}

}  // namespace tether
