// Names of numbered frames: frames.%04d.exr, frames.####.exr.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace relumine::cubemap {

/// A file name with a place for the frame's number: `%d`, `%04d` as in printf, or `####`, one # per
/// digit; longer numbers take more.
class FramePattern {
public:
    /// Nothing when the name of the file (folders are taken as they are) has no such place. Throws
    /// std::runtime_error when it has two.
    [[nodiscard]] static std::optional<FramePattern> parse(const std::string& text);

    /// The path of a frame, number >= 0.
    [[nodiscard]] std::string name(std::int64_t number) const;
    /// The path with a text in the number's place.
    [[nodiscard]] std::string name_of_all(std::string_view text) const;
    /// The number of the frame that has this path, or nothing. Leading zeros count: frame.07.exr is
    /// no frame of frame.%d.exr.
    [[nodiscard]] std::optional<std::int64_t> number(std::string_view path) const;

private:
    FramePattern(std::string prefix, std::size_t digits, std::string suffix);

    std::string prefix_;
    /// At least so many
    std::size_t digits_;
    std::string suffix_;
};

/// Frames first, first + step, ... up to last.
struct FrameRange {
    std::int64_t first = 0;
    std::int64_t last = 0;
    std::int64_t step = 1;

    /// "10-200", "10-200x5" (every fifth) or "10". Throws std::runtime_error for anything else.
    [[nodiscard]] static FrameRange parse(const std::string& text);
    [[nodiscard]] bool contains(std::int64_t number) const {
        return number >= first && number <= last && (number - first) % step == 0;
    }
};

} // namespace relumine::cubemap
