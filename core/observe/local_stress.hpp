// Where the stress is: in bins across the gradient, and through planes; and the temperature that forces tell.
//
// Every contribution runs along a straight line from one point to another, whose force it is: from particle j to i the pair
// force F_ij, from a base's center X to constituent i the force that holds it.  What a massless base or a rigid body bears
// nets to zero, so momentum is balanced everywhere; a Newton-Euler base does not feel its springs, and there it is not.  With r = r_i - r_j (or r_i - X) and stress positive in tension,
//     bins     Irving & Kirkwood (1950, doi 10.1063/1.1747782): -r F/V_bin times the part of the line in the bin,
//              kinetic -m v v/V_bin of the particles in it
//     planes   method of planes (Todd, Evans & Daivis 1995, doi 10.1103/PhysRevE.52.1627): a line that crosses a plane of
//              area A along its normal k adds -F sign(r_k)/A; a particle that crosses it in the step -m v sign(v_k)/(A dt)
// Planes stand at the bins' lower edges, normal to y, and as many, equally spaced, normal to x.  Velocities are against the
// imposed profile, and those of half a step ago where particles cross planes: with them every step moves their positions.
// A line through the sheared boundary is followed in the frame of its particle i.
//
// Conservative forces tell the temperature too (Rugh 1997, doi 10.1103/PhysRevLett.78.772; Butler et al. 1998,
// doi 10.1063/1.477301): kT = <sum |F_C,i|^2> / <sum div_i(-F_C,i)>, over the solvent.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "bodies/bodies.hpp"
#include "box.hpp"
#include "laws/species_law.hpp"
#include "pairs/pair_walk.hpp"
#include "state.hpp"

namespace tether {

template <int D>
class LocalStress {
  public:
    // `bodies` of ids: particles of one rigid body, which do not act on each other, share a number; -1 for all others.
    LocalStress(Box<D> const& box, LawNumbers const& law, std::vector<std::uint8_t> const& species,
                std::vector<std::int32_t> body_of_id, double timestep, std::size_t bins, std::uint64_t interval)
        : walk_(box, law, species),
          body_of_id_(std::move(body_of_id)),
          timestep_(timestep),
          bins_(bins),
          interval_(interval),
          rows_(walk_.rows()) {}

    bool is_due(std::uint64_t step) const { return step % interval_ == 0; }

    static constexpr std::size_t tensor = D * D;
    // Of a bin: sum m, sum m v, sum m v v, and the stress of pairs and of what holds constituents (row = direction of the
    // line, column = of the force).
    static constexpr std::size_t bin_values = 1 + D + 3 * tensor;
    // Of a plane: the force per area of crossing particles, of pairs, and of what holds constituents.
    static constexpr std::size_t plane_values = 3 * D;
    // All bins, then the planes normal to y, those normal to x, then the two sums of the configurational temperature.
    std::size_t values() const { return bins_ * (bin_values + 2 * plane_values) + 2; }

    // Before the forces, as PairForces::note.
    void note(Columns<D> const& particles, StepKey const& key, double prediction, std::size_t begin, std::size_t end) {
        walk_.note(particles, key, prediction, begin, end);
    }

    // After the forces; velocities are those of half a step ago.
    void take_forces(State<D> const& state, Box<D> const& box, std::vector<std::unique_ptr<Bodies<D>>> const& bodies,
                     std::size_t solvent, Team& team) {
        sums_.assign(values(), 0.0);
        walk_.sort(state, box, team);
        for (std::vector<double>& row : rows_) row.assign(values(), 0.0);
        push_.assign(state.size(), {});
        walk_.each(team, [&](std::size_t row, WalkedPair<D> const& pair, auto const& law) {
            add_pair(rows_[row], state, box, pair, law, solvent);
        });
        for (std::vector<double> const& row : rows_)
            for (std::size_t k = 0; k < row.size(); ++k) sums_[k] += row[k];
        std::vector<std::uint32_t> const& place = walk_.places();
        for (std::size_t s = 0; s < place.size(); ++s)
            if (state.id[place[s]] < solvent) sums_[values() - 2] += dot(push_[s], push_[s]);
        for (std::unique_ptr<Bodies<D>> const& kind : bodies)
            for (std::size_t k = 0; k < kind->pulls.size(); ++k) {
                Pull<D> const& pull = kind->pulls[k];
                add_line(sums_, box, state.position[state.place[kind->first_id(0) + k]], pull.arm, pull.force, held);
            }
        for (std::size_t p = 0; p < state.size(); ++p) add_crossing(state, box, p);
    }

    // At the end of the step, with its velocities; hands out the sums.
    std::vector<double> take_motion(State<D> const& state, Box<D> const& box) {
        for (std::size_t p = 0; p < state.size(); ++p) {
            Vector<D> const v = peculiar(state, box, p);
            double const mass = 1.0 / state.inverse_mass[p];
            double* const bin = sums_.data() + bin_of(state.position[p][1], box) * bin_values;
            bin[0] += mass;
            for (std::size_t k = 0; k < D; ++k) {
                bin[1 + k] += mass * v[k];
                for (std::size_t l = 0; l < D; ++l) bin[1 + D + k * D + l] += mass * v[k] * v[l];
            }
        }
        return sums_;
    }

