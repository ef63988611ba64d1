#include "optimise/journal.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace gradwright {
namespace {

namespace fs = std::filesystem;

class JournalTest : public ::testing::Test {
  protected:
    void SetUp() override {
        char name[] = "/tmp/gradwright_journal_XXXXXX";
        folder_ = mkdtemp(name);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string folder_;
};

Evaluation example() {
    Evaluation e;
    e.design.family = Family::straight;
    e.design.partition.points = {{0, 1.25e-3}, {3.2e-3, 1.0 / 3.0 * 1e-3}};
    e.design.parameters = {{"angle_deg", -11.5}, {"offset_m", 1e-5}};
    e.design.fill_fraction = {1, 0.9};
    e.design.dosage_factor = 2.75;
    e.design.land = 3.2e-3;
    e.design.footprint_offset = -1e-4;
    e.fidelity = Fidelity::full;
    e.health.status = "ok";
    e.health.warnings = {"gap below d_max"};
    e.health.max_overlap_ratio = 0.025;
    e.health.deep_contact_share = 1.0 / 3;
    e.seed = 9007199254740991ULL;
    e.profile.y_m = {1e-4, 3e-4};
    e.profile.gi = {0.1, std::nan("")};
    e.profile.standard_error = {0.02, std::nan("")};
    e.misfit.norm = Norm::max;
    e.misfit.value = 0.1 + 1e-17;
    e.residuals = {0.5, -0.25};
    e.objective = 1.0 / 7.0;
    e.spreads = 1;
    e.state_hash = "00ff";
    e.map.gi = {0.25, std::nan("")};
    return e;
}

TEST_F(JournalTest, what_is_written_is_read_back_bit_for_bit_and_undefined_bins_stay_undefined) {
    Layer layer;
    layer.origin_x = {1.0 / 3.0 * 1e-3};
    layer.volume = {3.35e-14};
    layer.is_a = {1};
    layer.labelled = true;
    layer.packing_seed = 77;
    {
        Journal journal(folder_);
        EXPECT_EQ(journal.append(example(), {layer}), 1);
    }
    const auto entries = Journal::read(folder_);
    ASSERT_EQ(entries.size(), 1u);
    const Evaluation expected = example();
    const Evaluation& got = entries[0].evaluation;
    EXPECT_EQ(got.fidelity, Fidelity::full);
    EXPECT_EQ(got.misfit.norm, Norm::max);
    EXPECT_EQ(got.design.family, Family::straight);
    EXPECT_EQ(got.design.parameters, expected.design.parameters);
    EXPECT_EQ(got.design.fill_fraction, expected.design.fill_fraction);
    EXPECT_EQ(got.design.partition.points[1].y, expected.design.partition.points[1].y);
    EXPECT_EQ(got.seed, expected.seed);
    EXPECT_EQ(got.profile.gi[0], 0.1);
    EXPECT_TRUE(std::isnan(got.profile.gi[1]));
    EXPECT_TRUE(std::isnan(got.map.gi[1]));
    EXPECT_EQ(got.objective, expected.objective);
    EXPECT_EQ(got.residuals, expected.residuals);
    EXPECT_EQ(got.health.warnings, expected.health.warnings);
    EXPECT_EQ(got.health.max_overlap_ratio, expected.health.max_overlap_ratio);
    EXPECT_EQ(got.health.deep_contact_share, expected.health.deep_contact_share);
    ASSERT_EQ(entries[0].layers.size(), 1u);
    EXPECT_EQ(entries[0].layers[0].origin_x, layer.origin_x);
    EXPECT_EQ(entries[0].layers[0].is_a, layer.is_a);
    EXPECT_EQ(entries[0].layers[0].packing_seed, 77u);
}

TEST_F(JournalTest, an_entry_from_before_deep_contacts_were_counted_is_read_without_them) {
    Journal(folder_).append(example());
    const std::string file = folder_ + "/000001_full.json";
    nlohmann::json entry = nlohmann::json::parse(std::ifstream(file));
    entry["format"] = 3;
    entry["health"].erase("deep_contact_share");
    std::ofstream(file) << entry;
    const auto entries = Journal::read(folder_);
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_TRUE(std::isnan(entries[0].evaluation.health.deep_contact_share));
    EXPECT_EQ(entries[0].evaluation.health.max_overlap_ratio, 0.025);
}

TEST_F(JournalTest, numbers_go_on_after_a_restart_and_name_the_fidelity) {
    Evaluation e = example();
    e.fidelity = Fidelity::map;
    EXPECT_EQ(Journal(folder_).append(e), 1);
    EXPECT_EQ(Journal(folder_).append(example()), 2);
    EXPECT_TRUE(fs::exists(folder_ + "/000001_map.json"));
    EXPECT_TRUE(fs::exists(folder_ + "/000002_full.json"));
}

TEST_F(JournalTest, a_kill_while_writing_leaves_the_entries_before_it_readable) {
    Journal journal(folder_);
    journal.append(example());
    std::ofstream(folder_ + "/000002_full.json.part") << "{\"half\":";
    EXPECT_EQ(Journal::read(folder_).size(), 1u);
    EXPECT_EQ(Journal(folder_).append(example()), 2);
    EXPECT_EQ(Journal::read(folder_).size(), 2u);
}

TEST_F(JournalTest, a_damaged_entry_is_named) {
    Journal(folder_).append(example());
    fs::resize_file(folder_ + "/000001_full.json", 40);
    try {
        Journal::read(folder_);
        FAIL() << "accepted";
    } catch (const std::runtime_error& problem) {
        EXPECT_NE(std::string(problem.what()).find("000001_full.json"), std::string::npos);
    }
}

TEST_F(JournalTest, a_full_disk_is_told_and_leaves_no_half_entry) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    Journal journal(folder_);
    journal.append(example());
    fs::create_symlink("/dev/full", folder_ + "/000002_full.json.part");
    try {
        journal.append(example());
        FAIL() << "accepted";
    } catch (const std::runtime_error& problem) {
        EXPECT_NE(std::string(problem.what()).find("No space left"), std::string::npos) << problem.what();
    }
    EXPECT_EQ(Journal::read(folder_).size(), 1u);
    EXPECT_EQ(journal.append(example()), 2);  // space again: the number was not lost
}

TEST_F(JournalTest, a_folder_that_cannot_be_made_or_written_is_told) {
    std::ofstream(folder_ + "/file") << "x";
    EXPECT_THROW(Journal(folder_ + "/file/journal"), std::runtime_error);
    if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
    chmod(folder_.c_str(), 0500);
    EXPECT_THROW(Journal{folder_}, std::runtime_error);
    chmod(folder_.c_str(), 0700);
}

TEST_F(JournalTest, no_folder_means_no_journal) {
    EXPECT_EQ(Journal("").append(example()), 0);
}

}  // namespace
}  // namespace gradwright
