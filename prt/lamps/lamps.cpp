#include "prt/lamps/lamps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "prt/receivers/mesh_point.h"

namespace relumine::prt {

namespace {

using Corners = std::array<glm::dvec2, 3>;

/// Returns one of the four parts of a triangle.
template<typename Point>
std::array<Point, 3> quarter(const std::array<Point, 3>& corners, std::uint32_t index) {
    const Point ab = 0.5 * (corners[0] + corners[1]), bc = 0.5 * (corners[1] + corners[2]),
                ca = 0.5 * (corners[2] + corners[0]);
    switch (index) {
    case 0:
        return {corners[0], ab, ca};
    case 1:
        return {ab, corners[1], bc};
    case 2:
        return {ca, bc, corners[2]};
    default:
        return {bc, ca, ab};
    }
}

template<typename Point>
std::array<Point, 3> part_of(std::array<Point, 3> corners, std::uint32_t part) {
    // Each level has two bits below the leading 1.
    for (int shift = std::bit_width(part) - 3; shift >= 0; shift -= 2)
        corners = quarter(corners, part >> shift & 3u);
    return corners;
}

/// Returns how many texels of its emission's texture a triangle covers.
double texels_of(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    const mesh::Material& material = mesh.materials[mesh.triangle_materials[triangle]];
    const std::optional<mesh::TextureSlot>& slot = material.emission_texture;
    if (!slot)
        return 0.0;
    std::array<glm::vec2, 3> uvs{};
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::vec2 corner(i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f);
        uvs[i] = slot->uv_from_mesh_uv * uv_at(mesh, {triangle, corner}, slot->uv_set);
    }
    const glm::dvec2 u(uvs[1] - uvs[0]), v(uvs[2] - uvs[0]);
    const mesh::Texture& texture = mesh.textures[slot->texture];
    return 0.5 * std::abs(u.x * v.y - u.y * v.x) * texture.width * texture.height;
}

/// Finds the emitters of a mesh, triangle by triangle.
class Finder {
public:
    Finder(const mesh::TriangleMesh& mesh, const SurfaceOverride& override_surface)
        : mesh_(mesh), override_(override_surface),
          group_of_(std::max<std::size_t>(mesh.groups.size(), 1), NoGroup) {}

    Lamps run() {
        for (std::uint32_t i = 0; i < mesh_.num_triangles(); ++i)
            if (front_of(mesh_, i) != glm::dvec3(0.0))
                add(i);
        leave_dark_ones_out();
        lamps_.lights = mesh_.lights;
        return std::move(lamps_);
    }

private:
    /// Parts that are small enough for one mean.
    static constexpr double TexelsOfPart = 1024.0;
    static constexpr std::uint32_t MostLevels = 4;
    static_assert(LastPart == 1u << (2 * MostLevels + 2));

    void add(std::uint32_t triangle) {
        if (override_) {
            const Surface own = surface_at(mesh_, triangle, glm::vec2(1.0f / 3.0f));
            if (const Surface given = override_(mesh_, triangle, own); given != own) {
                add(triangle, 1, given.emission);
                return;
            }
        }
        if (mesh_.triangle_materials.empty() ||
            mesh_.materials[mesh_.triangle_materials[triangle]].emission == glm::vec3(0.0f))
            return;
        const double texels = texels_of(mesh_, triangle);
        std::uint32_t level = 0;
        while (level < MostLevels && texels > TexelsOfPart * std::exp2(2.0 * level))
            ++level;
        const std::uint32_t count = 1u << 2 * level;
        // Every second texel along each side.
        const auto steps = static_cast<std::uint32_t>(
            std::clamp(std::ceil(0.5 * std::sqrt(2.0 * texels / count)), 1.0, 64.0));
        for (std::uint32_t part = count; part < 2 * count; ++part)
            add(triangle, part, mean_emission(triangle, part, steps));
    }

    void add(std::uint32_t triangle, std::uint32_t part, const glm::vec3& radiance) {
        if (radiance != glm::vec3(0.0f))
            lamps_.emitters.push_back({.triangle = triangle,
                                       .part = part,
                                       .group = group_of(triangle),
                                       .radiance = radiance});
    }

