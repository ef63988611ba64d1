// The page and the sentences: self-contained, escaped, small, honest.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <regex>

#include "reports/grain_picture.h"
#include "reports/html_report.h"
#include "reports/reduction_cost.h"
#include "reports/report_data.h"
#include "reports/summary.h"
#include "reports/wording.h"
#include "tests/reports/fixture.h"

namespace gradwright {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string page_of(const std::string& name) {
    const Study study = fixture::study(name);
    return report_html(report_data(study, fixture::result(study)));
}

TEST(Report, user_text_cannot_become_markup) {
    const std::string page = page_of("<img src=x onerror=alert(1)> & 'co'");
    EXPECT_THAT(page, HasSubstr("&lt;img src=x onerror=alert(1)&gt; &amp; &#39;co&#39;"));
    EXPECT_THAT(page, Not(HasSubstr("<img src=x")));
    EXPECT_THAT(page, Not(HasSubstr("<b>not bold")));
    // the study's own text holds "</script>": every "<" of the data block is an escape
    const std::size_t start = page.find("id=\"data\">") + 10;
    const std::string block = page.substr(start, page.find("</script>", start) - start);
    EXPECT_EQ(block.find('<'), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(block)["study_text"].get<std::string>(),
              fixture::study("<img src=x onerror=alert(1)> & 'co'").text);
}

TEST(Report, loads_nothing_from_anywhere) {
    const std::string page = page_of("coupon");
    // src= and href= of tags outside scripts; the plotting library itself is covered by the policy
    const std::regex loads(
        "<(script|link|img|iframe|object|embed|video|audio|source)[^>]*(src|href)=\"(?!data:)");
    EXPECT_FALSE(std::regex_search(page.substr(0, page.find("id=\"data\"")), loads));
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    EXPECT_THAT(page, Not(HasSubstr("@import")));
    EXPECT_LT(page.size(), 6u << 20);
}

TEST(Report, verdict_stands_in_the_page_without_its_script) {
    const std::string page = page_of("coupon");
    const std::size_t verdict = page.find("class=\"headline\">Target met");
    ASSERT_NE(verdict, std::string::npos);
    EXPECT_LT(verdict, page.find("<script"));
}

TEST(Report, refuses_data_that_are_not_its_own) {
    EXPECT_THROW(report_html({{"format", "something"}}), std::invalid_argument);
    EXPECT_THROW(report_html(nlohmann::json::array()), std::invalid_argument);
}

TEST(Report, command_quotes_a_file_name_with_blanks) {
    Study study = fixture::study();
    study.file = "my studies/it's.toml";
    EXPECT_THAT(report_data(study, fixture::result(study))["command"].get<std::string>(),
                HasSubstr("'my studies/it'\\''s.toml'"));
}

TEST(Report, command_says_all_that_decides_the_numbers) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    result.seed = 7;
    const std::vector<std::string> words = {
        "--strategy", "bobyqa", "--set", "process.layer_thickness=\"50 um\"", "--set", "run.seed=7"};
    EXPECT_EQ(report_data(study, result, {}, words)["command"],
              "gradwright design examples/01_linear_coupon.toml --strategy bobyqa --set "
              "'process.layer_thickness=\"50 um\"' --seed 7 --out OUT");
}

TEST(Report, origin_shares_sum_to_one_and_w_ends_at_one) {
    const Study study = fixture::study();
    const auto origin = report_data(study, fixture::result(study))["origin"];
    double sum = 0;
    for (const auto& share : origin["share"]) sum += share.get<double>();
    EXPECT_NEAR(sum, 1, 1e-3);  // rounded to 1e-7 in some hundred cells
    EXPECT_DOUBLE_EQ(origin["cumulative"].back().get<double>(), 1);
    EXPECT_DOUBLE_EQ(origin["cumulative"].front().get<double>(), 0);
}

