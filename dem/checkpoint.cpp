// Save and restore of a run at any step: everything the next step reads, bit for bit, lists and order
// included (the order of grains decides the order of sums). Restored, a run goes on with the bits it would
// have had.
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "dem/kernel.h"

namespace gradwright {
namespace {

constexpr char kMark[] = "gradwright run 4\n";

/// Both ways by one list of members, so that none is saved and not restored.
struct Saver {
    std::string bytes;
    template <class T>
    void value(T& v) {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
    }
    template <class T, class A>
    void array(std::vector<T, A>& v) {
        std::uint64_t count = v.size();
        value(count);
        bytes.append(reinterpret_cast<const char*>(v.data()), count * sizeof(T));
    }
};

struct Restorer {
    const std::string& bytes;
    std::size_t at = 0;
    template <class T>
    void value(T& v) {
        static_assert(std::is_trivially_copyable_v<T>);
        need(sizeof v);
        std::memcpy(&v, bytes.data() + at, sizeof v);
        at += sizeof v;
    }
    template <class T, class A>
    void array(std::vector<T, A>& v) {
        std::uint64_t count = 0;
        value(count);
        if (count > bytes.size() / sizeof(T)) need(bytes.size() + 1);
        need(count * sizeof(T));
        v.resize(count);
        if (count > 0) std::memcpy(static_cast<void*>(v.data()), bytes.data() + at, count * sizeof(T));
        at += count * sizeof(T);
    }
    void need(std::size_t more) const {
        if (more > bytes.size() - at)
            throw std::invalid_argument("Engine::restore: the saved run is cut short");
    }
};

}  // namespace

template <class T>
template <class Archive>
void Engine::KernelOf<T>::archive(Archive& to) {
    to.array(motion);
    to.array(tiles);
    to.array(rolls);
    to.array(walls);
    to.array(wall_first);
    to.array(blocks);
    to.array(force_on_fixed_by_block);
    to.value(active_slots);
    to.value(parked_slots);
    to.value(wall_slots);
}

template <class Archive>
void Engine::archive(Archive& to) {
    state_.for_each_array([&to](auto& array) { to.array(array); });
    to.array(body_removed_);
    to.value(largest_radius_);
    to.value(smallest_radius_);
    to.value(skin_);
    to.value(near_skin_);
    to.value(time_);
    to.value(body_time_);
    to.value(bodies_move_);
    to.value(steps_);
    to.value(late_steps_);
    to.value(grain_steps_);
    to.value(frame_);
    to.value(frame_shift_);
    to.value(typical_speed_);
    to.value(body_reach_);
    to.value(wide_body_reach_);
    to.value(still_rate_);
    for (auto* array : {&reach_, &wide_reach_, &inverse_reach2_}) to.array(*array);
    to.value(body_way_);
    to.value(travel_);
    to.value(steps_since_near_);
    to.value(lists_valid_);
    to.value(first_kick_);
    to.value(overlaps_seen_);
    to.value(built_from_);
    to.value(built_error_);
    to.array(built_);
    for (auto* array : {&candidate_first_, &candidate_, &candidate_slot_, &new_index_, &awake_})
        to.array(*array);
    to.array(reachable_);
    to.array(wakeable_);
    to.value(next_id_);
    if (options_.precision == Precision::double_law)
        static_cast<KernelOf<double>&>(*kernel_).archive(to);
    else
        static_cast<KernelOf<WideFloat>&>(*kernel_).archive(to);
}

std::string Engine::options_text() const {
    const auto& o = options_;
    const auto& i = o.interaction;
    std::string text;
    const auto add = [&text](double v) { text.append(reinterpret_cast<const char*>(&v), sizeof v); };
    for (const Material& m : o.materials)
        for (const double v : {m.density, m.youngs_modulus, m.poissons_ratio}) add(v);
    for (const double v : {i.coefficient_of_restitution, i.static_friction, i.rolling_friction,
                           i.work_of_adhesion, i.rolling_regularisation_speed, o.softening, o.time_step,
                           o.gravity[0], o.gravity[1], o.gravity[2], o.period_x, o.period_y, o.period_z,
                           o.sleep_speed, o.sleep_time, o.wake_speed, o.skin, o.near_skin, o.remove_beyond_x})
        add(v);
    for (const int v : {static_cast<int>(i.rolling_model), static_cast<int>(i.friction_cap),
                        static_cast<int>(o.adhesion_scaling), static_cast<int>(o.precision), int(o.sleep),
                        static_cast<int>(bodies_.size())})
        add(v);
    for (const Body& b : bodies_)
        for (const double v : {double(static_cast<int>(b.kind)), double(b.axis), b.sign, b.offset, b.x0, b.x1,
                               b.z0, b.z1, b.rounding, b.half_thickness, b.speed_x, b.speed_z,
                               double(b.material), double(b.frictionless), double(b.adhesive), b.yield_ratio})
            add(v);
    return text_hash(text);
}

std::string Engine::save() {
    if (options_.energy_account) throw std::logic_error("Engine::save: not with the energy account");
    Saver saver;
    archive(saver);
    return kMark + options_text() + text_hash(saver.bytes) + saver.bytes;
}

void Engine::restore(const std::string& saved) {
    const std::string mark = kMark, options = options_text();
    if (saved.compare(0, mark.size(), mark) != 0 || saved.size() < mark.size() + 2 * options.size())
        throw std::invalid_argument("Engine::restore: this is no saved run");
    if (saved.compare(mark.size(), options.size(), options) != 0)
        throw std::invalid_argument(
            "Engine::restore: saved with other options or bodies; build the engine as it was, then restore");
    const std::string bytes = saved.substr(mark.size() + 2 * options.size());
    if (saved.compare(mark.size() + options.size(), options.size(), text_hash(bytes)) != 0)
        throw std::invalid_argument("Engine::restore: the saved run is damaged");
    Restorer restorer{bytes};
    archive(restorer);
    kernel_->restored();
    failed_.clear();
}

}  // namespace gradwright
