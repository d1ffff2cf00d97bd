#include "relumine/in/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "files/hash.h"
#include "mesh/floor.h"
#include "mesh/normals.h"
#include "mesh/save.h"
#include "prt/scene/scene_file.h"
#include "tests/prt/scenes.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

class MeshFile : public scenes::InFolder {};

TEST_F(MeshFile, KnowsItsOriginAndItsFloor) {
    const mesh::TriangleMesh squares = scenes::two_squares();
    mesh::save(file("squares.ply"), squares);

    const Mesh plain = load_mesh(file("squares.ply"));
    EXPECT_EQ(plain.geometry.positions, squares.positions);
    EXPECT_EQ(plain.source, file("squares.ply").string());
    EXPECT_EQ(plain.source_hash, files::file_hash(file("squares.ply")));
    EXPECT_EQ(plain.floor_vertices, 0u);

    const Mesh standing =
        load_mesh(file("squares.ply"), {.floor_vertices = 5, .floor_scale = 2.0f});
    mesh::TriangleMesh expected = mesh::load(file("squares.ply"));
    mesh::append_floor(expected, 5, 2.0f);
    EXPECT_EQ(standing.geometry.positions, expected.positions);
    EXPECT_EQ(standing.floor_vertices, 5u);
}

TEST_F(MeshFile, SaysThatItHasAGroundWhereAFloorIsAskedFor) {
    mesh::TriangleMesh ball = scenes::icosphere(1, 1.0f, glm::vec3(0));
    mesh::save(file("ball.ply"), ball);
    mesh::append_floor(ball, 5, 4.0f);
    mesh::save(file("standing.ply"), ball);
    const auto num_said = [&](const char* name, std::optional<std::uint32_t> n) {
        const Mesh mesh = load_mesh(file(name), {.floor_vertices = n});
        return std::count(
            mesh.geometry.warnings.begin(), mesh.geometry.warnings.end(),
            "stands on a ground of its own: the added floor lies at the same height, leave it out");
    };
    EXPECT_EQ(num_said("standing.ply", 5), 1);
    EXPECT_EQ(num_said("standing.ply", std::nullopt), 0);
    EXPECT_EQ(num_said("ball.ply", 5), 0);
}

TEST_F(MeshFile, IsTurnedUpright) {
    const mesh::TriangleMesh squares = scenes::two_squares();
    mesh::save(file("squares.ply"), squares);
    const Mesh turned = load_mesh(file("squares.ply"), {.up = mesh::UpAxis::Z});
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(turned.geometry.normals[i], glm::vec3(0, 0, -1));
        EXPECT_EQ(turned.geometry.positions[i].y, squares.positions[i].z);
    }
}

/// A cube of STL: eight corners, each with the normals of three faces.
TEST_F(MeshFile, OfStlHasSharpEdgesUnlessTheyAreToBeSmooth) {
    std::string text = "solid s\n";
    const std::array<std::array<int, 4>, 6> faces = {
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& face : faces)
        for (const auto& corners :
             {std::array{face[0], face[1], face[2]}, std::array{face[0], face[2], face[3]}}) {
            text += "facet normal 0 0 0\nouter loop\n";
            for (const int corner : corners)
                text += fmt::format("vertex {} {} {}\n", corner & 1, corner >> 1 & 1, corner >> 2);
            text += "endloop\nendfacet\n";
        }
    const std::filesystem::path path = file("cube.stl");
    std::ofstream(path) << text << "endsolid s\n";
    const Mesh sharp = load_mesh(path);
    EXPECT_EQ(sharp.geometry.num_vertices(), 24u);
    for (const glm::vec3& normal : sharp.geometry.normals)
        EXPECT_NEAR(std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}), 1.0f,
                    1e-6f);
    EXPECT_EQ(load_mesh(path, {.normals = mesh::NormalSource::Smooth}).geometry.num_vertices(), 8u);
    EXPECT_EQ(load_mesh(path, {.crease = 120.0f}).geometry.num_vertices(), 8u);
}

