// Files of the output folder: HDF5 with units on everything, VTKHDF as its specification says, whole or not
// there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "reports/hdf5_file.h"
#include "reports/layers_json.h"
#include "reports/map_file.h"
#include "reports/output_folder.h"
#include "reports/particle_file.h"
#include "reports/results_file.h"
#include "reports/safe_write.h"
#include "tests/reports/fixture.h"

namespace gradwright {
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "gradwright_reports_XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    fs::path folder_;
};

struct DatasetFacts {
    bool units = false, long_name = false;
    std::vector<hsize_t> shape;
    int scales = 0;
    bool is_scale = false;
};

std::map<std::string, DatasetFacts> datasets(const std::string& file_name) {
    std::map<std::string, DatasetFacts> found;
    const H5Handle file(H5Fopen(file_name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open");
    H5Ovisit2(
        file, H5_INDEX_NAME, H5_ITER_NATIVE,
        [](hid_t root, const char* name, const H5O_info_t* info, void* out) -> herr_t {
            if (info->type != H5O_TYPE_DATASET) return 0;
            const H5Handle set(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose, "open dataset");
            DatasetFacts facts;
            facts.units = H5Aexists(set, "units") > 0;
            facts.long_name = H5Aexists(set, "long_name") > 0;
            const H5Handle space(H5Dget_space(set), H5Sclose, "shape");
            facts.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
            H5Sget_simple_extent_dims(space, facts.shape.data(), nullptr);
            for (unsigned d = 0; d < facts.shape.size(); ++d)
                facts.scales += std::max(0, H5DSget_num_scales(set, d));
            facts.is_scale = H5DSis_scale(set) > 0;
            (*static_cast<std::map<std::string, DatasetFacts>*>(out))[name] = facts;
            return 0;
        },
        &found, H5O_INFO_BASIC);
    return found;
}

TEST_F(Files, every_dataset_of_results_h5_carries_units_and_long_name) {
    const Study study = fixture::study();
    write_results_file(study, fixture::result(study), path("results.h5"));
    const auto found = datasets(path("results.h5"));
    EXPECT_GT(found.size(), 60u);
    for (const auto& [name, facts] : found) {
        EXPECT_TRUE(facts.units) << name;
        EXPECT_TRUE(facts.long_name) << name;
    }
    for (const char* name : {"config/verbatim", "config/resolved", "variables/name", "evaluations/profile",
                             "evaluations/x", "evaluations/status", "evaluations/seed", "evaluations/seconds",
                             "result/confirmed", "provenance/version"})
        EXPECT_TRUE(found.contains(name)) << name;
}

TEST_F(Files, bins_and_variables_are_dimension_scales) {
    const Study study = fixture::study();
    const StudyResult result = fixture::result(study);
    write_results_file(study, result, path("results.h5"));
    const auto found = datasets(path("results.h5"));
    EXPECT_TRUE(found.at("bins/y_m").is_scale);
    EXPECT_TRUE(found.at("variables/name").is_scale);
    EXPECT_EQ(found.at("evaluations/profile").scales, 1);
    EXPECT_EQ(found.at("evaluations/x").scales, 1);
    // kinematic, straight, predicted and one row per confirmation
    EXPECT_EQ(found.at("evaluations/profile").shape[0], 3 + result.confirmations.size());
    EXPECT_EQ(found.at("evaluations/profile").shape[1], static_cast<hsize_t>(study.bins.count));
}

std::vector<double> column(const std::string& file_name, const char* path, std::size_t size) {
    const H5Handle file(H5Fopen(file_name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open");
    std::vector<double> values(size);
    EXPECT_GE(H5LTread_dataset_double(file, path, values.data()), 0) << path;
    return values;
}

TEST_F(Files, layers_and_the_strips_of_an_extrapolation_have_rows_of_their_own) {
    Study study = fixture::study();
    StudyResult result = fixture::result(study);
    write_results_file(study, result, path("one.h5"));
    for (const auto& [name, facts] : datasets(path("one.h5")))
        EXPECT_FALSE(name.starts_with("layers/") || name.starts_with("extrapolated/")) << name;

    study.scene.layers = 2;
    for (Evaluation& confirmation : result.confirmations)
        for (const int number : {1, 2}) {
            LaidLayer layer;
            layer.number = number;
            layer.profile = confirmation.profile;
            for (double& gi : layer.profile.gi) gi *= 0.5 * number;
            layer.drift = confirmation.drift;
            layer.dosed_solid_volume = 1e-11 * number;
            confirmation.layers.push_back(layer);
        }
    ScaledHeap heap;
    for (const double length : {3.2e-3, 6.4e-3}) {
        HeapOrder strip;
        strip.dispenser_length = length;
        strip.share = std::vector<double>(39, length);
        strip.share_drift = std::vector<double>(39, -length);
        heap.strips.push_back(strip);
    }
    heap.profile_error = 0.06;
    heap.rests_on = {"dispenser length"};
    result.extrapolated = heap;
    write_results_file(study, result, path("two.h5"));
    const auto found = datasets(path("two.h5"));
    const auto bins = static_cast<hsize_t>(study.bins.count);
    EXPECT_EQ(found.at("layers/gi").shape, (std::vector<hsize_t>{2, bins}));
    EXPECT_EQ(found.at("layers/gi").scales, 1);
    EXPECT_EQ(found.at("extrapolated/share").shape, (std::vector<hsize_t>{2, 39}));
    for (const auto& [name, facts] : found) EXPECT_TRUE(facts.units && facts.long_name) << name;
    EXPECT_THAT(column(path("two.h5"), "/layers/judged", 2), testing::ElementsAre(0, 1));  // the last
    EXPECT_THAT(column(path("two.h5"), "/layers/dosed_solid", 2),
                testing::Pointwise(testing::DoubleNear(1e-20), {1e-11, 2e-11}));
    const std::vector<double> gi = column(path("two.h5"), "/layers/gi", 2 * bins);
    const std::vector<double> last = mean_layers(study, result).at(1).profile.gi;
    EXPECT_DOUBLE_EQ(gi[bins + 2], last[2]);
    EXPECT_DOUBLE_EQ(gi[2], 0.5 * last[2]);
    EXPECT_THAT(column(path("two.h5"), "/extrapolated/dispenser_length", 2),
                testing::ElementsAre(3.2e-3, 6.4e-3));
    EXPECT_EQ(column(path("two.h5"), "/extrapolated/share_drift", 78)[50], -6.4e-3);
    EXPECT_EQ(column(path("two.h5"), "/extrapolated/profile_error", 1)[0], 0.06);
}

TEST_F(Files, a_search_that_failed_still_gives_every_file) {
    const Study study = fixture::study();
    StudyResult result;
    result.termination = "failed";
    result.message = "jammed at the nip";
    const auto files = write_outputs(study, result, path("out"));
    for (const std::string& file : files) EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
    EXPECT_THAT(files, ::testing::Contains("report.html"));
}

TEST_F(Files, outputs_are_whole_listed_and_leave_nothing_aside) {
    const Study study = fixture::study();
    const auto files = write_outputs(study, fixture::result(study), path("out"));
    std::size_t on_disk = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
        EXPECT_THAT(files, ::testing::Contains(entry.path().filename().string()));
        ++on_disk;
    }
    EXPECT_EQ(on_disk, files.size());
    EXPECT_EQ(read_file(path("out/study.toml")), study.text);
}

TEST_F(Files, equal_results_give_equal_bytes) {
    const Study study = fixture::study();
    const StudyResult result = fixture::result(study);
    const auto files = write_outputs(study, result, path("one"));
    write_outputs(study, result, path("two"));
    for (const std::string& file : files)
        EXPECT_EQ(read_file(path("one/" + file)), read_file(path("two/" + file))) << file;
}

TEST_F(Files, particles_follow_the_vtkhdf_layout) {
    const Study study = fixture::study();
    const StudyResult result = fixture::result(study);
    const auto names = write_particle_series(result.snapshots, folder_.string());
    ASSERT_EQ(names.size(), result.snapshots.size() + 1);
    const H5Handle file(H5Fopen(path(names[0]).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open");
    const H5Handle group(H5Gopen2(file, "/VTKHDF", H5P_DEFAULT), H5Gclose, "open group");
    const H5Handle type(H5Aopen(group, "Type", H5P_DEFAULT), H5Aclose, "open Type");
    const H5Handle text(H5Aget_type(type), H5Tclose, "type of Type");
    EXPECT_GT(H5Tis_variable_str(text), -1);
    EXPECT_EQ(H5Tis_variable_str(text), 0);
    EXPECT_EQ(H5Tget_cset(text), H5T_CSET_ASCII);
    const hsize_t n = result.snapshots[0].x.size();
    const auto found = datasets(path(names[0]));
    EXPECT_EQ(found.at("VTKHDF/Points").shape, (std::vector<hsize_t>{n, 3}));
    EXPECT_EQ(found.at("VTKHDF/Offsets").shape, std::vector<hsize_t>{n + 1});
    EXPECT_EQ(found.at("VTKHDF/PointData/radius").shape, std::vector<hsize_t>{n});
    const auto series = nlohmann::json::parse(read_file(path(names.back())));
    EXPECT_EQ(series["files"].size(), result.snapshots.size());
    EXPECT_EQ(series["files"][1]["time"].get<double>(), result.snapshots[1].time);
}

TEST(MapFile, mean_map_weights_by_mass_and_keeps_holes) {
    const double nan = std::nan("");
    const GradationMap one{{0.1, 0.3}, {0.1}, {1.0, nan}, {3.0, 0.0}},
        two{{0.1, 0.3}, {0.1}, {0.0, nan}, {1.0, 0.0}};
    const GradationMap mean = mean_map({&one, &two});
    EXPECT_DOUBLE_EQ(mean.gi[0], (1.0 * 3 + 0.0 * 1) / (3 + 1));
    EXPECT_TRUE(std::isnan(mean.gi[1]));
    EXPECT_DOUBLE_EQ(mean.mass_kg[0], (3.0 + 1.0) / 2);
}

TEST_F(Files, an_unwritable_path_is_named_with_the_reason) {
    const std::string missing = path("not/there/results.h5");
    const Study study = fixture::study();
    for (const auto& write : std::vector<std::function<void()>>{
             [&] { write_file(missing, "x"); },
             [&] { write_results_file(study, fixture::result(study), missing); },
             [&] { write_particle_file({}, missing); }}) {
        try {
            write();
            FAIL() << "no exception";
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr(missing));
            EXPECT_THAT(error.what(), ::testing::HasSubstr("No such file or directory"));
        }
    }
    write_file(path("plain"), "a file, not a folder");
    EXPECT_THROW(write_outputs(study, fixture::result(study), path("plain/out")), std::runtime_error);
}

TEST_F(Files, a_writer_that_fails_leaves_the_old_file) {
    write_file(path("kept"), "old");
    EXPECT_THROW(write_aside(path("kept"),
                             [](const std::string& aside) {
                                 write_file(aside, "half");
                                 throw std::runtime_error("disk full");
                             }),
                 std::runtime_error);
    EXPECT_EQ(read_file(path("kept")), "old");
    EXPECT_FALSE(fs::exists(path("kept.part")));
}

TEST_F(Files, the_report_is_rebuilt_to_the_same_bytes) {
    const Study study = fixture::study();
    write_outputs(study, fixture::result(study), path("out"));
    const std::string before = read_file(path("out/report.html"));
    fs::remove(path("out/report.html"));
    EXPECT_EQ(read_file(rebuild_report(path("out"))), before);
    write_file(path("out/report_data.json"), "{\"format\": \"other\"}");
    EXPECT_THROW(rebuild_report(path("out")), std::runtime_error);
    write_file(path("out/report_data.json"), "{ cut");
    EXPECT_THROW(rebuild_report(path("out")), std::runtime_error);
}

}  // namespace
}  // namespace gradwright
