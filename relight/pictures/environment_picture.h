// An environment drawn for people: tone-mapped, with its axes and its sun marked.
#pragma once

#include <string>

#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::relight {

/// A ring around a direction with a word beside it. Without a word nothing is drawn.
struct SunMark {
    glm::dvec3 direction{0.0};
    /// Only the letters in "sun?" can be drawn.
    std::string label = {};
};

/// Writes a lat-long PNG of 1024 x 512 along the world axes: +Z in the middle, +X to its left, +Y
/// at the top. A cross marks each axis (-Z at both ends), a dotted line the horizon. Writes the
/// file whole or not at all. Radiance must be finite and not negative.
void save_environment_picture(const std::string& path, const cubemap::EnvironmentImage& image,
                              const SunMark& sun);

} // namespace relumine::relight
