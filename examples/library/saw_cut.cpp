// What does one straight saw cut lay? The study's heap is spread once, without labels, on its narrow strip;
// the origins of the laid grains then answer for the cut, and would for any other, in milliseconds.
//   saw_cut STUDY.toml ANGLE_DEG        prints y, the GI of the strip and that of the kinematic picture
#include <gradwright/dem/gradation.h>
#include <gradwright/dem/spread.h>
#include <gradwright/optimise/design_run.h>
#include <gradwright/optimise/study_file.h>

#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

int main(int argc, char** argv) {
    if (argc != 3) return std::fprintf(stderr, "usage: saw_cut STUDY.toml ANGLE_DEG\n"), 2;
    setenv("GRADWRIGHT_DATA", DATA_FOLDER, 0);  // where find_package found the shipped machines and materials
    try {
        using namespace gradwright;
        const Study study = read_study(argv[1]);
        Design cut = start_design(study);
        cut.family = Family::straight;
        cut.partition = straight_partition(study.scene.dispenser_length, study.dispenser_width,
                                           std::stod(argv[2]) * std::numbers::pi / 180, 0);

        const Scene strip = scene_of(study, cut, true, study.seed);
        const SpreadResult spread = run_spread(strip, nullptr, {});
        if (!spread.health.ok())
            return std::fprintf(stderr, "the spread failed: %s\n", spread.health.reason.c_str()), 5;
        const GradationProfile laid =
            homogeneous_profile({&spread.layer, 1}, cut.partition, study.footprint.x_low,
                                study.footprint.x_high, study.bins, {.resamples = 200});
        const Evaluation picture = evaluate_once(study, cut, Fidelity::kinematic, study.seed, {});

        std::printf("%ld grains, %ld steps\n y mm     GI  +-   kinematic\n", spread.grains, spread.steps);
        for (std::size_t i = 0; i < laid.gi.size(); ++i)
            std::printf("%.3f  %.3f %.3f  %.3f\n", 1e3 * laid.y_m[i], laid.gi[i], laid.standard_error[i],
                        picture.profile.gi[i]);
    } catch (const gradwright::InputError& error) {
        return std::fputs(report_of(error).c_str(), stderr), 3;
    }
}
