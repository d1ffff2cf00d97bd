// Radiance as numbers that numpy reads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "files/output_file.h"

namespace relumine::relight {

/// Writes [values.size() x 3] float32 as .npy version 1.0 (numpy.load), whole or not at all.
///
/// Throws:  std::runtime_error that names the path.
void save_npy(const std::filesystem::path& path, std::span<const glm::vec3> values);

/// Writes [num_frames x num_values x 3] float32 as .npy, frame by frame: only one frame is in
/// memory. Without commit() there is no file.
///
/// Throws:  std::runtime_error that names the path, from every function.
class NpyFrames {
public:
    /// Begins the file.
    NpyFrames(const std::filesystem::path& path, std::size_t num_frames, std::size_t num_values);
    /// Writes the next frame.
    ///
    /// Throws:  std::invalid_argument for another number of values than num_values.
    void append(std::span<const glm::vec3> values);
    /// Makes the file appear.
    ///
    /// Throws:  std::invalid_argument when frames are missing.
    void commit();

private:
    files::OutputFile file_;
    std::size_t frames_left_;
    std::size_t num_values_;
};

/// Vectors in rows. The shape is the array's shape without its last axis, which is x, y, z.
struct VectorArray {
    std::vector<std::size_t> shape;
    /// [product of the shape] in C order.
    std::vector<glm::vec3> values;
};

/// Reads a .npy file (versions 1 to 3) of little-endian float32 or float64, C order, with a last
/// axis of length 3.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] VectorArray load_npy(const std::filesystem::path& path);

} // namespace relumine::relight
