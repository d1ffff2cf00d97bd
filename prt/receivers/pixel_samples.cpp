#include "prt/receivers/pixel_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::prt {

namespace {

/// The surfaces that a ray meets, nearest first; none where it leaves.
using Sight = std::vector<RayScene::Layer>;

/// Moves a hit into its triangle: a ray through a shared edge may end a rounding error outside.
glm::vec2 inside(const glm::vec2& barycentric) {
    const glm::vec2 positive(std::max(barycentric.x, 0.0f), std::max(barycentric.y, 0.0f));
    return positive / std::max(positive.x + positive.y, 1.0f);
}

MeshPoint point_of(const RayScene::Layer& layer) {
    return {layer.hit.triangle, inside(layer.hit.barycentric)};
}

class PixelSamples {
public:
    PixelSamples(const mesh::TriangleMesh& mesh, const RayScene& rays, const PixelView& view)
        : mesh_(mesh), rays_(rays), view_(view),
          picture_(view.camera, view.width, view.height,
                   view.samples_per_axis.value_or(PixelLayout::EdgeSamplesPerAxis)) {}

    [[nodiscard]] std::vector<SeenSurface> row(std::uint32_t y) const {
        return view_.samples_per_axis ? evenly(y) : by_edges(y);
    }

private:
    void look(const glm::vec3& direction, Sight& sight) const {
        sight.clear();
        const auto hit = rays_.closest_hit(view_.camera.eye, direction, RayOf::Eye);
        if (!hit)
            return;
        if (rays_.is_thin(hit->triangle))
            rays_.layers(view_.camera.eye, direction, sight);
        else
            sight.push_back({*hit, {}});
    }

    /// Rays that see the same surface, and what their normals' spread counts.
    struct Alike {
        std::span<const Sight* const> sights = {};
        float weight = 1.0f;
    };
    /// Adds what is seen, which stands for what rays see that are alike.
    void add(const Sight& sight, const Alike& alike, std::uint32_t sample, unsigned share,
             std::vector<SeenSurface>& row) const {
        for (std::size_t i = 0; i < sight.size(); ++i)
            row.push_back({sample, point_of(sight[i]), sight[i].veil,
                           static_cast<std::uint16_t>(share),
                           alike.weight * normal_spread(alike.sights, i)});
    }

    /// Returns the mean square by which the normals of a layer differ from their mean.
    [[nodiscard]] float normal_spread(std::span<const Sight* const> sights,
                                      std::size_t layer) const {
        if (sights.size() < 2)
            return 0.0f;
        glm::vec3 sum(0.0f);
        for (const Sight* const sight : sights)
            sum += mapped_normal(mesh_, point_of((*sight)[layer]));
        const glm::vec3 mean = sum / static_cast<float>(sights.size());
        return std::max(1.0f - glm::dot(mean, mean), 0.0f);
    }

    [[nodiscard]] std::vector<SeenSurface> evenly(std::uint32_t y) const {
        std::vector<SeenSurface> row;
        Sight sight;
        auto sample =
            static_cast<std::uint32_t>(std::size_t{y} * view_.width * picture_.samples_per_pixel());
        for (std::uint32_t x = 0; x < view_.width; ++x)
            for (std::uint32_t i = 0; i < picture_.samples_per_pixel(); ++i, ++sample) {
                look(picture_.direction(x, y, i), sight);
                add(sight, {}, sample, 1, row);
            }
        return row;
    }

    [[nodiscard]] std::vector<SeenSurface> by_edges(std::uint32_t y) const {
        constexpr unsigned All = (1u << PixelLayout::EdgeSamples) - 1u;
        // A linear function's variance in a square is a third of that at its corners.
        constexpr float SpreadInside = 1.0f / 3.0f;
        std::vector<SeenSurface> row;
        std::array<std::vector<Sight>, 2> corners; // above and below
        for (std::uint32_t i = 0; i < 2; ++i) {
            corners[i].resize(view_.width + std::size_t{1});
            for (std::uint32_t x = 0; x <= view_.width; ++x)
                look(picture_.direction(glm::vec2(x, y + i)), corners[i][x]);
        }
        Sight middle;
        for (std::uint32_t x = 0; x < view_.width; ++x) {
            look(picture_.direction(glm::vec2(x, y) + 0.5f), middle);
            const std::size_t right = x + std::size_t{1};
            const std::array<const Sight*, 4> around = {&corners[0][x], &corners[0][right],
                                                        &corners[1][x], &corners[1][right]};
            const bool is_even = std::all_of(around.begin(), around.end(), [&](const Sight* sight) {
                return is_same(middle, *sight);
            });
            const auto first = static_cast<std::uint32_t>((std::size_t{y} * view_.width + x) *
                                                          PixelLayout::EdgeSamples);
            if (is_even)
                add(middle, {around, SpreadInside}, first, All, row);
            else
                add_surfaces(x, y, first, row);
        }
        return row;
    }

