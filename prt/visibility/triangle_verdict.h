// One ray and one triangle, in double precision.
#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// What the exact tracer says of a ray and a triangle, as far as its rounding errors let one know.
enum class Verdict { Miss, Hit, Doubt };

/// The ray from `origin` into the unit direction `w`, and triangle `lane` of a leaf.
[[nodiscard]] Verdict judge(const TriangleTree::Leaf& leaf, std::size_t lane,
                            const glm::vec3& origin, const glm::vec3& w);

} // namespace relumine::prt
