#include "prt/visibility/shaft.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <glm/geometric.hpp>

namespace relumine::prt {
namespace {

/// Widest side of a patch's rectangle, in units of its distance. Beyond it a shaft holds most of a
/// scene.
constexpr float WidestPatch = 1.1f;

/// Rounding errors and their bounds: docs/error-bounds.md, rows S1 to S3.
constexpr float DirectionSlack = 8.0f * Rounding; // of s and t
constexpr float GroundSlack = 32.0f * Rounding;
constexpr float MarginRoundings = 96.0f;

/// Sum of the absolute components.
float norm_1(const glm::vec3& v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

} // namespace

std::size_t PatchPlane::Bins::bin(float place) const {
    const float exact = (place - begin) * per_unit;
    const float rounded = std::clamp(exact, 0.0f, static_cast<float>(NumBins - 1)) + ToInteger;
    return std::bit_cast<std::uint32_t>(rounded) & (NumBins - 1);
}

namespace {

/// Sorts the places of directions between two sides into bins.
PatchPlane::Bins bins_of(const std::array<float, DirectionPatch::Size>& places, float low,
                         float high) {
    constexpr std::size_t NumBins = PatchPlane::NumBins;
    PatchPlane::Bins bins;
    bins.per_unit = (static_cast<float>(NumBins) - 2.25f) / std::max(high - low, 1e-6f);
    bins.begin = low - 0.625f / bins.per_unit;
    bins.greatest_until.fill(low);
    bins.least_from.fill(high);
    for (std::size_t j = 0; j < places.size(); ++j) {
        const std::size_t i = bins.bin(places[j]);
        const std::uint32_t bit = std::uint32_t{1} << (j % 32);
        bins.until[j / 32][i] |= bit;
        bins.from[j / 32][i] |= bit;
        bins.greatest_until[i] = std::max(bins.greatest_until[i], places[j]);
        bins.least_from[i] = std::min(bins.least_from[i], places[j]);
    }
    for (auto& half : bins.until)
        std::partial_sum(half.begin(), half.end(), half.begin(), std::bit_or());
    for (auto& half : bins.from)
        std::partial_sum(half.rbegin(), half.rend(), half.rbegin(), std::bit_or());
    for (std::size_t i = 1; i < NumBins; ++i) {
        bins.greatest_until[i] = std::max(bins.greatest_until[i], bins.greatest_until[i - 1]);
        const std::size_t j = NumBins - 1 - i;
        bins.least_from[j] = std::min(bins.least_from[j], bins.least_from[j + 1]);
    }
    return bins;
}

} // namespace

PatchPlane patch_plane(const DirectionPatch& patch) {
    PatchPlane plane;
    plane.num_directions = patch.num_directions;
    const glm::vec3 first = patch.direction(0);
    const glm::vec3 size = glm::abs(first);
    plane.axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    plane.sign = first[plane.axis] > 0.0f ? 1.0f : -1.0f;
    plane.s0 = plane.t0 = std::numeric_limits<float>::infinity();
    plane.s1 = plane.t1 = -plane.s0;
    for (std::size_t j = 0; j < DirectionPatch::Size; ++j) {
        const glm::vec3 w = patch.direction(j);
        const float along = plane.sign * w[plane.axis];
        if (!(along > 0.1f))
            return plane;
        plane.s[j] = w[(plane.axis + 1) % 3] / along;
        plane.t[j] = w[(plane.axis + 2) % 3] / along;
        plane.s0 = std::min(plane.s0, plane.s[j]);
        plane.s1 = std::max(plane.s1, plane.s[j]);
        plane.t0 = std::min(plane.t0, plane.t[j]);
        plane.t1 = std::max(plane.t1, plane.t[j]);
    }
    plane.narrow = std::max(plane.s1 - plane.s0, plane.t1 - plane.t0) < WidestPatch &&
                   std::max({plane.s1, -plane.s0, plane.t1, -plane.t0}) < 2.0f;
    plane.s0 -= DirectionSlack;
    plane.s1 += DirectionSlack;
    plane.t0 -= DirectionSlack;
    plane.t1 += DirectionSlack;
    plane.columns = bins_of(plane.s, plane.s0, plane.s1);
    plane.rows = bins_of(plane.t, plane.t0, plane.t1);
    return plane;
}

/// The first four pass through the sides of the rectangle, the fifth is behind the receivers, the
/// sixth is the receivers' own ground, turned towards the patch until all directions leave it.
Shaft shaft_of(const PatchRectangle& patch, const glm::vec3& mean_normal, float reach) {
    const auto vector = [&](float along, float s, float t) {
        glm::vec3 v;
        v[patch.axis] = patch.sign * along;
        v[(patch.axis + 1) % 3] = s;
        v[(patch.axis + 2) % 3] = t;
        return v;
    };
    Shaft shaft;
    shaft.axis = patch.axis;
    shaft.sign = patch.sign;
    shaft.reach = reach;
    shaft.normals = {vector(-patch.s0, 1, 0), vector(patch.s1, -1, 0), vector(-patch.t0, 0, 1),
                     vector(patch.t1, 0, -1), vector(1, 0, 0),         vector(1, 0, 0)};
    shaft.corners = {vector(1, patch.s0, patch.t0), vector(1, patch.s1, patch.t0),
                     vector(1, patch.s0, patch.t1), vector(1, patch.s1, patch.t1)};
    const float length = glm::length(mean_normal);
    if (length > 0.0f) {
        const glm::vec3 normal = mean_normal / length;
        float least = std::numeric_limits<float>::infinity();
        for (const glm::vec3& corner : shaft.corners)
            least = std::min(least, glm::dot(normal, corner));
        const float turn = std::max(0.0f, GroundSlack - least);
        shaft.normals.back() = normal + turn * vector(1, 0, 0);
    }
    for (std::size_t k = 0; k < Shaft::NumPlanes; ++k)
        shaft.margins[k] = MarginRoundings * Rounding * norm_1(shaft.normals[k]) * reach +
                           std::numeric_limits<float>::min();
    shaft.offsets.fill(std::numeric_limits<float>::infinity());
    shaft.origins_low = glm::vec3(std::numeric_limits<float>::infinity());
    shaft.origins_high = -shaft.origins_low;
    return shaft;
}

} // namespace relumine::prt
