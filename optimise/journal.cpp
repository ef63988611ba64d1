#include "optimise/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace gradwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kFormat = 4;
constexpr const char* kAside = ".part";

json number(double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
}
double number(const json& value) {
    return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}
json numbers(const std::vector<double>& values) {
    json list = json::array();
    for (const double value : values) list.push_back(number(value));
    return list;
}
std::vector<double> numbers(const json& list) {
    std::vector<double> values;
    for (const json& value : list) values.push_back(number(value));
    return values;
}

// One list of fields serves writing and reading, so that the two cannot drift apart.
struct Writer {
    json& at;
    void operator()(const char* key, const double& value) { at[key] = number(value); }
    void operator()(const char* key, const std::vector<double>& value) { at[key] = numbers(value); }
    template <class T>
    void operator()(const char* key, const T& value) {
        at[key] = value;
    }
    template <class Object, class Fields>
    void object(const char* key, Object& value, const Fields& fields) {
        json inner = json::object();
        fields(Writer{inner}, value);
        at[key] = inner;
    }
};
struct Reader {
    const json& at;
    void operator()(const char* key, double& value) { value = number(at.at(key)); }
    void operator()(const char* key, std::vector<double>& value) { value = numbers(at.at(key)); }
    template <class T>
    void operator()(const char* key, T& value) {
        at.at(key).get_to(value);
    }
    template <class Object, class Fields>
    void object(const char* key, Object& value, const Fields& fields) {
        fields(Reader{at.at(key)}, value);
    }
};

const auto profile_fields = [](auto io, auto& profile) {
    io("y_m", profile.y_m);
    io("gi", profile.gi);
    io("standard_error", profile.standard_error);
    io("volume_m3", profile.volume);
    io("n_eff", profile.n_eff);
    io("degrees", profile.degrees);
};
const auto field_fields = [](auto io, auto& field) {
    io("x_m", field.x_m);
    io("y_m", field.y_m);
    io.object("cells", field.cells, profile_fields);
};
const auto drift_fields = [](auto io, auto& drift) {
    io("difference", drift.difference);
    io("standard_error", drift.standard_error);
    io("value", drift.value);
    io("noise_floor", drift.noise_floor);
    io("degrees", drift.degrees);
};
const auto map_fields = [](auto io, auto& map) {
    io("x_m", map.x_m);
    io("y_m", map.y_m);
    io("gi", map.gi);
    io("mass_kg", map.mass_kg);
};
const auto misfit_fields = [](auto io, auto& misfit) {
    io("value", misfit.value);
    io("debiased", misfit.debiased);
    io("interval_low", misfit.interval_low);
    io("interval_high", misfit.interval_high);
    io("noise_floor", misfit.noise_floor);
    io("tolerance", misfit.tolerance);
};
const auto health_fields = [](auto io, auto& health) {
    io("status", health.status);
    io("reason", health.reason);
    io("max_overlap_ratio", health.max_overlap_ratio);
    io("deep_contact_share", health.deep_contact_share);
    io("warnings", health.warnings);
};
const auto design_fields = [](auto io, auto& design) {
    io("fill_fraction", design.fill_fraction);
    io("dosage_factor", design.dosage_factor);
    io("dose", design.dose);
    io("land_m", design.land);
    io("blade_speed_m_s", design.blade_speed);
    io("layer_thickness_m", design.layer_thickness);
    io("footprint_offset_m", design.footprint_offset);
    io("parameters", design.parameters);
};
const auto layer_fields = [](auto io, auto& layer) {
    io("origin_x", layer.origin_x);
    io("origin_y", layer.origin_y);
    io("origin_z", layer.origin_z);
    io("deposit_x", layer.deposit_x);
    io("deposit_y", layer.deposit_y);
    io("deposit_z", layer.deposit_z);
    io("volume", layer.volume);
    io("radius", layer.radius);
    io("is_a", layer.is_a);
    io("labelled", layer.labelled);
    io("periodic", layer.periodic);
    io("width", layer.width);
    io("dispenser_length", layer.dispenser_length);
    io("platform_length", layer.platform_length);
    io("gap", layer.gap);
    io("dosed_solid_volume", layer.dosed_solid_volume);
    io("overflow_solid_volume", layer.overflow_solid_volume);
    io("overflow_solid_volume_a", layer.overflow_solid_volume_a);
    io("bed_packing", layer.bed_packing);
    io("packing_seed", layer.packing_seed);
};
const auto evaluation_fields = [](auto io, auto& e) {
    io.object("design", e.design, design_fields);
    io.object("health", e.health, health_fields);
    io("seed", e.seed);
    io.object("profile", e.profile, profile_fields);
    io.object("plain_check", e.plain_check, profile_fields);
    io.object("plain_check_drift", e.plain_check_drift, drift_fields);
    io("every_grain", e.every_grain);
    io.object("x_drift", e.drift, drift_fields);
    io.object("map", e.map, map_fields);
    io("target", e.target);
    io("weight", e.weight);
    io.object("misfit", e.misfit, misfit_fields);
    io.object("drift_misfit", e.drift_misfit, misfit_fields);
    io("capture_fraction", e.capture_fraction);
    io("supply_ratio", e.supply_ratio);
    io("coverage", e.coverage);
    io("waste_fraction", e.waste_fraction);
    io("packing_fraction", e.packing_fraction);
    io("waste_a_share", e.waste_a_share);
    io("objective", e.objective);
    io("kinematic_error_bound", e.kinematic_error_bound);
    io("grains", e.grains);
    io("steps", e.steps);
    io("grain_steps", e.grain_steps);
    io("seconds", e.seconds);
    io("seconds_cold", e.seconds_cold);
    io("spreads", e.spreads);
    io("state_hash", e.state_hash);
    io("residuals", e.residuals);
};

