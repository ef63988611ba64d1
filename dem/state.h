// Grains in cell order; `id` is the grain's own number and never changes.
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

/// Where a grain is: what a step gathers of it [m].
struct alignas(32) Place {
    double x, y, z;  ///< y unwrapped when periodic
    double radius;
};
/// How it moves, at the last half step (leapfrog form of velocity Verlet), and what turns a force or a torque
/// into a change of that.
struct alignas(64) Moving {
    double vx, vy, vz;       ///< [m/s]
    double inverse_mass;     ///< [1/kg]
    double wx, wy, wz;       ///< [rad/s]
    double inverse_inertia;  ///< [1/(kg m2)]
};

/// One member of all rows, as if it were an array of its own.
template <class Row, double Row::*kMember>
class Column {
  public:
    explicit Column(AlignedVector<Row>& rows) : rows_(&rows) {}
    Column(const Column&) = delete;
    Column& operator=(const Column&) = delete;
    double& operator[](std::size_t i) { return (*rows_)[i].*kMember; }
    double operator[](std::size_t i) const { return (*rows_)[i].*kMember; }

  private:
    AlignedVector<Row>* rows_;
};

/// Grains in rows of what is read together; `x`, `vx` and so on are columns of those rows.
struct State {
    State() = default;
    State(const State& other) : State() { *this = other; }
    State& operator=(const State& other) {
        place = other.place;
        moving = other.moving;
        mass = other.mass;
        id = other.id;
        material = other.material;
        fixed = other.fixed;
        asleep = other.asleep;
        quiet = other.quiet;
        return *this;
    }

    AlignedVector<Place> place;    ///< may have more rows than there are grains: the engine's dummies
    AlignedVector<Moving> moving;  ///< of a fixed grain all zero
    std::vector<double> mass;      ///< [kg]
    std::vector<std::int32_t> id;
    std::vector<std::uint8_t> material;  ///< index into EngineOptions::materials
    std::vector<std::uint8_t> fixed;     ///< 1: never moves (rough floors)
    std::vector<std::uint8_t> asleep;
    std::vector<std::int32_t> quiet;  ///< steps at rest so far

    Column<Place, &Place::x> x{place};
    Column<Place, &Place::y> y{place};
    Column<Place, &Place::z> z{place};
    Column<Place, &Place::radius> radius{place};
    Column<Moving, &Moving::vx> vx{moving};
    Column<Moving, &Moving::vy> vy{moving};
    Column<Moving, &Moving::vz> vz{moving};
    Column<Moving, &Moving::wx> wx{moving};
    Column<Moving, &Moving::wy> wy{moving};
    Column<Moving, &Moving::wz> wz{moving};

    std::size_t size() const { return id.size(); }

    /// Every array with a row a grain, for permutations and removals: one list, so that none is forgotten.
    template <class Visitor>
    void for_each_array(Visitor&& visit) {
        visit(place);
        visit(moving);
        visit(mass);
        visit(id);
        visit(material);
        visit(fixed);
        visit(asleep);
        visit(quiet);
    }
};

}  // namespace gradwright
