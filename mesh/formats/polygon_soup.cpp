#include "mesh/formats/polygon_soup.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "mesh/formats/corner_vertices.h"
#include "mesh/formats/soup_colors.h"
#include "mesh/formats/triangulate.h"
#include "mesh/normals.h"
#include "mesh/tangents.h"

namespace relumine::mesh {

namespace {

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Refuses a soup that no mesh may have, for every format.
void check(const PolygonSoup& soup) {
    const std::size_t num_vertices = soup.positions.size();
    if (num_vertices == 0)
        throw std::runtime_error("expected vertices, got none");
    for (std::size_t i = 0; i < num_vertices; ++i)
        if (!is_finite(soup.positions[i]))
            throw std::runtime_error(fmt::format(
                "expected finite positions, got {} {} {} at vertex {} of {}", soup.positions[i].x,
                soup.positions[i].y, soup.positions[i].z, i, num_vertices));
    for (const std::uint32_t vertex : soup.corners)
        if (vertex >= num_vertices)
            throw std::runtime_error(
                fmt::format("expected vertex indices below {}, got {}", num_vertices, vertex));
    // A corner may become a vertex.
    constexpr std::uint64_t Most = 0xfffffffe;
    if (num_vertices + soup.corners.size() > Most)
        throw std::runtime_error(fmt::format("expected at most {} vertices and corners, got {}",
                                             Most, num_vertices + soup.corners.size()));
}

/// Cuts the faces into triangles of places in soup.corners. A triangle keeps the uvs of its
/// corners, and the material and group of its face.
void triangulate(const PolygonSoup& soup, TriangleMesh& mesh) {
    mesh.triangles.reserve(soup.face_ends.size());
    Triangulator triangulator(soup.positions);
    std::vector<std::array<std::uint32_t, 3>> cut;
    std::size_t begin = 0, num_skipped = 0;
    for (std::size_t face = 0; face < soup.face_ends.size(); ++face) {
        const std::size_t end = soup.face_ends[face];
        cut.clear();
        if (end - begin < 3)
            ++num_skipped;
        else
            triangulator.cut(std::span(soup.corners).subspan(begin, end - begin), cut);
        for (const auto& [a, b, c] : cut) {
            mesh.triangles.push_back({static_cast<std::uint32_t>(begin + a),
                                      static_cast<std::uint32_t>(begin + b),
                                      static_cast<std::uint32_t>(begin + c)});
            if (!soup.corner_uvs.empty())
                mesh.corner_uvs.push_back({soup.corner_uvs[begin + a], soup.corner_uvs[begin + b],
                                           soup.corner_uvs[begin + c]});
            if (!soup.face_materials.empty())
                mesh.triangle_materials.push_back(soup.face_materials[face]);
            if (!soup.face_groups.empty())
                mesh.triangle_groups.push_back(soup.face_groups[face]);
        }
        begin = end;
    }
    if (mesh.triangles.empty())
        throw std::runtime_error(
            fmt::format("expected faces with three or more corners, got {} vertices and {} faces{}",
                        soup.positions.size(), soup.face_ends.size(), soup.why_no_faces));
    if (num_skipped > 0)
        mesh.warnings.push_back(fmt::format("{} of {} faces have fewer than three corners",
                                            num_skipped, soup.face_ends.size()));
}

/// Brings a tiny mesh to a size of about 1. Products of coordinates below 1e-19 would be lost, and
/// shadows with them. A power of two changes nothing but the size.
void enlarge(PolygonSoup& soup) {
    constexpr float Least = 0x1p-40f;
    float size = 0.0f;
    for (const glm::vec3& p : soup.positions)
        size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    if (size == 0.0f || size >= Least)
        return;
    const int exponent = -std::ilogb(size);
    for (glm::vec3& p : soup.positions)
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = std::ldexp(p[axis], exponent);
    for (PunctualLight& light : soup.lights) {
        light.position *= std::exp2(static_cast<float>(exponent));
        light.range = std::ldexp(light.range, exponent);
        if (light.kind != PunctualLight::Kind::Directional)
            light.intensity *= std::exp2(2.0f * static_cast<float>(exponent));
    }
    soup.warnings.push_back(fmt::format(
        "coordinates are at most {:.3g}, too small to compute with; the mesh is read 2^{} times as "
        "large",
        size, exponent));
}

/// Returns how far floats are apart at a place.
double spacing_at(const glm::dvec3& place) {
    const glm::dvec3 far = glm::abs(place);
    return double{std::numeric_limits<float>::epsilon()} * std::max({far.x, far.y, far.z});
}

/// Whether floats round shapes, cameras and rays away at the place of a box.
bool is_coarse(const Bounds& box) {
    constexpr double LeastSpacings = 2000.0;
    const double size = box.diagonal();
    return size > 0.0 && size < LeastSpacings * spacing_at(glm::dvec3(box.center()));
}

/// Returns the value that half of the others are below.
double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Returns a round number near a coordinate that is far for a mesh of such a size, and 0 for
/// others.
double offset_of(double coordinate, double size) {
    constexpr double Far = 16.0;
    if (!(std::abs(coordinate) > Far * size))
        return 0.0;
    const double step = size > 0.0 ? std::exp2(std::floor(std::log2(size))) : 0.0;
    return step > 0.0 ? std::round(coordinate / step) * step : coordinate;
}

/// Makes the normals unit length. One that has no direction is that of no face: zero.
void normalize_normals(TriangleMesh& mesh) {
    for (glm::vec3& one : mesh.normals) {
        const glm::dvec3 normal(one);
        const double length = is_finite(one) ? glm::length(normal) : 0.0;
        one = length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0f);
    }
}

/// Leaves out each set of texture coordinates that are not all numbers, with a warning.
void check_uvs(TriangleMesh& mesh) {
    const auto is_number = [](const glm::vec2& uv) {
        return is_finite({uv, 0.0f});
    };
    const auto check_set = [&](auto& uvs, std::string_view owners, const auto& is_whole) {
        const auto num_broken = static_cast<std::ptrdiff_t>(uvs.size()) -
                                std::count_if(uvs.begin(), uvs.end(), is_whole);
        if (num_broken == 0)
            return;
        mesh.warnings.push_back(fmt::format(
            "{} of {} {} have texture coordinates that are no numbers: the set is left out",
            num_broken, uvs.size(), owners));
        uvs.clear();
    };
    check_set(mesh.uvs, "vertices", is_number);
    check_set(mesh.second_uvs, "vertices", is_number);
    check_set(mesh.corner_uvs, "triangles", [&](const auto& corners) {
        return std::all_of(corners.begin(), corners.end(), is_number);
    });
}

} // namespace