constexpr Norm kNorms[] = {Norm::rmse, Norm::mean_absolute, Norm::max};
constexpr Fidelity kFidelities[] = {Fidelity::kinematic, Fidelity::map, Fidelity::full, Fidelity::lammps};
template <class T, std::size_t N>
T named(const T (&all)[N], const std::string& name) {
    for (const T value : all)
        if (name == to_string(value)) return value;
    throw std::runtime_error("unknown name '" + name + "'");
}

json to_json(const Evaluation& evaluation, const std::vector<Layer>& layers) {
    json out = json::object();
    out["format"] = kFormat;
    out["fidelity"] = to_string(evaluation.fidelity);
    out["norm"] = to_string(evaluation.misfit.norm);
    out["family"] = to_string(evaluation.design.family);
    const auto listed = [](const std::vector<PlanPoint>& curve) {
        json points = json::array();
        for (const PlanPoint& point : curve) points.push_back({point.x, point.y});
        return points;
    };
    out["partition_points_m"] = listed(evaluation.design.partition.points);
    if (!evaluation.design.partition.second.empty())
        out["partition_points2_m"] = listed(evaluation.design.partition.second);
    evaluation_fields(Writer{out}, evaluation);
    if (!evaluation.field_target.empty()) {  // the target is one over x and y
        json field = json::object();
        field_fields(Writer{field}, evaluation.field);
        field["target"] = numbers(evaluation.field_target);
        field["weight"] = numbers(evaluation.field_weight);
        out["field"] = std::move(field);
    }
    out["layers"] = json::array();
    for (const Layer& layer : layers) {
        json inner = json::object();
        layer_fields(Writer{inner}, layer);
        out["layers"].push_back(std::move(inner));
    }
    return out;
}

void from_json(json in, JournalEntry& entry) {
    const int format = in.at("format").get<int>();
    if (format == 3)  // nobody had counted them yet
        in.at("health")["deep_contact_share"] = nullptr;
    else if (format != kFormat)
        throw std::runtime_error("written by another version of the journal");
    Evaluation& evaluation = entry.evaluation;
    evaluation_fields(Reader{in}, evaluation);
    if (in.contains("field")) {
        field_fields(Reader{in.at("field")}, evaluation.field);
        evaluation.field_target = numbers(in.at("field").at("target"));
        evaluation.field_weight = numbers(in.at("field").at("weight"));
    }
    evaluation.fidelity = named(kFidelities, in.at("fidelity"));
    evaluation.misfit.norm = named(kNorms, in.at("norm"));
    const std::optional<Family> family = family_of(in.at("family").get<std::string>());
    if (!family) throw std::runtime_error("unknown family " + in.at("family").dump());
    evaluation.design.family = *family;
    const auto read = [](const json& points, std::vector<PlanPoint>& curve) {
        for (const json& point : points)
            curve.push_back({point.at(0).get<double>(), point.at(1).get<double>()});
    };
    read(in.at("partition_points_m"), evaluation.design.partition.points);
    if (in.contains("partition_points2_m"))
        read(in.at("partition_points2_m"), evaluation.design.partition.second);
    for (const json& inner : in.at("layers")) layer_fields(Reader{inner}, entry.layers.emplace_back());
}

[[noreturn]] void fail(const std::string& what, const std::string& path) {
    throw std::runtime_error(fmt::format("journal: cannot {} {}: {}", what, path, std::strerror(errno)));
}

/// 000012_full.json -> 12, else 0.
int entry_number(const fs::path& path) {
    const std::string name = path.filename().string();
    const std::size_t digits = name.find_first_not_of("0123456789");
    if (path.extension() != ".json" || digits == 0 || digits == std::string::npos || digits > 9 ||
        name[digits] != '_')
        return 0;
    return std::stoi(name.substr(0, digits));
}