    /// Adds a receiver for each surface that the samples of a pixel see, where the sample lies that
    /// is nearest to the middle of those that see it.
    void add_surfaces(std::uint32_t x, std::uint32_t y, std::uint32_t first,
                      std::vector<SeenSurface>& row) const {
        std::array<Sight, PixelLayout::EdgeSamples> sights;
        unsigned left = 0;
        for (std::uint32_t i = 0; i < sights.size(); ++i) {
            look(picture_.direction(x, y, i), sights[i]);
            left |= sights[i].empty() ? 0u : 1u << i;
        }
        for (std::uint32_t i = 0; i < sights.size(); ++i) {
            if (((left >> i) & 1u) == 0)
                continue;
            unsigned share = 0;
            std::vector<const Sight*> same;
            for (std::uint32_t j = i; j < sights.size(); ++j)
                if (((left >> j) & 1u) != 0 && is_same(sights[i], sights[j])) {
                    share |= 1u << j;
                    same.push_back(&sights[j]);
                }
            left &= ~share;
            add(sights[middle_of(share)], {same}, first + i, share, row);
        }
    }

    /// Returns the sample of a set that is nearest to their middle.
    static std::size_t middle_of(unsigned share) {
        const auto place = [](std::uint32_t i) {
            return glm::vec2(i % PixelLayout::EdgeSamplesPerAxis,
                             i / PixelLayout::EdgeSamplesPerAxis);
        };
        glm::vec2 sum(0.0f);
        float count = 0.0f;
        for (std::uint32_t i = 0; i < PixelLayout::EdgeSamples; ++i)
            if (((share >> i) & 1u) != 0) {
                sum += place(i);
                ++count;
            }
        std::uint32_t nearest = 0;
        float least = INFINITY;
        for (std::uint32_t i = 0; i < PixelLayout::EdgeSamples; ++i)
            if (const float distance = glm::distance(place(i), sum / count);
                ((share >> i) & 1u) != 0 && distance < least) {
                least = distance;
                nearest = i;
            }
        return nearest;
    }

    [[nodiscard]] bool is_same(const Sight& a, const Sight& b) const {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                          [&](const RayScene::Layer& own, const RayScene::Layer& other) {
                              return is_same_surface(point_of(own), point_of(other));
                          });
    }

    /// Whether the surface goes on from one point to the other: without another material, a bend
    /// that is seen, or a step in depth.
    [[nodiscard]] bool is_same_surface(const MeshPoint& a, const MeshPoint& b) const {
        constexpr float CosineOfBend = 0.94f; // 20 degrees
        constexpr float SineOfStep = 0.5f;
        if (a.triangle == b.triangle)
            return true;
        if (!mesh_.triangle_materials.empty() &&
            mesh_.triangle_materials[a.triangle] != mesh_.triangle_materials[b.triangle])
            return false;
        if (glm::dot(shading_normal(mesh_, a), shading_normal(mesh_, b)) < CosineOfBend)
            return false;
        const glm::vec3 way =
            value_at(mesh_, mesh_.positions, b) - value_at(mesh_, mesh_.positions, a);
        return std::abs(glm::dot(face_normal(mesh_, a.triangle), way)) <=
               SineOfStep * glm::length(way);
    }

    const mesh::TriangleMesh& mesh_;
    const RayScene& rays_;
    const PixelView& view_;
    PictureRays picture_;
};

} // namespace

std::vector<std::vector<SeenSurface>> seen_rows(const mesh::TriangleMesh& mesh,
                                                const RayScene& rays, const PixelView& view,
                                                const Work& work) {
    const PixelSamples samples(mesh, rays, view);
    std::vector<std::vector<SeenSurface>> rows(view.height);
    constexpr std::uint32_t Band = 128; // rows between two looks at the work
    for (std::uint32_t y = 0; y < view.height; y += Band) {
        if (work.stop.stop_requested())
            throw Cancelled();
        files::parallel_for(y, std::min(y + Band, view.height),
                            [&](std::uint32_t row) { rows[row] = samples.row(row); });
        if (work.on_progress)
            work.on_progress(std::min(1.0, static_cast<double>(y + Band) / view.height));
    }
    return rows;
}

} // namespace relumine::prt
