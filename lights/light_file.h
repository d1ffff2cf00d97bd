// Light lists in JSON files. docs/light-lists.md describes the format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lights/light_list.h"

namespace relumine::lights {

/// The content of a light list file: the lights, and their origin if it is known.
struct LightList {
    std::vector<DistantLight> lights = {};
    /// Name of the environment's file. Empty: not known.
    std::string environment = {};
    /// How the lights were chosen. Empty: not known.
    std::string method = {};
    std::optional<std::uint64_t> seed = {};
};

/// Reads a file.
/// Throws:  std::runtime_error "path:line: expected X, got Y" for anything that the format does not
///          allow: unknown fields, no light at all, irradiance that is negative or not finite, a
///          direction whose length differs from 1 by more than 0.001.
[[nodiscard]] LightList load_lights(const std::filesystem::path& path);

/// Returns the text of a file that load_lights() reads back to the same values, bit by bit.
/// Throws:  std::invalid_argument for lists that load_lights() would refuse.
[[nodiscard]] std::string json_text(const LightList& list);

/// Writes json_text(). The file appears whole or not at all.
/// Throws:  as json_text(), and std::runtime_error naming the file.
void save_lights(const std::filesystem::path& path, const LightList& list);

/// Checks a list.
/// Throws:  std::invalid_argument "expected X, got Y" for lights that no file may hold.
void validate(const LightList& list);

} // namespace relumine::lights
