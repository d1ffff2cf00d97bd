// Values of receivers that lie in several processes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/team.h"

namespace relumine {

/// Gives the first process the values of all receivers, by their order; the others get none.
///
/// Shape:   `own` is [receivers of this process][width].
[[nodiscard]] std::vector<glm::vec3> gathered(prt::Team& team, std::span<const std::uint32_t> order,
                                              std::span<const glm::vec3> own,
                                              std::size_t width = 1);

} // namespace relumine
