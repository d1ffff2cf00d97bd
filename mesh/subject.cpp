#include "mesh/subject.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"
#include "mesh/materials/material.h"

namespace relumine::mesh {

bool is_unseen(const Material& material) {
    return material.alpha_mode == AlphaMode::Blend
               ? material.alpha == 0.0f
               : material.alpha_mode == AlphaMode::Mask && material.alpha < material.alpha_cutoff;
}

namespace {

/// Stray triangles reach so many times as far as the rest, and weigh no more than this part.
constexpr double Far = 16.0, Light = 1e-3;

/// The box around marked vertices, and whether there are any.
struct MarkedBox {
    Bounds box;
    bool any = false;
};

MarkedBox box_of(const TriangleMesh& mesh, const std::vector<bool>& is_marked) {
    MarkedBox result;
    for (std::size_t v = 0; v < mesh.num_vertices(); ++v) {
        if (!is_marked[v])
            continue;
        const glm::vec3& position = mesh.positions[v];
        result.box.min = result.any ? glm::min(result.box.min, position) : position;
        result.box.max = result.any ? glm::max(result.box.max, position) : position;
        result.any = true;
    }
    return result;
}

/// Marks the vertices of triangles among `of` that rise above a height.
std::vector<bool> above(const TriangleMesh& mesh, const std::vector<bool>& of, float height) {
    std::vector<bool> marks(mesh.num_vertices(), false);
    for (const Triangle& triangle : mesh.triangles)
        if (of[triangle[0]] && std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) {
                return mesh.positions[v].y > height;
            }))
            for (const std::uint32_t v : triangle)
                marks[v] = true;
    return marks;
}

/// Marks the vertices of triangles among `of` that stay within the sides of a box.
std::vector<bool> inside(const TriangleMesh& mesh, const std::vector<bool>& of, const Bounds& box) {
    const glm::vec3 margin = 0.1f * box.size();
    std::vector<bool> marks(mesh.num_vertices(), false);
    for (const Triangle& triangle : mesh.triangles)
        if (of[triangle[0]] && std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) {
                const glm::vec3& at = mesh.positions[v];
                return at.x >= box.min.x - margin.x && at.x <= box.max.x + margin.x &&
                       at.z >= box.min.z - margin.z && at.z <= box.max.z + margin.z;
            }))
            for (const std::uint32_t v : triangle)
                marks[v] = true;
    return marks;
}

Bounds box_of_counted(const TriangleMesh& mesh, const std::vector<bool>& counts) {
    std::vector<bool> used(mesh.num_vertices(), false);
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        if (counts[i])
            for (const std::uint32_t v : mesh.triangles[i])
                used[v] = true;
    return box_of(mesh, used).box;
}

void leave_out_unseen(const TriangleMesh& mesh, Extent& extent) {
    if (mesh.triangle_materials.empty() ||
        std::none_of(mesh.materials.begin(), mesh.materials.end(), is_unseen))
        return;
    std::vector<bool> counts(mesh.num_triangles());
    std::size_t num_unseen = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        counts[i] = !is_unseen(mesh.materials[mesh.triangle_materials[i]]);
        num_unseen += counts[i] ? 0 : 1;
    }
    if (num_unseen == 0 || num_unseen == counts.size())
        return;
    extent.num_unseen = num_unseen;
    extent.box = box_of_counted(mesh, counts);
    extent.counts = std::move(counts);
}

/// How far the triangles of a mesh reach from the middle of most of them.
class Reaches {
public:
    Reaches(const TriangleMesh& mesh, const Extent& extent) : mesh_(mesh), extent_(extent) {
        constexpr std::size_t MostSamples = 4096;
        const std::size_t step = 1 + mesh.num_triangles() / MostSamples;
        std::vector<glm::dvec3> centres;
        for (std::size_t i = 0; i < mesh.num_triangles(); i += step)
            if (counts(i))
                centres.push_back(centre(mesh.triangles[i]));
        if (centres.empty())
            return;
        for (int axis = 0; axis < 3; ++axis)
            middle_[axis] = median(centres, [=](const glm::dvec3& at) { return at[axis]; });
        usual_ =
            median(centres, [this](const glm::dvec3& at) { return glm::distance(at, middle_); });
        for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
            if (counts(i))
                farthest_ = std::max(farthest_, of(i));
    }

    [[nodiscard]] bool counts(std::size_t triangle) const {
        return extent_.counts.empty() || extent_.counts[triangle];
    }
    [[nodiscard]] double of(std::size_t triangle) const {
        double result = 0.0;
        for (const std::uint32_t corner : mesh_.triangles[triangle])
            result = std::max(result, glm::distance(glm::dvec3(mesh_.positions[corner]), middle_));
        return result;
    }
    [[nodiscard]] double farthest() const { return farthest_; }
    /// That of half of the triangles
    [[nodiscard]] double usual() const { return usual_; }

private:
    [[nodiscard]] glm::dvec3 centre(const Triangle& triangle) const {
        return (glm::dvec3(mesh_.positions[triangle[0]]) +
                glm::dvec3(mesh_.positions[triangle[1]]) +
                glm::dvec3(mesh_.positions[triangle[2]])) /
               3.0;
    }
    template<typename Value>
    static double median(const std::vector<glm::dvec3>& of, const Value& value) {
        std::vector<double> values;
        for (const glm::dvec3& each : of)
            values.push_back(value(each));
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    }

