// Many environments at once.
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// Lights the receivers of a relighter with one environment after the other. The radiance is bit by
/// bit that of Relighter::set_environment(); the relighter's own light stays as it is. A part of
/// the transfer is read once for several environments.
///
/// Shape:   radiance is [environments][num_receivers] in the receivers' own order.
/// Memory:  some megabytes for each of at most 8 environments.
/// Threads: parallel inside; the same bits for any number of threads.
/// Throws:  std::invalid_argument as Relighter::set_environment(), for another size of `radiance`,
///          for receivers with highlights, and for points in space.
void relight_batch(const Relighter& relighter, std::span<const cubemap::CubeMap> environments,
                   std::span<glm::vec3> radiance);

} // namespace relumine::relight
