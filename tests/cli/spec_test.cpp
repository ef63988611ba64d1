// gradwright spec as a user calls it, on a folder as `design` leaves it: its files, exit codes, refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/run_record.h"
#include "reports/output_folder.h"
#include "reports/step_file.h"
#include "tests/cli/called_program.h"
#include "tests/reports/fixture.h"

namespace {

using namespace gradwright;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const std::string kLinear = std::string(GRADWRIGHT_SOURCE_DIR) + "/examples/01_linear_coupon.toml";

class SpecVerb : public CalledProgram {
  protected:
    /// What a design of the first example leaves in `work/out`; `points` replace the fixture's partition.
    void leave_design(Verdict verdict = Verdict::met, const std::vector<PlanPoint>& points = {}) const {
        const Study study = read_study(kLinear, {});
        StudyResult result = fixture::result(study);
        result.verdict = verdict;
        result.snapshots.clear();
        // along the dispenser, bent gently enough for a sheet of 0.3 mm
        result.design.partition.points =
            points.empty() ? std::vector<PlanPoint>{{0, 0.6e-3}, {1.6e-3, 0.8e-3}, {3.2e-3, 1.0e-3 + 2e-4}}
                           : points;
        write_outputs(study, result, out());
        cli::write_record(out(), cli::record_of(study, {}, "map", "", 0));
    }
    std::string out() const { return (folder_ / "work/out").string(); }
    std::filesystem::path spec() const { return folder_ / "work/out/spec"; }
    int built() const { return step_available() ? 0 : 7; }
};

TEST_F(SpecVerb, writes_every_file_and_its_json_is_the_file) {
    leave_design();
    const Outcome outcome = run({"spec", "out", "--json", "--quiet"});
    ASSERT_EQ(outcome.code, built()) << outcome.err;
    EXPECT_EQ(outcome.out, content(spec() / "spec.json"));
    const json object = json::parse(outcome.out);
    EXPECT_EQ(object["verdict"], "met");
    EXPECT_EQ(object["missing"].size(), step_available() ? 0u : 1u);
    if (!step_available()) {
        EXPECT_THAT(outcome.err, HasSubstr("partition.step was not written"));
    }
    EXPECT_TRUE(object["buildable"].get<bool>());
    for (const json& name : object["files"])
        EXPECT_TRUE(std::filesystem::exists(spec() / name.get<std::string>())) << name;
    for (const char* name : {"partition.stl", "flat_pattern.dxf", "drawing.pdf", "drawing.svg",
                             "fill_sheet.pdf", "fill_sheet.html", "manifest.sha256"})
        EXPECT_THAT(object["files"], testing::Contains(name));
    EXPECT_NEAR(object["fill"]["rise_per_layer_m"].get<double>(), 120e-6, 1e-12);
    // the bed's packing of the result, times the solid density
    EXPECT_NEAR(object["fill"]["B"]["bulk_density_kg_m3"].get<double>(), 0.56 * 8200, 1e-6);
}

TEST_F(SpecVerb, gives_the_same_manifest_when_called_again_and_refuses_without_force) {
    leave_design();
    ASSERT_EQ(run({"spec", "out", "--quiet"}).code, built());
    const std::string manifest = content(spec() / "manifest.sha256");
    const Outcome again = run({"spec", "out"});
    EXPECT_EQ(again.code, 2);
    EXPECT_THAT(again.err, HasSubstr("add --force"));
    ASSERT_EQ(run({"spec", "out", "--quiet", "--force"}).code, built());
    EXPECT_EQ(content(spec() / "manifest.sha256"), manifest);
    if (!step_available()) return;
    ASSERT_EQ(run({"spec", "out", "--quiet", "--force", "--ap242"}).code, 0);
    EXPECT_NE(content(spec() / "manifest.sha256"), manifest);
    EXPECT_NE(content(spec() / "partition.step").find("'AP242_MANAGED"), std::string::npos);
}

TEST_F(SpecVerb, marks_what_is_not_verified_and_ends_with_4_when_it_cannot_be_built) {
    leave_design(Verdict::undecided);
    const Outcome undecided = run({"spec", "out", "--quiet"});
    EXPECT_EQ(undecided.code, built());
    EXPECT_THAT(undecided.out, testing::StartsWith("NOT VERIFIED: verdict undecided\n"));
    // folded back within its own bend radius
    leave_design(Verdict::met,
                 {{0, 0.6e-3}, {1.6e-3, 0.8e-3}, {1.7e-3, 0.6e-3}, {1.8e-3, 0.8e-3}, {3.2e-3, 0.8e-3}});
    const Outcome folded = run({"spec", "out", "--quiet", "--force"});
    EXPECT_EQ(folded.code, step_available() ? 4 : 7);
    EXPECT_THAT(folded.out, HasSubstr("CANNOT BE BUILT AS DRAWN: bends"));
    EXPECT_TRUE(std::filesystem::exists(spec() / "drawing.pdf"));
}

TEST_F(SpecVerb, takes_measured_densities_and_another_sheet_but_no_other_study) {
    leave_design();
    const Outcome outcome =
        run({"spec", "out", "--json", "--quiet", "--set", "partition_build.thickness=\"0.4 mm\"", "--set",
             "partition_build.bulk_density={ A = \"4.1 g/cm3\", B = \"4.2 g/cm3\" }"});
    ASSERT_EQ(outcome.code, built()) << outcome.err;
    const json object = json::parse(outcome.out);
    EXPECT_EQ(object["make"]["thickness_m"], 0.4e-3);
    EXPECT_TRUE(object["fill"]["A"]["bulk_density_measured"].get<bool>());
    EXPECT_EQ(object["fill"]["A"]["bulk_density_kg_m3"], 4100);
    EXPECT_THAT(content(spec() / "fill_sheet.html"), Not(HasSubstr("MEASURE BEFORE USE")));
    const Outcome other = run({"spec", "out", "--force", "--set", "process.layer_thickness=\"50 um\""});
    EXPECT_EQ(other.code, 2);
    EXPECT_THAT(other.err, HasSubstr("only partition_build"));
    const Outcome bad = run({"spec", "out", "--force", "--set", "partition_build.clearance=\"30 um\"",
                             "--set", "partition_build.thickness=\"9 mm\""});
    EXPECT_EQ(bad.code, 3);
    EXPECT_THAT(bad.err, HasSubstr("2 problems"));
}

TEST_F(SpecVerb, says_what_is_missing_or_damaged) {
    EXPECT_EQ(run({"spec", "nowhere"}).code, 6);
    leave_design();
    std::ofstream(folder_ / "work/out/result.json") << "{ \"design\": ";
    EXPECT_EQ(run({"spec", "out"}).code, 3);
    std::filesystem::remove(folder_ / "work/out/result.json");
    const Outcome unfinished = run({"spec", "out"});
    EXPECT_EQ(unfinished.code, 6);
    EXPECT_THAT(unfinished.err, HasSubstr("not finished"));
    leave_design(Verdict::met, {{0, 3e-3}, {3.2e-3, 3e-3}});
    const Outcome outside = run({"spec", "out"});
    EXPECT_EQ(outside.code, 3);
    EXPECT_THAT(outside.err, HasSubstr("nothing to build"));
    EXPECT_FALSE(std::filesystem::exists(spec()));
}

TEST_F(SpecVerb, its_inputs_are_shown_by_check) {
    const Outcome outcome = run({"check", kLinear, "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::size_t count = 0;
    const json object = json::parse(outcome.out);
    for (const json& input : object["inputs"]) {
        if (!input["key"].get<std::string>().starts_with("partition_build.")) continue;
        ++count;
        EXPECT_FALSE(input["note"].get<std::string>().empty()) << input;
    }
    EXPECT_EQ(count, 21u);
}

}  // namespace
