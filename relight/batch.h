// Many environments at once.
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// Lights the receivers of a relighter with many environments. The radiance is that of
/// Relighter::set_environment() but for roundings; the relighter's own light stays as it is. Up to
/// 8 environments share the reading of the transfer, and the cosines of clusters that lie inside of
/// a texel.
///
/// Shape:   radiance is [environments][num_receivers] in the receivers' own order.
/// Memory:  some megabytes for each of at most 8 environments.
/// Threads: parallel inside; the same bits for any number of threads.
/// Throws:  std::invalid_argument as Relighter::set_environment(), for another size of `radiance`,
///          for receivers with highlights, and for points in space.
void relight_batch(const Relighter& relighter, std::span<const cubemap::CubeMap> environments,
                   std::span<glm::vec3> radiance);

} // namespace relumine::relight
