// The film's bytes; what it shows is looked at by tests/browser/check_film.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "reports/film.h"
#include "reports/webp_animation.h"
#include "tests/reports/fixture.h"

namespace gradwright {
namespace {

/// Chunks of a RIFF file at its top level: four letters and the bytes inside, by the container's definition.
std::vector<std::pair<std::string, std::string>> chunks(const std::string& file) {
    std::vector<std::pair<std::string, std::string>> out;
    for (std::size_t at = 12; at + 8 <= file.size();) {
        std::uint32_t size = 0;
        std::memcpy(&size, file.data() + at + 4, 4);
        out.emplace_back(file.substr(at, 4), file.substr(at + 8, size));
        at += 8 + size + size % 2;
    }
    return out;
}

TEST(WebpAnimation, shows_each_picture_for_its_time) {
    WebpAnimation film(16, 8, 90);
    const int times[] = {40, 250, 1000};
    for (int k = 0; k < 3; ++k) {
        const std::vector<std::uint8_t> pixels(16 * 8 * 4, static_cast<std::uint8_t>(90 * k));
        film.add(pixels.data(), 16 * 4, times[k]);
    }
    const std::string file = film.finish();
    EXPECT_EQ(file.substr(0, 4), "RIFF");
    EXPECT_EQ(file.substr(8, 4), "WEBP");
    std::vector<int> shown;
    for (const auto& [name, bytes] : chunks(file))
        if (name == "ANMF")  // x, y, width, height, duration: 24 bits each, little endian
            shown.push_back(static_cast<unsigned char>(bytes[12]) | static_cast<unsigned char>(bytes[13])
                                                                        << 8);
    EXPECT_THAT(shown, testing::ElementsAreArray(times));
}

TEST(WebpAnimation, without_a_picture_is_an_error) {
    EXPECT_THROW(WebpAnimation(16, 8, 90).finish(), std::runtime_error);
    EXPECT_THROW(WebpAnimation(0, 8, 90), std::runtime_error);
}

class Film : public testing::Test {
  protected:
    const Study study_ = fixture::study();
    const StudyResult result_ = fixture::result(study_);
    std::string film(std::span<const Snapshot> instants) const {
        return film_webp(study_.scene, result_.design.partition, instants);
    }
};

TEST_F(Film, has_the_same_bytes_each_time_and_a_few_of_them) {
    const std::string once = film(result_.snapshots);
    EXPECT_EQ(once, film(result_.snapshots));
    EXPECT_LT(once.size(), 4u << 20);
}

TEST_F(Film, has_a_picture_for_each_instant_and_the_floor_s_rise) {
    std::vector<Snapshot> instants = {result_.snapshots[0], result_.snapshots[0], result_.snapshots[1]};
    for (float& x : instants[1].x) x += 1e-3f;
    instants[1].blade_x = 1e-3;
    long pictures = 0;
    for (const auto& chunk : chunks(film(instants))) pictures += chunk.first == "ANMF";
    // filled, drawn out, ten of the rise, one of the sweep, the layer
    EXPECT_EQ(pictures, 1 + 1 + 10 + 1 + 1);
}

TEST_F(Film, of_one_instant_is_refused) {
    EXPECT_THROW(film({result_.snapshots.data(), 1}), std::invalid_argument);
}

}  // namespace
}  // namespace gradwright
