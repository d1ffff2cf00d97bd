// What processors answer alike, from AVX2 on: rays through edges and corners, and along planes. The
// instruction sets of this processor stand for others.
#include <cstdint>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/visibility/ray_scene.h"
#include "tests/processor/limits.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// The ray scenes of a mesh on each instruction set that fuses products and sums.
std::vector<RayScene> on_every_set(const mesh::TriangleMesh& mesh, RayScene::Packets packets) {
    std::vector<RayScene> scenes;
    for (const char* set : {"isa=avx2", "isa=avx512"})
        try {
            processor::set_embree(set);
            scenes.emplace_back(mesh, packets);
        } catch (const std::runtime_error&) { // this processor has it not
        }
    processor::set_embree(nullptr);
    return scenes;
}

/// Rays as they come in lists of axis-parallel boxes: from corners, middles of edges and near
/// surfaces, to corners and edges, and along axes.
class HardRays {
public:
    explicit HardRays(const mesh::TriangleMesh& mesh) : mesh_(mesh) {}

    glm::vec3 origin() {
        switch (random_() % 4) {
        case 0:
            return vertex() + 0.125f * step(1);
        case 1:
            return 0.5f * (vertex() + vertex());
        case 2: {
            const std::size_t i = random_() % mesh_.num_vertices();
            return mesh_.positions[i] +
                   1e-4f * (mesh_.normals.empty() ? glm::vec3(0, 1, 0) : mesh_.normals[i]);
        }
        default:
            return scenes::random_direction(random_);
        }
    }

    DirectionPacket packet(const glm::vec3& origin) {
        DirectionPacket packet;
        packet.num_directions = PacketSize;
        const auto kind = random_() % 4;
        for (std::size_t lane = 0; lane < PacketSize; ++lane) {
            glm::vec3 target = vertex();
            if (kind == 1) {
                const mesh::Triangle& corners = mesh_.triangles[random_() % mesh_.num_triangles()];
                target = 0.5f * (mesh_.positions[corners[0]] + mesh_.positions[corners[1]]);
            } else if (kind == 2) {
                target = origin + step(2);
            } else if (kind == 3) {
                const auto axis = static_cast<int>(random_() % 3);
                target[axis] = origin[axis];
            }
            const glm::vec3 way = target - origin;
            packet.set(lane, glm::length(way) > 1e-6f ? glm::normalize(way) : glm::vec3(0, 1, 0));
        }
        return packet;
    }

private:
    glm::vec3 vertex() { return mesh_.positions[random_() % mesh_.num_vertices()]; }
    glm::vec3 step(int most) {
        const auto along = [&] {
            return static_cast<float>(std::uniform_int_distribution<int>(-most, most)(random_));
        };
        const float x = along(), y = along(), z = along();
        return {x, y, z};
    }

    const mesh::TriangleMesh& mesh_;
    std::mt19937 random_{1};
};

const std::vector<mesh::TriangleMesh>& hard_meshes() {
    static const std::vector<mesh::TriangleMesh> meshes = {
        scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f)), scenes::sphere_and_box_on_floor(),
        scenes::triangle_soup(300, 3)};
    return meshes;
}

void expect_the_same(const Hit& got, const Hit& expected) {
    EXPECT_EQ(got.triangle, expected.triangle);
    EXPECT_EQ(got.barycentric, expected.barycentric);
    EXPECT_EQ(got.distance, expected.distance);
}

TEST(Processors, AnswerHardRaysAlike) {
    for (const mesh::TriangleMesh& mesh : hard_meshes())
        for (const auto packets : {RayScene::Packets::Narrow, RayScene::Packets::Wide}) {
            const std::vector<RayScene> sets = on_every_set(mesh, packets);
            if (sets.empty())
                GTEST_SKIP() << "the processor does not fuse products and sums";
            HardRays rays(mesh);
            for (int round = 0; round < 5000 && !HasFailure(); ++round) {
                const glm::vec3 origin = rays.origin();
                const DirectionPacket packet = rays.packet(origin);
                const std::uint32_t blocked = sets[0].occluded(origin, packet, 0xffff);
                std::array<Hit, PacketSize> hits, others;
                const std::uint32_t found = sets[0].closest_hits(origin, packet, 0xffff, hits);
                for (const RayScene& set : sets) {
                    EXPECT_EQ(set.occluded(origin, packet, 0xffff), blocked) << "round " << round;
                    EXPECT_EQ(set.closest_hits(origin, packet, 0xffff, others), found);
                    for (std::size_t i = 0; i < PacketSize; ++i)
                        if ((found >> i & 1u) != 0)
                            expect_the_same(others[i], hits[i]);
                }
            }
        }
}

TEST(Processors, AnswerPacketsOfHardRaysAsSingleRays) {
    for (const mesh::TriangleMesh& mesh : hard_meshes()) {
        const RayScene scene(mesh);
        HardRays rays(mesh);
        for (int round = 0; round < 5000 && !HasFailure(); ++round) {
            const glm::vec3 origin = rays.origin();
            const DirectionPacket packet = rays.packet(origin);
            const std::uint32_t blocked = scene.occluded(origin, packet, 0xffff);
            std::array<Hit, PacketSize> hits;
            const std::uint32_t found = scene.closest_hits(origin, packet, 0xffff, hits);
            for (std::size_t i = 0; i < PacketSize; ++i) {
                EXPECT_EQ((blocked >> i & 1u) != 0, scene.occluded(origin, packet.direction(i)))
                    << "round " << round << ", lane " << i;
                const auto alone = scene.closest_hit(origin, packet.direction(i));
                ASSERT_EQ((found >> i & 1u) != 0, alone.has_value());
                if (alone)
                    expect_the_same(hits[i], *alone);
            }
        }
    }
}

} // namespace
} // namespace relumine::prt
