#include "mesh/half_edge/half_edge_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>

// IWYU: the kernel's classes come before the tools.
#include <OpenMesh/Core/Mesh/Traits.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "mesh/edge_uses.h"

namespace relumine::mesh {

namespace {

/// In double: positions are exact, and products of a small triangle's edges do not vanish.
struct Traits : OpenMesh::DefaultTraitsDouble {
    VertexAttributes(OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::Normal);
    EdgeAttributes(OpenMesh::Attributes::Status);
    HalfedgeAttributes(OpenMesh::Attributes::Status);
};
using Structure = OpenMesh::TriMesh_ArrayKernelT<Traits>;

/// Returns the triangles that a structure can hold: three different vertices, each set once.
std::vector<std::uint32_t> usable_triangles(std::span<const Triangle> triangles) {
    std::vector<std::array<std::uint32_t, 4>> sorted;
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        Triangle t = triangles[i];
        std::sort(t.begin(), t.end());
        if (t[0] != t[1] && t[1] != t[2])
            sorted.push_back({t[0], t[1], t[2], i});
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < sorted.size(); ++i)
        if (i == 0 || !std::equal(sorted[i].begin(), sorted[i].begin() + 3, sorted[i - 1].begin()))
            result.push_back(sorted[i][3]);
    std::sort(result.begin(), result.end());
    return result;
}

} // namespace

struct HalfEdgeMesh::Impl {
    Impl(const TriangleMesh& mesh, Cuts how) : source(mesh), cuts(how) {
        omerr().disable(); // libraries do not print
        std::vector<std::uint32_t> names(mesh.num_vertices());
        if (cuts == Cuts::Shape)
            names = first_at_place(mesh.positions);
        else
            std::iota(names.begin(), names.end(), 0u);
        const std::vector<Triangle> all = renamed(mesh.triangles, names);
        face_sources = usable_triangles(all);
        for (const std::uint32_t i : face_sources)
            triangles.push_back(all[i]);
        uses = edge_uses(triangles);
        add_fans();
        add_faces();
    }

    /// Whether the attributes of two triangles are the same along their edge.
    [[nodiscard]] bool attributes_agree(const EdgeUse& a, const EdgeUse& b) const {
        const std::uint32_t s = face_sources[a.triangle()], t = face_sources[b.triangle()];
        const auto differ = [&](const std::vector<std::uint32_t>& values) {
            return !values.empty() && values[s] != values[t];
        };
        if (differ(source.triangle_materials) || differ(source.triangle_groups))
            return false;
        if (source.corner_uvs.empty())
            return true;
        const std::uint32_t i = a.corner % 3, j = b.corner % 3;
        return source.corner_uvs[s][i] == source.corner_uvs[t][(j + 1) % 3] &&
               source.corner_uvs[s][(i + 1) % 3] == source.corner_uvs[t][j];
    }

