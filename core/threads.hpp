// A team of threads that runs numbered units of work.
//
// Each thread begins with a stretch of its own, the same part of the units in every call, so that what it works on is in
// its cache since the last one; when it is done it helps the others.  Which thread takes which unit is thus left to
// chance; results never depend on it, because a unit writes only what no other unit of the same call touches, and sums
// are taken over units in their order afterwards.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace tether {

class Team {
  public:
    explicit Team(int threads) : stretches_(static_cast<std::size_t>(threads)) {
        try {
            for (std::size_t k = 1; k < stretches_.size(); ++k) workers_.emplace_back([this, k] { serve(k); });
        } catch (...) {  // the system has no more threads to give
            close();
            throw;
        }
    }
    ~Team() { close(); }
    Team(Team const&) = delete;
    Team& operator=(Team const&) = delete;

    int size() const { return static_cast<int>(workers_.size()) + 1; }

    // Call work(unit) for every unit in [0, count), each once; returns when all are done.
    template <class Work>
    void each(std::size_t count, Work&& work) {
        if (workers_.empty() || count < 2) {
            for (std::size_t unit = 0; unit < count; ++unit) work(unit);
            return;
        }
        call_ = [](void* object, std::size_t unit) { (*static_cast<std::remove_reference_t<Work>*>(object))(unit); };
        object_ = const_cast<void*>(static_cast<void const*>(&work));
        for (std::size_t k = 0; k < stretches_.size(); ++k) {
            stretches_[k].next.store(k * count / stretches_.size(), std::memory_order_relaxed);
            stretches_[k].end = (k + 1) * count / stretches_.size();
        }
        busy_.store(workers_.size(), std::memory_order_relaxed);
        {
            std::lock_guard const lock(mutex_);
            round_.fetch_add(1, std::memory_order_release);
        }
        if (sleepers_.load(std::memory_order_acquire) > 0) wake_.notify_all();
        take_units(0);
        for (int spin = 0; busy_.load(std::memory_order_acquire) != 0; ++spin)
            if (spin > patience) std::this_thread::yield();
    }

    // The same over ranges [begin, end) of at most `length` items; the ranges do not depend on the number of threads.
    template <class Work>
    void ranges(std::size_t items, std::size_t length, Work&& work) {
        each((items + length - 1) / length, [&](std::size_t unit) {
            std::size_t const begin = unit * length;
            work(begin, begin + length < items ? begin + length : items, unit);
        });
    }

  private:
    static constexpr int patience = 20000;  // turns of an idle loop (some 10 microseconds) before a thread sleeps

    void close() {
        {
            std::lock_guard const lock(mutex_);
            closing_ = true;
            round_.fetch_add(1, std::memory_order_release);
        }
        wake_.notify_all();
        for (std::thread& worker : workers_) worker.join();
    }

    // A unit that throws ends the program: the others could not be called back.
    void take_units(std::size_t own) noexcept {
        for (std::size_t k = 0; k < stretches_.size(); ++k) {
            Stretch& stretch = stretches_[(own + k) % stretches_.size()];
            while (stretch.next.load(std::memory_order_relaxed) < stretch.end) {
                std::size_t const unit = stretch.next.fetch_add(1, std::memory_order_relaxed);
                if (unit < stretch.end) call_(object_, unit);
            }
        }
    }

    void serve(std::size_t own) {
        for (std::size_t seen = 0;;) {
            for (int spin = 0; round_.load(std::memory_order_acquire) == seen && spin < patience; ++spin) {}
            if (round_.load(std::memory_order_acquire) == seen) {
                std::unique_lock lock(mutex_);
                sleepers_.fetch_add(1, std::memory_order_release);
                wake_.wait(lock, [&] { return round_.load(std::memory_order_acquire) != seen; });
                sleepers_.fetch_sub(1, std::memory_order_release);
            }
            seen = round_.load(std::memory_order_acquire);
            if (closing_) return;
            take_units(own);
            busy_.fetch_sub(1, std::memory_order_release);
        }
    }

    struct alignas(64) Stretch {  // of units; in a cache line of its own
        std::atomic<std::size_t> next{0};
        std::size_t end = 0;
    };

    std::vector<Stretch> stretches_;
    std::vector<std::thread> workers_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::atomic<std::size_t> round_{0}, busy_{0}, sleepers_{0};
    bool closing_ = false;
    void (*call_)(void*, std::size_t) = nullptr;
    void* object_ = nullptr;
};

}  // namespace tether
