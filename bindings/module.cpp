// tether._core: the C++ core as Python sees it.  Users meet it through the package tether only.
#include "bindings.hpp"

NB_MODULE(_core, module) {
    module.doc() = "The C++ core of tether.";
    tether::bindings::export_engine(module);
    tether::bindings::export_box(module);
    tether::bindings::export_noise(module);
    tether::bindings::export_law(module);
    tether::bindings::export_pairs(module);
    tether::bindings::export_pair_histogram(module);
    tether::bindings::export_rotation(module);
}
