// Memory of large arrays: aligned to cache lines, so that a pack need not straddle two, and on huge pages where the
// system has them, so that translating addresses does not cost more than the memory itself.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace tether {

template <class T>
struct ArrayAllocator {
    using value_type = T;
    ArrayAllocator() = default;
    template <class U>
    ArrayAllocator(ArrayAllocator<U> const&) {}

    T* allocate(std::size_t n) {
        std::size_t const bytes = n * sizeof(T);
        void* const memory = ::operator new(bytes, std::align_val_t{alignment(bytes)});
#if defined(__linux__)
        if (bytes >= huge_page) madvise(memory, bytes / huge_page * huge_page, MADV_HUGEPAGE);  // a wish: no matter
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t n) { ::operator delete(memory, std::align_val_t{alignment(n * sizeof(T))}); }
    template <class U>
    bool operator==(ArrayAllocator<U> const&) const {
        return true;
    }

  private:
    static constexpr std::size_t cache_line = 64, huge_page = std::size_t{1} << 21;
    static std::size_t alignment(std::size_t bytes) { return bytes >= huge_page ? huge_page : cache_line; }
};

template <class T>
using Array = std::vector<T, ArrayAllocator<T>>;

}  // namespace tether
