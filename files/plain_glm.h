// Included by every header that shows GLM's types first: their layout must be the one that Relumine
// was compiled with.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

static_assert(sizeof(glm::vec3) == 12 && alignof(glm::vec3) == 4 && sizeof(glm::dmat3) == 72,
              "Relumine takes GLM's vectors without alignment: compile the sources that include it "
              "without GLM_FORCE_DEFAULT_ALIGNED_GENTYPES");
