// A mesh and an environment that are made in code: a box on a floor, under a sky with a window.
#include <cstdio>
#include <exception>

#include "relumine/relumine.h"

namespace {

using namespace relumine;

/// Adds a rectangle, counter-clockwise seen from its front, with vertices of its own: edges between
/// rectangles are hard.
void add_rectangle(mesh::TriangleMesh& mesh, const glm::vec3& corner, const glm::vec3& right,
                   const glm::vec3& up) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(),
                          {corner, corner + right, corner + right + up, corner + up});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

mesh::TriangleMesh box_on_a_floor() {
    mesh::TriangleMesh mesh;
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    add_rectangle(mesh, {-3, 0, 3}, 6.0f * x, -6.0f * z); // the floor looks to +Y
    add_rectangle(mesh, {-0.5f, 0, 0.5f}, x, y);
    add_rectangle(mesh, {0.5f, 0, -0.5f}, -x, y);
    add_rectangle(mesh, {0.5f, 0, 0.5f}, -z, y);
    add_rectangle(mesh, {-0.5f, 0, -0.5f}, z, y);
    add_rectangle(mesh, {-0.5f, 1, 0.5f}, x, -z);
    mesh.colors.assign(mesh.positions.size(), glm::vec3(0.6f, 0.5f, 0.4f));
    return mesh;
}

/// A blue sky over dark ground, 64 texels along the edge of each face.
cubemap::CubeMap sky() {
    cubemap::CubeMap map(64);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t row = 0; row < map.resolution; ++row)
            for (std::uint32_t column = 0; column < map.resolution; ++column) {
                const glm::vec3 to_sky =
                    cubemap::texel_direction(face, column, row, map.resolution);
                map.at(face, column, row) =
                    to_sky.y > 0.0f ? glm::vec3(0.4f, 0.5f, 0.8f) : glm::vec3(0.05f);
            }
    return map;
}

} // namespace

int main() try {
    LitScene lit(precompute(box_on_a_floor(), {.tolerance = 0.03f}));
    lit.light(sky());
    lit.bounce({.albedo = bounce_albedo(lit.scene())});
    const glm::vec3 before = lit.radiance()[8]; // a corner of the box's side towards -Z

    // A bright rectangle in the middle of the face that looks to -Z.
    const cubemap::TexelRectangle window{cubemap::Face::NegativeZ, 24, 24, 40, 40};
    const std::vector<glm::vec3> light(std::size_t{16} * 16, glm::vec3(10.0f, 9.0f, 8.0f));
    const UpdateReport edit = lit.environment().update_region(window, light);
    lit.bounce();
    const glm::vec3 after = lit.radiance()[8];
    std::printf("%zu vertices, %zu clusters changed; green %.3f before the window, %.3f after\n",
                lit.radiance().size(), edit.num_clusters, static_cast<double>(before.g),
                static_cast<double>(after.g));
    return after.g > before.g ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "in_code: %s\n", error.what());
    return 1;
}
