#include "prt/receivers/texel_receivers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "files/parallel.h"
#include "mesh/tangents.h"

namespace relumine::prt {

namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// A triangle in the atlas, in texel coordinates: x to the right, y down. Texel (x, y) is [x, x +
/// 1] x [y, y + 1].
class Chart {
public:
    Chart(const mesh::TriangleMesh& mesh, std::uint32_t triangle, const AtlasSize& size,
          std::uint32_t uv_set) {
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 uv(mesh::corner_uv(mesh, triangle, i, uv_set));
            corners_[i] = {uv.x * size.width, (1.0 - uv.y) * size.height};
        }
        double longest = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 edge = corners_[(i + 1) % 3] - corners_[i];
            longest = std::max(longest, glm::dot(edge, edge));
        }
        area_ = cross(corners_[1] - corners_[0], corners_[2] - corners_[0]);
        // A triangle thinner than a billionth of its length has an area only by rounding of the
        // uvs.
        is_flat_ = !(std::abs(area_) > 1e-9 * longest);
    }

    [[nodiscard]] bool is_flat() const { return is_flat_; }
    [[nodiscard]] glm::dvec2 low() const {
        return glm::min(glm::min(corners_[0], corners_[1]), corners_[2]);
    }
    [[nodiscard]] glm::dvec2 high() const {
        return glm::max(glm::max(corners_[0], corners_[1]), corners_[2]);
    }

    /// Returns the weights of the three corners at a point.
    [[nodiscard]] glm::dvec3 weights(const glm::dvec2& p) const {
        return glm::dvec3(cross(corners_[1] - p, corners_[2] - p),
                          cross(corners_[2] - p, corners_[0] - p),
                          cross(corners_[0] - p, corners_[1] - p)) /
               area_;
    }

    /// Whether the triangle and the inside of a texel have a point in common: no edge has the whole
    /// texel on its outer side. The texel's box must share an area with the triangle's box.
    [[nodiscard]] bool touches(double x, double y) const {
        const double side = area_ > 0.0 ? 1.0 : -1.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 from = corners_[i];
            const glm::dvec2 edge = corners_[(i + 1) % 3] - from;
            // The texel's corner that is farthest on the inner side.
            const glm::dvec2 inward = side * glm::dvec2(-edge.y, edge.x);
            const glm::dvec2 corner(x + (inward.x > 0.0 ? 1.0 : 0.0),
                                    y + (inward.y > 0.0 ? 1.0 : 0.0));
            // A chart that ends on a texel's border must not touch the next texel by rounding of
            // uvs in float.
            if (!(glm::dot(inward, corner - from) > 1e-5 * glm::length(edge)))
                return false;
        }
        return true;
    }

    /// Returns the nearest point to p on the triangle's border: its weights and squared distance.
    [[nodiscard]] std::pair<glm::dvec3, double> nearest_on_border(const glm::dvec2& p) const {
        std::pair<glm::dvec3, double> best{{}, std::numeric_limits<double>::infinity()};
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 from = corners_[i];
            const glm::dvec2 edge = corners_[(i + 1) % 3] - from;
            const double squared = glm::dot(edge, edge);
            const double t =
                squared > 0.0 ? std::clamp(glm::dot(p - from, edge) / squared, 0.0, 1.0) : 0.0;
            const glm::dvec2 way = p - (from + t * edge);
            if (const double distance = glm::dot(way, way); distance < best.second) {
                best.first = glm::dvec3(0.0);
                best.first[static_cast<int>(i)] = 1.0 - t;
                best.first[static_cast<int>((i + 1) % 3)] = t;
                best.second = distance;
            }
        }
        return best;
    }

private:
    std::array<glm::dvec2, 3> corners_{};
    /// Twice the area, signed.
    double area_ = 0.0;
    bool is_flat_ = false;
};

enum class Owner : std::uint8_t {
    None,
    /// A triangle touches the texel, but its centre is outside.
    Border,
    /// The centre is on an edge: it is also on the edge of the triangle behind.
    Edge,
    /// The centre is inside one triangle.
    Inside,
    /// The centre is inside several triangles.
    Overlapping,
};

struct Texel {
    MeshPoint point;
    /// Squared distance from the centre; for Border only.
    float distance = std::numeric_limits<float>::infinity();
    Owner owner = Owner::None;
};

class Atlas {
public:
    Atlas(const mesh::TriangleMesh& mesh, const AtlasSize& size, std::uint32_t uv_set)
        : mesh_(mesh), size_(size), uv_set_(uv_set),
          texels_(std::size_t{size.width} * size.height) {}