TEST_F(MeshFile, RefinedKeepsTheFloorLastAndTheBlockersAsTheyWere) {
    Mesh mesh(scenes::two_squares());
    mesh::append_floor(mesh.geometry, 3);
    mesh.floor_vertices = 3;
    const mesh::TriangleMesh before = mesh.geometry;
    const std::size_t num_own = before.num_vertices() - 9;
    const Mesh fine = refined(mesh, {.error = 0.0f, .max_vertices = 300});
    ASSERT_TRUE(fine.blockers);
    EXPECT_EQ(fine.blockers->positions, before.positions);
    EXPECT_EQ(fine.blockers->triangles, before.triangles);
    const std::vector<glm::vec3>& positions = fine.geometry.positions;
    EXPECT_TRUE(std::equal(before.positions.begin(),
                           before.positions.begin() + static_cast<std::ptrdiff_t>(num_own),
                           positions.begin()));
    ASSERT_GT(fine.floor_added, 0u);
    const std::size_t first = positions.size() - 9 - fine.floor_added;
    for (std::size_t i = 0; i < 9; ++i)
        EXPECT_EQ(positions[first + i], before.positions[num_own + i]);
    for (std::size_t i = 0; i < positions.size(); ++i)
        EXPECT_EQ(positions[i].y == before.positions.back().y, i >= first) << i;
    // The scene knows its floor.
    const Scene scene = unclustered_scene(fine);
    EXPECT_TRUE(scene.blockers);
    // A curved surface throws its own shadows.
    EXPECT_FALSE(refined(mesh, {.error = {}, .max_edge = 0.3f, .curved = true}).blockers);
    EXPECT_THROW(static_cast<void>(refined(mesh, {.max_vertices = 3})), std::runtime_error);
}

TEST_F(MeshFile, SimplifiedKeepsTheFloorAndTheBlockers) {
    Mesh mesh(scenes::two_squares());
    mesh::append_floor(mesh.geometry, 5);
    mesh.floor_vertices = 5;
    const Mesh coarse = simplified(mesh, 4);
    ASSERT_TRUE(coarse.blockers);
    EXPECT_EQ(coarse.blockers->positions, mesh.geometry.positions);
    EXPECT_TRUE(std::equal(mesh.geometry.positions.end() - 25, mesh.geometry.positions.end(),
                           coarse.geometry.positions.end() - 25));
    EXPECT_THROW(static_cast<void>(simplified(mesh, 2)), std::runtime_error);
}

TEST_F(MeshFile, ThatIsAbsentIsNamed) {
    try {
        static_cast<void>(load_mesh(file("absent.ply")));
        FAIL() << "loaded a mesh that is not there";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("absent.ply"), std::string::npos);
    }
}

TEST(RefinedMesh, TheFloorSinksUnderACurvedMesh) {
    // An octahedron of radius 1 whose normals are a ball's, lying on two of its lower triangles'
    // common edge: the curved edge bulges below it.
    mesh::TriangleMesh octahedron;
    const float s = std::sqrt(0.5f);
    octahedron.positions = {{s, s, 0}, {-s, s, 0}, {-s, -s, 0}, {s, -s, 0}, {0, 0, 1}, {0, 0, -1}};
    octahedron.normals = octahedron.positions;
    octahedron.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4},
                            {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}};
    mesh::append_floor(octahedron, 2);
    Mesh mesh(octahedron);
    mesh.floor_vertices = 2;
    const float height = octahedron.positions.back().y;
    const Mesh flat = refined(mesh, {.error = {}, .max_edge = 0.3f});
    EXPECT_EQ(flat.geometry.positions.back().y, height);
    const Mesh curved = refined(mesh, {.error = {}, .max_edge = 0.3f, .curved = true});
    const std::size_t num_of_ball = curved.geometry.num_vertices() - 4 - curved.floor_added;
    float lowest = 0.0f, highest_of_floor = -10.0f;
    for (std::size_t i = 0; i < curved.geometry.num_vertices(); ++i) {
        const float y = curved.geometry.positions[i].y;
        if (i < num_of_ball)
            lowest = std::min(lowest, y);
        else
            highest_of_floor = std::max(highest_of_floor, y);
    }
    EXPECT_LT(lowest, height) << "it bulges";
    EXPECT_LT(highest_of_floor, lowest);
    EXPECT_NEAR(lowest - highest_of_floor, -s - height, 1e-6f) << "as far below as before";
    EXPECT_EQ(curved.geometry.positions[3], octahedron.positions[3]);
}

