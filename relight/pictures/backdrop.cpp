#include "relight/pictures/backdrop.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "cubemap/image/projection.h"
#include "cubemap/resample/resample.h"
#include "files/parallel.h"

namespace relumine::relight {

namespace {

using cubemap::EnvironmentImage;
using cubemap::Layout;

/// Interpolates the four pixels around a place, given in pixels from the top left pixel's centre.
/// Columns go on at the other side where the picture is closed. Pixels of which `shows` is false do
/// not count.
template<typename Shows>
glm::vec3 bilinear(const EnvironmentImage& image, const glm::dvec2& place, bool is_closed,
                   const Shows& shows) {
    const auto width = static_cast<std::int64_t>(image.width);
    const auto height = static_cast<std::int64_t>(image.height);
    const glm::dvec2 corner(std::floor(place.x), std::floor(place.y));
    const glm::dvec2 part = place - corner;
    glm::dvec3 sum(0.0);
    double weight = 0.0;
    for (int i = 0; i < 4; ++i) {
        const int right = i & 1, down = i >> 1;
        const double own =
            (right != 0 ? part.x : 1.0 - part.x) * (down != 0 ? part.y : 1.0 - part.y);
        std::int64_t x = static_cast<std::int64_t>(corner.x) + right;
        // The place is at most one pixel outside: no division is needed.
        if (is_closed)
            x = x < 0 ? x + width : x >= width ? x - width : x;
        x = std::clamp<std::int64_t>(x, 0, width - 1);
        const std::int64_t y =
            std::clamp<std::int64_t>(static_cast<std::int64_t>(corner.y) + down, 0, height - 1);
        if (own == 0.0 || !shows(x, y))
            continue;
        sum += own * glm::dvec3(image.pixels[static_cast<std::size_t>(y * width + x)]);
        weight += own;
    }
    return weight > 0.0 ? glm::vec3(sum / weight) : glm::vec3(0.0f);
}

constexpr auto Always = [](std::int64_t, std::int64_t) {
    return true;
};

/// Returns the place of a direction in a lat-long image.
glm::dvec2 lat_long(const EnvironmentImage& image, const glm::dvec3& w) {
    const double u = 0.5 - std::atan2(w.x, w.z) / (2.0 * std::numbers::pi);
    const double v = 0.5 - std::asin(std::clamp(w.y, -1.0, 1.0)) / std::numbers::pi;
    if (image.sampling == cubemap::Sampling::Borders)
        return {u * (image.width - 1.0), v * (image.height - 1.0)};
    return {u * image.width - 0.5, v * image.height - 0.5};
}

glm::vec3 projected(const EnvironmentImage& image, const cubemap::Projection& projection,
                    const glm::dvec3& w) {
    const glm::dvec2 point = projection.point(w);
    const glm::dvec2 size(image.width, image.height);
    const bool is_disc = projection.is_disc();
    return bilinear(image, point * size - 0.5, false, [&](std::int64_t x, std::int64_t y) {
        const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / size - 0.5;
        return !is_disc || glm::dot(at, at) <= 0.25;
    });
}

/// Directions spread as a Gaussian about +Z.
std::vector<glm::dvec3> gaussian_spread(double sigma) {
    constexpr std::size_t NumDirections = 128;
    const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
    std::vector<glm::dvec3> spread;
    for (std::size_t i = 0; i < NumDirections; ++i) {
        const double share = (static_cast<double>(i) + 0.5) / NumDirections;
        const double angle =
            std::min(sigma * std::sqrt(-2.0 * std::log(1.0 - share)), std::numbers::pi);
        const double turn = golden_angle * static_cast<double>(i);
        spread.emplace_back(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                            std::cos(angle));
    }
    return spread;
}

cubemap::CubeMap blurred(const cubemap::CubeMap& map, double degrees) {
    const double sigma = degrees * std::numbers::pi / 180.0 / 2.355;
    // Texels of less than half of sigma hold all that the blur leaves.
    const double needed = 0.5 * std::numbers::pi / (0.45 * sigma);
    const auto resolution = static_cast<std::uint32_t>(std::clamp(std::ceil(needed), 8.0, 384.0));
    const cubemap::CubeMap source = cubemap::halved_to(map, 2 * resolution - 1);
    const std::vector<glm::dvec3> spread = gaussian_spread(sigma);
    cubemap::CubeMap result(resolution);
    files::parallel_for(std::uint32_t{0}, 6 * resolution, [&](std::uint32_t row) {
        const auto face = static_cast<cubemap::Face>(row / resolution);
        const std::uint32_t y = row % resolution;
        for (std::uint32_t x = 0; x < resolution; ++x) {
            const glm::dvec3 middle = cubemap::texel_direction(face, x, y, resolution);
            const glm::dvec3 other =
                std::abs(middle.y) < 0.7 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
            const glm::dvec3 right = glm::normalize(glm::cross(other, middle));
            const glm::dvec3 up = glm::cross(middle, right);
            glm::dvec3 sum(0.0);
            for (const glm::dvec3& w : spread)
                sum += glm::dvec3(
                    cubemap::sample(source, glm::vec3(w.x * right + w.y * up + w.z * middle)));
            result.at(face, x, y) = glm::vec3(sum / static_cast<double>(spread.size()));
        }
    });
    return result;
}

} // namespace

glm::vec3 Chart::seen(const ChartSpot& at) const {
    const glm::vec3 shown = bilinear(*image, at.place, is_closed, Always);
    return at.hidden > 0.0f ? glm::mix(shown, hiding, at.hidden) : shown;
}

Backdrop::Backdrop(Chart chart) : chart_(std::make_shared<const Chart>(std::move(chart))) {
    seen_ = [own = chart_](const glm::vec3& direction) {
        return own->seen(own->spot(direction));
    };
}

Backdrop plain_backdrop(const glm::vec3& color) {
    return [color](const glm::vec3&) {
        return color;
    };
}

Backdrop map_backdrop(const cubemap::CubeMap& map) {
    if (map.resolution == 0)
        throw std::invalid_argument("expected a background with texels");
    return [&map](const glm::vec3& direction) {
        return cubemap::sample(map, direction);
    };
}

Backdrop image_backdrop(std::shared_ptr<const EnvironmentImage> image, const glm::dmat3& turn) {
    const glm::dmat3 image_from_world = glm::inverse(turn);
    if (cubemap::has_faces(image->layout)) {
        const auto map = std::make_shared<const cubemap::CubeMap>(
            cubemap::resample(*image, cubemap::natural_resolution(*image)));
        return [map, image_from_world](const glm::vec3& direction) {
            return cubemap::sample(*map, glm::vec3(image_from_world * glm::dvec3(direction)));
        };
    }
    if (const cubemap::Projection* projection = cubemap::projection(image->layout))
        return
            [image = std::move(image), image_from_world, projection](const glm::vec3& direction) {
                return projected(*image, *projection,
                                 glm::normalize(image_from_world * glm::dvec3(direction)));
            };
    Chart chart;
    chart.image = image;
    chart.is_closed = image->sampling != cubemap::Sampling::Borders;
    chart.spot = [image = std::move(image), image_from_world](const glm::vec3& direction) {
        return ChartSpot{
            .place = lat_long(*image, glm::normalize(image_from_world * glm::dvec3(direction)))};
    };
    return Backdrop(std::move(chart));
}

Backdrop backdrop_of(const cubemap::EnvironmentFile& file) {
    return file.image ? image_backdrop(file.image, file.turn) : Backdrop();
}

Backdrop edited_backdrop(Backdrop sharp, const cubemap::CubeMap& base,
                         const cubemap::CubeMap& edited) {
    if (base.resolution == 0 || edited.resolution == 0)
        throw std::invalid_argument("expected a background with texels");
    return [sharp = std::move(sharp), &base, &edited](const glm::vec3& direction) {
        const glm::vec3 before = cubemap::sample(base, direction);
        const glm::vec3 after = cubemap::sample(edited, direction);
        glm::vec3 result = sharp(direction);
        for (int channel = 0; channel < 3; ++channel)
            if (after[channel] > before[channel])
                result[channel] += after[channel] - before[channel];
            else if (after[channel] < before[channel])
                result[channel] *= after[channel] / before[channel];
        return result;
    };
}

Backdrop blurred_backdrop(const cubemap::CubeMap& map, double degrees) {
    if (map.resolution == 0)
        throw std::invalid_argument("expected a background with texels");
    if (!(degrees > 0.0 && degrees <= 180.0))
        throw std::invalid_argument("expected a blur of up to 180 degrees");
    const auto soft = std::make_shared<const cubemap::CubeMap>(blurred(map, degrees));
    return [soft](const glm::vec3& direction) {
        return cubemap::sample(*soft, direction);
    };
}

} // namespace relumine::relight
