// Where the time of a step goes, phase by phase; it costs nothing unless it is on.
#pragma once

#include <array>
#include <chrono>

namespace tether {

enum class Phase { motion, sort, pairs, forces, bodies, measurement, order };
constexpr std::array<char const*, 7> phase_names = {"motion", "sort",        "pairs", "forces",
                                                    "bodies", "measurement", "order"};

class Stopwatch {
  public:
    bool is_on = false;
    std::array<double, phase_names.size()> seconds{};

    void start() {
        if (is_on) last_ = Clock::now();
    }
    // What has passed since the last lap, or the start, was spent on `phase`.
    void lap(Phase phase) {
        if (!is_on) return;
        Clock::time_point const now = Clock::now();
        seconds[static_cast<std::size_t>(phase)] += std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point last_;
};

}  // namespace tether