/// A wall of two triangles whose corners are under posts.
mesh::TriangleMesh wall_behind_posts() {
    mesh::TriangleMesh mesh;
    mesh.positions = {{-2, 0, 0}, {2, 0, 0}, {2, 2, 0}, {-2, 2, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    for (const glm::vec3 corner :
         {glm::vec3(-2, 0, 0), glm::vec3(2, 0, 0), glm::vec3(2, 2, 0), glm::vec3(-2, 2, 0)}) {
        const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
        for (std::uint32_t i = 0; i < 8; ++i) {
            const glm::vec3 way((i & 1u) != 0 ? 1 : -1, (i & 2u) != 0 ? 1 : -1,
                                (i & 4u) != 0 ? 1 : -1);
            mesh.positions.push_back(corner + 0.15f * way);
            mesh.normals.push_back(glm::normalize(way));
        }
        for (const mesh::Triangle& t : {mesh::Triangle{0, 2, 1},
                                        {1, 2, 3},
                                        {4, 5, 6},
                                        {5, 7, 6},
                                        {0, 1, 4},
                                        {1, 5, 4},
                                        {2, 6, 3},
                                        {3, 6, 7},
                                        {0, 4, 2},
                                        {2, 4, 6},
                                        {1, 3, 5},
                                        {3, 7, 5}})
            mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return mesh;
}

PrecomputeOptions small_work() {
    return {.face_resolution = 32};
}

/// The light of the first triangle's centre under a white sky, and of the whole mesh.
float light_in_the_middle(const LitScene& lit) {
    const mesh::TriangleMesh& mesh = lit.scene().mesh;
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        const glm::vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        if (p.z != 0.0f || q.z != 0.0f || r.z != 0.0f)
            continue;
        const glm::vec2 u(q - p), v(r - p), w(glm::vec2(0.01f, 1.02f) - glm::vec2(p));
        const float all = u.x * v.y - u.y * v.x;
        const glm::vec2 place((w.x * v.y - w.y * v.x) / all, (u.x * w.y - u.y * w.x) / all);
        if (place.x >= 0.0f && place.y >= 0.0f && place.x + place.y <= 1.0f)
            return prt::value_at(mesh, lit.radiance(), {i, place}).g;
    }
    return -1.0f;
}

TEST(RefinedByItself, AWallWhoseCornersAreHiddenIsLit) {
    const Mesh wall(wall_behind_posts());
    PrecomputeReport report;
    LitScene lit(precompute(wall, small_work(), {}, &report));
    lit.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
    ASSERT_TRUE(report.refined);
    EXPECT_EQ(report.num_vertices, wall.geometry.num_vertices() + report.refined->num_added);
    EXPECT_LE(report.refined->num_added, BudgetOfMesh);
    EXPECT_GT(light_in_the_middle(lit), 0.9f);
    EXPECT_TRUE(std::equal(wall.geometry.positions.begin(), wall.geometry.positions.end(),
                           lit.scene().mesh.positions.begin()));
    EXPECT_EQ(lit.scene().settings.tolerance, ToleranceOfRefined);
    // What is worst is said: the light of the vertices and of the points between them.
    const Verification check = verify(lit, {.num_samples = 50, .num_surface_points = 50});
    ASSERT_TRUE(check.surface && check.picture);
    EXPECT_EQ(worst_of(check).relative_l2,
              std::max({check.error.relative_l2, check.surface->error.relative_l2,
                        check.picture->error.relative_l2}));

    // The vertices as they are know nothing of the light between them.
    PrecomputeOptions as_it_is = small_work();
    as_it_is.no_refine = true;
    LitScene dark(precompute(wall, as_it_is, {}, &report));
    dark.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
    EXPECT_FALSE(report.refined);
    EXPECT_EQ(dark.scene().mesh.positions, wall.geometry.positions);
    EXPECT_LT(light_in_the_middle(dark), 0.1f);
    const Verification bad = verify(dark, {.num_samples = 0, .num_surface_points = 100});
    EXPECT_LT(bad.error.relative_l2, 0.05);
    EXPECT_GT(worst_of(bad).relative_l2, 0.2);
    EXPECT_NE(worst_of(bad).place, VerifiedPlaces[0]);
}

TEST(RefinedByItself, BothSidesOfASheetStayOnOneAnother) {
    // A sheet that stands out over a block: its back is hidden where the block is.
    mesh::TriangleMesh mesh = scenes::box({-1.0f, -1.0f, -1.0f}, {0.1f, -1e-3f, 1.0f});
    const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
    for (const float x : {-1.2f, 1.0f})
        for (const float z : {-1.2f, 1.2f}) {
            mesh.positions.emplace_back(x, 0.0f, z);
            mesh.normals.emplace_back(0.0f, 1.0f, 0.0f);
        }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first + 1, first + 3, first + 2});
    const Mesh fine = refined_by_itself(Mesh(std::move(mesh)));
    std::multiset<std::pair<float, float>> fronts, backs;
    for (std::size_t i = 0; i < fine.geometry.num_vertices(); ++i)
        if (const glm::vec3& at = fine.geometry.positions[i]; at.y == 0.0f)
            (fine.geometry.normals[i].y > 0.0f ? fronts : backs).insert({at.x, at.z});
    EXPECT_GT(backs.size(), 100u);
    EXPECT_EQ(fronts, backs);
}

