#include "cli/run_record.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>

#include "dem/cache_file.h"
#include "reports/provenance.h"
#include "reports/safe_write.h"

namespace gradwright::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string lock_of(const std::string& folder) {
    return folder + "/run.lock";
}

}  // namespace

RunRecord record_of(const Study& study, const std::vector<std::string>& set, const std::string& strategy,
                    const std::string& fidelity, int budget) {
    RunRecord record;
    record.study_file = fs::absolute(study.file).lexically_normal().string();
    record.study_text = study.text;
    record.set = set;
    record.strategy = strategy;
    record.fidelity = fidelity;
    record.budget = budget;
    // how the partition is made decides no number of a design
    for (const InputEntry& entry : study.inputs)
        if (!entry.key.starts_with("partition_build.")) record.inputs.emplace_back(entry.key, entry.value);
    // A table lies in a file of its own, which may have changed; its weights are zones.
    for (std::size_t k = 0; k < study.target.table_y.size(); ++k)
        record.inputs.emplace_back(fmt::format("target.table[{}]", k),
                                   fmt::format("{} {}", study.target.table_y[k], study.target.table_gi[k]));
    const Target& field = study.target;
    for (std::size_t k = 0; k < field.field_gi.size(); ++k)
        record.inputs.emplace_back(
            fmt::format("target.field[{}]", k),
            fmt::format("{} {} {}", field.field_x[k % field.field_x.size()], field.field_gi[k],
                        field.field_weight.empty() ? 1 : field.field_weight[k]));
    for (std::size_t k = 0; k < study.target.zones.size(); ++k) {
        const TargetZone& zone = study.target.zones[k];
        record.inputs.emplace_back(fmt::format("target.zone[{}]", k),
                                   fmt::format("{} {} {}", zone.y_low, zone.y_high, zone.weight));
    }
    record.engine = fmt::format("format {}, {}", kEngineFormat, compiled_instruction_set());
    return record;
}

void write_record(const std::string& folder, const RunRecord& record) {
    json inputs = json::array();
    for (const auto& [key, value] : record.inputs) inputs.push_back({key, value});
    const json object = {{"study_file", record.study_file},
                         {"study_text", record.study_text},
                         {"set", record.set},
                         {"strategy", record.strategy},
                         {"fidelity", record.fidelity},
                         {"budget", record.budget},
                         {"film", record.film},
                         {"inputs", inputs},
                         {"engine", record.engine}};
    write_file(folder + "/run.json", json_text(object) + "\n");
}

RunRecord read_record(const std::string& folder) {
    const std::string file = folder + "/run.json";
    if (!fs::exists(file))
        throw Failure(ExitCode::io, fmt::format("'{}' has no run.json: no design was begun there", folder),
                      "name the folder that 'gradwright design --out' wrote to");
    try {
        const json object = json::parse(read_file(file));
        RunRecord record;
        object.at("study_file").get_to(record.study_file);
        object.at("study_text").get_to(record.study_text);
        object.at("set").get_to(record.set);
        object.at("strategy").get_to(record.strategy);
        object.at("fidelity").get_to(record.fidelity);
        object.at("budget").get_to(record.budget);
        object.at("engine").get_to(record.engine);
        record.film = object.value("film", false);  // runs of earlier versions have none
        for (const json& pair : object.at("inputs"))
            record.inputs.emplace_back(pair.at(0).get<std::string>(), pair.at(1).get<std::string>());
        return record;
    } catch (const json::exception& problem) {
        throw Failure(ExitCode::bad_input, fmt::format("{} is damaged: {}", file, problem.what()),
                      "begin the design anew in another folder");
    }
}

std::vector<std::string> differences(const RunRecord& there, const RunRecord& now) {
    std::vector<std::string> out;
    const auto compare = [&out](const std::string& key, const std::string& a, const std::string& b) {
        const auto shown = [](const std::string& text) { return text.empty() ? "nothing" : text; };
        if (a != b) out.push_back(fmt::format("{}: {} there, {} now", key, shown(a), shown(b)));
    };
    compare("--strategy", there.strategy, now.strategy);
    compare("--fidelity", there.fidelity, now.fidelity);
    compare("--budget", std::to_string(there.budget), std::to_string(now.budget));
    compare("--film", there.film ? "yes" : "no", now.film ? "yes" : "no");
    compare("engine", there.engine, now.engine);
    std::map<std::string, std::string> new_values(now.inputs.begin(), now.inputs.end());
    for (const auto& [key, value] : there.inputs) {
        const auto found = new_values.find(key);
        compare(key, value, found == new_values.end() ? "" : found->second);
        if (found != new_values.end()) new_values.erase(found);
    }
    for (const auto& [key, value] : new_values) compare(key, "", value);
    return out;
}

FolderLock::FolderLock(const std::string& folder) {
    descriptor_ = ::open(lock_of(folder).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0)
        throw Failure(ExitCode::io, fmt::format("cannot open {}: {}", lock_of(folder), std::strerror(errno)),
                      "name another folder with --out");
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    const bool taken = errno == EWOULDBLOCK;  // some network file systems know no locks: go on without
    ::close(descriptor_);
    descriptor_ = -1;
    if (taken)
        throw Failure(ExitCode::usage, fmt::format("a design is running in '{}'", folder),
                      fmt::format("'gradwright status {}' tells how far it is", folder));
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

bool FolderLock::held(const std::string& folder) {
    const int descriptor = ::open(lock_of(folder).c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool held = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    ::close(descriptor);
    return held;
}

StatusFile::StatusFile(std::string folder)
    : folder_(std::move(folder)), begun_(std::chrono::steady_clock::now()) {
    write("running");
}

void StatusFile::update(const std::string& stage, double fraction) {
    constexpr auto kOften = std::chrono::seconds(2);
    const auto now = std::chrono::steady_clock::now();
    const bool new_stage = stage != stage_;
    stage_ = stage;
    fraction_ = fraction;
    if (!new_stage && now - written_ < kOften) return;
    written_ = now;
    write("running");
}

void StatusFile::end(const std::string& state) {
    write(state);
}

void StatusFile::write(const std::string& state) const {
    const auto seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
    const json object = {{"state", state},
                         {"stage", stage_},
                         {"fraction", fraction_},
                         {"seconds", seconds},
                         {"pid", static_cast<long>(::getpid())}};
    // Not flushed to the disk, unlike everything that is a result; and no reason to end a run.
    const std::string file = folder_ + "/status.json", aside = file + ".part";
    if (std::FILE* out = std::fopen(aside.c_str(), "w")) {
        const std::string text = json_text(object) + "\n";
        const bool whole = std::fwrite(text.data(), 1, text.size(), out) == text.size();
        if (std::fclose(out) == 0 && whole) std::rename(aside.c_str(), file.c_str());
    }
}

}  // namespace gradwright::cli
