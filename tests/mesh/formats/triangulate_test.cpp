#include "mesh/formats/triangulate.h"

#include <ctime>
#include <numbers>
#include <numeric>
#include <random>

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

/// The plane of a test polygon: tilted, away from the origin.
glm::vec3 lifted(double x, double y) {
    return glm::vec3(glm::dvec3(3, -5, 7) + x * glm::dvec3(0.36, 0.48, -0.8) +
                     y * glm::dvec3(-0.8, 0.6, 0.0));
}

std::vector<glm::vec3> lifted(const std::vector<glm::dvec2>& points) {
    std::vector<glm::vec3> result;
    result.reserve(points.size());
    for (const glm::dvec2& p : points)
        result.push_back(lifted(p.x, p.y));
    return result;
}

double signed_area(const std::vector<glm::dvec2>& points) {
    double sum = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec2 a = points[i], b = points[(i + 1) % points.size()];
        sum += 0.5 * (a.x * b.y - a.y * b.x);
    }
    return sum;
}

std::vector<Triangle> triangles_of(const std::vector<glm::vec3>& positions) {
    std::vector<std::uint32_t> polygon(positions.size());
    std::iota(polygon.begin(), polygon.end(), 0u);
    std::vector<Triangle> triangles;
    Triangulator(positions).append(polygon, triangles);
    return triangles;
}

/// Triangles that look the polygon's way and whose areas sum up to its area cover it exactly: any
/// overlap or any triangle outside would have to be made up for by a triangle that looks the other
/// way.
void expect_cover(const std::vector<glm::dvec2>& points) {
    for (const bool reversed : {false, true}) {
        std::vector<glm::dvec2> polygon = points;
        if (reversed)
            std::reverse(polygon.begin(), polygon.end());
        TriangleMesh mesh;
        mesh.positions = lifted(polygon);
        mesh.triangles = triangles_of(mesh.positions);
        ASSERT_EQ(mesh.num_triangles(), polygon.size() - 2);
        const double expected = std::abs(signed_area(polygon));
        EXPECT_NEAR(area(mesh), expected, 1e-5 * expected);
        glm::dvec3 sum(0.0);
        for (const Triangle& t : mesh.triangles)
            sum += 0.5 * glm::cross(glm::dvec3(mesh.positions[t[1]] - mesh.positions[t[0]]),
                                    glm::dvec3(mesh.positions[t[2]] - mesh.positions[t[0]]));
        EXPECT_NEAR(glm::dot(sum, glm::dvec3(0.48, 0.64, 0.6)), signed_area(polygon),
                    1e-5 * expected);
    }
}

