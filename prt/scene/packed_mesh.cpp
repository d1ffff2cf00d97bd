#include "prt/scene/packed_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace relumine::prt {

namespace {

const std::string Box = "packed_box", NumbersOf = "packed_counts", Positions = "packed_positions",
                  Normals = "packed_normals", Triangles = "packed_triangles";

constexpr std::uint32_t MostSteps = 65'535;

/// Normals are places on an octahedron that is unfolded to a square of so many steps a side: an
/// even number, so the axes keep all their bits. A floor that leans by a rounding has other
/// clusters on its horizon.
constexpr std::uint32_t NormalSteps = (1u << 20u) - 2u;

/// In the place of a normal that is zero.
constexpr std::uint32_t NoNormal = NormalSteps + 1;

/// Where a mesh's positions lie: the least of each axis, and the length of a step.
struct Grid {
    glm::vec3 low{0.0f};
    float step = 0.0f;
};
static_assert(sizeof(Grid) == 16);

/// Steps of 0, -1, 1, -2 and so on as 0, 1, 2, 3, and of these all lowest bytes, then the next:
/// alike bytes lie together, and planes of zeros at the end are left out.
std::vector<std::byte> planes_of(std::span<const std::uint32_t> steps) {
    std::vector<std::uint32_t> folded;
    std::uint32_t all = 0;
    for (const std::uint32_t step : steps) {
        folded.push_back(step << 1u ^ (0u - (step >> 31u)));
        all |= folded.back();
    }
    std::vector<std::byte> bytes;
    for (std::uint32_t shift = 0; shift < 32 && (shift == 0 || all >> shift != 0); shift += 8)
        for (const std::uint32_t value : folded)
            bytes.push_back(static_cast<std::byte>(value >> shift & 0xffu));
    return bytes;
}

/// Undoes planes_of().
std::vector<std::uint32_t> steps_of(const SectionReader& reader, const std::string& section,
                                    std::size_t count) {
    const std::vector<std::byte> bytes = reader.bytes(section);
    if (count == 0 || bytes.empty() || bytes.size() % count != 0 ||
        bytes.size() / count > sizeof(std::uint32_t))
        reader.fail(section, fmt::format("1 to 4 bytes for each of {} numbers", count));
    std::vector<std::uint32_t> steps(count);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        steps[i % count] |= std::to_integer<std::uint32_t>(bytes[i]) << 8 * (i / count);
    for (std::uint32_t& step : steps)
        step = step >> 1u ^ (0u - (step & 1u));
    return steps;
}

/// Numbers as steps from one to the next.
void to_steps(std::span<std::uint32_t> numbers) {
    std::adjacent_difference(numbers.begin(), numbers.end(), numbers.begin());
}
void from_steps(std::span<std::uint32_t> steps) {
    std::partial_sum(steps.begin(), steps.end(), steps.begin());
}

/// Where an octahedron is unfolded, the lower half of it lies around the upper one.
glm::vec2 unfolded(const glm::vec3& normal) {
    const glm::vec3 n = normal / (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
    if (n.z >= 0.0f)
        return {n.x, n.y};
    return {std::copysign(1.0f - std::abs(n.y), n.x), std::copysign(1.0f - std::abs(n.x), n.y)};
}

glm::vec3 folded(const glm::dvec2& place) {
    const double z = 1.0 - std::abs(place.x) - std::abs(place.y);
    if (z >= 0.0)
        return glm::normalize(glm::dvec3(place, z));
    return glm::normalize(glm::dvec3(std::copysign(1.0 - std::abs(place.y), place.x),
                                     std::copysign(1.0 - std::abs(place.x), place.y), z));
}

std::uint32_t step_of(float part, std::uint32_t num_steps) {
    return static_cast<std::uint32_t>(
        std::lround(std::clamp(static_cast<double>(part), 0.0, 1.0) * num_steps));
}

/// The numbers of a mesh's vertices and triangles.
struct Counts {
    std::uint32_t vertices = 0, triangles = 0;
};

} // namespace

void add_packed_mesh(NewSections& sections, const mesh::TriangleMesh& mesh) {
    const mesh::Bounds bounds = mesh::bounds(std::span(mesh.positions));
    const glm::vec3 size = bounds.size();
    const float longest = std::max({size.x, size.y, size.z});
    std::vector<std::uint32_t> positions, normals, triangles;
    for (int axis = 0; axis < 3; ++axis)
        for (const glm::vec3& position : mesh.positions)
            positions.push_back(
                longest > 0.0f ? step_of((position[axis] - bounds.min[axis]) / longest, MostSteps)
                               : 0);
    for (int axis = 0; axis < 2; ++axis)
        for (const glm::vec3& normal : mesh.normals)
            normals.push_back(normal == glm::vec3(0.0f)
                                  ? NoNormal
                                  : step_of(0.5f * unfolded(normal)[axis] + 0.5f, NormalSteps));
    for (std::size_t corner = 0; corner < 3; ++corner)
        for (const mesh::Triangle& triangle : mesh.triangles)
            triangles.push_back(corner == 0 ? triangle[0]
                                            : triangle[corner] - triangle[corner - 1]);
    to_steps(positions);
    to_steps(normals);
    to_steps(std::span(triangles).first(mesh.num_triangles()));
    sections[Box] =
        bytes_of(std::vector{Grid{bounds.min, longest / static_cast<float>(MostSteps)}});
    sections[NumbersOf] =
        bytes_of(std::vector{Counts{static_cast<std::uint32_t>(mesh.num_vertices()),
                                    static_cast<std::uint32_t>(mesh.num_triangles())}});
    sections[Positions] = planes_of(positions);
    sections[Normals] = planes_of(normals);
    sections[Triangles] = planes_of(triangles);
}

bool has_packed_mesh(const SectionReader& reader) {
    return reader.has(Positions);
}

void read_packed_mesh(const SectionReader& reader, mesh::TriangleMesh& mesh) {
    const Grid grid = reader.elements<Grid>(Box, 1).front();
    const Counts counts = reader.elements<Counts>(NumbersOf, 1).front();
    const std::size_t num_vertices = counts.vertices, num_triangles = counts.triangles;
    std::vector<std::uint32_t> positions = steps_of(reader, Positions, 3 * num_vertices);
    std::vector<std::uint32_t> normals = steps_of(reader, Normals, 2 * num_vertices);
    std::vector<std::uint32_t> triangles = steps_of(reader, Triangles, 3 * num_triangles);
    from_steps(positions);
    from_steps(normals);
    from_steps(std::span(triangles).first(num_triangles));
    mesh.positions.resize(num_vertices);
    mesh.normals.resize(num_vertices);
    mesh.triangles.resize(num_triangles);
    for (std::size_t i = 0; i < num_vertices; ++i) {
        for (int axis = 0; axis < 3; ++axis)
            mesh.positions[i][axis] =
                grid.low[axis] +
                grid.step * static_cast<float>(
                                positions[static_cast<std::size_t>(axis) * num_vertices + i]);
        const std::uint32_t u = normals[i], v = normals[num_vertices + i];
        if (u <= NormalSteps && v <= NormalSteps)
            mesh.normals[i] =
                folded((2.0 * glm::dvec2(u, v) - double{NormalSteps}) / double{NormalSteps});
    }
    for (std::size_t i = 0; i < num_triangles; ++i) {
        const std::uint32_t second = triangles[i] + triangles[num_triangles + i];
        mesh.triangles[i] = {triangles[i], second, second + triangles[2 * num_triangles + i]};
    }
}

} // namespace relumine::prt
