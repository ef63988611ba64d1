// Velocity field, circulation and mixing of the heap, on motions and mixtures whose truth is known.
#include "dem/heap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "dem/random.h"

namespace gradwright {
namespace {

constexpr double kCell = 40e-6, kWidth = 0.2e-3;

struct Motion {
    double vx = 0, vz = 0;
};

/// Grains on a lattice ahead of a blade at `blade_x`, four a cell and symmetric in it, so that a cell's mean
/// of a linear field is the field at its centre.
Snapshot lattice(double blade_x, int columns, int rows, const std::function<Motion(double, double)>& motion) {
    Snapshot s;
    s.blade_x = blade_x;
    for (int k = 0; k < 2 * rows; ++k)
        for (int i = 0; i < 2 * columns; ++i)
            for (int j = 0; j < 5; ++j) {
                const double x = (i + 0.5) * kCell / 2, z = (k + 0.5) * kCell / 2;
                const Motion v = motion(x, z);
                s.x.push_back(static_cast<float>(blade_x + x));
                s.y.push_back(static_cast<float>((j + 0.5) * kWidth / 5));
                s.z.push_back(static_cast<float>(z));
                s.radius.push_back(10e-6f);
                s.is_a.push_back(i < columns);
                s.vx.push_back(static_cast<float>(v.vx));
                s.vy.push_back(0);
                s.vz.push_back(static_cast<float>(v.vz));
            }
    return s;
}

HeapFieldOptions options() {
    HeapFieldOptions o;
    o.cell = kCell;
    o.width = kWidth;
    return o;
}

TEST(heap, a_rolling_wheel_has_twice_its_angular_velocity_as_vorticity_and_turns_once_in_its_circumference) {
    // rolls towards +x without sliding: clockwise with x right, z up: v = (U + w (z - c), -w (x - c)), U = w
    // c
    const double w = 300, centre = 0.2e-3;
    const Snapshot s = lattice(1e-3, 10, 10, [&](double x, double z) {
        return Motion{w * centre + w * (z - centre), -w * (x - centre)};
    });
    const std::vector<Snapshot> one = {s};
    const HeapField field = heap_field(one, options());
    ASSERT_EQ(field.columns, 10);
    ASSERT_EQ(field.rows, 10);
    EXPECT_NEAR(field.vx[field.at(3, 9)], w * field.z(9), 1e-6);
    EXPECT_NEAR(field.vz[field.at(0, 4)], w * (centre - field.x(0)), 1e-6);
    const HeapRotation turn = heap_rotation(field, one, options());
    // snapshots keep floats: 6e-8 of the positions, 2 mm, are 3e-6 of a cell
    EXPECT_NEAR(turn.area, 81 * kCell * kCell, 1e-5 * 81 * kCell * kCell);
    EXPECT_NEAR(turn.vorticity, -2 * w, 1e-3 * w);
    EXPECT_NEAR(turn.circulation, -2 * w * turn.area, 1e-3 * w * turn.area);
    EXPECT_NEAR(turn.turn_length(w * centre), 2 * std::numbers::pi * centre, 1e-3 * centre);
    EXPECT_TRUE(std::isnan(turn.deviation));
}

TEST(heap, circulation_does_not_see_a_uniform_velocity_and_is_minus_the_rate_of_a_simple_shear) {
    const double rate = 500;
    const std::vector<Snapshot> shots = {lattice(1e-3, 6, 4,
                                                 [&](double, double z) {
                                                     return Motion{0.1 + rate * z, 0.02};
                                                 }),
                                         lattice(2e-3, 6, 4, [&](double, double z) {
                                             return Motion{0.1 + 1.2 * rate * z, 0.02};
                                         })};
    const HeapField field = heap_field(shots, options());
    const HeapRotation turn = heap_rotation(field, shots, options());
    EXPECT_NEAR(turn.vorticity, -1.1 * rate, 1e-2);
    // two instants, 1.0 and 1.2 times the rate: standard deviation 0.2/sqrt(2)
    EXPECT_NEAR(turn.deviation, 0.2 * rate / std::sqrt(2.0), 1e-2);
    EXPECT_EQ(field.instants, 2);
    EXPECT_EQ(field.blade_high, 2e-3);
}

TEST(heap, cells_average_by_volume_and_cells_with_hardly_a_grain_are_undefined) {
    Snapshot s = lattice(0, 2, 2, [](double, double) { return Motion{}; });
    for (std::size_t n = 0; n < s.x.size(); ++n) s.vx[n] = n % 2 ? 0.3f : 0.1f;
    for (std::size_t n = 0; n < s.x.size(); ++n) s.radius[n] = n % 2 ? 20e-6f : 10e-6f;
    // a grain thrown far ahead: no field there
    for (auto* v : {&s.x, &s.y, &s.z, &s.vx, &s.vy, &s.vz}) v->push_back(1e-3f);
    s.radius.push_back(10e-6f);
    s.is_a.push_back(1);
    const HeapField field = heap_field(std::vector<Snapshot>{s}, options());
    EXPECT_EQ(field.columns, 2);
    EXPECT_EQ(field.rows, 2);
    // 10 small and 10 large grains a cell: (1 x 0.1 + 8 x 0.3) / 9
    EXPECT_NEAR(field.vx[0], 2.5 / 9, 1e-6);
    const double volume = 4.0 / 3 * std::numbers::pi * 1e-15 * (10 + 10 * 8);
    EXPECT_NEAR(field.solid_fraction[0], volume / (kCell * kCell * kWidth), 1e-6);
    EXPECT_EQ(field.gi[field.at(0, 0)], 1);
    EXPECT_EQ(field.gi[field.at(1, 0)], 0);
    EXPECT_EQ(heap_field({}, options()).columns, 0);
    EXPECT_THROW(heap_field({}, HeapFieldOptions{.cell = 0, .width = 1}), std::invalid_argument);
}

TEST(lacey, is_zero_for_pure_cells_and_follows_its_formula_in_between) {
    LaceyIndex pure(2);
    for (int n = 0; n < 50; ++n) pure.add(0, 1, 1), pure.add(1, 1, 0);
    EXPECT_DOUBLE_EQ(pure.value(), 0);
    EXPECT_DOUBLE_EQ(pure.gi(), 0.5);
    // two cells of 4 equal grains, 3 A + 1 B and 1 A + 3 B: g = 1/2, S0^2 = 1/4, S^2 = 1/16,
    // SR^2 = (1/4)/(1 - 1/8) (1/4 - 1/8) = 1/28: M = (3/16)/(3/14) = 7/8
    LaceyIndex half(2);
    for (const double share : {1, 1, 1, 0}) half.add(0, 2.0, share), half.add(1, 2.0, 1 - share);
    EXPECT_NEAR(half.value(), 7.0 / 8, 1e-12);
    LaceyIndex one_powder(3);
    for (int n = 0; n < 9; ++n) one_powder.add(n % 3, 1, 1);
    EXPECT_TRUE(std::isnan(one_powder.value()));
    EXPECT_TRUE(std::isnan(LaceyIndex(3).value()));
}

TEST(lacey, of_labels_dealt_at_random_is_one_on_average_whatever_the_grain_sizes) {
    Random random(5);
    const int deals = 400, grains = 300, cells = 15;
    std::vector<double> volume, sums(2, 0);
    for (int n = 0; n < grains; ++n) volume.push_back(std::pow(random.uniform(), 3) + 0.01);
    double removed = 0, removable = 0, square = 0;
    for (int deal = 0; deal < deals; ++deal) {
        LaceyIndex index(cells);
        for (int n = 0; n < grains; ++n) index.add(n % cells, volume[n], random.uniform() < 0.3 ? 1 : 0);
        removed += index.excess();
        removable += index.mixable();
        square += index.value() * index.value();
    }
    const double mean = removed / removable, deviation = std::sqrt(square / deals - mean * mean);
    // unbiased: within three standard errors of the mean over the deals
    EXPECT_NEAR(mean, 1, 3 * deviation / std::sqrt(deals));
    EXPECT_LT(deviation, 0.2);
}

/// A heap of random grains, 1 mm long and 0.3 mm high, over 0.8 mm of width; label by position and a coin.
Snapshot heap(const std::function<double(double x, double y)>& share_of_a) {
    Random random(11);
    Snapshot s;
    s.blade_x = 2e-3;
    s.time = 0.02;
    for (int n = 0; n < 6000; ++n) {
        const double x = 1e-3 * random.uniform(), y = 0.8e-3 * random.uniform(),
                     z = 0.3e-3 * random.uniform();
        s.x.push_back(static_cast<float>(s.blade_x + x));
        s.y.push_back(static_cast<float>(y));
        s.z.push_back(static_cast<float>(z));
        s.radius.push_back(static_cast<float>(8e-6 + 20e-6 * random.uniform()));
        s.is_a.push_back(random.uniform() < share_of_a(x, y));
        s.vx.push_back(0.1f);
        s.vy.push_back(0);
        s.vz.push_back(0);
    }
    return s;
}

HeapMixingOptions mixing_options() {
    HeapMixingOptions o;
    o.width = 0.8e-3;
    o.least_speed = 0.01;
    return o;
}

TEST(heap_mixing, tells_a_heap_graded_across_from_one_that_is_not_mixed_along_its_way) {
    // graded across y, random within: mixed in slices, unmixed over all
    const HeapMixing graded =
        heap_mixing(heap([](double, double y) { return y / 0.8e-3; }), mixing_options());
    EXPECT_NEAR(graded.lacey_in_slices, 1, 0.05);
    EXPECT_LT(graded.lacey, 0.8);
    ASSERT_EQ(graded.y_m.size(), 8u);
    for (std::size_t b = 0; b < 8; ++b) EXPECT_NEAR(graded.slice_gi[b], graded.y_m[b] / 0.8e-3, 0.08);
    // A in front, B behind: every slice unmixed
    const HeapMixing behind =
        heap_mixing(heap([](double x, double) { return x > 0.5e-3 ? 1 : 0; }), mixing_options());
    EXPECT_LT(behind.lacey_in_slices, 0.05);
    for (const double lacey : behind.slice_lacey) EXPECT_LT(lacey, 0.1);
    // random everywhere
    const HeapMixing mixed = heap_mixing(heap([](double, double) { return 0.4; }), mixing_options());
    EXPECT_NEAR(mixed.lacey, 1, 0.03);
    EXPECT_NEAR(mixed.gi, 0.4, 0.04);
    EXPECT_EQ(mixed.grains, 6000);
    EXPECT_EQ(mixed.blade_x, 2e-3);
    // nearly pure slices have nothing to mix
    const HeapMixing pure =
        heap_mixing(heap([](double, double y) { return y > 0.4e-3 ? 1 : 0; }), mixing_options());
    for (const double lacey : pure.slice_lacey) EXPECT_TRUE(std::isnan(lacey));
}

TEST(heap_mixing, counts_only_powder_that_moves_ahead_of_the_blade_above_its_edge) {
    Snapshot s = heap([](double, double) { return 0.5; });
    const long all = heap_mixing(s, mixing_options()).grains;
    s.vx[0] = 0;        // at rest
    s.z[1] = -10e-6f;   // in the layer
    s.x[2] = 1.9e-3f;   // behind the blade
    s.y[3] = -0.1e-3f;  // over a periodic side: counted where it wraps to
    HeapMixingOptions periodic = mixing_options();
    periodic.periodic = true;
    EXPECT_EQ(heap_mixing(s, periodic).grains, all - 3);
    EXPECT_EQ(heap_grains(s, 0.01).size(), static_cast<std::size_t>(all - 3));
    const HeapMixing nothing = heap_mixing(Snapshot{}, mixing_options());
    EXPECT_EQ(nothing.grains, 0);
    EXPECT_TRUE(std::isnan(nothing.lacey));
    EXPECT_TRUE(std::isnan(nothing.lacey_in_slices));
}

}  // namespace
}  // namespace gradwright
