// One ray and one triangle, in double precision.
#pragma once

#include <array>
#include <cstddef>

#include <glm/vec3.hpp>

#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// The answer of the exact tracer for a ray and a triangle, as far as bounds of its rounding errors
/// tell.
enum class Verdict { Miss, Hit, Doubt };

/// Judges the ray from `origin` in the unit direction `w` against triangle `lane` of a leaf.
[[nodiscard]] Verdict judge(const TriangleTree::Leaf& leaf, std::size_t lane,
                            const glm::vec3& origin, const glm::vec3& w);

/// Whether the exact tracer hits a triangle for certain. Corners are measured from the ray's start;
/// `w` is a unit vector. False more often than judge() is in doubt, and much faster.
[[nodiscard]] bool hits_for_certain(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w);

} // namespace relumine::prt
