#include "prt/scene/checkpoint_file.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/append_log.h"
#include "files/folder_lock.h"
#include "files/hash.h"
#include "files/json.h"
#include "files/output_file.h"

namespace relumine::prt {

namespace fs = std::filesystem;

namespace {

constexpr const char* RunName = "run.json";

/// Stands in front of a state.
struct StateHead {
    /// Bytes "RPPState".
    std::uint64_t mark = 0x6574617453505052;
    /// Bytes of the log that belong to the state.
    std::uint64_t log_size = 0;
    std::uint64_t size = 0;
    /// xxHash64 of the state, seeded with log_size.
    std::uint64_t checksum = 0;
};

/// Less work than this is not worth a file.
constexpr double WorthwhileSeconds = 5.0;

} // namespace

fs::path CheckpointFile::folder_for(const fs::path& output) {
    fs::path folder = output;
    folder += ".checkpoint";
    return folder;
}

CheckpointFile::CheckpointFile(const fs::path& output, Fingerprint fingerprint, Options options)
    : folder_(folder_for(output)), fingerprint_(std::move(fingerprint)),
      options_(std::move(options)), last_(Clock::now()) {
    if (!options_.resume || !fs::exists(folder_))
        return;
    if (!lock())
        throw std::runtime_error(fmt::format(
            "{}: expected a checkpoint of a run that ended, got one in use", folder_.string()));
    // The earlier run was killed before its first save was complete.
    if (!fs::exists(file(RunName)))
        return;
    check_fingerprint();
    is_ours_ = true;
}

CheckpointFile::~CheckpointFile() = default;

/// Returns the error to throw. From then on the folder holds no checkpoint of this work.
std::runtime_error CheckpointFile::damaged(const std::string& name) {
    is_ours_ = false;
    return std::runtime_error(fmt::format(
        "{}: expected a checkpoint, got damaged data; without --resume the work begins anew",
        file(name).string()));
}

void CheckpointFile::check_fingerprint() {
    const std::vector<std::byte> bytes = files::read(file(RunName));
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    files::Json json;
    try {
        json = files::parse_json({text, bytes.size()});
    } catch (const files::JsonError&) {
        throw damaged(RunName);
    }
    if (json.type() != files::Json::Type::Object)
        throw damaged(RunName);
    for (const auto& [name, value] : fingerprint_) {
        const files::Json* found = json.find(name);
        const std::string got = found != nullptr && found->type() == files::Json::Type::String
                                    ? found->string()
                                    : "none";
        if (got == value)
            continue;
        throw std::runtime_error(
            fmt::format("{}: expected a checkpoint of this run ({} {}), got another's "
                        "({} {}); without --resume the work begins anew",
                        folder_.string(), name, value, name, got));
    }
    if (json.size() != fingerprint_.size())
        throw std::runtime_error(
            fmt::format("{}: expected a checkpoint of this run, got one with highlights or "
                        "bounces; "
                        "without --resume the work begins anew",
                        folder_.string()));
}

bool CheckpointFile::lock() {
    if (!lock_)
        lock_ = files::FolderLock::acquire(folder_);
    return lock_ != nullptr;
}

/// Removes the files of a checkpoint and nothing else. The fingerprint, which makes it a
/// checkpoint, goes first.
void CheckpointFile::clear() {
    fs::remove(file(RunName));
    std::vector<fs::path> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
        if (const fs::path extension = entry.path().extension();
            extension == ".log" || extension == ".state" ||
            entry.path().filename().string().find(".writing-") != std::string::npos)
            names.push_back(entry.path());
    for (const fs::path& name : names)
        fs::remove(name);
}

/// Takes the folder for this run.
void CheckpointFile::claim() {
    if (is_ours_)
        return;
    fs::create_directory(folder_);
    if (!lock()) {
        gave_up_ = true;
        throw std::runtime_error(fmt::format("{}: another run uses it", folder_.string()));
    }
    clear();
    logs_.clear();
    files::Json json = files::Json::Object{};
    for (const auto& [name, value] : fingerprint_)
        json.set(name, value);
    files::save_text(file(RunName), json.text(2) + "\n");
    files::sync_folder(files::folder_of(folder_));
    is_ours_ = true;
}

files::AppendLog& CheckpointFile::log(const std::string& part) {
    std::unique_ptr<files::AppendLog>& log = logs_[part];
    if (!log)
        log = std::make_unique<files::AppendLog>(file(part + ".log"));
    return *log;
}

Checkpoint::Saved CheckpointFile::load(const std::string& part, bool with_state) {
    Saved saved;
    if (!is_ours_)
        return saved;
    const std::string state_name = part + ".state";
    const fs::path state_file = file(state_name);
    if (!with_state) {
        saved.records = log(part).read();
        return saved;
    }
    if (!fs::exists(state_file))
        return saved;
    const std::vector<std::byte> bytes = files::read(state_file);
    StateHead head;
    const StateHead expected;
    if (bytes.size() < sizeof head)
        throw damaged(state_name);
    std::memcpy(&head, bytes.data(), sizeof head);
    if (head.mark != expected.mark || head.size != bytes.size() - sizeof head ||
        files::hash_of(std::span(bytes).subspan(sizeof head), head.log_size) != head.checksum)
        throw damaged(state_name);
    saved.records = log(part).read(head.log_size);
    if (log(part).size() != head.log_size)
        throw damaged(part + ".log");
    saved.state.assign(bytes.begin() + sizeof head, bytes.end());
    return saved;
}

bool CheckpointFile::is_due() {
    return !gave_up_ && Clock::now() - last_ >= options_.interval;
}

bool CheckpointFile::is_worthwhile() {
    const std::chrono::duration<double> enough(
        std::min(WorthwhileSeconds, options_.interval.count()));
    return !gave_up_ && Clock::now() - last_ >= enough;
}

bool CheckpointFile::save(const std::string& part, std::span<const std::byte> record,
                          std::span<const std::byte> state) {
    bool is_saved = false;
    std::optional<std::uint64_t> log_size;
    try {
        claim();
        log_size = log(part).size();
        if (!record.empty())
            log(part).append(record);
        if (!state.empty()) {
            const StateHead head{.log_size = log(part).size(),
                                 .size = state.size(),
                                 .checksum = files::hash_of(state, log(part).size())};
            files::OutputFile output(file(part + ".state"));
            output.expect(sizeof head + state.size());
            output.append(std::as_bytes(std::span(&head, 1)));
            output.append(state);
            output.commit();
        }
        is_saved = true;
    } catch (const std::exception& error) {
        // The work goes on: the next save may find room. It brings the record again.
        if (log_size)
            log(part).cut(*log_size);
        if (options_.on_problem)
            options_.on_problem(fmt::format("no checkpoint: {}", error.what()));
    }
    last_ = Clock::now();
    return is_saved;
}

void CheckpointFile::remove() {
    std::error_code none;
    if (!fs::is_directory(folder_, none) || !lock())
        return;
    try {
        logs_.clear();
        clear();
        fs::remove(folder_, none); // stays if it holds other files
    } catch (const fs::filesystem_error& error) {
        if (options_.on_problem)
            options_.on_problem(
                fmt::format("{}: cannot remove: {}", folder_.string(), error.code().message()));
    }
    is_ours_ = false;
}

} // namespace relumine::prt
