#include "relight/pictures/floor_shadows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "cubemap/face.h"
#include "cubemap/r2_sequence.h"
#include "relight/sharp/light_packets.h"

namespace relumine::relight {

namespace {

constexpr glm::vec3 Up(0.0f, 1.0f, 0.0f);

/// Pixels on a side of a square, whose rays are traced together.
constexpr std::uint32_t SquareSide = 8;

/// Returns a direction in a cell, of (s, t) in [0, 1].
glm::vec3 direction_in(const prt::Cell& cell, double s, double t) {
    return cubemap::direction(cell.face, (cell.x + s) * cell.size(), (cell.y + t) * cell.size());
}

/// Returns some of the points, far apart; the first is the farthest from the middle.
prt::DirectionPacket spread(const std::vector<glm::vec3>& points, const glm::vec3& middle) {
    std::vector<float> nearness;
    for (const glm::vec3& point : points)
        nearness.push_back(glm::dot(point, middle));
    prt::DirectionPacket result;
    while (result.num_directions < std::min(points.size(), prt::PacketSize)) {
        const auto next = static_cast<std::size_t>(
            std::min_element(nearness.begin(), nearness.end()) - nearness.begin());
        for (std::size_t lane = result.num_directions++;
             lane < (result.num_directions == 1 ? prt::PacketSize : result.num_directions); ++lane)
            result.set(lane, points[next]);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const float own = glm::dot(points[i], points[next]);
            nearness[i] = result.num_directions == 1 ? own : std::max(nearness[i], own);
        }
        nearness[next] = 2.0f;
    }
    return result;
}

double fraction(double x) {
    return x - std::floor(x);
}

std::uint64_t bits(std::size_t count) {
    return count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

} // namespace

FloorLights::FloorLights(std::span<const SharpLight> lights, std::size_t samples_per_pixel) {
    // Samples fill each cell evenly, and lights shift them by steps that fill the unit square
    // [Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"].
    constexpr double Golden = 1.0 / std::numbers::phi;
    struct Part {
        prt::DirectionPatch patch;
        std::vector<const SharpLight*> lights;
    };
    std::vector<Part> parts;
    for (const SharpLight& light : lights) {
        auto part = std::find_if(parts.begin(), parts.end(), [&](const Part& candidate) {
            return fits(candidate.patch, light);
        });
        if (part == parts.end())
            part = parts.emplace(part);
        part->patch.add(glm::vec3(light.direction));
        part->lights.push_back(&light);
    }
    for (const auto& [patch, part] : parts) {
        Beam& beam = beams_.emplace_back();
        glm::dvec3 sum(0.0);
        for (const SharpLight* light : part)
            sum += light->irradiance.luminance();
        beam.places.resize(samples_per_pixel);
        std::vector<glm::vec3> corners;
        for (std::size_t i = 0; i < part.size(); ++i) {
            const SharpLight& light = *part[i];
            beam.radiance[i] = light.irradiance.on(Up) / std::numbers::pi;
            beam.whole += beam.radiance[i];
            for (const auto& [right, down] : {std::pair(0.0, 0.0), std::pair(0.0, 1.0),
                                              std::pair(1.0, 0.0), std::pair(1.0, 1.0)})
                corners.push_back(direction_in(light.cell, right, down));
            for (std::size_t s = 0; s < samples_per_pixel; ++s) {
                const auto k = static_cast<double>(i), n = static_cast<double>(s);
                beam.places[s].add(direction_in(light.cell,
                                                (n + fraction(cubemap::R2StepS * k)) /
                                                    static_cast<double>(samples_per_pixel),
                                                fraction(Golden * n + cubemap::R2StepT * k)));
            }
        }
        beam.border = spread(corners, glm::vec3(glm::normalize(sum)));
    }
}

struct FloorShadows::Group {
    std::array<glm::vec3, prt::ReceiverGroup::MaxSize> origins{};
    std::array<std::uint64_t, prt::ReceiverGroup::MaxSize> reached{};
    std::array<std::uint32_t, prt::ReceiverGroup::MaxSize> pixels{};
    std::size_t size = 0;

