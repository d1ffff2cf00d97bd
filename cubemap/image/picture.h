// The one type of pictures: pixels of linear RGB radiance.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::cubemap {

struct Picture {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// [height * width] row by row from the top; linear RGB radiance.
    std::vector<glm::vec3> pixels = {};
    /// [height * width] in [0, 1]. It is already multiplied into the pixels where it is not 0.
    /// Empty: the picture is opaque.
    std::vector<float> alpha = {};
    bool operator==(const Picture&) const = default;
};

} // namespace relumine::cubemap
