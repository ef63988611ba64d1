#include "dem/spread_file.h"

#include <cstring>

#include "dem/cache_file.h"

namespace gradwright {
namespace {

/// Both ways by one list of members, so that none is written and not read.
struct Put {
    std::string bytes;
    bool ok = true;
    template <class T>
    void all(const std::vector<T>& values) {
        put(bytes, values);
    }
    template <class T>
    void one(const T& value) {
        put(bytes, std::vector<T>{value});
    }
    void one(const bool& value) { one(static_cast<std::uint8_t>(value)); }
    void text(const std::string& text) { put(bytes, std::vector<char>(text.begin(), text.end())); }
    template <class T>
    bool more(const std::vector<T>& list) const {
        return !list.empty();
    }
    template <class T>
    void count(const std::vector<T>& list) {
        one(static_cast<std::uint64_t>(list.size()));
    }
};
struct Take {
    const std::string& bytes;
    std::size_t at = 0;
    bool ok = true;
    template <class T>
    void all(std::vector<T>& values) {
        ok = ok && take(bytes, at, values);
    }
    template <class T>
    void one(T& value) {
        std::vector<T> values;
        all(values);
        ok = ok && values.size() == 1;
        if (ok) value = values[0];
    }
    void one(bool& value) {
        std::uint8_t number = 0;
        one(number);
        value = number != 0;
    }
    void text(std::string& text) {
        std::vector<char> letters;
        all(letters);
        text.assign(letters.begin(), letters.end());
    }
    template <class T>
    bool more(const std::vector<T>&) const {
        return at < bytes.size();
    }
    template <class T>
    void count(std::vector<T>& list) {
        std::uint64_t size = 0;
        one(size);
        // every member of the list takes at least its own length
        ok = ok && size <= (bytes.size() - at) / sizeof(std::uint64_t);
        list.resize(ok ? size : 0);
    }
};

const auto layer_members = [](auto& io, auto& l) {
    for (auto* v : {&l.origin_x, &l.origin_y, &l.origin_z, &l.deposit_x, &l.deposit_y, &l.deposit_z,
                    &l.volume, &l.radius})
        io.all(*v);
    io.all(l.is_a);
    io.one(l.labelled);
    io.one(l.periodic);
    for (auto* v : {&l.width, &l.dispenser_length, &l.platform_length, &l.gap, &l.dosed_solid_volume,
                    &l.overflow_solid_volume, &l.overflow_solid_volume_a, &l.bed_packing})
        io.one(*v);
    io.one(l.packing_seed);
};

const auto members = [](auto& io, auto& r) {
    auto& h = r.health;
    io.text(h.status);
    io.text(h.reason);
    io.one(h.max_overlap_ratio);
    io.one(h.deep_contact_share);
    io.count(h.warnings);
    for (auto& warning : h.warnings) io.text(warning);
    layer_members(io, r.layer);
    auto& b = r.bed;
    for (auto* v : {&b.packing_fraction, &b.mean_coordination, &b.max_overlap_ratio, &b.speed_number,
                    &b.carried_weight_ratio, &b.seconds, &b.seconds_cold})
        io.one(*v);
    io.one(b.steps);
    io.one(b.from_cache);
    io.all(b.made_d10_d50_d90);
    io.count(r.snapshots);
    for (auto& shot : r.snapshots) {
        io.one(shot.time);
        io.one(shot.blade_x);
        for (auto* v : {&shot.x, &shot.y, &shot.z, &shot.radius, &shot.vx, &shot.vy, &shot.vz}) io.all(*v);
        io.all(shot.is_a);
    }
    for (auto* v : {&r.grains, &r.fixed_grains, &r.pinched_grains, &r.steps}) io.one(*v);
    for (auto* v :
         {&r.grain_steps, &r.all_grain_steps, &r.time_step, &r.bond_number, &r.seconds, &r.seconds_cold})
        io.one(*v);
    io.text(r.state_hash);
    // of several passes or over powder only, so that the files of all others stay what they were
    if (!io.more(r.passes)) return;
    io.count(r.passes);
    for (auto& pass : r.passes)
        for (auto* v : {&pass.raised_solid_volume, &pass.carried_off_solid_volume, &pass.proud_solid_volume})
            io.one(*v);
    io.count(r.earlier);
    for (auto& layer : r.earlier) layer_members(io, layer);
};

}  // namespace

std::string spread_bytes(const SpreadResult& spread) {
    Put io;
    members(io, spread);
    return io.bytes;
}

bool read_spread(const std::string& bytes, SpreadResult& to) {
    Take io{bytes};
    members(io, to);
    return io.ok && io.at == bytes.size();
}

}  // namespace gradwright
