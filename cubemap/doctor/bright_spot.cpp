#include "cubemap/doctor/bright_spot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine::cubemap {

namespace {

constexpr double RadiansPerDegree = std::numbers::pi / 180.0;

/// The surroundings are a ring about the peak. Its inner radius leaves out the bloom that lenses
/// put around the sun. Its width spans a piece of sky. In coarse maps both are at least some
/// texels.
constexpr double RingInnerDegrees = 8.0, RingOuterDegrees = 20.0;
constexpr double RingInnerTexels = 3.0, RingOuterTexels = 6.0;
/// No other spot is searched closer to a peak than this.
constexpr double ApartDegrees = 5.0;
constexpr double ApartTexels = 2.0;
/// A spot ends where the light above the surroundings falls below PeakPart of the peak's, or the
/// light falls below TimesSurroundings times the surroundings.
constexpr double PeakPart = 0.01;
constexpr double TimesSurroundings = 2.0;
/// Peaks below this part of the brightest peak are ignored.
constexpr double FaintestPeak = 0.002;

double distance_of_angle(double radians) {
    return 2.0 * std::sin(0.5 * std::min(radians, std::numbers::pi));
}

struct Finder {
    explicit Finder(const CubeMap& map)
        : resolution(map.resolution), texel_angle(0.5 * std::numbers::pi / map.resolution),
          solid_angles(texel_solid_angles(map.resolution)), luminances(map.texels.size()),
          taken(map.texels.size(), false) {
        for (std::size_t i = 0; i < map.texels.size(); ++i)
            luminances[i] = static_cast<float>(luminance(glm::dvec3(map.texels[i])));
        directions.reserve(map.texels.size());
        for (const Face face : AllFaces)
            for (std::uint32_t y = 0; y < resolution; ++y)
                for (std::uint32_t x = 0; x < resolution; ++x)
                    directions.emplace_back(texel_direction(face, x, y, resolution));
    }

    [[nodiscard]] double solid_angle(std::uint32_t texel) const {
        return solid_angles[texel % (std::size_t{resolution} * resolution)];
    }

    /// Returns the brightest texel that is not taken.
    [[nodiscard]] std::uint32_t peak() const {
        std::uint32_t best = 0;
        float value = -1.0f;
        for (std::uint32_t i = 0; i < luminances.size(); ++i) {
            if (!taken[i] && luminances[i] > value) {
                value = luminances[i];
                best = i;
            }
        }
        return value > 0.0f ? best : static_cast<std::uint32_t>(luminances.size());
    }

    /// Calls visit(texel, squared chord) for the texels within a chord.
    template<typename Visit>
    void near(const glm::vec3& direction, double chord, const Visit& visit) const {
        const auto limit = static_cast<float>(chord * chord);
        for (std::uint32_t i = 0; i < directions.size(); ++i) {
            const glm::vec3 apart = directions[i] - direction;
            const float squared = glm::dot(apart, apart);
            if (squared <= limit)
                visit(i, squared);
        }
    }

    [[nodiscard]] double surroundings(const glm::vec3& direction) const {
        const double inner = distance_of_angle(
            std::max(RingInnerDegrees * RadiansPerDegree, RingInnerTexels * texel_angle));
        const double outer = distance_of_angle(
            std::max(RingOuterDegrees * RadiansPerDegree, RingOuterTexels * texel_angle));
        std::vector<float> ring;
        near(direction, outer, [&](std::uint32_t texel, float squared) {
            if (squared > static_cast<float>(inner * inner))
                ring.push_back(luminances[texel]);
        });
        if (ring.empty())
            return 0.0;
        const auto middle = ring.begin() + static_cast<std::ptrdiff_t>(ring.size() / 2);
        std::nth_element(ring.begin(), middle, ring.end());
        return *middle;
    }

    /// Sets the spot's texels: all texels above `level` that are connected with `start`. The spot
    /// is cut at the chord `farthest`.
    void flood(std::uint32_t start, float farthest, double level, BrightSpot& spot) const {
        std::vector<std::uint32_t> front = {start};
        spot.texels = {start};
        std::vector<bool> seen(luminances.size(), false);
        seen[start] = true;
        while (!front.empty()) {
            std::vector<std::uint32_t> next;
            for (const std::uint32_t texel : grown(front, resolution)) {
                if (seen[texel] || taken[texel])
                    continue;
                seen[texel] = true;
                if (luminances[texel] <= level)
                    continue;
                if (glm::distance(directions[texel], directions[start]) > farthest) {
                    spot.is_cut = true;
                    continue;
                }
                next.push_back(texel);
            }
            spot.texels.insert(spot.texels.end(), next.begin(), next.end());
            front = std::move(next);
        }
    }