    /// One vertex of the structure for each fan of corners.
    void add_fans() {
        DisjointSets fans(3 * triangles.size());
        for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
            if (!is_smooth_join(edge) ||
                (cuts == Cuts::Attributes && !attributes_agree(edge[0], edge[1])))
                return;
            // The sides run against each other: the start of one is the end of the other.
            fans.join(edge[0].corner, next_corner(edge[1].corner));
            fans.join(next_corner(edge[0].corner), edge[1].corner);
        });
        corner_fans.resize(3 * triangles.size());
        num_fans.resize(source.num_vertices());
        for (std::uint32_t corner = 0; corner < corner_fans.size(); ++corner)
            corner_fans[corner] =
                fans.first(corner) == corner ? add_fan(corner) : corner_fans[fans.first(corner)];
    }

    static std::uint32_t next_corner(std::uint32_t corner) {
        return corner - corner % 3 + (corner % 3 + 1) % 3;
    }

    std::uint32_t add_fan(std::uint32_t corner) {
        const std::uint32_t name = triangles[corner / 3][corner % 3];
        const glm::vec3& p = source.positions[name];
        structure.add_vertex({double{p.x}, double{p.y}, double{p.z}});
        fan_names.push_back(name);
        fan_corners.push_back(corner);
        ++num_fans[name];
        return static_cast<std::uint32_t>(fan_names.size() - 1);
    }

    void add_faces() {
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            std::array<OpenMesh::VertexHandle, 3> corners;
            const auto take = [&] {
                for (std::uint32_t k = 0; k < 3; ++k)
                    corners[k] = OpenMesh::VertexHandle(static_cast<int>(corner_fans[3 * i + k]));
            };
            take();
            if (structure.add_face(corners[0], corners[1], corners[2]).is_valid())
                continue;
            // A strip that comes back to its own edge the wrong way round.
            for (std::uint32_t k = 0; k < 3; ++k)
                corner_fans[3 * i + k] = add_fan(3 * i + k);
            take();
            structure.add_face(corners[0], corners[1], corners[2]);
        }
    }

    /// Whether more than one triangle has the edge between two vertices.
    [[nodiscard]] bool is_shared(std::uint32_t a, std::uint32_t b) const {
        const EdgeUse edge{.low = std::min(a, b), .high = std::max(a, b)};
        const auto [begin, end] = std::equal_range(
            uses.begin(), uses.end(), edge, [](const EdgeUse& x, const EdgeUse& y) {
                return std::pair(x.low, x.high) < std::pair(y.low, y.high);
            });
        return end - begin > 1;
    }

    const TriangleMesh& source;
    Cuts cuts;
    /// [num faces] the triangles of the source.
    std::vector<std::uint32_t> face_sources;
    /// [num faces] named vertices.
    std::vector<Triangle> triangles;
    std::vector<EdgeUse> uses;
    /// [3 num faces].
    std::vector<std::uint32_t> corner_fans;
    /// [num fans] the vertex, and a corner whose attributes it has.
    std::vector<std::uint32_t> fan_names, fan_corners;
    /// [num vertices of the source].
    std::vector<std::uint32_t> num_fans;
    Structure structure;
};

HalfEdgeMesh::HalfEdgeMesh(const TriangleMesh& mesh, Cuts cuts)
    : impl_(std::make_unique<Impl>(mesh, cuts)) {}
HalfEdgeMesh::~HalfEdgeMesh() = default;
HalfEdgeMesh::HalfEdgeMesh(HalfEdgeMesh&&) noexcept = default;
HalfEdgeMesh& HalfEdgeMesh::operator=(HalfEdgeMesh&&) noexcept = default;

std::vector<std::vector<HalfEdgeMesh::RimCorner>> HalfEdgeMesh::rims() const {
    const Structure& structure = impl_->structure;
    std::vector<bool> is_seen(structure.n_halfedges());
    std::vector<std::vector<RimCorner>> result;
    for (const auto& start : structure.halfedges()) {
        if (!structure.is_boundary(start) || is_seen[static_cast<std::size_t>(start.idx())])
            continue;
        std::vector<RimCorner>& rim = result.emplace_back();
        OpenMesh::HalfedgeHandle side = start;
        do {
            is_seen[static_cast<std::size_t>(side.idx())] = true;
            const auto fan = static_cast<std::size_t>(structure.from_vertex_handle(side).idx());
            const auto next = static_cast<std::size_t>(structure.to_vertex_handle(side).idx());
            const OpenMesh::FaceHandle face =
                structure.face_handle(structure.opposite_halfedge_handle(side));
            const auto at = static_cast<std::size_t>(face.idx());
            const std::uint32_t name = impl_->fan_names[fan];
            RimCorner corner{.triangle = impl_->face_sources[at]};
            while (impl_->triangles[at][corner.corner] != name)
                ++corner.corner;
            corner.vertex = impl_->source.triangles[corner.triangle][corner.corner];
            corner.is_cut =
                impl_->num_fans[name] > 1 || impl_->is_shared(name, impl_->fan_names[next]);
            rim.push_back(corner);
            side = structure.next_halfedge_handle(side);
        } while (side != start);
    }
    return result;
}