void flush_folder(const std::string& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) fail("open folder", folder);
    const int failed = ::fsync(descriptor);
    ::close(descriptor);
    if (failed) fail("flush folder", folder);
}

/// Whole text to the disk, or an exception and no file.
void write_flushed(const std::string& path, const std::string& text) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (descriptor < 0) fail("write", path);
    std::size_t done = 0;
    bool failed = false;
    while (done < text.size() && !failed) {
        const ssize_t wrote = ::write(descriptor, text.data() + done, text.size() - done);
        if (wrote > 0)
            done += std::size_t(wrote);
        else
            failed = wrote == 0 || errno != EINTR;
    }
    failed = failed || ::fsync(descriptor) != 0;
    const int reason = errno;
    // Some file systems tell of a full disk only here.
    const bool closed = ::close(descriptor) == 0;
    if (!failed && closed) return;
    if (failed) errno = reason;
    const int kept = errno;
    ::unlink(path.c_str());
    errno = kept;
    fail("write", path);
}

/// Key in which the evaluation differs from the one in the file; empty when they are the same. Times and
/// warnings hang on the machine's day, and the layers on the spread whose hash is compared.
std::string first_difference(const std::string& file, const Evaluation& evaluation) {
    json known;
    try {
        std::ifstream in(file);
        known = json::parse(in);
    } catch (const json::exception& problem) {
        throw std::runtime_error(fmt::format("journal: {} is damaged: {}", file, problem.what()));
    }
    const json now = json::parse(to_json(evaluation, {}).dump());  // through text, as the other went
    for (const auto& [key, value] : now.items()) {
        if (key == "seconds" || key == "seconds_cold" || key == "layers") continue;
        if (key == "health") {
            if (!known.contains(key) || known[key]["status"] != value["status"]) return "health.status";
            continue;
        }
        if (!known.contains(key) || known[key] != value) return key;
    }
    return {};
}

}  // namespace

Journal::Journal(std::string folder, bool replay) : folder_(std::move(folder)) {
    if (folder_.empty()) return;
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error)
        throw std::runtime_error(fmt::format("journal: cannot make folder {}: {}", folder_, error.message()));
    if (::access(folder_.c_str(), W_OK | X_OK) != 0) fail("write into folder", folder_);
    for (const auto& file : fs::directory_iterator(folder_)) {
        last_ = std::max(last_, entry_number(file.path()));
        if (replay && entry_number(file.path()) > 0) replayed_.push_back(file.path().string());
    }
    std::sort(replayed_.begin(), replayed_.end(),
              [](const std::string& a, const std::string& b) { return entry_number(a) > entry_number(b); });
}

int Journal::append(const Evaluation& evaluation, const std::vector<Layer>& layers) {
    if (folder_.empty()) return 0;
    if (!replayed_.empty()) {
        const std::string known = replayed_.back();
        replayed_.pop_back();
        const std::string key = first_difference(known, evaluation);
        if (!key.empty())
            throw OtherWay(fmt::format("the run goes another way than in {}: '{}' differs", known, key));
        return entry_number(known);
    }
    const std::string path =
        fmt::format("{}/{:06}_{}.json", folder_, last_ + 1, to_string(evaluation.fidelity));
    const std::string aside = path + kAside;
    try {
        write_flushed(aside, to_json(evaluation, layers).dump() + "\n");
        if (std::rename(aside.c_str(), path.c_str()) != 0) fail("rename into place", path);
        flush_folder(folder_);
    } catch (const std::runtime_error& error) {
        if (!on_failure) throw;
        on_failure(error.what());
        return 0;
    }
    return ++last_;
}

std::vector<JournalEntry> Journal::read(const std::string& folder) {
    std::vector<JournalEntry> entries;
    if (!fs::is_directory(folder)) return entries;
    for (const auto& file : fs::directory_iterator(folder)) {
        const int number = entry_number(file.path());
        if (number == 0) continue;
        JournalEntry entry;
        entry.number = number;
        entry.file = file.path().string();
        entries.push_back(std::move(entry));
    }
    std::sort(entries.begin(), entries.end(),
              [](const JournalEntry& a, const JournalEntry& b) { return a.number < b.number; });
    for (JournalEntry& entry : entries) {
        try {
            std::ifstream in(entry.file);
            from_json(json::parse(in), entry);
        } catch (const std::exception& problem) {
            throw std::runtime_error(fmt::format("journal: {} is damaged: {}", entry.file, problem.what()));
        }
    }
    return entries;
}

}  // namespace gradwright
