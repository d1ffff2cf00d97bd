#include "relumine/in/mesh.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "cubemap/luminance.h"
#include "mesh/customs.h"
#include "mesh/floor.h"
#include "mesh/half_edge/simplify.h"
#include "mesh/half_edge/winding.h"
#include "mesh/normals.h"
#include "mesh/opacity.h"
#include "mesh/subject.h"
#include "prt/lamps/lamps.h"
#include "prt/memory_estimate.h"
#include "prt/refinement/lit_backs.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/lamps/lamp_light.h"
#include "relight/pictures/framing.h"
#include "relumine/in/stages.h"
#include "relumine/options/option_table.h"

namespace relumine {

namespace {

/// Whether a mesh lies on a ground that is wider than what stands on it.
bool has_ground(const mesh::TriangleMesh& mesh) {
    constexpr float WiderThanSubject = 1.5f;
    const auto width = [](const mesh::Bounds& box) {
        return std::max(box.max.x - box.min.x, box.max.z - box.min.z);
    };
    return width(mesh::extent(mesh).box) > WiderThanSubject * width(mesh::subject_bounds(mesh));
}

/// Returns how many vertices come before an added floor.
std::size_t num_without_floor(const Mesh& mesh) {
    const std::size_t n = mesh.floor_vertices;
    return mesh.geometry.num_vertices() - (n == 0 ? 0 : n * n + mesh.floor_added);
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
    mesh::for_each_vertex_array(mesh, sort);
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
    mesh::for_each_vertex_array(part, keep_vertices);
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
    keep_triangles(part.corner_tangents);
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
    add(mesh.second_uvs, part.second_uvs);
    if (!mesh.lifts.empty() || !part.lifts.empty()) {
        mesh.lifts.resize(first, glm::vec3(0.0f));
        add(mesh.lifts, part.lifts);
        mesh.lifts.resize(mesh.num_vertices(), glm::vec3(0.0f));
    }
    add(mesh.corner_uvs, part.corner_uvs);
    add(mesh.corner_tangents, part.corner_tangents);
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

OptionTable open_choices(MeshOptions& o) {
    return {row<PoseText>(
                "--pose", o.pose,
                "glTF: the moment of an animation in which skins, morph targets and nodes stand: "
                "its name or number, and seconds (they stand as the nodes say)",
                {.type = "ANIMATION@SECONDS", .example = "0@0.5"}),
            row("--variant", o.variant,
                "glTF: the variant of its materials, by name; `info` lists them (each surface has "
                "its own material)",
                {.type = "NAME", .example = "red"})};
}

OptionTable options_of(MeshOptions& o) {
    OptionTable table = {
        row<FloorText>(
            "--floor", o.floor_vertices,
            "add a floor under the mesh: a grid of N x N vertices, or auto, when no N is "
            "given: as many vertices as its shadows need",
            {.type = "[N]", .bare = "auto", .example = "193"}),
        row("--floor-scale", o.floor_scale,
            "side of the floor over the mesh's width, or half its height if that is more",
            {.min = 1e-6, .max = 1e6, .library_only = true}),
        row("--up", o.up, "the mesh's axis that points up (y; z for .stl, which comes from CAD)"),
        row("--normals", o.normals,
            "vertex normals: the file's where it has them, or always smooth",
            {.library_only = true}),
        row("--vertex-colors", o.vertex_colors,
            "what colours of vertices and faces mean (srgb for .obj, .off and bytes of .ply; "
            "linear "
            "for floats of .ply and for glTF)"),
        row("--uv-set", o.uv_set,
            "glTF: the set of uvs that a lightmap takes, n of TEXCOORD_n (1 where it is within 0 "
            "to "
            "1 and does not overlap, or 0)",
            {.min = 0, .max = 255, .type = "N"}),
        crease_row(o.crease)};
    for (OptionRow& each : open_choices(o))
        table.push_back(std::move(each));
    return table;
}

OptionTable options_of(RefineOptions& o) {
    return {row("--tolerance", o.error,
                "split edges while the light at their middle may differ so much from the mean of "
                "their ends: RMS of the transfer, 1/sr",
                {.min = 0, .max = 1}),
            row("--vertices", o.max_vertices,
                "let the mesh grow to so many vertices; the edges that matter most come first",
                {.min = 1, .max = 4294967294.0, .type = "N", .shows_default = false}),
            row("--max-edge", o.max_edge, "split all edges that are longer than this",
                {.min = 0, .max = LargestPosition, .type = "LENGTH"}),
            row("--curved", o.curved,
                "put new vertices on the smooth surface that the normals pretend")};
}

Mesh load_mesh(const std::filesystem::path& path, const MeshOptions& options) {
    mesh::LoadedMesh loaded = mesh::load(path, {.normals = options.normals,
                                                .pose = options.pose,
                                                .variant = options.variant,
                                                .colors = options.vertex_colors,
                                                .lightmap_uvs = options.uv_set.value_or(1)});
    return prepared(std::move(loaded), path, options);
}

Mesh prepared(mesh::LoadedMesh loaded, const std::filesystem::path& path,
              const MeshOptions& options) {
    Mesh mesh;
    mesh.source_hash = loaded.hash;
    mesh.camera = loaded.camera;
    const bool has_normals = loaded.has_normals;
    mesh.geometry = std::move(loaded);
    mesh.source = path.string();
    if (options.uv_set)
        mesh.lightmap_uvs = mesh.geometry.second_uvs.empty() ? 0 : 1;
    if (mesh.lightmap_uvs == 0u && *options.uv_set != 0)
        throw std::runtime_error(fmt::format("{}: expected a set of uvs TEXCOORD_{} for a "
                                             "lightmap, got none",
                                             mesh.source, *options.uv_set));
    const std::optional<float> crease =
        options.crease || options.normals == mesh::NormalSource::Smooth
            ? options.crease
            : mesh::customary_crease(path);
    if (crease)
        mesh.geometry = mesh::with_creases(mesh.geometry, *crease);
    if (has_normals && !crease)
        mesh::settle_normals(mesh.geometry);
    const mesh::UpAxis up = options.up.value_or(mesh::customary_up(path));
    mesh::turn_up(mesh.geometry, up);
    for (std::string& line : mesh::doubts_of_size(mesh.geometry))
        mesh.geometry.warnings.push_back(std::move(line));
    if (mesh.camera)
        mesh::turn_up(*mesh.camera, up);
    if (options.floor_vertices && has_ground(mesh.geometry))
        mesh.geometry.warnings.emplace_back(
            "stands on a ground of its own: the added floor lies at the same height, leave it out");
    add_floor(mesh, options);
    return mesh;
}

std::uint32_t FloorText::read(const std::string& text) {
    if (text == "auto")
        return AutomaticFloor;
    const std::optional<std::uint32_t> n = parse_count(text);
    if (!n || *n < 2 || *n > 65535)
        refuse_text("auto or a number from 2 to 65535", text);
    return *n;
}

std::string FloorText::show(std::uint32_t n) {
    return n == AutomaticFloor ? "auto" : fmt::format("{}", n);
}

mesh::Pose PoseText::read(const std::string& text) {
    const std::size_t at = text.rfind('@');
    const std::optional<double> seconds =
        at == std::string::npos ? std::nullopt : parse_number(text.substr(at + 1));
    constexpr double Longest = 1e6;
    if (at == 0 || !seconds || !(*seconds >= 0.0 && *seconds <= Longest))
        refuse_text("ANIMATION@SECONDS, such as Walk@1.5", text);
    return {.animation = text.substr(0, at), .seconds = *seconds};
}

std::string PoseText::show(const mesh::Pose& pose) {
    return fmt::format("{}@{}", pose.animation, pose.seconds);
}

void add_floor(Mesh& mesh, const MeshOptions& options) {
    // Coarse, but fine enough to begin with: half of a row is narrower than what stands on it.
    constexpr std::uint32_t NumToBegin = 25;
    if (!options.floor_vertices)
        return;
    mesh.is_floor_open = *options.floor_vertices == AutomaticFloor;
    mesh.floor_vertices = mesh.is_floor_open ? NumToBegin : *options.floor_vertices;
    const std::size_t n = mesh.floor_vertices;
    const std::uint64_t bytes =
        prt::scene_bytes({.num_vertices = mesh.geometry.num_vertices() + n * n,
                          .num_triangles = mesh.geometry.num_triangles() + 2 * (n - 1) * (n - 1),
                          .has_beams = false});
    if (options.max_memory && bytes > *options.max_memory)
        throw MemoryLimitExceeded(
            MemoryLimitExceeded::Part::Scene,
            fmt::format("{}: expected work within {}, got a floor with which the scene takes {} of "
                        "memory alone",
                        mesh.source, megabytes(*options.max_memory), megabytes(bytes)));
    mesh::append_floor(mesh.geometry, mesh.floor_vertices, options.floor_scale);
}

namespace {

float lowest(std::span<const glm::vec3> positions) {
    float result = std::numeric_limits<float>::infinity();
    for (const glm::vec3& position : positions)
        result = std::min(result, position.y);
    return result;
}

} // namespace

Mesh sound(Mesh mesh) {
    if (mesh.geometry.normals.empty())
        mesh.geometry.normals = mesh::smooth_normals(mesh.geometry);
    mesh::require_consistent(mesh.geometry);
    return mesh;
}

namespace {

/// Lets refinement see the light of a mesh's own lamps (RefineOptions::lamps). Keeps references.
void look_at_lamps(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                   RefineOptions& options) {
    prt::Lamps lamps = prt::lamps_of(mesh);
    if (lamps.empty())
        return;
    options.lamps =
        [&mesh, &rays, lamps = std::move(lamps),
         bias = options.bias.value_or(prt::automatic_bias(mesh))](const prt::Receivers& points) {
            std::vector<float> result;
            for (const glm::vec3& light : relight::lamp_light(mesh, lamps.emitters, lamps.lights,
                                                              {.positions = points.positions,
                                                               .normals = points.normals,
                                                               .rays = rays,
                                                               .bias = bias}))
                result.push_back(static_cast<float>(cubemap::luminance(light)));
            return result;
        };
}

} // namespace

Mesh refined(Mesh given, RefineOptions options, const prt::Work& work, RefineReport* report) {
    Mesh mesh = sound(std::move(given));
    const mesh::TriangleMesh& before = mesh.blockers ? *mesh.blockers : mesh.geometry;
    const std::size_t num_old = mesh.geometry.num_vertices();
    const std::size_t n = mesh.floor_vertices;
    const std::size_t first_of_floor = num_without_floor(mesh);
    const float lowest_before = lowest(std::span(mesh.geometry.positions).first(first_of_floor));
    mesh::TriangleMesh after;
    try {
        const prt::RayScene rays(before, prt::RayScene::Packets::Wide);
        const prt::BeamScene beams(before, rays);
        look_at_lamps(mesh.geometry, rays, options);
        after = prt::refine(mesh.geometry, beams, options, work, report);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(prefix_of(mesh) + error.what());
    }
    mesh.is_open = mesh.is_floor_open = false;
    if (options.curved)
        mesh.blockers.reset();
    else if (!mesh.blockers)
        mesh.blockers = mesh::blockers_of(mesh.geometry);
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

namespace {

/// Parts of the diagonal of the mesh without its floor. A mesh with longer sides is coarse: they
/// are wider than some twenty pixels of a picture that the mesh fills. Then triangles are refined
/// that are wider than eight. Edges of twice the least length are split.
constexpr float CoarseEdge = 1.0f / 40.0f, RefinedEdge = 1.0f / 100.0f, LeastEdge = 1.0f / 320.0f,
                LeastEdgeOfFloor = 1.0f / 160.0f;

/// RefineOptions::error. A few vertices are added wherever light shows; more only where it changes
/// more than --refine allows. Shadows on an even floor show every triangle, and its light hardly
/// changes elsewhere.
constexpr float ErrorOfFew = 0.006f, ErrorOfMesh = 0.012f, ErrorOfFloor = 0.005f;
constexpr std::size_t FewOfMesh = 9000;

/// Where refined_by_itself() finds things: the scene, and what it adds to.
struct Refining {
    const prt::Blockers& blockers;
    /// Has the bias and the lamps.
    RefineOptions options;
    const prt::Work& work;
    RefineReport& report;
};

mesh::TriangleMesh refined_part(const mesh::TriangleMesh& part, RefineOptions options,
                                std::size_t budget, const Refining& with) {
    options.bias = with.options.bias;
    options.lamps = with.options.lamps;
    options.max_vertices =
        std::min<std::size_t>(part.num_vertices() + budget, RefineOptions{}.max_vertices);
    RefineReport found;
    mesh::TriangleMesh result = prt::refine(part, with.blockers, options, with.work, &found);
    RefineReport& sum = with.report;
    sum.num_rounds = std::max(sum.num_rounds, found.num_rounds);
    sum.num_points += found.num_points;
    sum.num_added += found.num_added;
    sum.largest_error = std::max(sum.largest_error, found.largest_error);
    sum.is_at_limit = sum.is_at_limit || found.is_at_limit;
    sum.seconds += found.seconds;
    return result;
}

} // namespace

Mesh refined_by_itself(Mesh mesh, std::optional<float> bias, const prt::Work& work,
                       RefineReport* report) {
    if (!mesh.is_open && !mesh.is_floor_open)
        return mesh;
    const std::size_t first_of_floor = num_without_floor(mesh);
    const mesh::TriangleMesh own = part_of(mesh.geometry, 0, first_of_floor);
    const float size = mesh::scale(own);
    const bool is_coarse =
        mesh.is_open && size > 0.0f && prt::has_coarse_triangles(own, CoarseEdge * size);
    if (!is_coarse && !mesh.is_floor_open)
        return mesh;
    mesh::TriangleMesh before =
        mesh.blockers ? std::move(*mesh.blockers) : mesh::blockers_of(mesh.geometry);
    const bool has_blockers = std::exchange(mesh.blockers, {}).has_value();
    mesh::TriangleMesh floor = part_of(mesh.geometry, first_of_floor, mesh.geometry.num_vertices());
    RefineReport local;
    try {
        const prt::RayScene rays(before, prt::RayScene::Packets::Wide);
        const prt::BeamScene beams(before, rays);
        // The mesh as it comes, with all of its lamps.
        const mesh::TriangleMesh whole = std::move(mesh.geometry);
        Refining with{beams,
                      {.bias = bias.value_or(prt::automatic_bias(whole))},
                      work,
                      report != nullptr ? *report : local};
        look_at_lamps(whole, rays, with.options);
        mesh.geometry = own;
        if (is_coarse) {
            mesh.geometry = prt::with_lit_backs(own, beams, *with.options.bias, work);
            const std::size_t num_of_backs = mesh.geometry.num_vertices() - first_of_floor;
            with.report.num_added += num_of_backs;
            mesh.geometry = refined_part(mesh.geometry,
                                         {.error = ErrorOfMesh,
                                          .error_of_few = ErrorOfFew,
                                          .few = FewOfMesh,
                                          .coarse_edge = RefinedEdge * size,
                                          .min_edge = LeastEdge * size},
                                         BudgetOfMesh, with);
        }
        if (mesh.is_floor_open)
            floor =
                refined_part(floor, {.error = ErrorOfFloor, .min_edge = LeastEdgeOfFloor * size},
                             BudgetOfFloor, with);
        append(mesh.geometry, floor);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(prefix_of(mesh) + error.what());
    }
    mesh.floor_added = static_cast<std::uint32_t>(
        floor.num_vertices() - std::size_t{mesh.floor_vertices} * mesh.floor_vertices);
    mesh.is_open = mesh.is_floor_open = false;
    if (has_blockers || mesh.geometry.num_vertices() != before.num_vertices())
        mesh.blockers = std::move(before);
    return mesh;
}

Mesh with_backs_of_sheets(Mesh mesh) {
    const std::size_t first_of_floor = num_without_floor(mesh);
    mesh::TriangleMesh with_backs =
        prt::with_backs_of_sheets(part_of(mesh.geometry, 0, first_of_floor));
    if (with_backs.num_vertices() == first_of_floor)
        return mesh;
    append(with_backs, part_of(mesh.geometry, first_of_floor, mesh.geometry.num_vertices()));
    if (!mesh.blockers)
        mesh.blockers = mesh::blockers_of(mesh.geometry);
    mesh.geometry = std::move(with_backs);
    return mesh;
}

Mesh simplified(Mesh given, std::size_t num_vertices) {
    Mesh mesh = sound(std::move(given));
    mesh.is_open = false;
    if (!mesh.blockers)
        mesh.blockers = mesh::blockers_of(mesh.geometry);
    const std::size_t first_of_floor = num_without_floor(mesh);
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

void stand_on_floor(Mesh& mesh) {
    if (mesh.floor_vertices == 0 && !relight::inside_room(mesh.geometry) &&
        !has_ground(mesh.geometry))
        add_floor(mesh, {.floor_vertices = AutomaticFloor});
}

} // namespace relumine
