#include "data_gen/scenes.h"

#include <cmath>
#include <numbers>
#include <ostream>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "mesh_checks.h"

namespace relumine::data_gen {

std::ostream& operator<<(std::ostream& out, const Scene& scene) {
    return out << scene.name;
}

namespace {

bool on_floor(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle) {
    return mesh.positions[triangle[0]].y == 0.0f && mesh.positions[triangle[1]].y == 0.0f &&
           mesh.positions[triangle[2]].y == 0.0f && area_vector(mesh, triangle).y > 0.0;
}

// The scene without its floor.
mesh::TriangleMesh objects(const mesh::TriangleMesh& scene) {
    mesh::TriangleMesh rest;
    rest.positions = scene.positions;
    for (const mesh::Triangle& triangle : scene.triangles) {
        if (!on_floor(scene, triangle)) {
            rest.triangles.push_back(triangle);
        }
    }
    return rest;
}

class SceneTest : public testing::TestWithParam<Scene> {
protected:
    static bool is_room() { return GetParam().name.ends_with("room"); }
};

INSTANTIATE_TEST_SUITE_P(All, SceneTest, testing::ValuesIn(scenes().begin(), scenes().end()),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST_P(SceneTest, MeetsTheVertexCount) {
    for (const std::size_t wish : {1'000u, 1'234u, 2'000u, 3'500u, 7'999u, 8'000u, 15'000u, 20'000u,
                                   33'333u, 79'999u, 80'000u, 100'000u, 250'000u}) {
        const auto count = static_cast<double>(GetParam().make(wish).num_vertices());
        const double allowed = wish < 20'000 ? 0.04 : 0.01;
        EXPECT_NEAR(count / static_cast<double>(wish), 1.0, allowed) << wish;
    }
}

TEST_P(SceneTest, RefusesCountsOutOfRange) {
    EXPECT_THROW((void)GetParam().make(MinSceneVertices - 1), std::invalid_argument);
    EXPECT_THROW((void)GetParam().make(MaxSceneVertices + 1), std::invalid_argument);
}

TEST_P(SceneTest, IsTheSameEveryTime) {
    const mesh::TriangleMesh first = GetParam().make(20'000);
    const mesh::TriangleMesh second = GetParam().make(20'000);
    EXPECT_EQ(first.positions, second.positions);
    EXPECT_EQ(first.triangles, second.triangles);
    EXPECT_EQ(first.normals, second.normals);
}

TEST_P(SceneTest, HasSoundTrianglesAndUnitNormals) {
    for (const std::size_t wish : {1'000u, 10'000u, 300'000u}) {
        const mesh::TriangleMesh mesh = GetParam().make(wish);
        ASSERT_EQ(mesh.normals.size(), mesh.num_vertices());
        std::vector<bool> used(mesh.num_vertices());
        double smallest = 1.0;
        for (const mesh::Triangle& triangle : mesh.triangles) {
            for (const std::uint32_t index : triangle) {
                ASSERT_LT(index, mesh.num_vertices());
                used[index] = true;
            }
            smallest = std::min(smallest, glm::length(area_vector(mesh, triangle)));
        }
        EXPECT_GT(smallest, 1e-9) << wish;
        EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "vertices without a triangle";
        for (const glm::vec3& normal : mesh.normals) {
            ASSERT_NEAR(glm::length(normal), 1.0f, 1e-5f);
        }
    }
}

TEST_P(SceneTest, ObjectsAreClosedAndFaceOutwards) {
    if (is_room()) {
        GTEST_SKIP() << "rooms are sheets that face inwards";
    }
    for (const std::size_t wish : {1'000u, 10'000u, 100'000u}) {
        const mesh::TriangleMesh solid = objects(GetParam().make(wish));
        EXPECT_EQ(num_open_edges(solid), 0u) << wish;
        for (const double volume : volumes(solid)) {
            EXPECT_GT(volume, 0.0) << wish;
        }
    }
}

TEST_P(SceneTest, StandsOnAFloorOfAboutHalfTheVertices) {
    if (is_room()) {
        GTEST_SKIP() << "rooms have a floor like their walls";
    }
    const mesh::TriangleMesh mesh = GetParam().make(50'000);
    std::set<std::uint32_t> floor;
    for (const mesh::Triangle& triangle : mesh.triangles) {
        if (on_floor(mesh, triangle)) {
            floor.insert(triangle.begin(), triangle.end());
        }
    }
    EXPECT_NEAR(static_cast<double>(floor.size()) / static_cast<double>(mesh.num_vertices()), 0.5,
                0.1);
    for (const std::uint32_t index : floor) {
        ASSERT_NEAR(mesh.normals[index].y, 1.0f, 1e-6f);
    }
    EXPECT_GE(mesh::bounds(mesh).min.y, 0.0f) << "something lies under the floor";
}

TEST(ColonnadeTest, ReachesTheLargestCount) {
    const mesh::TriangleMesh mesh = colonnade(MaxSceneVertices);
    EXPECT_NEAR(static_cast<double>(mesh.num_vertices()), double(MaxSceneVertices),
                0.01 * double(MaxSceneVertices));
    for (const mesh::Triangle& triangle : mesh.triangles) {
        ASSERT_GT(glm::length(area_vector(mesh, triangle)), 0.0);
    }
}

TEST(ColonnadeTest, EdgesAreSharp) {
    // The steps' treads look straight up, to the very edge.
    const mesh::TriangleMesh mesh = colonnade(100'000);
    std::size_t num_tread_vertices = 0;
    for (const mesh::Triangle& triangle : mesh.triangles) {
        const glm::dvec3 face = area_vector(mesh, triangle);
        if (face.y > 0.9999 * glm::length(face)) {
            for (const std::uint32_t index : triangle) {
                ASSERT_NEAR(mesh.normals[index].y, 1.0f, 1e-4f);
                ++num_tread_vertices;
            }
        }
    }
    EXPECT_GT(num_tread_vertices, 10'000u);
}

TEST(SphereTest, IsASphereWhereTheHeaderSays) {
    const mesh::TriangleMesh mesh = sphere(50'000);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        if (mesh.positions[i].y > 0.0f) {
            const glm::vec3 from_center = mesh.positions[i] - SphereCenter;
            ASSERT_NEAR(glm::length(from_center), SphereRadius, 1e-5f);
            ASSERT_GT(glm::dot(mesh.normals[i], from_center / SphereRadius), 0.9999f);
        }
    }
}

// The volume of a closed surface is that of its enclosed part, negative where it faces inwards. The
// sheets of a room close but for its opening, which does not count for planes through the origin.
TEST(RoomTest, SheetsFaceInwardsAndEncloseTheRoom) {
    constexpr double Ball = 4.0 / 3.0 * std::numbers::pi;
    const auto volume_of = [](const mesh::TriangleMesh& mesh) {
        double volume = 0.0;
        for (const mesh::Triangle& triangle : mesh.triangles) {
            volume +=
                glm::dot(glm::dvec3(mesh.positions[triangle[0]]), area_vector(mesh, triangle)) /
                3.0;
        }
        return volume;
    };
    // Without its outer end, at x = -2.3, the shaft lacks a third of the end's area times 2.3. The
    // floor has no cells under the box, whose bottom is there; both lie at y = 0.
    const double window = 1.3 * 1.6;
    const double room_volume = 4.0 * 2.8 * 5.0 + 0.3 * window - 0.9 * 0.7 * 0.9 -
                               Ball * std::pow(0.4, 3) - 2.3 / 3.0 * window;
    EXPECT_NEAR(volume_of(room(50'000)), -room_volume, 1e-3 * room_volume);
    // The front at z = 2 is open.
    const double painted_volume =
        4.0 * 3.2 * 4.0 - 1.0 * 1.8 * 1.0 - Ball * std::pow(0.6, 3) - 2.0 / 3.0 * 4.0 * 3.2;
    EXPECT_NEAR(volume_of(painted_room(50'000)), -painted_volume, 1e-3 * painted_volume);
}

TEST(RoomTest, WallsMeetToTheBitAndHaveColours) {
    for (const mesh::TriangleMesh& mesh : {room(20'000), painted_room(20'000)}) {
        ASSERT_EQ(mesh.colors.size(), mesh.num_vertices());
        std::set<std::tuple<float, float, float>> colors;
        std::size_t num_shared = 0;
        for (const glm::vec3& color : mesh.colors) {
            colors.emplace(color.r, color.g, color.b);
        }
        const std::vector<std::uint32_t> weld = welded(mesh);
        for (std::uint32_t i = 0; i < weld.size(); ++i) {
            num_shared += static_cast<std::size_t>(weld[i] != i);
        }
        EXPECT_GE(colors.size(), 2u);
        EXPECT_GT(num_shared, 500u) << "along the edges of the room";
    }
}

TEST(KnotTest, StrandsKeepApart) {
    // Neighbours on one strand look nearly the same way; two strands that met would have close
    // vertices that do not.
    const mesh::TriangleMesh mesh = knot(8'000);
    std::size_t num_tube = 0;
    while (mesh.positions[num_tube].y > 0.0f) {
        ++num_tube;
    }
    EXPECT_NEAR(static_cast<double>(num_tube), 4'000.0, 100.0);
    for (std::size_t i = 0; i < num_tube; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (glm::distance(mesh.positions[i], mesh.positions[j]) < 0.2f) {
                ASSERT_GT(glm::dot(mesh.normals[i], mesh.normals[j]), 0.6f);
            }
        }
    }
}

TEST(KnotTest, TubeHasItsRadius) {
    // Pappus: a tube along a line of length l has the area 2 pi r l and the volume pi r^2 l.
    const mesh::TriangleMesh tube = objects(knot(200'000));
    EXPECT_NEAR(2.0 * volumes(tube).at(0) / area(tube), 0.27, 0.001);
}

} // namespace
} // namespace relumine::data_gen