    void draw() {
        for (std::uint32_t triangle = 0; triangle < mesh_.num_triangles(); ++triangle)
            draw(triangle);
    }
    [[nodiscard]] const std::vector<Texel>& texels() const { return texels_; }
    [[nodiscard]] std::size_t num_flat() const { return num_flat_; }
    [[nodiscard]] std::size_t num_outside() const { return num_outside_; }

private:
    void draw(std::uint32_t triangle) {
        const Chart chart(mesh_, triangle, size_, uv_set_);
        if (chart.is_flat()) {
            ++num_flat_;
            return;
        }
        const glm::dvec2 end(size_.width, size_.height);
        const glm::dvec2 low = chart.low();
        const glm::dvec2 high = chart.high();
        // Farther out than the rounding of uvs in float.
        const glm::dvec2 slack = 1e-5 * end;
        if (low.x < -slack.x || low.y < -slack.y || high.x > end.x + slack.x ||
            high.y > end.y + slack.y)
            ++num_outside_;
        const glm::dvec2 first = glm::floor(glm::clamp(low, glm::dvec2(0.0), end));
        const glm::dvec2 last = glm::ceil(glm::clamp(high, glm::dvec2(0.0), end));
        for (auto y = static_cast<std::uint32_t>(first.y); y < static_cast<std::uint32_t>(last.y);
             ++y)
            for (auto x = static_cast<std::uint32_t>(first.x);
                 x < static_cast<std::uint32_t>(last.x); ++x)
                claim(texels_[std::size_t{y} * size_.width + x], triangle, chart, x, y);
    }

    static void claim(Texel& texel, std::uint32_t triangle, const Chart& chart, double x,
                      double y) {
        const glm::dvec2 centre(x + 0.5, y + 0.5);
        const glm::dvec3 weights = chart.weights(centre);
        const double least = std::min({weights.x, weights.y, weights.z});
        if (least >= 0.0) {
            // A centre nearer to an edge may also be inside the triangle behind it, by rounding.
            constexpr double Strictly = 1e-6;
            const bool strictly = least > Strictly;
            if (texel.owner < Owner::Edge) {
                texel.point = {
                    .triangle = triangle,
                    .barycentric = {static_cast<float>(weights.y), static_cast<float>(weights.z)}};
                texel.owner = strictly ? Owner::Inside : Owner::Edge;
            } else if (strictly) {
                texel.owner = texel.owner == Owner::Edge ? Owner::Inside : Owner::Overlapping;
            }
            return;
        }
        if (texel.owner >= Owner::Edge || !chart.touches(x, y))
            return;
        const auto [nearest, distance] = chart.nearest_on_border(centre);
        if (static_cast<float>(distance) >= texel.distance)
            return;
        texel = {.point = {.triangle = triangle,
                           .barycentric = {static_cast<float>(nearest.y),
                                           static_cast<float>(nearest.z)}},
                 .distance = static_cast<float>(distance),
                 .owner = Owner::Border};
    }

    const mesh::TriangleMesh& mesh_;
    AtlasSize size_;
    std::uint32_t uv_set_;
    std::vector<Texel> texels_;
    std::size_t num_flat_ = 0;
    std::size_t num_outside_ = 0;
};

} // namespace

TexelReceivers texel_receivers(const mesh::TriangleMesh& mesh, const AtlasSize& size,
                               std::uint32_t uv_set) {
    const auto is_size = [](std::uint32_t side) {
        return side >= 1 && side <= MaxPictureSize;
    };
    if (!is_size(size.width) || !is_size(size.height) ||
        std::size_t{size.width} * size.height > MaxTexels)
        throw std::invalid_argument(
            fmt::format("expected a lightmap of 1 to {} texels a side and {} in all, got {} x {}",
                        MaxPictureSize, MaxTexels, size.width, size.height));
    if (uv_set == 0 ? mesh.uvs.empty() && mesh.corner_uvs.empty() : mesh.second_uvs.empty())
        throw std::invalid_argument("expected a mesh with uvs for a lightmap, got one without");

    Atlas atlas(mesh, size, uv_set);
    atlas.draw();
    TexelReceivers result{
        .receivers = {},
        .layout = {.width = size.width, .height = size.height},
        .report = {.num_flat = atlas.num_flat(), .num_outside = atlas.num_outside()}};
    const std::vector<Texel>& texels = atlas.texels();
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const Texel& texel = texels[i];
        if (texel.owner == Owner::None)
            continue;
        result.layout.texels.push_back(static_cast<std::uint32_t>(i));
        result.receivers.points.push_back(texel.point);
        result.report.num_borders += static_cast<std::size_t>(texel.owner == Owner::Border);
        if (texel.owner == Owner::Overlapping && result.report.num_overlapping++ == 0)
            result.report.first_overlap = static_cast<std::uint32_t>(i);
    }
    if (result.layout.texels.empty())
        throw std::invalid_argument(fmt::format("expected uvs that touch a texel of {} x {}, got "
                                                "{} triangles without an area in uv and {} "
                                                "that reach beyond 0 to 1, of {}",
                                                size.width, size.height, atlas.num_flat(),
                                                atlas.num_outside(), mesh.num_triangles()));
    Receivers& receivers = result.receivers;
    receivers.positions.resize(receivers.points.size());
    receivers.normals.resize(receivers.points.size());
    files::parallel_for(std::size_t{0}, receivers.points.size(), [&](std::size_t i) {
        receivers.positions[i] = smooth_position(mesh, receivers.points[i]);
        receivers.normals[i] = mapped_normal(mesh, receivers.points[i]);
    });
    return result;
}

} // namespace relumine::prt