    /// The mean over the middles of steps x steps equal triangles.
    [[nodiscard]] glm::vec3 mean_emission(std::uint32_t triangle, std::uint32_t part,
                                          std::uint32_t steps) const {
        const Corners corners =
            part_of(Corners{glm::dvec2(0.0), glm::dvec2(1.0, 0.0), glm::dvec2(0.0, 1.0)}, part);
        const glm::dvec2 u = (corners[1] - corners[0]) / static_cast<double>(steps);
        const glm::dvec2 v = (corners[2] - corners[0]) / static_cast<double>(steps);
        glm::dvec3 sum(0.0);
        const auto add_at = [&](double x, double y) {
            const glm::vec2 at(corners[0] + x * u + y * v);
            sum += glm::dvec3(emission_at(mesh_, triangle, at));
        };
        for (std::uint32_t i = 0; i < steps; ++i)
            for (std::uint32_t j = 0; j + i < steps; ++j) {
                add_at(i + 1.0 / 3.0, j + 1.0 / 3.0);
                if (i + j + 1 < steps)
                    add_at(i + 2.0 / 3.0, j + 2.0 / 3.0);
            }
        return glm::vec3(sum / (static_cast<double>(steps) * steps));
    }

    std::uint32_t group_of(std::uint32_t triangle) {
        const std::uint32_t of_mesh =
            mesh_.triangle_groups.empty() ? 0 : mesh_.triangle_groups[triangle];
        std::uint32_t& group = group_of_[of_mesh];
        if (group == NoGroup) {
            group = static_cast<std::uint32_t>(lamps_.groups.size());
            lamps_.groups.push_back(mesh_.groups.empty() ? "" : mesh_.groups[of_mesh]);
        }
        return group;
    }

    [[nodiscard]] double power_of(const Emitter& emitter) const {
        const auto [a, b, c] = corners_of(mesh_, emitter);
        const glm::dvec3 radiance(emitter.radiance);
        return glm::length(glm::cross(b - a, c - a)) * (radiance.r + radiance.g + radiance.b);
    }

    void leave_dark_ones_out() {
        constexpr double Share = 1e-3;
        std::vector<double> powers;
        std::vector<std::vector<std::size_t>> of_groups(lamps_.groups.size());
        for (std::size_t i = 0; i < lamps_.emitters.size(); ++i) {
            powers.push_back(power_of(lamps_.emitters[i]));
            of_groups[lamps_.emitters[i].group].push_back(i);
        }
        for (std::vector<std::size_t>& indices : of_groups) {
            std::stable_sort(indices.begin(), indices.end(),
                             [&](std::size_t a, std::size_t b) { return powers[a] < powers[b]; });
            double all = 0.0, dark = 0.0;
            for (const std::size_t i : indices)
                all += powers[i];
            for (const std::size_t i : indices)
                if ((dark += powers[i]) < Share * all)
                    lamps_.emitters[i].part = 0;
        }
        std::erase_if(lamps_.emitters, [](const Emitter& emitter) { return emitter.part == 0; });
    }

    const mesh::TriangleMesh& mesh_;
    const SurfaceOverride& override_;
    /// [groups of the mesh]
    std::vector<std::uint32_t> group_of_;
    Lamps lamps_;
};

} // namespace

std::vector<std::string> Lamps::names() const {
    std::vector<std::string> result = groups;
    for (const mesh::PunctualLight& light : lights)
        result.push_back(light.name);
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
}

std::array<glm::dvec3, 3> corners_of(const mesh::TriangleMesh& mesh, const Emitter& emitter) {
    const mesh::Triangle& triangle = mesh.triangles[emitter.triangle];
    return part_of(std::array{glm::dvec3(mesh.positions[triangle[0]]),
                              glm::dvec3(mesh.positions[triangle[1]]),
                              glm::dvec3(mesh.positions[triangle[2]])},
                   emitter.part);
}

glm::dvec3 front_of(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    const glm::dvec3 normal(face_normal(mesh, triangle));
    glm::dvec3 sum(0.0);
    for (const std::uint32_t vertex : mesh.triangles[triangle])
        sum += glm::dvec3(mesh.normals[vertex]);
    return glm::dot(normal, sum) < 0.0 ? -normal : normal;
}

Lamps lamps_of(const mesh::TriangleMesh& mesh, const SurfaceOverride& override_surface) {
    return Finder(mesh, override_surface).run();
}

std::vector<std::uint32_t> lamp_groups(const mesh::TriangleMesh& mesh, const Lamps& lamps) {
    std::vector<std::uint32_t> result;
    if (!lamps.emitters.empty())
        result.assign(mesh.num_triangles(), NoGroup);
    for (const Emitter& emitter : lamps.emitters)
        result[emitter.triangle] = emitter.group;
    return result;
}

} // namespace relumine::prt