    const TriangleMesh& mesh_;
    const Extent& extent_;
    glm::dvec3 middle_{0.0};
    double usual_ = 0.0, farthest_ = 0.0;
};

/// Returns the area of a triangle, but no more than the square of its shortest side: one corner far
/// away gives no weight.
double weight(const TriangleMesh& mesh, const Triangle& triangle) {
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 side = glm::dvec3(mesh.positions[triangle[(k + 1) % 3]]) -
                                glm::dvec3(mesh.positions[triangle[k]]);
        shortest = std::min(shortest, glm::dot(side, side));
    }
    return std::min(shortest, 0.5 * glm::length(area_normal(mesh.positions, triangle)));
}

void leave_out_strays(const TriangleMesh& mesh, Extent& extent) {
    const Reaches reaches(mesh, extent);
    if (!(reaches.farthest() > Far * reaches.usual()) || !std::isfinite(reaches.farthest()))
        return;
    std::vector<std::pair<double, double>> found; // reach and weight
    double all = 0.0;
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        if (reaches.counts(i)) {
            found.emplace_back(reaches.of(i), weight(mesh, mesh.triangles[i]));
            all += found.back().second;
        }
    std::sort(found.begin(), found.end());
    double left = Light * all, reach = 0.0;
    for (auto each = found.rbegin(); each != found.rend() && left >= 0.0; ++each) {
        reach = each->first;
        left -= each->second;
    }
    if (!(reaches.farthest() > Far * reach))
        return;
    std::vector<bool> counts(mesh.num_triangles());
    for (std::size_t i = 0; i < counts.size(); ++i) {
        counts[i] = reaches.counts(i) && reaches.of(i) <= Far * reach;
        extent.num_stray += reaches.counts(i) && !counts[i] ? 1 : 0;
    }
    extent.reach = static_cast<float>(reach);
    extent.stray_reach = static_cast<float>(reaches.farthest());
    extent.box = box_of_counted(mesh, counts);
    extent.counts = std::move(counts);
}

/// Whether what lies below a height is a plate: seen from above, it covers some of the box. Low
/// houses of a town do not.
bool is_plate(const TriangleMesh& mesh, const Extent& extent, float height, const Bounds& box) {
    constexpr double Covered = 0.25;
    double area = 0.0;
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
        const Triangle& triangle = mesh.triangles[i];
        if ((extent.counts.empty() || extent.counts[i]) &&
            std::all_of(triangle.begin(), triangle.end(),
                        [&](std::uint32_t v) { return mesh.positions[v].y <= height; }))
            area += 0.5 * std::abs(area_normal(mesh.positions, triangle).y);
    }
    return area >= Covered * double{box.size().x} * double{box.size().z};
}

} // namespace

Extent extent(const TriangleMesh& mesh) {
    Extent result{.box = bounds(mesh)};
    if (mesh.triangles.empty())
        return result;
    leave_out_unseen(mesh, result);
    leave_out_strays(mesh, result);
    return result;
}

std::vector<std::string> doubts_of_size(const TriangleMesh& mesh) {
    const Extent found = extent(mesh);
    std::vector<std::string> lines;
    if (found.num_unseen != 0)
        lines.push_back(fmt::format("{} triangles have an alpha of 0 and are not seen: camera and "
                                    "floor are placed without them",
                                    found.num_unseen));
    if (found.num_stray != 0)
        lines.push_back(fmt::format("{} triangles lie {:.3g} away, all others within {:.3g}: "
                                    "camera and floor are placed without them",
                                    found.num_stray, found.stray_reach, found.reach));
    return lines;
}

std::vector<bool> subject(const TriangleMesh& mesh, const Extent& extent) {
    constexpr float Wider = 1.5f;
    const Bounds& all = extent.box;
    std::vector<bool> used(mesh.num_vertices(), false);
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        if (extent.counts.empty() || extent.counts[i])
            for (const std::uint32_t v : mesh.triangles[i])
                used[v] = true;
    std::vector<bool> stands = above(mesh, used, all.min.y + 1e-3f * all.size().y);
    const MarkedBox whole = box_of(mesh, stands);
    if (!whole.any)
        return used;
    const auto width = [](const Bounds& box) {
        return std::max(box.size().x, box.size().z);
    };
    // From thin plates to thick ones, so that little of the rest is cut off.
    for (const float thickness : {0.001f, 0.003f, 0.01f, 0.02f}) {
        const float height = whole.box.min.y + thickness * width(whole.box);
        const MarkedBox upper = box_of(mesh, above(mesh, stands, height));
        if (!upper.any)
            return stands;
        if (width(whole.box) > Wider * width(upper.box) &&
            is_plate(mesh, extent, height, whole.box))
            return inside(mesh, stands, upper.box);
    }
    return stands;
}

Bounds subject_bounds(const TriangleMesh& mesh) {
    return bounds_of(mesh, subject(mesh, extent(mesh)));
}

Bounds bounds_of(const TriangleMesh& mesh, const std::vector<bool>& vertices) {
    return box_of(mesh, vertices).box;
}

float scale(const TriangleMesh& mesh) {
    constexpr float MostOfSubject = 10.0f;
    const Extent found = extent(mesh);
    const float all = found.box.diagonal();
    const float of_subject = bounds_of(mesh, subject(mesh, found)).diagonal();
    return of_subject > 0.0f ? std::min(all, MostOfSubject * of_subject) : all;
}

} // namespace relumine::mesh