void PolygonSoup::add_position(const glm::dvec3& position) {
    const glm::vec3 rounded(position);
    const glm::vec3 rest(position - glm::dvec3(rounded));
    if (rest != glm::vec3(0.0f) && is_finite(rounded)) {
        remainders.resize(positions.size(), glm::vec3(0.0f));
        remainders.push_back(rest);
    }
    positions.push_back(rounded);
}

void PolygonSoup::move_back(const glm::dvec3& by) {
    remainders.resize(positions.size(), glm::vec3(0.0f));
    for (std::size_t i = 0; i < positions.size(); ++i)
        positions[i] = glm::vec3(glm::dvec3(positions[i]) - by + glm::dvec3(remainders[i]));
    remainders.clear();
}

void centre(PolygonSoup& soup) {
    const auto is_one = [](const glm::vec3& position) {
        return is_finite(position);
    };
    if (!std::all_of(soup.positions.begin(), soup.positions.end(), is_one))
        return;
    const bool has_digits = !soup.remainders.empty();
    if (!has_digits && !is_coarse(bounds(soup.positions)))
        return;
    const std::size_t count = soup.positions.size();
    // A few vertices may lie anywhere.
    std::vector<double> values(count);
    glm::dvec3 middle;
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < count; ++i)
            values[i] = double{soup.positions[i][axis]};
        middle[axis] = median(values);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 away = glm::abs(glm::dvec3(soup.positions[i]) - middle);
        values[i] = std::max({away.x, away.y, away.z});
    }
    const auto nearly_all = values.begin() + static_cast<std::ptrdiff_t>(count - 1 - count / 10);
    std::nth_element(values.begin(), nearly_all, values.end());
    glm::dvec3 offset;
    for (int axis = 0; axis < 3; ++axis)
        offset[axis] = offset_of(middle[axis], *nearly_all);
    if (offset == glm::dvec3(0.0)) {
        soup.remainders.clear();
        return;
    }
    soup.offset = offset;
    soup.move_back(offset);
    for (std::size_t i = 0; i < soup.light_positions.size(); ++i)
        soup.lights[i].position = glm::vec3(soup.light_positions[i] - offset);
    if (!has_digits)
        soup.warnings.push_back(fmt::format(
            "coordinates are about {:.3g} apart from each other at ({:.0f}, {:.0f}, {:.0f}), which "
            "is coarse for a mesh of {:.3g}: move it to the origin before it is exported",
            spacing_at(middle), middle.x, middle.y, middle.z, bounds(soup.positions).diagonal()));
    soup.notes.push_back(fmt::format(
        "coordinates are far from the origin: ({}, {}, {}) is taken off them while the mesh is "
        "computed with; places in options and in written files count as in this file",
        offset.x, offset.y, offset.z));
}

TriangleMesh to_mesh(PolygonSoup soup, NormalSource source, std::optional<ColorCurve> curve) {
    check(soup);
    centre(soup);
    enlarge(soup);
    settle_colors(soup, curve);
    TriangleMesh mesh;
    mesh.warnings = std::move(soup.warnings);
    triangulate(soup, mesh);
    const std::size_t num_of_file = soup.positions.size();
    const std::size_t num_added = set_corner_vertices(soup, mesh.triangles, source);
    if (num_added != 0)
        soup.notes.push_back(fmt::format(
            "{} {} added behind the {} of the file, where normals or colours of faces differ",
            num_added, num_added == 1 ? "vertex is" : "vertices are", num_of_file));
    for (Triangle& triangle : mesh.triangles)
        for (std::uint32_t& corner : triangle)
            corner = soup.corners[corner];
    mesh.notes = std::move(soup.notes);
    mesh.positions = std::move(soup.positions);
    mesh.offset = soup.offset;
    mesh.normals = std::move(soup.normals);
    mesh.colors = std::move(soup.colors);
    mesh.uvs = std::move(soup.uvs);
    mesh.second_uvs = std::move(soup.second_uvs);
    mesh.materials = std::move(soup.materials);
    mesh.groups = std::move(soup.groups);
    mesh.textures = std::move(soup.textures);
    mesh.missing = std::move(soup.missing);
    mesh.lights = std::move(soup.lights);
    const bool is_smooth = source == NormalSource::Smooth && soup.face_colors.empty();
    if (is_smooth || mesh.normals.empty())
        mesh.normals = smooth_normals(mesh);
    else
        normalize_normals(mesh);
    check_uvs(mesh);
    set_tangents(mesh, soup.tangents);
    return mesh;
}

} // namespace relumine::mesh
