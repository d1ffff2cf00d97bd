#include "mesh/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/counted.h"

namespace relumine::mesh {

namespace {

/// Corners of equal keys share a tangent: material, position, normal and uv, as bits.
struct Corner {
    std::array<std::uint32_t, 9> key;
    std::uint32_t triangle;
    std::uint32_t corner;
};

/// The part of a vector across a unit normal, of length 1, or zero.
glm::dvec3 across(const glm::dvec3& v, const glm::dvec3& normal) {
    const glm::dvec3 flat = v - glm::dot(normal, v) * normal;
    const double length = glm::length(flat);
    return length > 1e-12 * glm::length(v) ? flat / length : glm::dvec3(0.0);
}

/// Any unit vector across a normal.
glm::dvec3 any_across(const glm::dvec3& normal) {
    return across(std::abs(normal.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), normal);
}

/// The map whose uvs the tangents follow: the surface's, its coat's, that of its anisotropy, or
/// none: the first uvs. Empty: the material needs no tangents.
std::optional<TextureSlot> map_of(const Material& material) {
    if (material.normal_texture)
        return material.normal_texture;
    if (material.coat_normal_texture)
        return material.coat_normal_texture;
    if (material.anisotropy == 0.0f)
        return std::nullopt;
    constexpr std::uint32_t NoTexture = ~0u;
    return material.anisotropy_texture.value_or(TextureSlot{.texture = NoTexture});
}

class Tangents {
public:
    Tangents(TriangleMesh& mesh, std::span<const glm::vec4> of_file)
        : mesh_(mesh), of_file_(of_file) {
        mesh_.corner_tangents.assign(mesh_.num_triangles(), {});
        for (const Material& material : mesh_.materials)
            maps_.push_back(map_of(material));
    }

    void set() {
        for (std::uint32_t i = 0; i < mesh_.num_triangles(); ++i)
            if (slot(i))
                for (std::uint32_t k = 0; k < 3; ++k)
                    if (!take_from_file(i, k))
                        corners_.push_back(corner(i, k));
        std::sort(corners_.begin(), corners_.end(), [](const Corner& a, const Corner& b) {
            return a.key != b.key ? a.key < b.key : a.triangle < b.triangle;
        });
        for (std::size_t begin = 0, end = 0; begin < corners_.size(); begin = end) {
            while (end < corners_.size() && corners_[end].key == corners_[begin].key)
                ++end;
            set_alike(std::span(corners_).subspan(begin, end - begin));
        }
        if (num_unusable_ > 0)
            mesh_.warnings.push_back(
                fmt::format("tangents are zero or not finite at {}: computed from the uvs",
                            files::counted(num_unusable_, "corner")));
    }

private:
    [[nodiscard]] const std::optional<TextureSlot>& slot(std::uint32_t triangle) const {
        return maps_[mesh_.triangle_materials[triangle]];
    }

    /// The place in the normal map; v grows upwards, as in the picture.
    [[nodiscard]] glm::dvec2 uv(std::uint32_t triangle, std::size_t k) const {
        const TextureSlot& own = *slot(triangle);
        const glm::vec2 uv =
            own.uv_from_mesh_uv * corner_uv(mesh_, triangle, k, own.uv_set) + own.uv_offset;
        // Only glTF has tangents without a map: there v counts from the top.
        const bool is_from_top = own.texture >= mesh_.textures.size() ||
                                 mesh_.textures[own.texture].origin == VOrigin::Top;
        return {uv.x, is_from_top ? -uv.y : uv.y};
    }

    [[nodiscard]] Corner corner(std::uint32_t triangle, std::uint32_t k) const {
        const std::uint32_t vertex = mesh_.triangles[triangle][k];
        const glm::vec3 &p = mesh_.positions[vertex], &n = mesh_.normals[vertex];
        const glm::vec2 t(uv(triangle, k));
        const auto bits = [](float value) {
            return std::bit_cast<std::uint32_t>(value + 0.0f); // -0 is 0
        };
        return {.key = {mesh_.triangle_materials[triangle], bits(p.x), bits(p.y), bits(p.z),
                        bits(n.x), bits(n.y), bits(n.z), bits(t.x), bits(t.y)},
                .triangle = triangle,
                .corner = k};
    }