  private:
    enum Source { crossing, pairs, held };  // as they follow each other in what is kept of a plane

    template <class Law>
    void add_pair(std::vector<double>& sums, State<D> const& state, Box<D> const& box, WalkedPair<D> const& pair,
                  Law const& law, std::size_t solvent) {
        std::uint32_t const id_i = state.id[pair.place_i], id_j = state.id[pair.place_j];
        if (body_of_id_[id_i] >= 0 && body_of_id_[id_i] == body_of_id_[id_j]) return;
        // The random force has no mean.
        double const magnitude = pair.force.conservative + pair.force.dissipative;
        add_line(sums, box, state.position[pair.place_i], pair.separation,
                 (magnitude * pair.inverse_distance) * pair.separation, pairs);
        Vector<D> const push = (pair.force.conservative * pair.inverse_distance) * pair.separation;
        push_[pair.i] += push;
        push_[pair.j] -= push;
        double const divergence =
            law.curvature(pair.distance, walk_.species_at(pair.place_i), walk_.species_at(pair.place_j)) -
            (D - 1) * pair.force.conservative * pair.inverse_distance;
        sums[values() - 1] += divergence * ((id_i < solvent) + (id_j < solvent));
    }

    // A line that ends at `end` and is `along` long, with the force at its end.
    void add_line(std::vector<double>& sums, Box<D> const& box, Vector<D> const& end, Vector<D> const& along,
                  Vector<D> const& force, Source source) const {
        double const height = box.length()[1], width = height / static_cast<double>(bins_);
        double const per_volume = -static_cast<double>(bins_) / box.volume();
        auto const n = static_cast<long>(bins_);
        double const low = std::min(end[1], end[1] - along[1]) / width,
                     high = std::max(end[1], end[1] - along[1]) / width;
        long const first = static_cast<long>(std::floor(low)), last = static_cast<long>(std::floor(high));
        for (long b = first; b <= last; ++b) {
            double const inside = std::min(high, static_cast<double>(b + 1)) - std::max(low, static_cast<double>(b));
            double const part = first == last ? 1.0 : inside / (high - low);
            double* const bin = sums.data() + static_cast<std::size_t>((b % n + n) % n) * bin_values + 1 + D + tensor +
                                (source == held ? tensor : 0);
            for (std::size_t k = 0; k < D; ++k)
                for (std::size_t l = 0; l < D; ++l) bin[k * D + l] += per_volume * part * along[k] * force[l];
        }
        cross_planes(sums, box, 1, end[1] - along[1], end[1], force, source);
        cross_planes(sums, box, 0, end[0] - along[0], end[0], force, source);
    }

    // What crosses the planes normal to `axis` on the way from `begin` to `end` adds -carried sign(end - begin)/A.
    void cross_planes(std::vector<double>& sums, Box<D> const& box, std::size_t axis, double begin, double end,
                      Vector<D> const& carried, Source source) const {
        auto const n = static_cast<long>(bins_);
        double const spacing = box.length()[axis] / static_cast<double>(bins_);
        // Planes p with begin < p <= end, or the other way round
        long const below = static_cast<long>(std::floor(std::min(begin, end) / spacing));
        long const reach = static_cast<long>(std::floor(std::max(begin, end) / spacing));
        double const per_area = (end > begin ? -1.0 : 1.0) * box.length()[axis] / box.volume();
        for (long p = below + 1; p <= reach; ++p) {
            std::size_t const plane = (axis == 1 ? 0 : bins_) + static_cast<std::size_t>((p % n + n) % n);
            double* const at = sums.data() + bins_ * bin_values + plane * plane_values + source * D;
            for (std::size_t k = 0; k < D; ++k) at[k] += per_area * carried[k];
        }
    }

    void add_crossing(State<D> const& state, Box<D> const& box, std::size_t p) {
        Vector<D> const v = peculiar(state, box, p);
        Vector<D> const at = state.position[p];
        Vector<D> const momentum = (1.0 / (state.inverse_mass[p] * timestep_)) * v;
        cross_planes(sums_, box, 1, at[1] - timestep_ * v[1], at[1], momentum, crossing);
        cross_planes(sums_, box, 0, at[0] - timestep_ * v[0], at[0], momentum, crossing);
    }

    static Vector<D> peculiar(State<D> const& state, Box<D> const& box, std::size_t p) {
        Vector<D> v = state.velocity[p];
        v[0] -= box.flow_velocity(state.position[p][1]);
        return v;
    }

    std::size_t bin_of(double y, Box<D> const& box) const {
        auto const bin = static_cast<std::size_t>(y / box.length()[1] * static_cast<double>(bins_));
        return std::min(bin, bins_ - 1);
    }

    PairWalk<D> walk_;
    std::vector<std::int32_t> body_of_id_;
    double timestep_;
    std::size_t bins_;
    std::uint64_t interval_;
    std::vector<std::vector<double>> rows_;  // sums of each row of cells
    std::vector<double> sums_;
    std::vector<Vector<D>> push_;  // conservative force, in the order of the walk
};

}  // namespace tether
