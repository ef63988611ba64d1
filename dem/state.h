// Grains as structure of arrays, in cell order; `id` is the grain's own number and never changes.
#pragma once
#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstdint>
#include <new>
#include <vector>

namespace gradwright {

/// Storage for vector loads: cache-line aligned, on large pages where it is large. The grains of a step are
/// spread over thousands of small pages, more than the processor keeps the addresses of.
template <class T>
struct AlignedAllocator {
    using value_type = T;
    AlignedAllocator() = default;
    template <class U>
    AlignedAllocator(const AlignedAllocator<U>&) {}
    T* allocate(std::size_t n) {
        std::size_t bytes = n * sizeof(T);
        const std::size_t alignment = alignment_of(bytes);
        if (alignment == kLargePage) bytes = (bytes + kLargePage - 1) / kLargePage * kLargePage;
        void* const p = ::operator new(bytes, std::align_val_t(alignment));
#ifdef __linux__
        if (alignment == kLargePage) madvise(p, bytes, MADV_HUGEPAGE);  // a wish
#endif
        return static_cast<T*>(p);
    }
    void deallocate(T* p, std::size_t n) {
        ::operator delete(p, std::align_val_t(alignment_of(n * sizeof(T))));
    }
    static constexpr std::size_t kLargePage = std::size_t{2} << 20;
    static std::size_t alignment_of(std::size_t bytes) {
        return bytes >= kLargePage / 4 ? kLargePage : 64;
    }
    template <class U>
    bool operator==(const AlignedAllocator<U>&) const {
        return true;
    }
};
template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

/// Velocities and spins stand at the last half step (leapfrog form of velocity Verlet).
struct State {
    std::vector<double> x, y, z;       ///< [m], y unwrapped when periodic
    std::vector<double> vx, vy, vz;    ///< [m/s]
    std::vector<double> wx, wy, wz;    ///< [rad/s]
    std::vector<double> radius, mass;  ///< [m], [kg]
    std::vector<std::int32_t> id;
    std::vector<std::uint8_t> material;  ///< index into EngineOptions::materials
    std::vector<std::uint8_t> fixed;     ///< 1: never moves (rough floors)
    std::vector<std::uint8_t> asleep;
    std::vector<std::int32_t> quiet;  ///< steps at rest so far

    std::size_t size() const { return x.size(); }

    /// Every per-grain array, for permutations and removals: one list, so that no array is forgotten.
    template <class Visitor>
    void for_each_array(Visitor&& visit) {
        for (auto* a : {&x, &y, &z, &vx, &vy, &vz, &wx, &wy, &wz, &radius, &mass}) visit(*a);
        visit(id);
        visit(material);
        visit(fixed);
        visit(asleep);
        visit(quiet);
    }
};

}  // namespace gradwright