    void add(const glm::vec3& origin, std::uint32_t pixel) {
        origins[size] = origin;
        pixels[size++] = pixel;
    }
    [[nodiscard]] bool is_full() const { return size == prt::ReceiverGroup::MaxSize; }
    /// Finds which directions of a patch reach the points.
    void trace(const prt::Blockers& blockers, const prt::DirectionPatch& patch) {
        std::fill_n(reached.begin(), size, bits(patch.num_directions));
        if (size != 0)
            blockers.clear_blocked({std::span(origins).first(size), Up}, patch,
                                   std::span(reached).first(size));
    }
};

glm::vec3 FloorShadows::origin(const prt::MeshPoint& point) const {
    return prt::ray_origin(prt::value_at(mesh_, mesh_.positions, point), Up, bias_);
}

void FloorShadows::trace(const SampleRectangle& seen, const PixelRectangle& inner) {
    pixels_ = seen.pixels();
    num_samples_.assign(pixels_.size(), 0);
    radiance_.assign(pixels_.size(), glm::vec3(0.0f));
    std::uint32_t any = 0;
    for (std::uint32_t y = inner.top; y < inner.bottom; ++y)
        for (std::uint32_t x = inner.left; x < inner.right; ++x)
            for (const EyeSample& sample : seen.pixel(x, y))
                any += num_samples_[index(x, y)] += is_floor(sample) ? 1 : 0;
    if (any == 0)
        return;
    find_borders(seen);
    choose(inner);
    for (std::size_t b = 0; b < chosen_.size(); ++b) {
        const FloorLights::Beam& beam = lights_.beams()[b];
        for (std::size_t s = 0; s < beam.places.size(); ++s) {
            Group group;
            const auto finish = [&] {
                group.trace(blockers_, beam.places[s]);
                for (std::size_t i = 0; i < group.size; ++i) {
                    glm::vec3 sum(0.0f);
                    for (std::uint64_t rays = group.reached[i]; rays != 0; rays &= rays - 1)
                        sum += beam.radiance[static_cast<std::size_t>(std::countr_zero(rays))];
                    radiance_[group.pixels[i]] +=
                        sum / static_cast<float>(num_samples_[group.pixels[i]]);
                }
                group.size = 0;
            };
            for (const std::uint32_t pixel : chosen_[b]) {
                const auto x = static_cast<std::uint32_t>(pixels_.left + pixel % pixels_.width());
                const auto y = static_cast<std::uint32_t>(pixels_.top + pixel / pixels_.width());
                if (const EyeSample& sample = seen.pixel(x, y)[s]; is_floor(sample))
                    group.add(origin(sample.point()), pixel);
                if (group.is_full())
                    finish();
            }
            finish();
        }
    }
}

/// Finds what the middles of pixels see of the beams.
void FloorShadows::find_borders(const SampleRectangle& seen) {
    const std::span<const FloorLights::Beam> beams = lights_.beams();
    num_pairs_ = num_pairs_across() * ((pixels_.bottom + 1) / 2 - pixels_.top / 2);
    borders_.assign(beams.size() * num_pairs_, Seen::NoFloor);
    const std::uint32_t bottom = (pixels_.bottom + 1) / 2, right = (pixels_.right + 1) / 2;
    for (std::uint32_t top = pixels_.top / 2; top < bottom; top += SquareSide)
        for (std::uint32_t left = pixels_.left / 2; left < right; left += SquareSide) {
            Group group;
            for (std::uint32_t v = top; v < std::min(top + SquareSide, bottom); ++v)
                for (std::uint32_t u = left; u < std::min(left + SquareSide, right); ++u) {
                    const std::uint32_t x = std::max(2 * u, pixels_.left);
                    const std::uint32_t y = std::max(2 * v, pixels_.top);
                    if (const EyeSample& sample = seen.middle(x, y); is_floor(sample))
                        group.add(origin(sample.point()), static_cast<std::uint32_t>(pair(x, y)));
                }
            for (std::size_t b = 0; b < beams.size(); ++b) {
                prt::DirectionPatch border;
                border.packets[0] = beams[b].border;
                border.num_directions = beams[b].border.num_directions;
                group.trace(blockers_, border);
                const std::uint64_t all = bits(border.num_directions);
                for (std::size_t i = 0; i < group.size; ++i)
                    borders_[b * num_pairs_ + group.pixels[i]] = group.reached[i] == all ? Seen::All
                                                                 : group.reached[i] == 0
                                                                     ? Seen::Nothing
                                                                     : Seen::Part;
            }
        }
}

/// Lights the pixels that see all or nothing of a beam, and chooses those to trace.
void FloorShadows::choose(const PixelRectangle& inner) {
    const std::size_t num_beams = lights_.beams().size();
    chosen_.assign(num_beams, {});
    // In squares, so that neighbours are traced together.
    for (std::uint32_t top = inner.top; top < inner.bottom; top += SquareSide)
        for (std::uint32_t left = inner.left; left < inner.right; left += SquareSide)
            for (std::uint32_t y = top; y < std::min(top + SquareSide, inner.bottom); ++y)
                for (std::uint32_t x = left; x < std::min(left + SquareSide, inner.right); ++x) {
                    const std::size_t own = index(x, y);
                    if (num_samples_[own] == 0)
                        continue;
                    for (std::size_t b = 0; b < num_beams; ++b) {
                        const Seen around = seen_around(b, x, y);
                        if (around == Seen::All)
                            radiance_[own] += lights_.beams()[b].whole;
                        else if (around != Seen::Nothing)
                            chosen_[b].push_back(static_cast<std::uint32_t>(own));
                    }
                }
}

/// Returns what a pixel and those around it see of a beam; Part where they differ.
FloorShadows::Seen FloorShadows::seen_around(std::size_t beam, std::uint32_t x,
                                             std::uint32_t y) const {
    const std::span<const Seen> of_beam =
        std::span(borders_).subspan(beam * num_pairs_, num_pairs_);
    const Seen own = of_beam[pair(x, y)];
    for (std::uint32_t v = y - std::min(y - pixels_.top, 2u); v < std::min(y + 3, pixels_.bottom);
         v += 2)
        for (std::uint32_t u = x - std::min(x - pixels_.left, 2u);
             u < std::min(x + 3, pixels_.right); u += 2)
            if (of_beam[pair(u, v)] != own)
                return Seen::Part;
    return own;
}

glm::vec3 FloorShadows::at(const prt::MeshPoint& point, std::size_t sample) const {
    glm::vec3 sum(0.0f);
    Group group;
    group.add(origin(point), 0);
    for (const FloorLights::Beam& beam : lights_.beams()) {
        group.trace(blockers_, beam.places[sample]);
        for (std::uint64_t rays = group.reached[0]; rays != 0; rays &= rays - 1)
            sum += beam.radiance[static_cast<std::size_t>(std::countr_zero(rays))];
    }
    return sum;
}

} // namespace relumine::relight
