#include "bindings.hpp"
#include "bodies/rigid.hpp"
#include "bodies/tethered.hpp"
#include "cpu_engine.hpp"

namespace tether::bindings {

namespace {

// A base as a flat row, for checkpoints: center, rotation, velocity, angular momentum, force, torque.
template <int D>
constexpr std::size_t base_values = sizeof(Base<D>) / sizeof(double);

// The value that a word stands for; ValueError for any other word.
template <class Value>
Value chosen(std::string const& word, std::vector<std::pair<std::string, Value>> const& words) {
    for (auto const& [known, value] : words)
        if (known == word) return value;
    throw std::invalid_argument("unknown word \"" + word + "\"");
}

// The law of all pairs, from (species, species, 5) of repulsion, friction, noise, cutoff and steepness.
LawNumbers laws_of(Array3 const& laws, double exponent, std::string const& random, double timestep) {
    std::size_t const species = laws.shape(0);
    if (species == 0 || laws.shape(1) != species || laws.shape(2) != 5)
        throw std::invalid_argument("expected laws of shape (species, species, 5)");
    LawNumbers law{exponent == 0.5   ? LawKind::half_power
                   : exponent == 2.0 ? LawKind::square_power
                                     : LawKind::any_power,
                   0.5 * exponent,
                   chosen<NoiseKind>(random, {{"uniform", NoiseKind::uniform}, {"gaussian", NoiseKind::gaussian}}),
                   species,
                   {}};
    for (std::size_t i = 0; i < species; ++i)
        for (std::size_t j = 0; j < species; ++j) {
            for (std::size_t k = 0; k < 5; ++k)
                if (laws(i, j, k) != laws(j, i, k)) throw std::invalid_argument("expected laws that are symmetric");
            law.table.push_back(
                {laws(i, j, 0), laws(i, j, 1), laws(i, j, 2) / std::sqrt(timestep), laws(i, j, 3), laws(i, j, 4)});
        }
    return law;
}

// ValueError unless bodies of so many sites, from the particle `first` on, are there to be held.
void check_bodies(std::size_t particles, std::size_t sites, std::size_t count, std::size_t first, double mass) {
    if (sites == 0 || !(mass > 0.0)) throw std::invalid_argument("expected sites, and a mass above 0");
    if (first > particles || count > (particles - first) / sites)
        throw std::invalid_argument("expected constituents that are there");
}

template <int D>
void export_engine_of(nb::module_& module, char const* name) {
    using E = CpuEngine<D>;
    auto const vectors = [](Field<D> State<D>::* member) {
        return std::pair(
            [member](E const& self) {
                State<D> const& state = self.state;
                std::vector<Vector<D>> by_id(state.size());
                for (std::size_t id = 0; id < by_id.size(); ++id) by_id[id] = (state.*member)[state.place[id]];
                return to_numpy(by_id);
            },
            [member](E& self, Array2 const& array) {
                State<D>& state = self.state;
                std::vector<Vector<D>> const by_id = to_vectors<D>(array);
                if (by_id.size() != state.size()) throw std::invalid_argument("expected a row for each particle");
                for (std::size_t id = 0; id < by_id.size(); ++id) (state.*member).set(state.place[id], by_id[id]);
            });
    };
    auto const [get_position, set_position] = vectors(&State<D>::position);
    auto const [get_velocity, set_velocity] = vectors(&State<D>::velocity);
    auto const [get_force, set_force] = vectors(&State<D>::force);

    auto const owned = nb::for_getter(nb::rv_policy::automatic);  // the arrays own their copies

    nb::class_<E>(module, name,
                  "The CPU engine: positions, velocities and forces are copies of shape (n, D), in the order of ids.")
        .def(
            "__init__",
            [](E* self, std::vector<double> const& size, double shear_rate, Array3 const& laws, double exponent,
               std::string const& random, std::vector<std::pair<std::uint64_t, double>> const& stages,
               std::optional<std::pair<double, double>> oscillation, std::string const& driving, double force,
               int periods, double timestep, double verlet_lambda, std::uint64_t seed,
               std::vector<double> const& species_mass,
               nb::ndarray<std::uint8_t const, nb::ndim<1>, nb::c_contig> species, std::string const& pairs,
               std::string const& precision, std::string const& instruction_set, int threads) {
                LawNumbers const law = laws_of(laws, exponent, random, timestep);
                for (std::size_t i = 0; i < species.shape(0); ++i)
                    if (species(i) >= species_mass.size() || (law.species > 1 && species(i) >= law.species))
                        throw std::invalid_argument("expected a mass and, in a table of laws, a row for each species");
                PairEngine const engine{
                    chosen<bool>(pairs, {{"packed", false}, {"reference", true}}),
                    chosen<Precision>(precision, {{"mixed", Precision::mixed}, {"double", Precision::full}}),
                    instruction_set};
                std::vector<Shear::Stage> shear_stages;
                for (auto const& [steps, rate] : stages) {
                    if (steps == 0) throw std::invalid_argument("expected steps in every stage");
                    shear_stages.push_back({steps, rate});
                }
                Shear shear = oscillation      ? Shear::oscillation(oscillation->first, oscillation->second)
                              : stages.empty() ? Shear::steady(shear_rate)
                                               : Shear::stages(std::move(shear_stages));
                Driving const drive{chosen<Driving::Profile>(driving, {{"none", Driving::Profile::none},
                                                                       {"poiseuille", Driving::Profile::poiseuille},
                                                                       {"kolmogorov", Driving::Profile::kolmogorov}}),
                                    force, static_cast<double>(periods)};
                new (self)
                    E(Box<D>(to_vector<D>(size), shear_rate), law, std::move(shear), drive, timestep, verlet_lambda,
                      seed, species_mass, std::vector<std::uint8_t>(species.data(), species.data() + species.shape(0)),
                      engine, threads);
            },
            nb::kw_only(), nb::arg("size"), nb::arg("shear_rate") = 0.0, nb::arg("laws"), nb::arg("exponent"),
            nb::arg("random"), nb::arg("stages") = std::vector<std::pair<std::uint64_t, double>>{},
            nb::arg("oscillation") = nb::none(), nb::arg("driving") = "none", nb::arg("force") = 0.0,
            nb::arg("periods") = 1, nb::arg("timestep"), nb::arg("verlet_lambda"), nb::arg("seed"),
            nb::arg("species_mass"), nb::arg("species"), nb::arg("pairs") = "packed", nb::arg("precision") = "mixed",
            nb::arg("instruction_set") = "", nb::arg("threads") = 1,
            "laws: (species, species, 5) of repulsion, friction, noise, cutoff and steepness (0 for a linear "
            "repulsion), "
            "one species for a law that all share. The shear is steady, or goes through stages (steps, rate), or is an "
            "oscillation (amplitude, angular frequency).")
        .def(
            "add_tethered_bodies",
            [](E& self, Array2 const& sites, std::size_t count, std::size_t first, double stiffness, double mass,
               std::string const& base, std::string const& torque_arms) {
                check_bodies(self.state.size(), sites.shape(0), count, first, mass);
                BaseMotion const motion =
                    chosen<BaseMotion>(base, {{"massless", BaseMotion::massless},
                                              {"newton-euler", BaseMotion::newton_euler},
                                              {"newton-euler-lagged", BaseMotion::newton_euler_lagged}});
                TorqueArms const arms = chosen<TorqueArms>(
                    torque_arms, {{"constituents", TorqueArms::constituents}, {"sites", TorqueArms::sites}});
                self.add_bodies(std::make_unique<TetheredBodies<D>>(to_vectors<D>(sites), count, first, stiffness, mass,
                                                                    motion, arms));
            },
            nb::kw_only(), nb::arg("sites"), nb::arg("count"), nb::arg("first"), nb::arg("stiffness"), nb::arg("mass"),
            nb::arg("base"), nb::arg("torque_arms"))
        .def(
            "add_rigid_bodies",
            [](E& self, Array2 const& sites, std::size_t count, std::size_t first, double mass) {
                check_bodies(self.state.size(), sites.shape(0), count, first, mass);
                std::size_t const species = self.law().species == 1 ? 0 : self.state.species.at(first);
                self.add_bodies(
                    std::make_unique<RigidBodies<D>>(to_vectors<D>(sites), count, first, mass, self.law(), species));
            },
            nb::kw_only(), nb::arg("sites"), nb::arg("count"), nb::arg("first"), nb::arg("mass"))
        .def(
            "observe_stress",
            [](E& self, std::size_t bins, std::uint64_t interval) {
                if (interval == 0) throw std::invalid_argument("expected an interval of at least one step");
                self.observe_stress(bins, interval);
            },
            nb::arg("bins"), nb::arg("interval"),
            "Look at the local stress at the end of every step that the interval divides; once all bodies are there.")
        .def(
            "take_stress",
            [](E& self) {
                std::vector<double> const seen = self.take_stress();
                std::size_t const values = std::max<std::size_t>(self.stress_values(), 1);
                return to_numpy<double>(seen.data(), {seen.size() / values, values});
            },
            "What has been seen of the local stress since the last call, a row for each step: of each bin the sums of "
            "m, "
            "m v and m v v and the stress of pairs and of what holds constituents; of each plane normal to y, then x, "
            "force per area of crossing particles, of pairs, of what holds constituents; the two sums of the "
            "configurational temperature.")
        .def(
            "body_frames",
            [](E const& self) {
                std::vector<Vector<D>> center, velocity;
                std::vector<double> rotation;
                for (auto const& kind : self.bodies)
                    for (std::size_t b = 0; b < kind->count(); ++b) {
                        BodyMotion<D> const motion = kind->motion_of(b, self.state, self.box);
                        Vector<D> at = motion.center, moving = motion.velocity;
                        self.box.wrap(at, moving);
                        center.push_back(at);
                        velocity.push_back(moving);
                        for (std::size_t k = 0; k < D; ++k)
                            for (std::size_t l = 0; l < D; ++l) {
                                Vector<D> unit{};
                                unit[l] = 1.0;
                                rotation.push_back(kind->bases[b].rotation.turn(unit)[k]);
                            }
                    }
                return nb::make_tuple(to_numpy(center), to_numpy(velocity),
                                      to_numpy<double>(rotation.data(), {center.size(), D, D}));
            },
            "Centers inside the box, their velocities (bodies, D), and rotations (bodies, D, D), kind by kind.")
        .def("start_gently", &E::start_gently, nb::arg("first"), nb::arg("steps"), nb::arg("displacement"),
             nb::call_guard<nb::gil_scoped_release>())
        .def("place", &E::place, nb::call_guard<nb::gil_scoped_release>())
        .def(
            "run",
            [](E& self, std::uint64_t steps, std::uint64_t interval) {
                if (interval > 0 && steps % interval != 0)
                    throw std::invalid_argument("steps must be a multiple of interval");
                std::vector<double> means;
                {
                    nb::gil_scoped_release const release;
                    means = self.run(steps, interval);
                }
                return to_numpy<double>(means.data(), {means.size() / Sample<D>::values, Sample<D>::values});
            },
            nb::arg("steps"), nb::arg("interval") = 0,
            "Advance; with an interval, return the means of every measured quantity over each interval of steps, "
            "(steps/interval, values).")
        .def_prop_ro_static("columns", [](nb::handle) { return Sample<D>::columns(); })
        .def_prop_rw(
            "order", [](E const& self) { return to_numpy<std::uint32_t>(self.state.id.data(), {self.state.size()}); },
            [](E& self, Ids const& order) {
                Array<std::uint32_t> from(self.state.size());
                std::vector<bool> is_there(from.size());
                if (order.shape(0) != from.size()) throw std::invalid_argument("expected an id for each particle");
                for (std::size_t p = 0; p < from.size(); ++p) {
                    std::uint32_t const id = order(p);
                    if (id >= from.size() || is_there[id]) throw std::invalid_argument("expected each id once");
                    is_there[id] = true;
                    from[p] = self.state.place[id];
                }
                self.state.reorder(from, self.team());
            },
            owned, "Ids in the order that particles have in memory, (n,); sums of floating-point numbers depend on it.")
        .def_prop_rw("position", get_position, set_position, owned)
        .def_prop_rw("velocity", get_velocity, set_velocity, owned)
        .def_prop_rw("force", get_force, set_force, owned)
        .def_prop_ro(
            "species",
            [](E const& self) {
                return to_numpy<std::uint8_t>(self.state.species.data(), {self.state.species.size()});
            },
            owned)
        .def_prop_rw(
            "step", [](E const& self) { return self.state.step; },
            [](E& self, std::uint64_t step) { self.stand_at(step); })
        .def_prop_ro("shear_rate", [](E const& self) { return self.box.shear_rate(); })
        .def_prop_rw(
            "offset", [](E const& self) { return self.box.offset(); },
            [](E& self, double offset) { self.box.set_offset(offset); })
        .def_prop_rw(
            "bases",
            [](E const& self) {
                std::vector<double> rows;
                for (auto const& kind : self.bodies)
                    for (Base<D> const& base : kind->bases) {
                        double const* values = reinterpret_cast<double const*>(&base);
                        rows.insert(rows.end(), values, values + base_values<D>);
                    }
                return to_numpy<double>(rows.data(), {rows.size() / base_values<D>, base_values<D>});
            },
            [](E& self, Array2 const& rows) {
                std::size_t count = 0;
                for (auto const& kind : self.bodies) count += kind->count();
                if (rows.shape(0) != count || rows.shape(1) != base_values<D>)
                    throw std::invalid_argument("expected a row of " + std::to_string(base_values<D>) +
                                                " for each body");
                double const* row = rows.data();
                for (auto const& kind : self.bodies)
                    for (Base<D>& base : kind->bases) {
                        std::memcpy(static_cast<void*>(&base), row, sizeof(Base<D>));
                        row += base_values<D>;
                    }
            },
            owned, "Bases as rows of center, rotation, velocity, angular momentum, force and torque, kind by kind.")
        .def_prop_ro(
            "rotational_freedom",
            [](E const& self) {
                std::vector<int> freedom;
                for (auto const& kind : self.bodies) freedom.push_back(kind->rotational_freedom());
                return freedom;
            },
            "Rotational degrees of freedom of a body, kind by kind.")
        .def(
            "force_quantum",
            [](E const& self, std::string const& precision) {
                return self.force_quantum(
                    chosen<Precision>(precision, {{"mixed", Precision::mixed}, {"double", Precision::full}}));
            },
            nb::arg("precision"), "The rounding of forces in that precision: they are summed as its multiples.")
        .def_prop_ro("threads", &E::threads)
        .def_prop_rw(
            "is_timed", [](E const& self) { return self.watch.is_on; },
            [](E& self, bool is_on) { self.watch.is_on = is_on; }, "Whether the phases of a step are timed.")
        .def_prop_ro(
            "seconds",
            [](E const& self) {
                std::vector<std::pair<std::string, double>> phases;
                for (std::size_t k = 0; k < phase_names.size(); ++k)
                    phases.emplace_back(phase_names[k], self.watch.seconds[k]);
                return phases;
            },
            "Seconds spent in each phase of the steps that were timed.")
        .def_prop_ro("instruction_set", &E::instruction_set, "That of the pair loop; empty for the reference.")
        .def_prop_ro(
            "fault",
            [](E const& self) -> std::optional<std::tuple<std::uint64_t, std::size_t, double>> {
                if (!self.fault) return std::nullopt;
                return std::tuple(self.fault->step, self.fault->particle, self.fault->speed);
            },
            "Step, particle and speed of a particle that ran away, or None.");
}

}  // namespace

void export_engine(nb::module_& module) {
    export_engine_of<2>(module, "CpuEngine2");
    export_engine_of<3>(module, "CpuEngine3");
    module.def(
        "instruction_sets",
        [] {
            std::vector<std::pair<std::string, bool>> all;
            for (InstructionSet const& set : instruction_sets()) all.emplace_back(set.name, set.is_here);
            return all;
        },
        "The instruction sets that the pair loop was compiled for, the widest first, and whether this processor has "
        "them.");
}

}  // namespace tether::bindings
