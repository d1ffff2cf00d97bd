// Radiance as numbers that numpy reads.
#pragma once

#include <filesystem>
#include <span>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// Writes [values.size() x 3] float32 as .npy version 1.0 (numpy.load). Whole or not at all. Throws std::runtime_error naming the path.
void save_npy(const std::filesystem::path& path, std::span<const glm::vec3> values);

} // namespace relumine::relight
