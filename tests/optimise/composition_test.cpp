// Composition from GI: end members, conservation, and melting against its recursion written out.
#include "optimise/composition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "optimise/material_table.h"
#include "optimise/study_file.h"

namespace gradwright {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

std::array<Material, 2> alloys() {
    Material a, b;
    a.name = "steel";
    a.density = 7980;
    a.composition = {{"Fe", 75}, {"Cr", 16}, {"Ni", 5}};
    b.name = "nickel";
    b.density = 8200;
    b.composition = {{"Ni", 53}, {"Cr", 19}, {"Fe", 18}, {"Nb", 5}};
    return {a, b};
}

GradationProfile profile(const std::vector<double>& gi, double error = 0.02) {
    GradationProfile p;
    for (std::size_t b = 0; b < gi.size(); ++b) p.y_m.push_back((static_cast<double>(b) + 0.5) * 0.1e-3);
    p.gi = gi;
    p.standard_error.assign(gi.size(), error);
    p.volume.assign(gi.size(), 1e-12);
    return p;
}

TEST(composition, mass_fraction_weighs_volumes_with_the_densities) {
    EXPECT_EQ(mass_fraction_a(0, 2, 5), 0);
    EXPECT_EQ(mass_fraction_a(1, 2, 5), 1);
    // one volume of density 2 beside three of density 5: 2 of 17
    EXPECT_NEAR(mass_fraction_a(0.25, 2, 5), 2.0 / 17, 1e-15);
}

TEST(composition, pure_powders_give_their_alloys_and_a_mixture_lies_between_by_mass) {
    const Composition c = powder_composition(profile({1, 0, 0.5, kNan}), alloys(), 2);
    EXPECT_DOUBLE_EQ(c.wt("Fe").value[0], 75);
    EXPECT_DOUBLE_EQ(c.wt("Ni").value[0], 5);
    EXPECT_DOUBLE_EQ(c.wt("Ni").value[1], 53);
    EXPECT_DOUBLE_EQ(c.wt("Nb").value[0], 0);
    const double m = 7980.0 / (7980 + 8200);
    EXPECT_NEAR(c.wt("Fe").value[2], 75 * m + 18 * (1 - m), 1e-12);
    EXPECT_TRUE(std::isnan(c.wt("Fe").value[3]));
    EXPECT_TRUE(std::isnan(c.wt("Fe").low[3]));
    // every bin's elements add up to what the alloys' own add up to
    double sum = 0;
    for (const ElementProfile& element : c.elements) sum += element.wt.value[2];
    EXPECT_NEAR(sum, 96 * m + 95 * (1 - m), 1e-12);
    EXPECT_EQ(c.elements.front().element, "Fe");
    EXPECT_THROW(c.wt("Au"), std::out_of_range);
}

TEST(composition, the_band_of_gi_becomes_a_band_of_every_element_the_right_way_round) {
    const Composition c = powder_composition(profile({0.5, 0.99}, 0.02), alloys(), 2);
    const auto [a, b] = alloys();
    const double low = mass_fraction_a(0.46, a.density, b.density),
                 high = mass_fraction_a(0.54, a.density, b.density);
    EXPECT_NEAR(c.wt("Fe").low[0], 75 * low + 18 * (1 - low), 1e-12);
    EXPECT_NEAR(c.wt("Fe").high[0], 75 * high + 18 * (1 - high), 1e-12);
    // nickel falls with A: its lower end belongs to the upper end of GI
    EXPECT_NEAR(c.wt("Ni").low[0], 5 * high + 53 * (1 - high), 1e-12);
    EXPECT_LT(c.wt("Ni").low[0], c.wt("Ni").high[0]);
    EXPECT_DOUBLE_EQ(c.wt("Fe").high[1], 75);  // clipped at pure A
    GradationProfile unknown = profile({0.5});
    unknown.standard_error.clear();
    EXPECT_TRUE(std::isnan(powder_composition(unknown, alloys(), 2).wt("Fe").low[0]));
}

TEST(composition, an_alloy_without_composition_is_named) {
    std::array<Material, 2> two = alloys();
    two[1].composition.clear();
    try {
        powder_composition(profile({0.5}), two, 2);
        FAIL() << "no exception";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("nickel"));
    }
}

