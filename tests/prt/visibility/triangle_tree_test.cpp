#include "prt/visibility/triangle_tree.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "files/parallel.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// Every triangle lies in one leaf, and in the boxes of all nodes above it.
void check(const mesh::TriangleMesh& mesh) {
    const TriangleTree tree = triangle_tree(mesh.positions, mesh.triangles);
    std::multiset<std::array<float, 9>> expected, found;
    for (const mesh::Triangle& triangle : mesh.triangles) {
        std::array<float, 9> corners;
        for (std::size_t i = 0; i < 9; ++i)
            corners[i] = mesh.positions[triangle[i / 3]][static_cast<int>(i % 3)];
        expected.insert(corners);
    }
    const auto visit = [&](const auto& self, std::int32_t index,
                           const std::array<float, 6>& box) -> void {
        if (index < 0) {
            const TriangleTree::Leaf& leaf = tree.leaves[static_cast<std::size_t>(~index)];
            EXPECT_GE(leaf.size, 1u);
            for (std::size_t lane = 0; lane < TriangleTree::Width; ++lane) {
                std::array<float, 9> corners;
                for (std::size_t i = 0; i < 9; ++i)
                    corners[i] = leaf.corners[i][lane];
                if (lane >= leaf.size) {
                    EXPECT_EQ(corners[0], leaf.corners[0][0]);
                    continue;
                }
                found.insert(corners);
                for (std::size_t i = 0; i < 9; ++i) {
                    const float x = corners[i] - tree.centre[static_cast<int>(i % 3)];
                    EXPECT_LE(box[i % 3], x);
                    EXPECT_GE(box[i % 3 + 3], x);
                    EXPECT_LE(std::abs(x), tree.extent);
                }
            }
            return;
        }
        const TriangleTree::Node& node = tree.nodes[static_cast<std::size_t>(index)];
        std::size_t num_children = 0;
        for (std::size_t lane = 0; lane < TriangleTree::Width; ++lane) {
            std::array<float, 6> inner;
            for (std::size_t i = 0; i < 6; ++i)
                inner[i] = node.bounds[i][lane];
            if (inner[0] > inner[3])
                continue; // unused
            ++num_children;
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_LE(box[i], inner[i]);
                EXPECT_GE(box[i + 3], inner[i + 3]);
            }
            self(self, node.child[lane], inner);
        }
        EXPECT_GE(num_children, 1u);
    };
    const float far = 1e30f;
    if (!mesh.triangles.empty())
        visit(visit, 0, {-far, -far, -far, far, far, far});
    EXPECT_EQ(found, expected);
}

TEST(TriangleTree, HoldsEveryTriangleOnceInsideItsBoxes) {
    // The last is so large that its parts are built in parallel, two levels deep.
    for (const std::size_t n : {0u, 1u, 2u, 16u, 17u, 100u, 5000u, 400000u})
        check(scenes::triangle_soup(n, 1));
    check(scenes::sphere_and_box_on_floor());
}

TEST(TriangleTree, IsTheSameOnAnyNumberOfThreads) {
    const mesh::TriangleMesh mesh = scenes::triangle_soup(100000, 3);
    const auto tree_on = [&](std::size_t num_threads) {
        const files::ThreadLimit limit(num_threads);
        return triangle_tree(mesh.positions, mesh.triangles);
    };
    const TriangleTree one = tree_on(1), many = tree_on(0);
    ASSERT_EQ(one.nodes.size(), many.nodes.size());
    for (std::size_t i = 0; i < one.nodes.size(); ++i) {
        EXPECT_EQ(one.nodes[i].bounds, many.nodes[i].bounds);
        EXPECT_EQ(one.nodes[i].child, many.nodes[i].child);
    }
    ASSERT_EQ(one.leaves.size(), many.leaves.size());
    ASSERT_EQ(one.triangles.size(), many.leaves.size());
    for (std::size_t i = 0; i < one.leaves.size(); ++i) {
        EXPECT_EQ(one.leaves[i].corners, many.leaves[i].corners);
        for (std::size_t lane = 0; lane < one.leaves[i].size; ++lane) {
            const std::uint32_t number = one.triangles[i][lane];
            EXPECT_EQ(number, many.triangles[i][lane]);
            EXPECT_EQ(one.leaves[i].corners[0][lane], mesh.positions[mesh.triangles[number][0]].x);
        }
    }
}

TEST(TriangleTree, ManyTrianglesInOnePlace) {
    mesh::TriangleMesh mesh = scenes::triangle_soup(3, 2);
    for (int i = 0; i < 300; ++i)
        mesh.triangles.push_back(mesh.triangles[static_cast<std::size_t>(i) % 3]);
    check(mesh);
}

TEST(TriangleTree, LargeTrianglesGetLeavesOfTheirOwn) {
    mesh::TriangleMesh mesh = scenes::icosphere(3, 0.01f, glm::vec3(0.0f));
    const auto n = static_cast<std::uint32_t>(mesh.num_vertices());
    mesh.positions.insert(mesh.positions.end(), {{-10, -1, -10}, {10, -1, -10}, {0, -1, 10}});
    mesh.triangles.push_back({n, n + 1, n + 2});
    const TriangleTree tree = triangle_tree(mesh.positions, mesh.triangles);
    for (const TriangleTree::Leaf& leaf : tree.leaves)
        for (std::size_t lane = 0; lane < leaf.size; ++lane)
            if (leaf.corners[0][lane] == -10.0f) {
                EXPECT_EQ(leaf.size, 1u);
            }
}

} // namespace
} // namespace relumine::prt
