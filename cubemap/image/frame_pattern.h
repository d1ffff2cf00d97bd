// Names of numbered frames: frames.%04d.exr, frames.####.exr.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace relumine::cubemap {

/// A file name with a place for the frame's number: `%d` or `%04d` as in printf, or `####` with one
/// # per digit. Longer numbers take more digits.
class FramePattern {
public:
    /// Reads a pattern. Returns nothing if the file's name has no place for a number; names of
    /// folders are not searched.
    /// Throws:  std::runtime_error for two such places.
    [[nodiscard]] static std::optional<FramePattern> parse(const std::string& text);

    /// Returns the path of a frame with a number >= 0.
    [[nodiscard]] std::string name(std::int64_t number) const;
    /// Returns the path with a text in the number's place.
    [[nodiscard]] std::string name_of_all(std::string_view text) const;
    /// Returns the number of the frame with this path, or nothing if the path does not fit the
    /// pattern. Leading zeros count: frame.07.exr is no frame of frame.%d.exr.
    [[nodiscard]] std::optional<std::int64_t> number(std::string_view path) const;

private:
    FramePattern(std::string prefix, std::size_t digits, std::string suffix);

    std::string prefix_;
    /// Least number of digits.
    std::size_t digits_;
    std::string suffix_;
};

/// The frames first, first + step, ... up to last.
struct FrameRange {
    std::int64_t first = 0;
    std::int64_t last = 0;
    std::int64_t step = 1;

    /// Reads "10-200", "10-200x5" (every fifth) or "10".
    /// Throws:  std::runtime_error for any other text.
    [[nodiscard]] static FrameRange parse(const std::string& text);
    [[nodiscard]] bool contains(std::int64_t number) const {
        return number >= first && number <= last && (number - first) % step == 0;
    }
};

} // namespace relumine::cubemap