TEST(melting, a_pool_no_wider_than_a_bin_leaves_the_powder_as_it_is) {
    const GradationProfile p = profile({0, 0.1, 0.6, 1});
    const Composition powder = powder_composition(p, alloys(), 2),
                      melted = melted_composition(p, alloys(), 2, {100e-6, 80e-6, 40e-6});
    for (std::size_t b = 0; b < 4; ++b) {
        EXPECT_NEAR(melted.wt("Fe").value[b], powder.wt("Fe").value[b], 1e-12);
        EXPECT_NEAR(melted.wt("Ni").value[b], powder.wt("Ni").value[b], 1e-12);
    }
}

TEST(melting, a_wide_pool_is_the_mass_weighted_mean_over_its_window) {
    std::array<Material, 2> equal = alloys();
    equal[1].density = equal[0].density;  // then m = g
    GradationProfile p = profile({0, 0, 1, 1, 1}, 0.03);
    const auto fe = [&](double width) {
        return melted_composition(p, equal, 2, {100e-6, width, 40e-6}).mass_fraction_a;
    };
    // three bins: (0 + 1 + 1)/3 around the step
    EXPECT_NEAR(fe(0.3e-3).value[2], 2.0 / 3, 1e-12);
    // two bins wide: half a neighbour on either side, (0.5 x 0 + 1 + 0.5 x 1)/2
    EXPECT_NEAR(fe(0.2e-3).value[2], 0.75, 1e-12);
    // at the wall the pool ends with the powder
    EXPECT_NEAR(fe(0.3e-3).value[0], 0, 1e-12);
    EXPECT_NEAR(fe(0.5e-3).value[1], 2.0 / 4, 1e-12);
    // half width of the band: factor s sqrt(3)/3
    const double half = 2 * 0.03 / std::sqrt(3.0);
    EXPECT_NEAR(fe(0.3e-3).high[1], 1.0 / 3 + half, 1e-12);
    EXPECT_NEAR(fe(0.3e-3).low[1], 1.0 / 3 - half, 1e-12);
    // a bin that holds twice the powder weighs twice
    p.volume[2] = 2e-12;
    EXPECT_NEAR(fe(0.3e-3).value[2], 3.0 / 4, 1e-12);
}

TEST(melting, keeps_the_slope_of_a_ramp_and_rounds_only_its_ends) {
    std::array<Material, 2> equal = alloys();
    equal[1].density = equal[0].density;
    std::vector<double> gi;
    for (int b = 0; b < 30; ++b) gi.push_back(std::clamp((b - 5) / 20.0, 0.0, 1.0));
    const std::vector<double> m =
        melted_composition(profile(gi), equal, 2, {100e-6, 0.5e-3, 40e-6}).mass_fraction_a.value;
    for (int b = 8; b < 22; ++b) EXPECT_NEAR(m[b], gi[b], 1e-12) << b;
    EXPECT_GT(m[5], gi[5]);
    EXPECT_LT(m[25], gi[25]);
}

TEST(melting, an_undefined_bin_is_no_part_of_any_pool) {
    std::array<Material, 2> equal = alloys();
    equal[1].density = equal[0].density;
    const std::vector<double> m =
        melted_composition(profile({0.2, kNan, 0.8}), equal, 2, {100e-6, 0.3e-3, 40e-6})
            .mass_fraction_a.value;
    EXPECT_NEAR(m[0], 0.2, 1e-12);
    EXPECT_TRUE(std::isnan(m[1]));
}