TEST(RefinedByItself, AFineMeshAndChosenVerticesStay) {
    const Mesh fine(scenes::corner(64));
    EXPECT_EQ(refined_by_itself(fine).geometry.positions, fine.geometry.positions);
    EXPECT_FALSE(refined_by_itself(fine).blockers);
    const Mesh chosen = refined(Mesh(wall_behind_posts()), {.error = {}, .max_edge = 1.0f});
    EXPECT_EQ(refined_by_itself(chosen).geometry.positions, chosen.geometry.positions);
    // Pixels need no vertices.
    PrecomputeReport report;
    PrecomputeOptions pixels = small_work();
    pixels.receivers = Pixels{.width = 8, .height = 6};
    pixels.view = View{};
    EXPECT_EQ(precompute(Mesh(wall_behind_posts()), pixels, {}, &report).mesh.num_vertices(),
              wall_behind_posts().num_vertices());
}

/// A box whose faces share no vertices and look inwards or outwards. Each has a sixth of the atlas.
mesh::TriangleMesh box_of_faces(const glm::vec3& low, const glm::vec3& high, bool inwards) {
    mesh::TriangleMesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (const int side : {0, 1}) {
            const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
            const glm::vec2 corner(static_cast<float>(axis) / 3.0f,
                                   static_cast<float>(side) / 2.0f);
            for (const glm::ivec2 at : {glm::ivec2(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
                glm::vec3 part(0.0f), normal(0.0f);
                part[axis] = static_cast<float>(side);
                part[(axis + 1) % 3] = static_cast<float>(at.x);
                part[(axis + 2) % 3] = static_cast<float>(at.y);
                normal[axis] = (side == 1) == inwards ? -1.0f : 1.0f;
                mesh.positions.push_back(low + part * (high - low));
                mesh.normals.push_back(normal);
                mesh.uvs.push_back(corner + glm::vec2(0.03f) +
                                   glm::vec2(at) * glm::vec2(0.27f, 0.44f));
            }
            const bool turns = (side == 1) == inwards;
            const std::uint32_t second = first + (turns ? 3 : 1), last = first + (turns ? 1 : 3);
            mesh.triangles.push_back({first, second, first + 2});
            mesh.triangles.push_back({first, first + 2, last});
        }
    return mesh;
}

/// Light on backs is not asked.
mesh::TriangleMesh of_one_side(mesh::TriangleMesh mesh) {
    mesh.materials = {{.is_double_sided = false}};
    mesh.triangle_materials.assign(mesh.num_triangles(), 0);
    return mesh;
}

/// A room without a window; a ball and a crate stand on its floor, which is a single sheet.
mesh::TriangleMesh closed_room() {
    mesh::TriangleMesh ball = scenes::icosphere(2, 0.6f, {-0.8f, 0, 0});
    float lowest = 0.0f;
    for (const glm::vec3& at : ball.positions)
        lowest = std::min(lowest, at.y);
    for (glm::vec3& at : ball.positions)
        at.y -= lowest;
    mesh::TriangleMesh mesh = box_of_faces({-2, 0, -2.5f}, {2, 3, 2.5f}, true);
    const mesh::TriangleMesh crate = box_of_faces({0.6f, 0, -1.4f}, {1.4f, 0.8f, -0.6f}, false);
    mesh.uvs.clear();
    return of_one_side(scenes::joined(scenes::joined(mesh, ball), crate));
}

bool is_black(const glm::vec3& value) {
    return value == glm::vec3(0.0f);
}

TEST(ClosedRoom, IsBlackToTheLastBit) {
    for (const bool is_refined : {true, false}) {
        PrecomputeOptions options = small_work();
        options.no_refine = !is_refined;
        LitScene lit(precompute(Mesh(closed_room()), options));
        lit.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
        EXPECT_TRUE(std::all_of(lit.radiance().begin(), lit.radiance().end(), is_black));
    }
}

TEST(ClosedRoom, TexelsOnTheVeryEdgeOfAWallSeeNothingBehindTheNext) {
    PrecomputeOptions options = small_work();
    options.receivers = Texels{.width = 96, .height = 96};
    LitScene lit(
        precompute(Mesh(box_of_faces({-2, -1.5f, -2.5f}, {2, 1.5f, 2.5f}, true)), options));
    lit.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
    EXPECT_GT(lit.radiance().size(), 5000u);
    EXPECT_TRUE(std::all_of(lit.radiance().begin(), lit.radiance().end(), is_black));
}

TEST(RefinedByItself, NoLightIsLentThroughASheet) {
    // A ball that touches a sheet with its lowest vertex. From below, the sheet is lit.
    mesh::TriangleMesh mesh = scenes::icosphere(3, 1.0f, {0, 0, 0});
    float lowest = 0.0f;
    for (const glm::vec3& at : mesh.positions)
        lowest = std::min(lowest, at.y);
    for (glm::vec3& at : mesh.positions)
        at.y -= lowest;
    mesh::TriangleMesh sheet = box_of_faces({-4, -1, -4}, {4, 0, 4}, false);
    sheet.uvs.clear();
    // Of the box only its upper face is there.
    sheet.triangles = {sheet.triangles[6], sheet.triangles[7]};
    LitScene lit(precompute(Mesh(of_one_side(scenes::joined(mesh, sheet))), small_work()));
    lit.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
    const std::vector<glm::vec3>& at = lit.scene().mesh.positions;
    std::size_t num_near = 0;
    for (std::size_t i = 0; i < at.size(); ++i)
        if (at[i].y < 0.02f && std::max(std::abs(at[i].x), std::abs(at[i].z)) < 0.15f) {
            ++num_near;
            EXPECT_LT(lit.radiance()[i].g, 0.1f) << at[i].x << " " << at[i].y << " " << at[i].z;
        }
    EXPECT_GT(num_near, 3u);
    // What is asked without lifts agrees.
    EXPECT_LT(verify(lit, {.num_samples = 0, .num_surface_points = 0}).error.max_abs, 0.1);
}

TEST_F(MeshFile, LiftsOfRefinedVerticesStandInTheScene) {
    mesh::TriangleMesh tent;
    tent.positions = {{-1, 0, -1}, {-1, 0, 1}, {0, 0.5f, -1}, {0, 0.5f, 1}, {1, 0, -1}, {1, 0, 1}};
    tent.triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};
    tent.normals = mesh::smooth_normals(tent);
    const Scene scene = precompute(Mesh(tent), small_work());
    ASSERT_EQ(scene.mesh.lifts.size(), scene.mesh.num_vertices());
    EXPECT_NE(scene.receivers.positions, scene.mesh.positions);
    save_scene(file("tent.prt"), scene);
    const Scene loaded = load_scene(file("tent.prt"));
    EXPECT_EQ(loaded.mesh.lifts, scene.mesh.lifts);
    EXPECT_EQ(loaded.receivers.positions, scene.receivers.positions);
    // A sheet has a back, which light from below reaches.
    EXPECT_GE(scene.mesh.num_triangles(), 2 * tent.num_triangles());
}

/// The light of a point lamp, as interpolation between vertices has it: sums over triangles.
struct LampOnVertices {
    double all = 0.0, worst = 0.0;

    /// `exact` is the light at a place, `mean` its mean.
    LampOnVertices(const mesh::TriangleMesh& mesh, const std::function<double(glm::dvec3)>& exact,
                   double mean) {
        for (const mesh::Triangle& triangle : mesh.triangles) {
            if (mesh.normals[triangle[0]].y < 0.0f) // the back of the sheet
                continue;
            std::array<glm::dvec3, 3> corners{};
            double sum = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                corners[k] = glm::dvec3(mesh.positions[triangle[k]]);
                sum += exact(corners[k]) / 3.0;
            }
            all += 0.5 * sum *
                   glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
            const double inside = exact((corners[0] + corners[1] + corners[2]) / 3.0);
            worst = std::max(worst, std::abs(sum - inside) / (inside + mean));
        }
    }
};