TEST(Report, knows_what_the_reductions_in_use_cost) {
    // the set of the first example, as docs/speed-against-error.md measured it whole
    Study study = fixture::study();
    study.reductions = {"early_stop", "fines_cut", "shallow_bed", "strip_map"};
    study.scene.softening = 1e-4;
    study.scene.rayleigh_fraction = 0.3;
    const auto cost = report_data(study, fixture::result(study))["reduction_cost"];
    ASSERT_TRUE(cost.is_object());
    EXPECT_EQ(cost["used"], "study");
    EXPECT_EQ(cost["own"], false);
    std::ifstream file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/speed-against-error.md");
    const std::string page((std::istreambuf_iterator<char>(file)), {});
    const std::string ladder = page.substr(page.find("<!-- ladder: begin"));
    for (const auto& level : cost["levels"]) {
        if (level["name"] != "study") continue;
        char row[64];
        std::snprintf(row, sizeof row, "| %.2f | %.3f | %.3f |", level["speed_up"].get<double>(),
                      level["gi_rmse"].get<double>(), level["noise_floor"].get<double>());
        EXPECT_THAT(ladder, HasSubstr(row));
    }
    // one setting aside, and nothing is known
    study.scene.rayleigh_fraction = 0.31;
    EXPECT_TRUE(reduction_cost(study).is_null());
    study.scene.rayleigh_fraction = 0.3;
    study.reductions.pop_back();
    EXPECT_TRUE(reduction_cost(study).is_null());
}

TEST(Report, the_study_s_own_tradeoff_stands_for_it) {
    nlohmann::json level = {{"name", "study"}, {"gi_rmse", 0.02}, {"beds", nlohmann::json::array()}};
    nlohmann::json missing = {{"name", "finest"}, {"gi_rmse", nullptr}};
    nlohmann::json tradeoff = {{"study", "s"},
                               {"seeds", 3},
                               {"noise_allowed", 2},
                               {"provenance", {{"host", {{"isa", "AVX2"}}}}},
                               {"levels", {missing, level}}};
    const auto cost = reduction_cost(tradeoff, "gradwright tradeoff OUT");
    EXPECT_EQ(cost["own"], true);
    EXPECT_EQ(cost["levels"].size(), 1u);
    EXPECT_FALSE(cost["levels"][0].contains("beds"));
    tradeoff["levels"] = {missing};
    EXPECT_TRUE(reduction_cost(tradeoff, "").is_null());
}

TEST(GrainPicture, base64_matches_rfc_4648) {
    const auto encoded = [](const std::string& text) { return base64({text.begin(), text.end()}); };
    EXPECT_EQ(encoded(""), "");
    EXPECT_EQ(encoded("f"), "Zg==");
    EXPECT_EQ(encoded("fo"), "Zm8=");
    EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(GrainPicture, leaves_out_what_fell_and_wraps_periodic_sides) {
    Scene scene;
    scene.width = 1e-3;
    scene.sides = Sides::periodic;
    Snapshot shot;
    shot.x = {1e-3f, 2e-3f, 1e-3f};
    shot.y = {-0.2e-3f, 0.1e-3f, 0.5e-3f};
    shot.z = {0, 0, -5e-3f};  // the last one fell into the overflow
    shot.radius = {2e-5f, 2e-5f, 2e-5f};
    shot.is_a = {1, 0, 0};
    const auto picture = grain_picture(shot, scene);
    EXPECT_EQ(picture["grains"], 3);
    EXPECT_EQ(picture["shown"], 2);
    EXPECT_NEAR(picture["origin"][1].get<double>() + picture["extent"][1].get<double>(), 0.8e-3, 1e-9);
}

TEST(GrainPicture, a_big_bed_keeps_its_surface_and_its_cut) {
    const Study study = fixture::study();
    const StudyResult result = fixture::result(study);
    const auto all = grain_picture(result.snapshots[0], study.scene);
    const auto few = grain_picture(result.snapshots[0], study.scene, 1000);
    EXPECT_LT(few["shown"].get<int>(), all["shown"].get<int>());
    EXPECT_GT(few["shown"].get<int>(), 1000);  // 84 x 42 columns of grains are seen from above
    EXPECT_EQ(few["data"].get<std::string>().size(), (few["shown"].get<std::size_t>() * 8 + 2) / 3 * 4);
}

TEST(GrainPicture, no_bed_takes_more_than_its_share_of_the_page) {
    const Study study = fixture::study();
    const StudyResult result = fixture::result(study);
    const auto few = grain_picture(result.snapshots[0], study.scene, 1000, 500);
    EXPECT_EQ(few["shown"], 500);
    EXPECT_EQ(few["grains"], result.snapshots[0].x.size());
    // evenly over the heights: the lowest of the surface stays, and something near the top
    const auto all = grain_picture(result.snapshots[0], study.scene, 1000);
    EXPECT_EQ(few["origin"][2], all["origin"][2]);
    EXPECT_GT(few["extent"][2].get<double>(), 0.9 * all["extent"][2].get<double>());
}

TEST(Report, shows_the_first_and_the_last_instant_and_some_between) {
    EXPECT_THAT(shown_instants(0), testing::IsEmpty());
    EXPECT_THAT(shown_instants(1), testing::ElementsAre(0));
    EXPECT_THAT(shown_instants(2), testing::ElementsAre(0, 1));
    EXPECT_THAT(shown_instants(5), testing::ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(shown_instants(61), testing::ElementsAre(0, 15, 30, 45, 60));
}

TEST(Report, carries_the_3_d_library_only_where_there_are_grains) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    EXPECT_NE(report_html(report_data(study, result)).find("var THREE="), std::string::npos);
    result.snapshots.clear();
    EXPECT_EQ(report_html(report_data(study, result)).find("var THREE="), std::string::npos);
}

TEST(Wording, verdict_names_the_margin) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    EXPECT_THAT(wording(study, result).verdict, HasSubstr("0.013 inside the tolerance of 0.040"));
    result.verdict = Verdict::not_met;
    result.misfit = {Norm::rmse, 0.06, 0.058, 0.052, 0.066, 0.01, 0.04};
    EXPECT_EQ(wording(study, result).headline, "Target not met");
    EXPECT_THAT(wording(study, result).verdict, HasSubstr("0.012 beyond the tolerance of 0.040"));
}

