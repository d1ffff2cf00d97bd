// Blender's Cycles: path tracing, which stores nothing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "mesh/triangle_mesh.h"

namespace relumine::bench {

/// Direct light of a mesh's vertices, baked by cycles_bake.py.
class Cycles {
public:
    /// Whether there is a `blender` to run.
    [[nodiscard]] static bool is_there();

    /// Writes the mesh to a folder of its own, which goes with this object.
    explicit Cycles(const mesh::TriangleMesh& mesh);
    Cycles(const Cycles&) = delete;
    Cycles& operator=(const Cycles&) = delete;
    ~Cycles();

    struct Baked {
        /// [num_vertices] of albedo 1
        std::vector<glm::vec3> radiance;
        /// Of the bake alone, without Blender's start.
        double seconds = 0.0;
    };
    /// Throws:  std::runtime_error with what Blender said, where it baked nothing.
    [[nodiscard]] Baked bake(const cubemap::CubeMap& environment, std::uint32_t samples) const;

private:
    std::filesystem::path folder_;
};

} // namespace relumine::bench