TEST(RefinedByItself, ALampOverTwoTrianglesGivesAllOfItsLight) {
    constexpr double HalfSide = 4.0, Intensity = 3.0;
    mesh::TriangleMesh square = scenes::floor_grid(2, static_cast<float>(2.0 * HalfSide));
    ASSERT_EQ(square.num_triangles(), 2u);
    const glm::dvec3 lamp(0.0, 1.0, 0.0);
    square.lights = {{.intensity = glm::vec3(Intensity), .position = glm::vec3(lamp)}};
    const auto exact = [&](const glm::dvec3& at) {
        const double distance = glm::distance(at, lamp);
        return Intensity / (std::numbers::pi * distance * distance * distance);
    };
    // The solid angle of the square from the lamp.
    const double all = Intensity / std::numbers::pi * 4.0 *
                       std::asin(HalfSide * HalfSide / (HalfSide * HalfSide + lamp.y * lamp.y));
    const double mean = all / (4.0 * HalfSide * HalfSide);
    const LampOnVertices before(square, exact, mean);
    EXPECT_LT(before.all, 0.2 * all);
    const Mesh fine = refined_by_itself(Mesh(square));
    const LampOnVertices after(fine.geometry, exact, mean);
    EXPECT_NEAR(after.all, all, 0.005 * all);
    EXPECT_LT(after.worst, 0.02);
    // Without the lamp there is nothing to see on a square.
    square.lights.clear();
    EXPECT_LT(refined_by_itself(Mesh(square)).geometry.num_vertices(),
              fine.geometry.num_vertices() / 4);
}