TEST(Wording, a_prediction_is_never_called_confirmed) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    result.confirmations.clear();
    result.confirmed = {};
    const Wording words = wording(study, result);
    EXPECT_THAT(words.verdict, HasSubstr("redicted (not confirmed)"));
    EXPECT_THAT(words.sure, HasSubstr("prediction"));
}

TEST(Wording, a_spread_read_in_the_mirror_is_called_so) {
    Study study = fixture::study();
    StudyResult result = fixture::result(study);
    ASSERT_FALSE(result.confirmations.empty());
    for (Evaluation& one : result.confirmations) one.every_grain = true;
    study.scene.plate_thickness = 0;
    study.scene.powder[1] = study.scene.powder[0];
    EXPECT_THAT(wording(study, result).sure, HasSubstr("mirror image"));
    study.scene.plate_thickness = 50e-6;
    EXPECT_THAT(wording(study, result).sure, HasSubstr("read for every y"));
    EXPECT_THAT(wording(study, result).sure, Not(HasSubstr("mirror image")));
}

TEST(Wording, a_drift_above_a_tenth_is_a_warning) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    const std::size_t before = wording(study, result).warnings.size();
    result.confirmed_drift.value = 0.24;
    EXPECT_EQ(wording(study, result).warnings.size(), before + 1);
}

TEST(Wording, durations_round_up_to_the_next_unit) {
    EXPECT_EQ(duration(3.21), "3.2 s");
    EXPECT_EQ(duration(9.97), "10 s");
    EXPECT_EQ(duration(59.7), "1 min 00 s");
    EXPECT_EQ(duration(3600 * 2 + 60 * 5), "2 h 05 min");
    EXPECT_EQ(duration(std::nan("")), "unknown");
}

TEST(Summary, says_verdict_first_then_what_to_build_and_fill) {
    const Study study = fixture::study();
    const std::string text = summary(study, fixture::result(study), "out", {"result.json"});
    EXPECT_EQ(text.find("Target met"), 0u);
    for (const char* words : {"tolerance 0.040", "P5   x    3.200   y    1.223", "SS17-4PH", "IN718", "noise",
                              "1 map strip and 2 full spreads", "result.json"})
        EXPECT_THAT(text, HasSubstr(words));
    EXPECT_THAT(text, Not(HasSubstr("nan")));
    EXPECT_THAT(text, Not(HasSubstr("\033")));
    EXPECT_THAT(summary(study, fixture::result(study), "", {}, TerminalColour::ansi),
                HasSubstr("\033[1;32mTarget met"));
}

}  // namespace
}  // namespace gradwright
