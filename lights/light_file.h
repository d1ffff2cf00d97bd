// Light lists in JSON files. The format: docs/light-lists.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lights/light_list.h"

namespace relumine::lights {

/// What a light list file holds: the lights, and where they come from as far as it is known.
struct LightList {
    std::vector<DistantLight> lights = {};
    /// Name of the environment's file; empty: not known
    std::string environment = {};
    /// How they were chosen; empty: not known
    std::string method = {};
    std::optional<std::uint64_t> seed = {};
};

/// Reads a file. Throws std::runtime_error "path:line: expected X, got Y" for anything that is not
/// as the format's page says: unknown fields, no light at all, irradiance that is negative or not
/// finite, a direction whose length is not 1 within 0.001.
[[nodiscard]] LightList load_lights(const std::filesystem::path& path);

/// The text of a file that load_lights() reads back to the same values, bit by bit. Throws
/// std::invalid_argument for what load_lights() would refuse.
[[nodiscard]] std::string json_text(const LightList& list);

/// Writes json_text(). Whole or not at all. Throws std::runtime_error naming the file, too.
void save_lights(const std::filesystem::path& path, const LightList& list);

/// Throws std::invalid_argument "expected X, got Y" for lights that no file may hold.
void validate(const LightList& list);

} // namespace relumine::lights
