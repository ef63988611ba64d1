// The figures of a spread, on a made one: a heap that rolls like a wheel ahead of the blade, a layer whose GI
// is a known ramp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "dem/random.h"
#include "optimise/partition_family.h"
#include "reports/composition_json.h"
#include "reports/hdf5_file.h"
#include "reports/image_file.h"
#include "reports/result_json.h"
#include "reports/safe_write.h"
#include "reports/spread_figures.h"
#include "reports/svg_figure.h"
#include "tests/reports/fixture.h"

namespace gradwright {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

constexpr double kRoll = 400;  // angular velocity of the made heap [rad/s]

Study straight_study() {
    Study study = fixture::study("a <b> & c");
    study.scene.blade_speed = 0.1;
    study.scene.land = study.design_space.land.value = 0.5e-3;
    study.footprint = {0, 3.2e-3, 0, 1.6e-3};
    for (const int i : {0, 1}) {
        Material& material = study.scene.powder[i].material;
        material.composition = i == 0 ? std::vector<ElementShare>{{"Fe", 75}, {"Ni", 4}}
                                      : std::vector<ElementShare>{{"Ni", 53}, {"Fe", 19}};
    }
    return study;
}

Design straight_design(const Study& study) {
    Design design;
    design.family = Family::straight;
    design.partition = straight_partition(study.scene.dispenser_length, study.dispenser_width, 0.2, 0);
    design.land = study.scene.land;
    return design;
}

/// GI of the made layer: a line of half the unmixed slope through the middle.
double made_gi(double y, double extent) {
    return std::clamp(0.5 + 0.5 * (y - 0.8e-3) / extent, 0.0, 1.0);
}

SpreadResult made_spread(const Study& study, const Design& design) {
    Random random(3);
    SpreadResult spread;
    spread.health.status = "ok";
    Layer& layer = spread.layer;
    layer.labelled = true;
    layer.periodic = false;
    layer.width = study.dispenser_width;
    layer.platform_length = study.scene.platform_length;
    layer.gap = 140e-6;
    const double extent = study.scene.dispenser_length * std::tan(0.2);
    for (int n = 0; n < 40000; ++n) {
        const double y = layer.width * random.uniform();
        layer.deposit_x.push_back(layer.platform_length * random.uniform());
        layer.deposit_y.push_back(y);
        layer.volume.push_back(1e-14 * (0.5 + random.uniform()));
        layer.is_a.push_back(random.uniform() < made_gi(y, extent));
        for (auto* v : {&layer.origin_x, &layer.origin_y, &layer.origin_z, &layer.deposit_z, &layer.radius})
            v->push_back(0);
    }
    const double platform = study.scene.dispenser_length + design.land;
    for (int k = 0; k < 24; ++k) {
        Snapshot shot;
        shot.time = 0.003 * k;
        shot.blade_x = k / 23.0 * (platform + study.scene.platform_length);
        for (int n = 0; n < 3000; ++n) {
            // a half disc of radius 0.4 mm; rolls about a point of the edge's plane
            const double r = 0.4e-3 * std::sqrt(random.uniform()), turn = std::numbers::pi * random.uniform();
            const double x = 0.4e-3 + r * std::cos(turn), z = r * std::sin(turn),
                         y = 1.6e-3 * random.uniform();
            shot.x.push_back(static_cast<float>(shot.blade_x + x));
            shot.y.push_back(static_cast<float>(y));
            shot.z.push_back(static_cast<float>(z));
            shot.radius.push_back(static_cast<float>(10e-6 + 20e-6 * random.uniform()));
            shot.is_a.push_back(random.uniform() < made_gi(y, extent));
            shot.vx.push_back(static_cast<float>(0.1 + kRoll * z));
            shot.vy.push_back(0);
            shot.vz.push_back(static_cast<float>(-kRoll * (x - 0.4e-3)));
        }
        spread.snapshots.push_back(shot);
    }
    return spread;
}

Evaluation made_evaluation(const Study& study, const Design& design, const SpreadResult& spread) {
    Evaluation evaluation = fixture::evaluation(study, design, Fidelity::full, 1);
    evaluation.profile =
        plain_profile(spread.layer, carried_labels(spread.layer), study.footprint, study.bins, 1);
    return evaluation;
}

const CompositionRequest kMelt{MeltPool{100e-6, 0.3e-3, 40e-6}};

TEST(SpreadFigures, the_line_the_rotation_and_the_mixing_of_a_made_spread_are_found) {
    const Study study = straight_study();
    const Design design = straight_design(study);
    const SpreadFigures figures = spread_figures(study, design, made_spread(study, design), kMelt);
    const double extent = 3.2e-3 * std::tan(0.2);
    EXPECT_NEAR(figures.y_high - figures.y_low, extent, 1e-9);
    EXPECT_NEAR(figures.unmixed_slope, 1 / extent, 1e-3 / extent);
    ASSERT_EQ(figures.fits.size(), 3u);
    const LinearFit& line = figures.fits[0].line;
    EXPECT_NEAR(line.slope, 0.5 / extent, 3 * line.slope_standard_error);
    EXPECT_LT(line.slope_standard_error, 0.05 / extent);
    EXPECT_GT(line.r_squared, 0.95);
    // melting leaves the slope of a ramp that goes on beyond the window
    EXPECT_NEAR(figures.fits[2].line.slope, figures.fits[1].line.slope, 0.1 * figures.fits[1].line.slope);
    // rigid rotation: vorticity -2 w, one turn in 2 pi U / w; 1e-3 leaves room for positions kept as floats
    EXPECT_NEAR(figures.rotation.vorticity, -2 * kRoll, 1e-3 * kRoll);
    const double circumference = 2 * std::numbers::pi * 0.1 / kRoll;
    EXPECT_NEAR(figures.rotation.turn_length(0.1), circumference, 1e-3 * circumference);
    // labels drawn by y alone: mixed within slices, not over the whole heap
    ASSERT_FALSE(figures.mixing.empty());
    for (const HeapMixing& row : figures.mixing) {
        EXPECT_NEAR(row.lacey_in_slices, 1, 0.15);
        EXPECT_LT(row.lacey, row.lacey_in_slices);
    }
    EXPECT_EQ(figures.shown.size(), 4u);
}

/// Every tag closes in order; text holds no bare & or <. A linear scan: std::regex overflows its stack on
/// long path data.
void expect_well_formed(const std::string& xml) {
    std::vector<std::string> open;
    for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
        const std::size_t end = xml.find('>', at);
        ASSERT_NE(end, std::string::npos);
        const std::string tag = xml.substr(at + 1, end - at - 1);
        ASSERT_EQ(tag.find('<'), std::string::npos) << tag.substr(0, 80);
        if (tag[0] == '?') continue;
        const std::string name =
            tag.substr(tag[0] == '/' ? 1 : 0, tag.find_first_of(" /", 1) - (tag[0] == '/' ? 1 : 0));
        if (tag[0] == '/') {
            ASSERT_FALSE(open.empty());
            ASSERT_EQ(open.back(), tag.substr(1));
            open.pop_back();
        } else if (tag.back() != '/') {
            open.push_back(name);
        }
    }
    EXPECT_TRUE(open.empty());
    for (std::size_t at = xml.find('&'); at != std::string::npos; at = xml.find('&', at + 1))
        EXPECT_LT(xml.find(';', at) - at, 6u);
}

