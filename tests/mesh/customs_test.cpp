#include "mesh/customs.h"

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

TEST(Customs, StlHasSharpEdges) {
    EXPECT_EQ(customary_crease("PART.STL"), 40.0f);
    EXPECT_EQ(customary_crease("part.obj"), std::nullopt);
}

/// A pyramid on a square; `base` is the axis that the square looks along, downwards.
TriangleMesh pyramid(int base, float height) {
    TriangleMesh mesh;
    const auto point = [&](float u, float v, float w) {
        glm::vec3 p(0.0f);
        p[(base + 1) % 3] = u;
        p[(base + 2) % 3] = v;
        p[base] = w;
        return p;
    };
    mesh.positions = {point(0, 0, 0), point(1, 0, 0), point(1, 1, 0), point(0, 1, 0),
                      point(0.5f, 0.5f, height)};
    mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    return mesh;
}

TEST(Customs, AFlatSideBelowSuggestsWhatIsUp) {
    EXPECT_TRUE(stands_on_z(pyramid(2, 1.0f), 5));
    EXPECT_FALSE(stands_on_z(pyramid(1, 1.0f), 5));
    EXPECT_FALSE(stands_on_z(pyramid(0, 1.0f), 5));
    EXPECT_FALSE(stands_on_z(pyramid(2, -1.0f), 5)) << "the square is above";
    EXPECT_FALSE(stands_on_z(pyramid(2, 0.01f), 5)) << "flat: a relief on a wall";
    EXPECT_FALSE(stands_on_z(obj("v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 3\nv 1 0 3\nv 1 2 3\n"
                                 "v 0 2 3\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\n"
                                 "f 3 4 8 7\nf 4 1 5 8\n"),
                             8))
        << "a box stands on every side";
    TriangleMesh with_floor = pyramid(2, 1.0f);
    const std::size_t own = with_floor.num_vertices();
    for (const glm::vec3& p : {glm::vec3(-9, 0, -9), glm::vec3(9, 0, 9), glm::vec3(9, 0, -9)})
        with_floor.positions.push_back(p);
    with_floor.triangles.push_back({5, 6, 7});
    EXPECT_TRUE(stands_on_z(with_floor, own));
}

TEST(UpAxis, OfStlIsZByCustom) {
    EXPECT_EQ(customary_up("part.stl"), UpAxis::Z);
    EXPECT_EQ(customary_up("PART.STL"), UpAxis::Z);
    for (const char* name : {"a.obj", "a.ply", "a.glb", "a.gltf", "a.off", "stl"})
        EXPECT_EQ(customary_up(name), UpAxis::Y) << name;
}

} // namespace
} // namespace relumine::mesh
