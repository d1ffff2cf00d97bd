#include "prt/visibility/coplanar_faces.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/visibility/ray_scene.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// Two squares in one plane, which is turned out of the axes; the first is cut into many triangles.
mesh::TriangleMesh two_in_a_plane(float apart) {
    mesh::TriangleMesh mesh =
        scenes::joined(scenes::floor_grid(38, 2.0f), scenes::floor_grid(6, 1.1f, apart));
    const glm::vec3 x = glm::normalize(glm::vec3(0.8f, 0.3f, -0.2f));
    const glm::vec3 y = glm::normalize(glm::cross(glm::vec3(0.1f, 0.2f, 0.9f), x));
    const glm::vec3 z = glm::cross(x, y);
    for (glm::vec3& at : mesh.positions)
        at = at.x * x + at.y * y + at.z * z + glm::vec3(3.1f, -0.7f, 0.9f);
    for (glm::vec3& normal : mesh.normals)
        normal = y;
    return mesh;
}

TEST(CoplanarFaces, TheSurfaceThatBeginsFirstCoversOthersInItsPlane) {
    const mesh::TriangleMesh mesh = two_in_a_plane(0.0f);
    const CoplanarFaces faces(mesh.positions, mesh.triangles);
    const std::uint32_t of_first = 37 * 37, of_second = 2 * 37 * 37 + 12;
    EXPECT_TRUE(faces.covers(of_first, of_second));
    EXPECT_FALSE(faces.covers(of_second, of_first));
    EXPECT_FALSE(faces.covers(of_first, of_first + 1)) << "of one surface";
    const mesh::TriangleMesh apart = two_in_a_plane(1e-4f);
    EXPECT_FALSE(CoplanarFaces(apart.positions, apart.triangles).covers(of_first, of_second));
}

TEST(CoplanarFaces, EyesSeeOneOfTwoSurfacesEverywhere) {
    const mesh::TriangleMesh mesh = two_in_a_plane(0.0f);
    const std::uint32_t num_of_first = 2 * 37 * 37;
    const RayScene rays(mesh);
    const glm::vec3 eye = mesh.positions[0] + 2.3f * mesh.normals[0] + glm::vec3(0.2f);
    std::size_t num_hits = 0;
    for (std::size_t i = 38 * 38; i < mesh.num_vertices(); ++i)
        for (std::size_t j = i + 1; j < mesh.num_vertices(); j += 3) {
            const glm::vec3 way = glm::mix(mesh.positions[i], mesh.positions[j], 0.37f) - eye;
            const auto hit = rays.closest_hit(eye, way, RayOf::Eye);
            ASSERT_TRUE(hit);
            EXPECT_LT(hit->triangle, num_of_first);
            EXPECT_NEAR(hit->distance, 1.0f, 1e-5f);
            ++num_hits;
            DirectionPacket packet;
            std::array<Hit, PacketSize> hits{};
            for (std::size_t lane = 0; lane < PacketSize; ++lane)
                packet.set(lane, way);
            ASSERT_EQ(rays.closest_hits(eye, packet, 1u, hits, RayOf::Eye), 1u);
            EXPECT_EQ(hits[0].triangle, hit->triangle);
        }
    EXPECT_GT(num_hits, 100u);
    // Of two planes the nearer one is seen.
    const mesh::TriangleMesh apart = two_in_a_plane(1e-4f);
    const glm::vec3 way = apart.positions[38 * 38 + 14] - eye;
    EXPECT_GE(RayScene(apart).closest_hit(eye, way, RayOf::Eye)->triangle, num_of_first);
}

} // namespace
} // namespace relumine::prt