TEST(Triangulate, ConvexPolygonsAreFans) {
    EXPECT_EQ(triangles_of(lifted({{0, 0}, {1, 0}, {1, 1}, {0, 1}})),
              (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(triangles_of(lifted({{0, 0}, {2, 0}, {3, 1}, {2, 2}, {0, 2}})),
              (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(Triangulate, ConcaveQuadsAreCutAtTheirReflexCorner) {
    for (std::size_t shift = 0; shift < 4; ++shift) {
        std::vector<glm::dvec2> dart = {{0, 0}, {2, 1}, {0, 2}, {0.5, 1}};
        std::rotate(dart.begin(), dart.begin() + static_cast<std::ptrdiff_t>(shift), dart.end());
        expect_cover(dart);
    }
}

TEST(Triangulate, RandomStarsAreCoveredExactly) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> radius(0.05, 1.0);
    for (std::size_t n = 3; n < 300; n += 1 + n / 8) {
        std::vector<glm::dvec2> star;
        for (std::size_t i = 0; i < n; ++i) {
            const double angle =
                2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
            star.push_back(radius(random) * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
        expect_cover(star);
    }
}

TEST(Triangulate, CornersOnStraightEdges) {
    std::vector<glm::dvec2> square;
    for (int side = 0; side < 4; ++side)
        for (int i = 0; i < 4; ++i) {
            const glm::dvec2 p(-1.0 + 0.5 * i, -1.0);
            square.push_back(side == 0   ? p
                             : side == 1 ? glm::dvec2(-p.y, p.x)
                             : side == 2 ? -p
                                         : glm::dvec2(p.y, -p.x));
        }
    expect_cover(square);
}

TEST(Triangulate, HolesJoinedByDoubledEdges) {
    expect_cover({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}});
    // Two holes, joined to different corners; the second touches the first one's bridge nowhere.
    expect_cover({{0, 0},
                  {9, 0},
                  {9, 4},
                  {8, 3},
                  {6, 3},
                  {6, 1},
                  {8, 1},
                  {8, 3},
                  {9, 4},
                  {0, 4},
                  {0, 0},
                  {1, 1},
                  {1, 3},
                  {3, 3},
                  {3, 1},
                  {1, 1}});
}

/// A comb of n teeth, and a spiral: many reflex corners.
std::vector<glm::dvec2> comb(int n) {
    std::vector<glm::dvec2> points;
    for (int i = 0; i < n; ++i) {
        points.emplace_back(i, 0.0);
        points.emplace_back(i + 0.5, 100.0);
    }
    points.emplace_back(n, 0.0);
    points.emplace_back(n, -1.0);
    points.emplace_back(0.0, -1.0);
    std::reverse(points.begin(), points.end());
    return points;
}

std::vector<glm::dvec2> spiral(int n) {
    std::vector<glm::dvec2> points;
    points.reserve(2 * static_cast<std::size_t>(n));
    const auto at = [](double angle, double offset) {
        return (10.0 + angle + offset) * glm::dvec2(std::cos(angle), std::sin(angle));
    };
    for (int i = 0; i < n; ++i)
        points.push_back(at(0.1 * i, 2.0));
    for (int i = n - 1; i >= 0; --i)
        points.push_back(at(0.1 * i, 0.0));
    return points;
}

TEST(Triangulate, CombsAndSpiralsAreCoveredExactly) {
    expect_cover(comb(50));
    expect_cover(spiral(500));
}

TEST(Triangulate, HugePolygonsTakeNoLongTime) {
    for (const auto& polygon : {comb(5000), spiral(10000)}) {
        // In a plane of two axes, so that rounding moves no corner out of it.
        TriangleMesh mesh;
        std::vector<glm::dvec2> rounded;
        mesh.positions.reserve(polygon.size());
        rounded.reserve(polygon.size());
        for (const glm::dvec2& point : polygon) {
            mesh.positions.emplace_back(point.y, 0.0f, point.x);
            rounded.emplace_back(mesh.positions.back().z, mesh.positions.back().x);
        }
        const auto start = std::clock();
        mesh.triangles = triangles_of(mesh.positions);
        EXPECT_LT(std::clock() - start, 20 * CLOCKS_PER_SEC);
        EXPECT_EQ(mesh.num_triangles(), polygon.size() - 2);
        EXPECT_NEAR(area(mesh), std::abs(signed_area(rounded)), 1e-9 * area(mesh));
    }
}

TEST(Triangulate, PolygonsWithoutATriangulationStillGiveValidIndices) {
    EXPECT_EQ(triangles_of(lifted({{0, 0}, {1, 1}, {1, 0}, {0, 1}})).size(), 2u) << "a bow tie";
    EXPECT_EQ(triangles_of(std::vector<glm::vec3>(7, glm::vec3(1.0f))).size(), 5u) << "a point";
    EXPECT_EQ(triangles_of(lifted({{0, 0}, {1, 0}, {2, 0}, {3, 0}})).size(), 2u) << "a line";
    EXPECT_EQ(triangles_of(lifted({{0, 0}, {2, 0}, {2, 0}, {2, 2}, {0, 2}})).size(), 3u)
        << "a doubled corner";
}

TEST(Triangulate, AHugeScribbleIsGivenUpQuickly) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> coordinate(0.0, 1.0);
    std::vector<glm::dvec2> scribble(20000);
    for (glm::dvec2& point : scribble)
        point = {coordinate(random), coordinate(random)};
    const auto start = std::clock();
    expect_refusal([&] { return triangles_of(lifted(scribble)).size(); }, "takes too long");
    EXPECT_LT(std::clock() - start, 20 * CLOCKS_PER_SEC);
}

} // namespace
} // namespace relumine::mesh
