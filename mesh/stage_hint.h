// What messages say of stages of USD.
#pragma once

#include <filesystem>
#include <string>

namespace relumine::mesh {

/// Returns who reads a stage of USD: the Python package alone. Empty for any other name.
[[nodiscard]] std::string hint_of_stage(const std::filesystem::path& path);

} // namespace relumine::mesh
