// Checkpoints on disk, in a folder beside the scene file to be.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "prt/checkpoint.h"
#include "prt/scene/fingerprint.h"

namespace relumine::files {
class AppendLog;
class FolderLock;
} // namespace relumine::files

namespace relumine::prt {

/// The folder OUT.prt.checkpoint: `run.json`, the fingerprint; for each part `PART.log`, its
/// records, and `PART.state`, which says how much of the log belongs to it. A log only grows and a
/// state is replaced whole, so a crash at any moment leaves the last checkpoint or the one before.
/// It appears with the first save. One process at a time uses it.
class CheckpointFile final : public Checkpoint {
public:
    struct Options {
        /// Take up what the folder holds; else it is cleared at the first save
        bool resume = false;
        /// Between two saves
        std::chrono::duration<double> interval{20.0};
        /// A save failed, or another process is at work
        std::function<void(const std::string&)> on_problem = {};
    };

    /// Nothing is written yet. With `resume`: throws std::runtime_error "FOLDER: expected X, got Y"
    /// when the checkpoint there belongs to other work, is damaged or in use. There may be none.
    CheckpointFile(const std::filesystem::path& output, Fingerprint fingerprint, Options options);
    ~CheckpointFile() override;

    /// "out.prt.checkpoint" for "out.prt".
    [[nodiscard]] static std::filesystem::path folder_for(const std::filesystem::path& output);

    [[nodiscard]] Saved load(const std::string& part, bool with_state) override;
    [[nodiscard]] bool is_due() override;
    [[nodiscard]] bool is_worthwhile() override;
    [[nodiscard]] bool save(const std::string& part, std::span<const std::byte> record,
                            std::span<const std::byte> state) override;

    /// Whether there is something to resume from. No more when load() found it damaged.
    [[nodiscard]] bool exists() const { return is_ours_; }
    /// The work is done: the folder goes, an older run's, too, unless another process uses it.
    void remove();

private:
    using Clock = std::chrono::steady_clock;

    void check_fingerprint();
    [[nodiscard]] std::runtime_error damaged(const std::string& name);
    bool lock();
    void clear();
    void claim();
    files::AppendLog& log(const std::string& part);
    [[nodiscard]] std::filesystem::path file(const std::string& name) const {
        return folder_ / name;
    }

    std::filesystem::path folder_;
    Fingerprint fingerprint_;
    Options options_;
    std::unique_ptr<files::FolderLock> lock_;
    std::map<std::string, std::unique_ptr<files::AppendLog>> logs_;
    /// The folder holds this work
    bool is_ours_ = false;
    /// Another process has the folder
    bool gave_up_ = false;
    Clock::time_point last_;
};

} // namespace relumine::prt