    [[nodiscard]] BrightSpot spot(std::uint32_t start, double max_radius) const {
        BrightSpot spot;
        spot.peak_direction = glm::normalize(glm::dvec3(directions[start]));
        spot.peak_luminance = luminances[start];
        spot.surrounding_luminance = surroundings(directions[start]);
        const double level =
            std::max(TimesSurroundings * spot.surrounding_luminance,
                     spot.surrounding_luminance +
                         PeakPart * (spot.peak_luminance - spot.surrounding_luminance));
        const double farthest = distance_of_angle(std::max(max_radius, 2.0 * texel_angle));
        flood(start, static_cast<float>(farthest), level, spot);
        std::sort(spot.texels.begin(), spot.texels.end());
        for (const std::uint32_t texel : spot.texels) {
            spot.solid_angle += solid_angle(texel);
            spot.irradiance +=
                (luminances[texel] - spot.surrounding_luminance) * solid_angle(texel);
        }
        return spot;
    }

    void take(const BrightSpot& spot) {
        // The rim is taken too: the spot covers its texels in part.
        for (const std::uint32_t texel : grown(grown(spot.texels, resolution), resolution))
            taken[texel] = true;
        const double apart =
            distance_of_angle(std::max(ApartDegrees * RadiansPerDegree, ApartTexels * texel_angle));
        near(glm::vec3(spot.peak_direction), apart,
             [&](std::uint32_t texel, float) { taken[texel] = true; });
    }

    std::uint32_t resolution;
    double texel_angle;
    std::vector<double> solid_angles;
    std::vector<float> luminances;
    std::vector<glm::vec3> directions;
    std::vector<bool> taken;
};

} // namespace

std::uint32_t texel_index(const glm::dvec3& direction, std::uint32_t resolution) {
    const FacePoint point = face_point(direction);
    const auto texel = [&](double position) {
        return static_cast<std::uint32_t>(std::clamp(position * resolution, 0.0, resolution - 1.0));
    };
    return (static_cast<std::uint32_t>(point.face) * resolution + texel(point.t)) * resolution +
           texel(point.s);
}

std::vector<std::uint32_t> grown(const std::vector<std::uint32_t>& texels,
                                 std::uint32_t resolution) {
    std::vector<std::uint32_t> result;
    result.reserve(9 * texels.size());
    const std::uint32_t per_face = resolution * resolution;
    for (const std::uint32_t texel : texels) {
        const Face face = AllFaces[texel / per_face];
        const std::int64_t x = texel % resolution, y = texel % per_face / resolution;
        for (std::int64_t dy = -1; dy <= 1; ++dy) {
            for (std::int64_t dx = -1; dx <= 1; ++dx) {
                const std::int64_t column = x + dx, row = y + dy;
                if (column >= 0 && row >= 0 && column < resolution && row < resolution)
                    result.push_back(static_cast<std::uint32_t>(static_cast<std::int64_t>(texel) +
                                                                dy * resolution + dx));
                else // a point just beyond the face's border lies on its neighbour
                    result.push_back(texel_index(
                        cube_point(face, (static_cast<double>(column) + 0.5) / resolution,
                                   (static_cast<double>(row) + 0.5) / resolution),
                        resolution));
            }
        }
    }
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
}

std::vector<BrightSpot> bright_spots(const CubeMap& map, const SpotOptions& options) {
    Finder finder(map);
    std::vector<BrightSpot> spots;
    while (spots.size() < options.max_spots) {
        const std::uint32_t peak = finder.peak();
        if (peak == map.texels.size() ||
            (!spots.empty() &&
             finder.luminances[peak] < FaintestPeak * spots.front().peak_luminance))
            break;
        spots.push_back(finder.spot(peak, options.max_radius_degrees * RadiansPerDegree));
        finder.take(spots.back());
    }
    return spots;
}

} // namespace relumine::cubemap
