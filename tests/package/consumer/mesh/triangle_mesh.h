#pragma once

namespace engine {

inline constexpr const char* name = "an engine with a mesh/triangle_mesh.h of its own";

} // namespace engine