    bool take_from_file(std::uint32_t triangle, std::size_t k) {
        if (of_file_.empty())
            return false;
        const glm::vec4& own = of_file_[mesh_.triangles[triangle][k]];
        const double length = glm::length(glm::dvec3(own));
        if (own == glm::vec4(0.0f))
            return false;
        if (!(length > 0.0) || !std::isfinite(length) || !std::isfinite(own.w)) {
            ++num_unusable_;
            return false;
        }
        mesh_.corner_tangents[triangle][k] =
            glm::vec4(glm::dvec3(own) / length, own.w < 0.0f ? -1.0f : 1.0f);
        return true;
    }

    /// The direction of growing u in a triangle, its length being 1, and the sign of its area in
    /// uv: 0 where it has none.
    [[nodiscard]] std::pair<glm::dvec3, double> direction(std::uint32_t triangle) const {
        const auto& [a, b, c] = mesh_.triangles[triangle];
        const glm::dvec3 origin(mesh_.positions[a]);
        const glm::dvec3 p1 = glm::dvec3(mesh_.positions[b]) - origin;
        const glm::dvec3 p2 = glm::dvec3(mesh_.positions[c]) - origin;
        const glm::dvec2 uv0 = uv(triangle, 0);
        const glm::dvec2 t1 = uv(triangle, 1) - uv0, t2 = uv(triangle, 2) - uv0;
        const double area = t1.x * t2.y - t1.y * t2.x;
        const glm::dvec3 growing = (area < 0.0 ? -1.0 : 1.0) * (t2.y * p1 - t1.y * p2);
        const double length = glm::length(growing);
        if (!(std::abs(area) > 0.0) || !(length > 0.0) || !std::isfinite(length))
            return {glm::dvec3(0.0), 0.0};
        return {growing / length, area < 0.0 ? -1.0 : 1.0};
    }

    /// The angle of a triangle at a corner, as seen along the normal.
    [[nodiscard]] double angle(const Corner& of, const glm::dvec3& normal) const {
        const Triangle& t = mesh_.triangles[of.triangle];
        const glm::dvec3 origin(mesh_.positions[t[of.corner]]);
        const auto to = [&](std::size_t k) {
            return across(glm::dvec3(mesh_.positions[t[(of.corner + k) % 3]]) - origin, normal);
        };
        return std::acos(std::clamp(glm::dot(to(1), to(2)), -1.0, 1.0));
    }

    /// Corners of one key: those of each handedness share a mean, and those of triangles without an
    /// area in uv take either.
    void set_alike(std::span<const Corner> corners) {
        const Corner& first = corners.front();
        const glm::dvec3 normal(mesh_.normals[mesh_.triangles[first.triangle][first.corner]]);
        std::array<glm::dvec3, 2> sums{};
        std::vector<double> signs;
        for (const Corner& one : corners) {
            const auto [growing, sign] = direction(one.triangle);
            signs.push_back(sign);
            if (sign != 0.0)
                sums[sign < 0.0 ? 1 : 0] += angle(one, normal) * across(growing, normal);
        }
        for (std::size_t i = 0; i < corners.size(); ++i) {
            bool is_mirrored = signs[i] < 0.0;
            if (signs[i] == 0.0)
                is_mirrored = sums[0] == glm::dvec3(0.0) && sums[1] != glm::dvec3(0.0);
            glm::dvec3 tangent = across(sums[is_mirrored ? 1 : 0], normal);
            if (tangent == glm::dvec3(0.0))
                tangent = any_across(normal);
            mesh_.corner_tangents[corners[i].triangle][corners[i].corner] =
                glm::vec4(tangent, is_mirrored ? -1.0f : 1.0f);
        }
    }

    TriangleMesh& mesh_;
    std::span<const glm::vec4> of_file_;
    /// By material.
    std::vector<std::optional<TextureSlot>> maps_;
    std::vector<Corner> corners_;
    std::size_t num_unusable_ = 0;
};

} // namespace

glm::vec2 corner_uv(const TriangleMesh& mesh, std::uint32_t triangle, std::size_t corner,
                    std::uint32_t uv_set) {
    if (uv_set == 0 && !mesh.corner_uvs.empty())
        return mesh.corner_uvs[triangle][corner];
    const std::vector<glm::vec2>& uvs = uv_set == 0 ? mesh.uvs : mesh.second_uvs;
    return uvs.empty() ? glm::vec2(0.0f) : uvs[mesh.triangles[triangle][corner]];
}

void set_tangents(TriangleMesh& mesh, std::span<const glm::vec4> of_file) {
    if (!mesh.triangle_materials.empty() &&
        std::any_of(mesh.materials.begin(), mesh.materials.end(),
                    [](const Material& material) { return map_of(material).has_value(); }))
        Tangents(mesh, of_file).set();
}

} // namespace relumine::mesh
