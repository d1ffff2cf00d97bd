// Radiance as numbers that numpy reads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "files/output_file.h"

namespace relumine::relight {

/// Writes [values.size() x 3] float32 as .npy version 1.0 (numpy.load). Whole or not at all. Throws
/// std::runtime_error naming the path.
void save_npy(const std::filesystem::path& path, std::span<const glm::vec3> values);

/// Writes [num_frames x num_values x 3] float32 as .npy, frame by frame: only one frame is in
/// memory. Without commit() no file.
class NpyFrames {
public:
    /// Throws std::runtime_error naming the path, as all its functions do.
    NpyFrames(const std::filesystem::path& path, std::size_t num_frames, std::size_t num_values);
    /// The next frame. Throws std::invalid_argument for another number of values than was stated.
    void append(std::span<const glm::vec3> values);
    /// The file appears. Throws std::invalid_argument when frames are missing.
    void commit();

private:
    files::OutputFile file_;
    std::size_t frames_left_;
    std::size_t num_values_;
};

/// Vectors in rows: the array's shape without its last axis, which is x, y, z.
struct VectorArray {
    std::vector<std::size_t> shape;
    /// As many as the product of the shape, C order
    std::vector<glm::vec3> values;
};

/// Reads a .npy file (versions 1 to 3) of little-endian float32 or float64, C order, whose last
/// axis is 3 long. Throws std::runtime_error "path: expected X, got Y".
[[nodiscard]] VectorArray load_npy(const std::filesystem::path& path);

} // namespace relumine::relight