void HalfEdgeMesh::simplify(std::size_t num_vertices, float largest_turn) {
    Structure& structure = impl_->structure;
    const auto num_now = static_cast<std::size_t>(
        std::count_if(impl_->num_fans.begin(), impl_->num_fans.end(),
                      [](std::uint32_t num_fans) { return num_fans > 0; }));
    if (num_vertices >= num_now)
        return;
    for (const auto& vertex : structure.vertices())
        structure.status(vertex).set_locked(structure.is_boundary(vertex));
    structure.update_face_normals();
    OpenMesh::Decimater::DecimaterT<Structure> decimater(structure);
    OpenMesh::Decimater::ModQuadricT<Structure>::Handle quadric;
    OpenMesh::Decimater::ModNormalFlippingT<Structure>::Handle flipping;
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err();
    decimater.add(flipping);
    decimater.module(flipping).set_max_normal_deviation(largest_turn);
    decimater.initialize();
    decimater.decimate(num_now - num_vertices);
}

namespace {

/// Copies what belongs to no vertex and no triangle.
void copy_lists(const TriangleMesh& from, TriangleMesh& to) {
    to.offset = from.offset;
    to.materials = from.materials;
    to.groups = from.groups;
    to.textures = from.textures;
    to.lights = from.lights;
    to.missing = from.missing;
    to.warnings = from.warnings;
    to.notes = from.notes;
}

} // namespace

TriangleMesh HalfEdgeMesh::mesh() const {
    const TriangleMesh& source = impl_->source;
    TriangleMesh result;
    copy_lists(source, result);
    std::vector<bool> stays(source.num_vertices(), true);
    for (const Triangle& triangle : source.triangles)
        for (const std::uint32_t vertex : triangle)
            stays[vertex] = false;
    std::vector<std::uint32_t> faces;
    for (const auto& face : impl_->structure.faces()) // leaves out what is deleted
        faces.push_back(static_cast<std::uint32_t>(face.idx()));
    std::vector<std::array<std::uint32_t, 3>> fans;
    for (const std::uint32_t face : faces) {
        std::array<std::uint32_t, 3>& corners = fans.emplace_back();
        auto corner = corners.begin();
        for (const auto& vertex :
             impl_->structure.fv_range(OpenMesh::FaceHandle(static_cast<int>(face)))) {
            *corner = static_cast<std::uint32_t>(vertex.idx());
            stays[impl_->fan_names[*corner++]] = true;
        }
    }
    std::vector<std::uint32_t> places(source.num_vertices());
    const auto keep = [&](const auto& values, auto& kept) {
        for (std::size_t i = 0; i < values.size(); ++i)
            if (stays[i])
                kept.push_back(values[i]);
    };
    keep(source.positions, result.positions);
    keep(source.normals, result.normals);
    keep(source.colors, result.colors);
    keep(source.uvs, result.uvs);
    keep(source.second_uvs, result.second_uvs);
    std::uint32_t place = 0;
    for (std::size_t i = 0; i < places.size(); ++i)
        places[i] = stays[i] ? place++ : 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const std::uint32_t from = impl_->face_sources[faces[i]];
        Triangle& triangle = result.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
            triangle[k] = places[impl_->fan_names[fans[i][k]]];
        const auto keep_corners = [&](const auto& values, auto& kept) {
            if (values.empty())
                return;
            auto& corners = kept.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t corner = impl_->fan_corners[fans[i][k]];
                corners[k] = values[impl_->face_sources[corner / 3]][corner % 3];
            }
        };
        keep_corners(source.corner_uvs, result.corner_uvs);
        keep_corners(source.corner_tangents, result.corner_tangents);
        if (!source.triangle_materials.empty())
            result.triangle_materials.push_back(source.triangle_materials[from]);
        if (!source.triangle_groups.empty())
            result.triangle_groups.push_back(source.triangle_groups[from]);
    }
    return result;
}

} // namespace relumine::mesh
