#include "dem/next_pass.h"

#include <algorithm>

#include "dem/bulk.h"
#include "dem/substrate.h"

namespace gradwright {

void come_to_rest(const Scene& scene, Engine& engine, std::size_t grains) {
    const double quiet = quiet_energy(scene, grains);
    for (int k = 0; k < 40 && engine.failed().empty() && engine.kinetic_energy() > quiet; ++k)
        engine.advance(500);
}

Pass next_pass(const Scene& scene, const Stage& stage, const Pass& before, Engine& engine, int first_mobile) {
    const double platform = platform_start(scene), end = platform_end(scene);
    const bool melts = scene.substrate == Substrate::fused;
    Pass pass;
    pass.number = before.number + 1;
    pass.floor_rise = before.floor_rise + scene.dose_height;
    pass.gap = melts ? scene.gap : scene.layer_thickness;
    // Whatever the surface that the blade left: one rise brings that much solid through any plane of the bed.
    pass.dosed_solid_volume =
        scene.dose_height * scene.dispenser_length * scene.width * stage.bed.facts.packing_fraction;

    engine.start_bodies();  // where they began,
    engine.stop_bodies();   // and at rest there
    engine.move_body(stage.blade, stage.bodies[static_cast<std::size_t>(stage.blade)], false);
    engine.remove_grains([&](std::size_t i) { return engine.state().x[i] >= (melts ? platform : end); });

    State& s = engine.state();
    const std::vector<GrainSpec> fresh = melts ? fused_surface(scene, pass.number) : std::vector<GrainSpec>{};
    for (std::size_t i = 0; i < s.size(); ++i) {
        // what lies on a land's edge would sink into the land: it goes up too, and falls back
        const bool on_edge = !melts && !s.fixed[i] && s.x[i] >= platform &&
                             std::min(s.x[i] - platform, end - s.x[i]) < 0.95 * s.radius[i];
        if (s.x[i] < platform || on_edge)
            s.z[i] += scene.dose_height;
        else if (melts)
            s.z[i] = fresh.at(static_cast<std::size_t>(s.id[i]) - stage.platform_floor).z;
        else
            s.z[i] -= scene.sink();
    }
    if (stage.plate >= 0) {
        Body plate = engine.bodies()[static_cast<std::size_t>(stage.plate)];
        plate.z1 -= scene.sink();
        engine.move_body(stage.plate, plate, true);
    }
    engine.wake_all();  // and have all lists made anew
    engine.advance(500);
    come_to_rest(scene, engine, stage.grains());

    pass.stand.assign(stage.grains(), Stand::gone);
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s.fixed[i] || s.x[i] >= end) continue;
        const bool ahead = s.x[i] < platform || melts;  // on metal only what rolled there while it settled
        pass.stand[static_cast<std::size_t>(s.id[i] - first_mobile)] =
            ahead ? Stand::ahead : Stand::on_platform;
        if (ahead && s.z[i] > 0) pass.raised_solid_volume += sphere_volume(s.radius[i]);
    }
    return pass;
}

}  // namespace gradwright
