// Environments that change over time, with one file per frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cubemap/image/environment.h"
#include "cubemap/image/frame_pattern.h"
#include "cubemap/image/image_size.h"
#include "cubemap/image/read_ahead.h"

namespace relumine::cubemap {

/// The file of one frame.
struct FrameFile {
    std::int64_t number = 0;
    std::filesystem::path path = {};
};

/// Returns the frames that a name stands for, numbers ascending. The name is a FramePattern, a glob
/// (* ? [...]) or one file.
///
/// - A pattern's frames must follow each other without a gap: all from the first to the last file,
///   or all of `range`.
/// - A glob takes the files that are there. A frame's number is the last number in the file's name.
///   If a name has no number or two names have the same, the files are counted from 1 in the order
///   of their names. `range` chooses among them.
///
/// Throws:  std::runtime_error "NAME: expected ..., got ..." if there is no frame, or a gap.
[[nodiscard]] std::vector<FrameFile> find_frames(const std::string& name,
                                                 const std::optional<FrameRange>& range = {});

/// Frames on disk. At most two are in memory at a time: the frame that was asked for and the next
/// one.
class FrameSequence {
public:
    using Loader = std::function<EnvironmentImage(const std::filesystem::path&)>;

    /// Reads the header of every frame. The loader may be called by another thread.
    /// Throws:  std::runtime_error naming the first frame that cannot be read or differs in size
    ///          from the first.
    explicit FrameSequence(std::vector<FrameFile> files, Loader loader = default_loader());
    FrameSequence(const FrameSequence&) = delete;
    FrameSequence& operator=(const FrameSequence&) = delete;

    [[nodiscard]] std::size_t size() const { return files_.size(); }
    [[nodiscard]] const std::filesystem::path& path(std::size_t frame) const {
        return files_[frame].path;
    }
    [[nodiscard]] std::int64_t number(std::size_t frame) const { return files_[frame].number; }
    [[nodiscard]] std::span<const FrameFile> files() const { return files_; }
    /// Width and height of all frames.
    [[nodiscard]] ImageSize image_size() const { return size_; }

    /// Returns the frame as the loader gives it, and starts loading the next one. Frames may be
    /// asked for in any order; in ascending order most frames were loaded while the caller was
    /// busy.
    /// Throws:  what the loader throws.
    [[nodiscard]] EnvironmentImage load(std::size_t frame) { return ahead_.get(frame); }
    /// Returns the frame and loads nothing else, for callers that read ahead themselves.
    [[nodiscard]] EnvironmentImage read(std::size_t frame) const {
        return loader_(files_[frame].path);
    }

    /// Returns load_environment() with default options.
    [[nodiscard]] static Loader default_loader();

private:
    std::vector<FrameFile> files_;
    Loader loader_;
    ImageSize size_;
    ReadAhead<EnvironmentImage> ahead_;
};

} // namespace relumine::cubemap