TEST(melting, dilution_is_the_recursion_of_pools_that_mix_with_what_lies_below) {
    const MeltPool pool{100e-6, 120e-6, 40e-6};
    EXPECT_NEAR(pool.new_share(), 0.4, 1e-15);
    // c_n = a p + (1 - a) c_(n-1) on a base of 1, powder of 0: what is left of the base
    double left = 1;
    for (int layer = 1; layer <= 8; ++layer) {
        left *= 1 - 0.4;
        EXPECT_NEAR(pool.base_share(layer), left, 1e-15);
    }
    // layers with independent scatter of 1: variance sum a^2 (1-a)^(2k)
    double variance = 0;
    for (int k = 0; k < 200; ++k) variance += 0.16 * std::pow(0.6, 2 * k);
    EXPECT_NEAR(pool.scatter_factor(), std::sqrt(variance), 1e-12);
    // a pool as deep as the layer mixes with nothing below
    const MeltPool shallow{40e-6, 120e-6, 40e-6};
    EXPECT_EQ(shallow.base_share(1), 0);
    EXPECT_EQ(shallow.scatter_factor(), 1);
    EXPECT_THROW(melted_composition(profile({0.5}), alloys(), 2, {30e-6, 1e-4, 40e-6}),
                 std::invalid_argument);
    EXPECT_THROW(melted_composition(profile({0.5}), alloys(), 2, {1e-4, 0, 40e-6}), std::invalid_argument);
}

// ---- where compositions come from

TEST(material_table, shipped_alloys_have_compositions_that_add_up) {
    int known = 0;
    for (const Material& material : shipped_materials()) {
        if (material.name == "geometry") continue;
        double sum = 0;
        for (const ElementShare& share : material.composition) sum += share.wt_percent;
        EXPECT_NEAR(sum, 100, 1e-9) << material.name;
        EXPECT_FALSE(material.composition_source.empty()) << material.name;
        EXPECT_TRUE(std::is_sorted(material.composition.begin(), material.composition.end(),
                                   [](const auto& a, const auto& b) { return a.wt_percent > b.wt_percent; }));
        ++known;
    }
    EXPECT_GE(known, 6);
}

std::vector<InputProblem> problems_of(const std::string& composition) {
    const std::string file = testing::TempDir() + "gradwright_materials_test.toml";
    std::ofstream(file) << "[alloy]\n"
                           "density = { value = \"8000 kg/m3\", source = \"s\" }\n"
                           "youngs_modulus = { value = \"200 GPa\", source = \"s\" }\n"
                           "poissons_ratio = { value = 0.3, source = \"s\" }\n"
                           "composition = "
                        << composition << "\n";
    try {
        const std::vector<Material> read = read_materials(file);
        EXPECT_EQ(read.size(), 1u);
    } catch (const InputError& error) {
        return error.problems;
    }
    return {};
}

TEST(material_table, a_composition_is_judged_where_it_is_read) {
    EXPECT_TRUE(problems_of(R"({ wt = { Ni = 50.0, Fe = "balance" }, source = "s" })").empty());
    const auto rule = [](const std::string& text) {
        const auto found = problems_of(text);
        EXPECT_EQ(found.size(), 1u) << text;
        return found.empty() ? "" : found[0].key + " " + found[0].rule;
    };
    EXPECT_THAT(rule(R"({ wt = { Nix = 50.0 }, source = "s" })"), testing::HasSubstr("no chemical symbol"));
    EXPECT_THAT(rule(R"({ wt = { Ni = 60.0, Fe = 50.0 }, source = "s" })"),
                testing::HasSubstr("adds up to 110"));
    EXPECT_THAT(rule(R"({ wt = { Ni = "balance", Fe = "balance" }, source = "s" })"),
                testing::HasSubstr("second balance"));
    EXPECT_THAT(rule(R"({ wt = { Ni = -1.0 }, source = "s" })"),
                testing::HasSubstr("alloy.composition.wt.Ni"));
    EXPECT_THAT(rule(R"({ wt = { Ni = 50.0 } })"), testing::HasSubstr("alloy.composition.source"));
    EXPECT_THAT(rule(R"({ wt = { Ni = 50.0 }, source = "s", balance = "Fe" })"),
                testing::HasSubstr("known key"));
    EXPECT_THAT(rule(R"({ source = "s" })"), testing::HasSubstr("alloy.composition.wt"));
}

}  // namespace
}  // namespace gradwright
