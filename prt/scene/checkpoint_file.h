// Checkpoints on disk, in a folder beside the future scene file.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "prt/checkpoint.h"
#include "prt/scene/fingerprint.h"

namespace relumine::files {
class AppendLog;
class FolderLock;
} // namespace relumine::files

namespace relumine::prt {

/// The folder OUT.prt.checkpoint. One process at a time uses it.
///
/// `run.json` holds the fingerprint. Each part has its records in `PART.log` and its state in
/// `PART.state`; the state also says how much of the log belongs to it. A log only grows and a
/// state is replaced whole, so a crash at any moment leaves the last checkpoint or the one before.
/// The folder appears with the first save.
class CheckpointFile final : public Checkpoint {
public:
    struct Options {
        /// Takes up what the folder holds. Otherwise the first save clears the folder.
        bool resume = false;
        /// Time between two saves.
        std::chrono::duration<double> interval{20.0};
        /// Called when a save failed, or another process is at work.
        std::function<void(const std::string&)> on_problem = {};
    };

    /// Writes nothing yet. With `resume`, a folder that does not exist is no error.
    ///
    /// Throws:  std::runtime_error "FOLDER: expected X, got Y" with `resume`, when the checkpoint
    ///          belongs to other work, is damaged or in use.
    CheckpointFile(const std::filesystem::path& output, Fingerprint fingerprint, Options options);
    ~CheckpointFile() override;

    /// Returns "out.prt.checkpoint" for "out.prt".
    [[nodiscard]] static std::filesystem::path folder_for(const std::filesystem::path& output);

    [[nodiscard]] Saved load(const std::string& part, bool with_state) override;
    [[nodiscard]] bool is_due() override;
    [[nodiscard]] bool is_worthwhile() override;
    [[nodiscard]] bool save(const std::string& part, std::span<const std::byte> record,
                            std::span<const std::byte> state) override;

    /// Whether there is something to resume from. False once load() found damage.
    [[nodiscard]] bool exists() const { return is_ours_; }
    /// Removes the folder when the work is done, also the folder of an older run. A folder that
    /// another process uses stays.
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
    /// The folder holds this work.
    bool is_ours_ = false;
    /// Another process has the folder.
    bool gave_up_ = false;
    Clock::time_point last_;
};

} // namespace relumine::prt
