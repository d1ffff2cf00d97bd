// Long work in steps: step, checkpoint, progress, cancel.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "prt/checkpoint.h"
#include "prt/work.h"

namespace relumine::files {
class ByteReader;
class ByteWriter;
} // namespace relumine::files

namespace relumine::prt {

/// Turns the progress of stages into one fraction that never falls.
///
/// Threads: any thread may call any function but start_stage().
class Progress {
public:
    explicit Progress(const Work& work)
        : stop_(work.stop_in_step()), on_progress_(work.on_progress) {}

    /// Begins the next stage, which takes the work from `begin` to `end` by the estimate of now.
    /// Where an earlier stage thought that more was done, what is left of the scale is shared out
    /// over the work that is left: the fraction goes on slowly and does not wait.
    void start_stage(double begin, double end);
    /// Says that the fraction `part` of the stage is done.
    ///
    /// Throws:  Cancelled when the work must stop.
    void report(double part);
    /// Checks the stop token.
    ///
    /// Throws:  Cancelled when the work must stop.
    void poll() const;

private:
    std::stop_token stop_;
    std::function<void(double)> on_progress_;
    double begin_ = 0.0;
    double end_ = 0.0;
    double last_ = 0.0;
    std::mutex mutex_;
};

/// Stops work between two of its steps, and saves it. All processes that share the work call the
/// same functions in the same order.
class Steps {
public:
    /// What a save stores: what was found since the last one, and what the remaining work needs.
    struct Content {
        std::vector<std::byte> record = {};
        std::vector<std::byte> state = {};
    };

    /// `part`: its name in a checkpoint. `content` makes what a save stores; `on_saved` hears that
    /// it is stored. `work` must outlive this object.
    Steps(const Work& work, std::string part, std::function<Content()> content,
          std::function<void()> on_saved);

    /// Returns what an earlier run left; see Checkpoint::load().
    [[nodiscard]] Checkpoint::Saved load(bool with_state) const;

    /// Ends a step: saves if a checkpoint is due.
    ///
    /// Throws:  Cancelled when any process was asked to stop.
    void look_up();

    /// Does the work, which calls look_up() after each step. Leaves a checkpoint where it pays:
    /// when the work is cancelled, or more work follows; in any case where it throws TooLarge.
    void run(const std::function<void()>& work);

    [[nodiscard]] double seconds_saving() const { return seconds_saving_; }

private:
    void save();

    const Work& work_;
    std::string part_;
    std::function<Content()> content_;
    std::function<void()> on_saved_;
    /// Steps have ended since the last save.
    bool has_news_ = false;
    double seconds_saving_ = 0.0;
};

/// Work on blocks of receivers that do not depend on each other.
struct BlockWork {
    /// Its name in a checkpoint
    std::string part = {};
    /// Blocks of this process
    std::size_t num_blocks = 0;
    /// A checkpoint has so many together, as processes share them out.
    std::size_t blocks_per_tile = 1;
    /// Between two looks at the checkpoint
    std::size_t blocks_per_step = 1;
    /// Does a block. Threads: any number at a time.
    std::function<void(std::size_t block)> work = {};
    /// What a checkpoint has of a finished block
    std::function<void(std::size_t block, files::ByteWriter& writer)> write = {};
    std::function<void(std::size_t block, files::ByteReader& reader)> read = {};
    /// Called before each step and after the last one; may throw TooLarge, in all processes.
    std::function<void()> check = {};
};

/// Does the blocks that a checkpoint does not have.
///
/// Progress: the stage that `progress` is in.
/// Throws:   Cancelled; std::runtime_error for a checkpoint of other work.
void do_blocks(const Work& work, const BlockWork& blocks, Progress& progress);

} // namespace relumine::prt
