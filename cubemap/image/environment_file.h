// An environment as its file has it, beside the map that was made from it.
#pragma once

#include <memory>

#include <glm/mat3x3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// An environment as its file has it, and how the map that lights the scene was turned.
struct EnvironmentFile {
    std::shared_ptr<const cubemap::EnvironmentImage> image;
    /// What the image shows in direction w lights the scene from `turn` w.
    glm::dmat3 turn{1.0};
};

} // namespace relumine::cubemap