TEST(SpreadFigures, every_file_is_written_whole_and_says_what_the_json_says) {
    const Study study = straight_study();
    const Design design = straight_design(study);
    const SpreadResult spread = made_spread(study, design);
    const Evaluation evaluation = made_evaluation(study, design, spread);
    std::string folder = (fs::temp_directory_path() / "gradwright_figures_XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    const SpreadFigures figures = spread_figures(study, design, spread, kMelt);
    const std::vector<std::string> files = write_figures(study, evaluation, spread, figures, folder);
    for (const char* name :
         {"gi_map.svg", "gi_map.vtkhdf", "gi_line.svg", "heap_velocity.svg", "heap_velocity.vtkhdf",
          "heap_mixing.svg", "composition.svg", "particles_0003.vtkhdf", "particles.vtkhdf.series"})
        EXPECT_THAT(files, Contains(name));
    for (const std::string& name : files) {
        EXPECT_TRUE(fs::exists(folder + "/" + name)) << name;
        if (name.ends_with(".svg")) {
            const std::string svg = read_file(folder + "/" + name);
            expect_well_formed(svg);
            EXPECT_EQ(svg.find("nan"), std::string::npos) << name;
            EXPECT_EQ(svg.find("inf"), std::string::npos) << name;
            EXPECT_LT(svg.size(), 600000u) << name;
        }
    }
    const nlohmann::json object = figures_json(study, figures, kMelt);
    EXPECT_EQ(object["line"]["fits"][0]["slope_per_m"].get<double>(), figures.fits[0].line.slope);
    EXPECT_EQ(object["mixing"]["rows"].size(), figures.mixing.size());
    EXPECT_EQ(object["velocity"]["vorticity_per_s"].get<double>(), figures.rotation.vorticity);
    EXPECT_EQ(object["composition"]["y_m"].size(), object["line"]["y_m"].size());
    EXPECT_THAT(figures_text(figures), HasSubstr("Lacey"));

    // VTKHDF ImageData: a slab of two planes across y, vectors with their components last
    const H5Handle file(H5Fopen((folder + "/heap_velocity.vtkhdf").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                        H5Fclose, "open");
    const H5Handle set(H5Dopen2(file, "/VTKHDF/PointData/velocity", H5P_DEFAULT), H5Dclose, "open velocity");
    const H5Handle space(H5Dget_space(set), H5Sclose, "shape");
    hsize_t shape[4] = {};
    ASSERT_EQ(H5Sget_simple_extent_ndims(space), 4);
    H5Sget_simple_extent_dims(space, shape, nullptr);
    EXPECT_EQ(shape[0], static_cast<hsize_t>(figures.field.rows));
    EXPECT_EQ(shape[1], 2u);
    EXPECT_EQ(shape[2], static_cast<hsize_t>(figures.field.columns));
    EXPECT_EQ(shape[3], 3u);
    fs::remove_all(folder);
}

TEST(SpreadFigures, a_spread_that_left_little_still_gives_what_there_is) {
    const Study study = straight_study();
    Design design = straight_design(study);
    SpreadResult empty;
    empty.layer.labelled = true;
    empty.layer.width = study.dispenser_width;
    empty.layer.platform_length = study.scene.platform_length;
    empty.layer.gap = 140e-6;
    empty.snapshots.resize(4);
    const SpreadFigures figures = spread_figures(study, design, empty, {});
    EXPECT_TRUE(figures.mixing.empty());
    EXPECT_EQ(figures.field.columns, 0);
    const nlohmann::json object = figures_json(study, figures, {});
    EXPECT_TRUE(object["velocity"]["circulation_m2_s"].is_null());
    EXPECT_TRUE(object["composition"].is_null());
    // a partition across the whole width: an extent, but no line through empty bins
    EXPECT_TRUE(object["line"]["fits"][0]["slope_per_m"].is_null());
    // a step: no line at all
    design.partition = straight_partition(study.scene.dispenser_length, study.dispenser_width, 0, 0);
    EXPECT_TRUE(spread_figures(study, design, made_spread(study, design), {}).fits.empty());
}

TEST(SvgFigure, ticks_are_round_and_cover_the_range) {
    EXPECT_EQ(ticks(0, 1, 5), (std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1}));
    EXPECT_EQ(ticks(-3, 7.2, 5), (std::vector<double>{-2.5, 0, 2.5, 5}));
    for (const double span : {1e-6, 0.037, 1.0, 990.0}) {
        const std::vector<double> marks = ticks(0.3 * span, 1.3 * span, 6);
        EXPECT_GE(marks.size(), 3u) << span;
        EXPECT_LE(marks.size(), 7u) << span;
    }
}

TEST(SvgFigure, colours_run_from_b_to_a) {
    EXPECT_EQ(gi_colour(0), "#e69f00");
    EXPECT_EQ(gi_colour(1), "#0072b2");
    EXPECT_EQ(gi_colour(7), gi_colour(1));
    EXPECT_NE(gi_colour(std::nan("")), gi_colour(0));
}

TEST(CompositionJson, has_every_promised_name_and_nulls_where_undefined) {
    const Study study = straight_study();
    Evaluation evaluation = fixture::evaluation(study, straight_design(study), Fidelity::map, 1);
    evaluation.profile.gi[2] = std::nan("");
    const nlohmann::json with = composition_json(study, evaluation, kMelt.pool),
                         without = composition_json(study, evaluation, {});
    for (const char* name : {"y_m", "wt_fe", "wt_ni", "mass_fraction_a"})
        EXPECT_EQ(with[name].size(), 8u) << name;
    for (const char* band : {"band_low", "band_high"})
        for (const char* name : {"wt_fe", "wt_ni"}) EXPECT_EQ(with[band][name].size(), 8u);
    EXPECT_TRUE(with["wt_fe"][2].is_null());
    EXPECT_TRUE(with["melt"]["wt_fe"][2].is_null());
    EXPECT_LE(with["band_low"]["wt_ni"][1].get<double>(), with["wt_ni"][1].get<double>());
    EXPECT_NEAR(with["melt"]["dilution"].get<double>(), 0.6, 1e-12);
    EXPECT_NEAR(with["melt"]["base_share"][1].get<double>(), 0.36, 1e-12);
    EXPECT_TRUE(without["melt"].is_null());
    EXPECT_EQ(with["alloys"]["A"]["wt"]["Fe"], 75);
    EXPECT_THAT(composition_text(study, evaluation, kMelt.pool), HasSubstr("melted"));
}

TEST(ImageFile, refuses_sizes_that_disagree) {
    EXPECT_THROW(write_image_file({}, "nowhere"), std::invalid_argument);
    ImageData image;
    image.points = {2, 2, 2};
    image.arrays = {{"gi", 3, std::vector<double>(8)}};
    EXPECT_THROW(write_image_file(image, "nowhere"), std::invalid_argument);
}

}  // namespace
}  // namespace gradwright
