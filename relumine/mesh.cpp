#include "relumine/mesh.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "mesh/customs.h"
#include "mesh/floor.h"
#include "mesh/half_edge/simplify.h"
#include "mesh/normals.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"

namespace relumine {

namespace {

/// What rays need of a mesh.
mesh::TriangleMesh blockers_of(const mesh::TriangleMesh& mesh) {
    mesh::TriangleMesh blockers;
    blockers.positions = mesh.positions;
    blockers.triangles = mesh.triangles;
    return blockers;
}

/// Moves the floor's vertices to the end, those of `num_old` first. Returns how many of the floor
/// are new.
std::uint32_t move_floor_last(mesh::TriangleMesh& mesh, std::size_t first_of_floor,
                              std::size_t num_old) {
    std::vector<bool> is_floor(mesh.num_vertices());
    std::fill(is_floor.begin() + static_cast<std::ptrdiff_t>(first_of_floor),
              is_floor.begin() + static_cast<std::ptrdiff_t>(num_old), true);
    // The floor is a group of its own.
    const std::uint32_t group = mesh.triangle_groups[static_cast<std::size_t>(
        std::find_if(mesh.triangles.begin(), mesh.triangles.end(),
                     [&](const mesh::Triangle& triangle) { return is_floor[triangle[0]]; }) -
        mesh.triangles.begin())];
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        for (const std::uint32_t vertex : mesh.triangles[i])
            is_floor[vertex] =
                is_floor[vertex] || (mesh.triangle_groups[i] == group && vertex >= num_old);
    std::vector<std::uint32_t> order(mesh.num_vertices());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_partition(order.begin(), order.end(),
                          [&](std::uint32_t vertex) { return !is_floor[vertex]; });
    std::vector<std::uint32_t> places(order.size());
    for (std::uint32_t place = 0; place < order.size(); ++place)
        places[order[place]] = place;
    const auto sort = [&](auto& values) {
        if (values.empty())
            return;
        auto sorted = values;
        for (std::size_t place = 0; place < order.size(); ++place)
            sorted[place] = values[order[place]];
        values = std::move(sorted);
    };
    sort(mesh.positions);
    sort(mesh.normals);
    sort(mesh.colors);
    sort(mesh.uvs);
    for (mesh::Triangle& triangle : mesh.triangles)
        for (std::uint32_t& vertex : triangle)
            vertex = places[vertex];
    const auto num_floor =
        static_cast<std::size_t>(std::count(is_floor.begin(), is_floor.end(), true));
    return static_cast<std::uint32_t>(num_floor - (num_old - first_of_floor));
}

/// Returns the vertices [begin, end) and the triangles between them.
mesh::TriangleMesh part_of(const mesh::TriangleMesh& mesh, std::size_t begin, std::size_t end) {
    mesh::TriangleMesh part = mesh;
    const auto keep_vertices = [&](auto& values) {
        if (!values.empty())
            values = {values.begin() + static_cast<std::ptrdiff_t>(begin),
                      values.begin() + static_cast<std::ptrdiff_t>(end)};
    };
    keep_vertices(part.positions);
    keep_vertices(part.normals);
    keep_vertices(part.colors);
    keep_vertices(part.uvs);
    const auto keep_triangles = [&](auto& values) {
        if (values.empty())
            return;
        std::size_t place = 0;
        for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
            if (mesh.triangles[i][0] >= begin && mesh.triangles[i][0] < end)
                values[place++] = values[i];
        values.resize(place);
    };
    keep_triangles(part.triangles);
    keep_triangles(part.corner_uvs);
    keep_triangles(part.triangle_materials);
    keep_triangles(part.triangle_groups);
    for (mesh::Triangle& triangle : part.triangles)
        for (std::uint32_t& vertex : triangle)
            vertex -= static_cast<std::uint32_t>(begin);
    return part;
}

/// Appends a part of the same mesh: materials and groups are the same.
void append(mesh::TriangleMesh& mesh, const mesh::TriangleMesh& part) {
    const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
    const auto add = [](auto& values, const auto& others) {
        values.insert(values.end(), others.begin(), others.end());
    };
    add(mesh.positions, part.positions);
    add(mesh.normals, part.normals);
    add(mesh.colors, part.colors);
    add(mesh.uvs, part.uvs);
    add(mesh.corner_uvs, part.corner_uvs);
    add(mesh.triangle_materials, part.triangle_materials);
    add(mesh.triangle_groups, part.triangle_groups);
    for (const auto& [a, b, c] : part.triangles)
        mesh.triangles.push_back({a + first, b + first, c + first});
}

std::string prefix_of(const Mesh& mesh) {
    return mesh.source.empty() ? "" : mesh.source + ": ";
}

} // namespace

OptionRow crease_row(std::optional<float>& degrees) {
    return row("--crease", degrees,
               "normals from the faces: smooth over edges up to so many degrees, broken beyond",
               {.min = 0, .max = 180, .type = "DEGREES"});
}

OptionTable options_of(MeshOptions& o) {
    return {
        row("--floor", o.floor_vertices,
            "add a floor of N x N vertices under the mesh; 193 when no N is given",
            {.min = 2, .max = 65535, .type = "[N]", .bare = "193"}),
        row("--floor-scale", o.floor_scale,
            "side of the floor over the mesh's width, or half its height if that is more",
            {.min = 1e-6, .max = 1e6, .needs = "--floor"}),
        row("--up", o.up, "the mesh's axis that points up (y; z for .stl, which comes from CAD)"),
        row("--normals", o.normals,
            "vertex normals: the file's where it has them, or always smooth"),
        crease_row(o.crease)};
}

OptionTable options_of(RefineOptions& o) {
    return {row("--error", o.error,
                "split edges while the light at their middle may differ so much from the mean of "
                "their ends: RMS of the transfer, 1/sr",
                {.min = 0, .max = 1}),
            row("--max-vertices", o.max_vertices,
                "let the mesh grow to so many vertices; the edges that matter most come first",
                {.min = 1, .max = 4294967294.0, .type = "N", .shows_default = false}),
            row("--min-edge", o.min_edge,
                "leave no edges shorter than this, in the mesh's unit (1/1000 of its diagonal)",
                {.min = 0, .max = LargestPosition, .type = "LENGTH"}),
            row("--max-edge", o.max_edge, "split all edges that are longer than this",
                {.min = 0, .max = LargestPosition, .type = "LENGTH"}),
            row("--curved", o.curved,
                "put new vertices on the smooth surface that the normals pretend")};
}

Mesh load_mesh(const std::filesystem::path& path, const MeshOptions& options) {
    Mesh mesh;
    mesh.geometry = mesh::load(path, options.normals, &mesh.source_hash);
    mesh.source = path.string();
    const std::optional<float> crease =
        options.crease || options.normals == mesh::NormalSource::Smooth
            ? options.crease
            : mesh::customary_crease(path);
    if (crease)
        mesh.geometry = mesh::with_creases(mesh.geometry, *crease);
    mesh::turn_up(mesh.geometry, options.up.value_or(mesh::customary_up(path)));
    if (options.floor_vertices) {
        mesh::append_floor(mesh.geometry, *options.floor_vertices, options.floor_scale);
        mesh.floor_vertices = *options.floor_vertices;
    }
    return mesh;
}

namespace {

float lowest(std::span<const glm::vec3> positions) {
    float result = std::numeric_limits<float>::infinity();
    for (const glm::vec3& position : positions)
        result = std::min(result, position.y);
    return result;
}

} // namespace

Mesh refined(Mesh mesh, const RefineOptions& options, const prt::Work& work, RefineReport* report) {
    const mesh::TriangleMesh& before = mesh.blockers ? *mesh.blockers : mesh.geometry;
    const std::size_t num_old = mesh.geometry.num_vertices();
    const std::size_t n = mesh.floor_vertices;
    const std::size_t first_of_floor = num_old - (n == 0 ? 0 : n * n + mesh.floor_added);
    const float lowest_before = lowest(std::span(mesh.geometry.positions).first(first_of_floor));
    mesh::TriangleMesh after;
    try {
        const prt::RayScene rays(before, prt::RayScene::Packets::Wide);
        const prt::BeamScene beams(before, rays);
        after = prt::refine(mesh.geometry, beams, options, work, report);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(prefix_of(mesh) + error.what());
    }
    if (options.curved)
        mesh.blockers.reset();
    else if (!mesh.blockers)
        mesh.blockers = blockers_of(mesh.geometry);
    mesh.geometry = std::move(after);
    if (n == 0)
        return mesh;
    mesh.floor_added += move_floor_last(mesh.geometry, first_of_floor, num_old);
    // Curved surfaces may bulge downwards. The floor goes down with the lowest point.
    const std::span<glm::vec3> positions(mesh.geometry.positions);
    const std::size_t num_of_mesh = positions.size() - n * n - mesh.floor_added;
    const float sunk = lowest_before - lowest(positions.first(num_of_mesh));
    if (sunk > 0.0f)
        for (glm::vec3& position : positions.subspan(num_of_mesh))
            position.y -= sunk;
    return mesh;
}

Mesh simplified(Mesh mesh, std::size_t num_vertices) {
    if (!mesh.blockers)
        mesh.blockers = blockers_of(mesh.geometry);
    const std::size_t n = mesh.floor_vertices;
    const std::size_t first_of_floor =
        mesh.geometry.num_vertices() - (n == 0 ? 0 : n * n + mesh.floor_added);
    const mesh::TriangleMesh floor =
        part_of(mesh.geometry, first_of_floor, mesh.geometry.num_vertices());
    try {
        mesh.geometry = mesh::simplified(part_of(mesh.geometry, 0, first_of_floor), num_vertices);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(prefix_of(mesh) + error.what());
    }
    append(mesh.geometry, floor);
    return mesh;
}

} // namespace relumine