TEST(RefinedByItself, AnAutomaticFloorGetsVerticesWhereShadowsFall) {
    Mesh mesh(wall_behind_posts());
    add_floor(mesh, {.floor_vertices = AutomaticFloor});
    const std::uint32_t n = mesh.floor_vertices;
    const std::size_t first = mesh.geometry.num_vertices() - std::size_t{n} * n;
    const Mesh fine = refined_by_itself(mesh);
    ASSERT_GT(fine.floor_added, 100u);
    EXPECT_LE(fine.floor_added, BudgetOfFloor);
    EXPECT_EQ(fine.floor_vertices, n);
    const std::size_t first_after =
        fine.geometry.num_vertices() - std::size_t{n} * n - fine.floor_added;
    const auto before = mesh::floor_place(std::span(mesh.geometry.positions).subspan(first), n);
    const auto after =
        mesh::floor_place(std::span(fine.geometry.positions).subspan(first_after), n);
    EXPECT_EQ(after.center, before.center);
    EXPECT_EQ(after.half_side, before.half_side);
    const float height = mesh.geometry.positions[first].y;
    std::size_t num_near = 0;
    for (std::size_t i = first_after + std::size_t{n} * n; i < fine.geometry.num_vertices(); ++i) {
        EXPECT_EQ(fine.geometry.positions[i].y, height);
        num_near +=
            glm::distance(glm::vec2(fine.geometry.positions[i].x, fine.geometry.positions[i].z),
                          before.center) < 0.5f * before.half_side
                ? 1
                : 0;
    }
    EXPECT_GT(num_near, fine.floor_added / 2) << "a quarter of the area, most of the shadow";
    // A floor of a chosen size stays.
    Mesh chosen(wall_behind_posts());
    add_floor(chosen, {.floor_vertices = 5});
    EXPECT_EQ(refined_by_itself(chosen).floor_added, 0u);
    // The floor is not the file's.
    PrecomputeOptions as_it_is = small_work();
    as_it_is.no_refine = true;
    const Scene scene = precompute(mesh, as_it_is);
    EXPECT_GT(scene.settings.floor_added, 100u);
    EXPECT_EQ(first_floor_vertex(scene), first);
}

TEST(MeshInCode, WithoutNormalsAndWithAWrongIndexIsRefused) {
    mesh::TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 3'000'000'000}};
    try {
        static_cast<void>(sound(Mesh(mesh)));
        ADD_FAILURE() << "it is sound";
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(), "expected vertices below 3, got 3000000000 of triangle 0");
    }
}

} // namespace
} // namespace relumine
