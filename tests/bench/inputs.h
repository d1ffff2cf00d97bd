// The scenes and environments that the benches measure: real ones, or small generated ones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cubemap/cube_map.h"
#include "cubemap/layers/light_layer.h"
#include "relumine/in/mesh.h"
#include "relumine/in/scene.h"
#include "tests/bench/program.h"

namespace relumine::bench {

struct NamedMap {
    std::string name;
    cubemap::CubeMap map;
};

/// Where inputs come from. With --tiny: generated, whatever is asked for.
class Inputs {
public:
    /// Adds --data to the program, which must outlive this; by default what RELUMINE_DATA says.
    explicit Inputs(Program& program);
    /// Adds --scene, too: a finished .prt in place of bunny()'s precompute.
    void add_scene();

    /// A mesh of meshes/stanford on its floor of n x n vertices, 0 for none. Tiny: a boulder.
    /// Throws Absent.
    [[nodiscard]] Mesh mesh(const std::string& name, std::uint32_t floor_vertices = 193) const;

    /// The Stanford bunny on its floor, precomputed with the default tolerance. Tiny: a boulder
    /// with a rough one. Throws Absent.
    [[nodiscard]] Scene bunny() const;

    /// An environment of envs/debevec at resolution R, 0 for its own. Tiny: R = 16 and another
    /// picture. Throws Absent.
    [[nodiscard]] cubemap::CubeMap environment(const std::string& file,
                                               std::uint32_t resolution) const;

    /// Five probes of envs/debevec, and the sun and sky. Throws Absent.
    [[nodiscard]] std::vector<NamedMap> probes_and_sky(std::uint32_t resolution) const;

    /// A studio with small bright lamps, of envs/polyhaven. Throws Absent.
    [[nodiscard]] cubemap::CubeMap studio(std::uint32_t resolution) const;

    [[nodiscard]] bool is_tiny() const { return program_.is_tiny(); }

private:
    [[nodiscard]] cubemap::CubeMap map_of(const std::filesystem::path& file,
                                          std::uint32_t resolution) const;

    Program& program_;
    std::filesystem::path data_;
    std::filesystem::path scene_;
};

/// The disc of the editing experiments; its radius is a part of the map's width. A face, a quarter
/// of the map's width around, spans 90 degrees.
[[nodiscard]] cubemap::LightLayer disc(const glm::dvec3& direction, double part_of_face,
                                       double intensity);

} // namespace relumine::bench
