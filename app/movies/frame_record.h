// Which frames of an animation are done, so that it can go on where it stopped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace relumine::app {

/// A text file beside the frames, one line added when a frame is done: what it was made from and
/// what was written. A frame counts as done while its input (name, size, time of change) and its
/// output (size and content) are still those, under the same settings.
class FrameRecord {
public:
    /// `settings`: all that shapes every frame, in any words. With `resume` what the file tells of
    /// the same settings is kept, otherwise the file begins anew. Throws std::runtime_error when it
    /// cannot be written.
    FrameRecord(std::filesystem::path path, const std::string& settings, bool resume);

    [[nodiscard]] bool is_done(std::int64_t number, const std::filesystem::path& input,
                               const std::filesystem::path& output) const;
    void add(std::int64_t number, const std::filesystem::path& input,
             const std::filesystem::path& output);

    /// The exposure that was chosen for all frames; empty: none yet.
    [[nodiscard]] std::optional<double> exposure_ev() const { return exposure_ev_; }
    void set_exposure_ev(double ev);

    /// Name, size and time of change of a file, or of the six that hold a frame's faces; a missing
    /// file is different from every other.
    [[nodiscard]] static std::string stamp(const std::filesystem::path& path);

private:
    std::filesystem::path path_;
    std::optional<double> exposure_ev_;
    /// Input and output of each finished frame, by its number.
    std::map<std::int64_t, std::string> done_;
};

} // namespace relumine::app
