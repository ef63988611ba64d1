#include "optimise/kinematic_evaluator.h"

#include <chrono>
#include <cmath>
#include <numbers>

#include "optimise/chamber_fill.h"

namespace gradwright {

double lateral_spread(const Study& study, const Design& design) {
    constexpr double kDiffusion = 0.05;
    const double repose = std::numbers::pi / 6;  // 30 deg, physics.md 1.2
    const Scene scene = scene_of(study, design, false, study.seed);
    const double d50 = 0.5 * (scene.powder[0].size.d50 + scene.powder[1].size.d50);
    const Footprint footprint = footprint_of(study, design);
    // from the dispenser's middle to the footprint's
    const double travel =
        0.5 * scene.dispenser_length + scene.land + 0.5 * (footprint.x_low + footprint.x_high);
    // The whole dose as a wedge against the blade: h L_d = H^2 / (2 tan(repose)).
    const double heap = std::sqrt(2 * std::tan(repose) * scene.dose_height * scene.dispenser_length);
    return heap > 0 ? d50 * std::sqrt(2 * kDiffusion * travel / heap) : 0;
}

KinematicEvaluator::KinematicEvaluator(const Study& study, std::optional<double> capture_fraction)
    : study_(study), capture_fraction_(capture_fraction) {}

Evaluation KinematicEvaluator::evaluate(const Design& design, std::uint64_t seed) {
    const auto begun = std::chrono::steady_clock::now();
    Evaluation evaluation;
    evaluation.design = design;
    evaluation.fidelity = Fidelity::kinematic;
    evaluation.seed = seed;
    evaluation.health.status = "ok";

    constexpr int kPerBin = 20, kAlong = 400;  // 10 um x 8 um cells on the coupon: under half a grain
    constexpr double kReach = 4;               // sigmas of blur taken
    const BinGrid& bins = study_.bins;
    const double step = bins.width / kPerBin;
    const double sigma = lateral_spread(study_, design);
    const int extra = int(std::ceil(kReach * sigma / step));
    const int inside = bins.count * kPerBin;
    std::vector<double> share(inside + 2 * extra), kernel(2 * extra + 1);
    const double length = study_.scene.dispenser_length;
    for (std::size_t j = 0; j < share.size(); ++j) {
        const double y = (double(j) - extra + 0.5) * step;
        int above = 0;
        for (int i = 0; i < kAlong; ++i) above += design.partition.on_side_a((i + 0.5) * length / kAlong, y);
        share[j] = double(above) / kAlong;
    }
    double kernel_sum = 0;
    for (int k = -extra; k <= extra; ++k) {
        const double z = sigma > 0 ? k * step / sigma : 0;
        kernel_sum += kernel[k + extra] = std::exp(-0.5 * z * z);
    }
    GradationProfile& profile = evaluation.profile;
    for (int bin = 0; bin < bins.count; ++bin) {
        double sum = 0;
        for (int s = 0; s < kPerBin; ++s)
            for (std::size_t k = 0; k < kernel.size(); ++k) sum += kernel[k] * share[bin * kPerBin + s + k];
        profile.y_m.push_back(bins.centre(bin));
        profile.gi.push_back(sum / (kernel_sum * kPerBin));
    }
    profile.standard_error.assign(bins.count, 0.0);
    profile.volume.assign(bins.count, 0.0);
    profile.n_eff.assign(bins.count, 0.0);
    // Fully mixed means the same everywhere along x.
    evaluation.drift.difference.assign(bins.count, 0.0);
    evaluation.drift.standard_error.assign(bins.count, 0.0);

    chamber_fill(study_, design).apply(profile, evaluation.drift);
    if (study_.target.is_field()) {
        const Footprint footprint = footprint_of(study_, design);
        GradationField& field = evaluation.field;
        field.y_m = profile.y_m;
        for (int column = 0; column < study_.columns; ++column) {
            field.x_m.push_back(footprint.x_low +
                                (column + 0.5) / study_.columns * (footprint.x_high - footprint.x_low));
            const auto add = [](std::vector<double>& cells, const std::vector<double>& bins) {
                cells.insert(cells.end(), bins.begin(), bins.end());
            };
            add(field.cells.y_m, profile.y_m);
            add(field.cells.gi, profile.gi);
            add(field.cells.standard_error, profile.standard_error);
            add(field.cells.volume, profile.volume);
            add(field.cells.n_eff, profile.n_eff);
        }
    }
    if (capture_fraction_) evaluation.capture_fraction = *capture_fraction_;
    evaluation.kinematic_error_bound = capture_fraction_ ? 1 - *capture_fraction_ : 1;
    judge(study_, evaluation);
    evaluation.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    evaluation.seconds_cold = evaluation.seconds;
    return evaluation;
}

}  // namespace gradwright
