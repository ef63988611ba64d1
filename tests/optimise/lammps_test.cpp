// LAMMPS itself as the witness of single contacts: the same law, and a deck that says it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "optimise/lammps_pairs.h"

namespace gradwright {
namespace {

namespace fs = std::filesystem;

Scene scene_of_the_law() {
    Scene s;
    s.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
    s.powder[1].material = {"B", 8200, 195e9, 0.3, ""};
    s.wall = s.powder[0].material;
    return s;
}

class TwoBody : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "gradwright two body XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// Names of the cases, after every one has been held to the tolerance.
    std::vector<std::string> expect_agreement(const Scene& scene) const {
        const TwoBodyResult result = compare_two_body(scene, (folder_ / "two body").string());
        std::vector<std::string> names;
        for (const TwoBodyCase& one : result.cases) {
            EXPECT_LE(one.error, kTwoBodyTolerance) << one.name;
            EXPECT_GT(one.contacts, 0) << one.name;
            names.push_back(one.name);
        }
        EXPECT_LE(result.max_relative_error, kTwoBodyTolerance);
        return names;
    }
    fs::path folder_;
};

TEST_F(TwoBody, adhesive_pairs_and_walls_answer_alike_before_during_and_after_sliding) {
    EXPECT_EQ(expect_agreement(scene_of_the_law()).size(), 17u);
}

TEST_F(TwoBody, plain_pairs_with_little_restitution_and_unlike_stiffness_answer_alike) {
    Scene scene = scene_of_the_law();
    scene.interaction.work_of_adhesion = 0;
    scene.interaction.coefficient_of_restitution = 0.1;
    scene.powder[1].material.youngs_modulus = 70e9;
    scene.powder[1].material.poissons_ratio = 0.2;
    EXPECT_EQ(expect_agreement(scene).size(), 16u);
}

TEST_F(TwoBody, without_damping_and_friction_there_is_nothing_and_both_say_so) {
    Scene scene = scene_of_the_law();
    scene.interaction.coefficient_of_restitution = 1;
    scene.interaction.static_friction = 0;
    expect_agreement(scene);
}

TEST_F(TwoBody, a_deck_of_another_law_is_found_out) {
    // The forces that LAMMPS computes from our deck, held against a law whose restitution is another one:
    // what a wrong conversion of the damping would look like.
    const Scene scene = scene_of_the_law();
    Scene other = scene;
    other.interaction.coefficient_of_restitution = 0.52;
    const TwoBodyResult result = compare_two_body(scene, (folder_ / "two body").string(), &other);
    double elastic = 0, damping = 0;
    for (const TwoBodyCase& one : result.cases) {
        if (one.name == "pair, elastic normal force") elastic = one.error;
        if (one.name == "pair, damping normal force") damping = one.error;
    }
    EXPECT_LE(elastic, kTwoBodyTolerance);
    EXPECT_GT(damping, 0.01);
    EXPECT_GT(result.max_relative_error, 0.01);
}

}  // namespace
}  // namespace gradwright
