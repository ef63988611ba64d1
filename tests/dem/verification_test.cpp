// The ladder passes in both precisions; its numbers are the published ones; a broken law turns the rungs red
// that should see it.
#include "dem/verification/verification.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace gradwright {
namespace {

using testing::Contains;

struct RungRun {
    VerificationRung rung;
    Precision precision;
};

class Ladder : public testing::TestWithParam<RungRun> {};

TEST_P(Ladder, every_case_is_within_its_tolerance) {
    VerificationOptions options;
    options.precision = GetParam().precision;
    const auto cases = GetParam().rung.run(options);
    ASSERT_FALSE(cases.empty());
    for (const auto& c : cases) {
        EXPECT_TRUE(c.pass) << fmt::format(
            "{} {}: {}: expected {:.10g}, obtained {:.10g}, error {:.3g}, tolerance {:.3g} ({})", c.id,
            c.name, c.quantity, c.expected, c.obtained, c.error, c.tolerance, c.source);
        EXPECT_EQ(c.id, GetParam().rung.id);
        EXPECT_FALSE(c.source.empty());
    }
}

std::vector<RungRun> all_runs() {
    std::vector<RungRun> runs;
    for (const auto& rung : verification_ladder())
        for (const Precision p : {Precision::double_law, Precision::single_law}) runs.push_back({rung, p});
    return runs;
}

INSTANTIATE_TEST_SUITE_P(Rungs, Ladder, testing::ValuesIn(all_runs()), [](const auto& info) {
    return info.param.rung.id + (info.param.precision == Precision::double_law ? "_double" : "_single");
});

/// Rungs with a failed case.
std::set<std::string> red_rungs(const LawFault& fault, const std::vector<std::string>& only) {
    std::set<std::string> red;
    VerificationOptions options;
    options.fault = fault;
    for (const auto& rung : verification_ladder()) {
        if (std::find(only.begin(), only.end(), rung.id) == only.end()) continue;
        for (const auto& c : rung.run(options))
            if (!c.pass) red.insert(c.id);
    }
    return red;
}

class LadderWithAFault : public testing::TestWithParam<Mutation> {};

TEST_P(LadderWithAFault, turns_the_rungs_red_that_must_see_it_and_no_elastic_impact) {
    const Mutation& m = GetParam();
    std::vector<std::string> rungs = m.red;
    rungs.push_back("V1");  // elastic head-on impacts know none of these faults
    EXPECT_THAT(red_rungs(m.fault, rungs), testing::UnorderedElementsAreArray(m.red));
}

INSTANTIATE_TEST_SUITE_P(Mutations, LadderWithAFault, testing::ValuesIn(mutations()),
                         [](const auto& info) { return info.param.name; });

TEST(Mutations, the_faults_on_offer_are_the_promised_ones) {
    std::vector<std::string> names;
    for (const Mutation& m : mutations()) names.push_back(m.name);
    EXPECT_THAT(names, testing::ElementsAre("damping", "history", "pull_off", "lever_arm"));
}

/// Rows of a reference file as column name -> text.
std::vector<std::map<std::string, std::string>> read_reference(const std::string& name) {
    std::ifstream in(std::string(GRADWRIGHT_SOURCE_DIR) + "/tests/dem/reference/" + name);
    std::vector<std::map<std::string, std::string>> rows;
    std::vector<std::string> header;
    auto split = [](const std::string& line) {
        std::vector<std::string> cells;
        std::stringstream text(line);
        for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
        return cells;
    };
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#') continue;
        if (header.empty()) {
            header = split(line);
            continue;
        }
        const auto cells = split(line);
        rows.emplace_back();
        for (std::size_t k = 0; k < header.size(); ++k) rows.back()[header[k]] = cells.at(k);
    }
    return rows;
}

TEST(Reference, the_ladder_holds_every_row_of_the_hertz_table) {
    const auto cases = verify_hertz_impacts({});
    std::vector<double> expected;
    for (const auto& c : cases) expected.push_back(c.expected);
    const auto rows = read_reference("hertz_impact.csv");
    ASSERT_EQ(rows.size(), 6u);
    for (const auto& row : rows)
        for (const char* column : {"delta_max_m", "force_max_N", "contact_time_s"})
            EXPECT_THAT(expected, Contains(std::stod(row.at(column))));
}

TEST(Reference, the_ladder_holds_every_row_of_the_oblique_table) {
    const auto cases = verify_oblique_impacts({});
    const auto rows = read_reference("oblique_impact.csv");
    ASSERT_EQ(rows.size(), 13u);
    for (const auto& row : rows) {
        std::vector<double> expected;
        for (const auto& c : cases)
            if (c.name == "test 4, " + row.at("angle_deg") + " degrees") expected.push_back(c.expected);
        for (const auto& [column, text] : row)
            if (column != "angle_deg") {
                EXPECT_THAT(expected, Contains(std::stod(text))) << row.at("angle_deg") << " " << column;
            }
    }
}

template <class T>
double law_force(double r1, double r2, double youngs_modulus, double poissons_ratio, double gamma,
                 double overlap) {
    const double r = r1 * r2 / (r1 + r2),
                 e_star = 0.5 * youngs_modulus / (1 - poissons_ratio * poissons_ratio);
    LawConstants law;
    law.time_step = 1e-9;
    Contact<T> c{};
    c.nx = c.mass = c.touching = c.g_star8 = splat<T>(1);
    c.overlap = splat<T>(overlap);
    c.radius = splat<T>(r);
    c.arm_i = splat<T>(r1);
    c.arm_j = splat<T>(r2);
    c.e_star = splat<T>(e_star);
    c.jkr_radius = splat<T>(std::cbrt(2 * 3.14159265358979323846 * gamma * r * r / e_star));
    ContactHistory<T> h{};
    const auto out = contact_law<T, true, RollingModel::none>(law, {}, c, h);
    if constexpr (Lane<T>::kWidth == 1)
        return out.fx;
    else
        return static_cast<double>(out.fx[Lane<T>::kWidth - 1]);
}

TEST(Reference, the_law_gives_every_row_of_the_jkr_curve) {
    std::map<std::string, double> pull_off, tear_off;
    for (const auto& row : read_reference("jkr_points.csv")) {
        pull_off[row.at("case")] = std::stod(row.at("pull_off_force_N"));
        tear_off[row.at("case")] = std::stod(row.at("tear_off_overlap_m"));
    }
    const auto rows = read_reference("jkr_curve.csv");
    ASSERT_GT(rows.size(), 80u);
    for (const auto& row : rows) {
        const auto number = [&](const char* column) { return std::stod(row.at(column)); };
        const double overlap = number("overlap_m"), expected = number("force_N");
        // The tear-off row itself is a double root: the overlap's last bit decides whether it still lives.
        if (overlap < tear_off.at(row.at("case")) * (1 - 1e-6)) continue;
        const double scale = std::max(std::fabs(expected), pull_off.at(row.at("case")));
        const double exact = law_force<double>(number("r1_m"), number("r2_m"), number("youngs_modulus_Pa"),
                                               number("poisson"), number("work_of_adhesion_J_m2"), overlap);
        const double fast = law_force<WideFloat>(number("r1_m"), number("r2_m"), number("youngs_modulus_Pa"),
                                                 number("poisson"), number("work_of_adhesion_J_m2"), overlap);
        EXPECT_NEAR(exact, expected, 1e-6 * scale) << row.at("case") << " " << overlap;
        EXPECT_NEAR(fast, expected, 1e-4 * scale) << row.at("case") << " " << overlap;
    }
}

}  // namespace
}  // namespace gradwright
