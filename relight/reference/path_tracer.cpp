#include "relight/reference/path_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/luminance.h"
#include "cubemap/split_mix64.h"
#include "files/parallel.h"
#include "prt/precompute.h"
#include "prt/receivers/mesh_point.h"
#include "relight/lamps/punctual.h"

namespace relumine::relight {

namespace {

constexpr std::uint32_t BouncesBeforeRoulette = 3;
constexpr double LargestSurvival = 0.95;

/// Random numbers in [0, 1).
class Random {
public:
    explicit Random(std::uint64_t seed) : bits_(seed) {}
    double operator()() { return cubemap::unit_interval(bits_.next()); }

private:
    cubemap::SplitMix64 bits_;
};

/// Draws texels of an environment by their power.
class EnvironmentSampler {
public:
    explicit EnvironmentSampler(const cubemap::CubeMap& map)
        : map_(map), solid_angles_(cubemap::texel_solid_angles(map.resolution)),
          sums_(map.texels.size() + 1) {
        for (std::size_t i = 0; i < map.texels.size(); ++i)
            sums_[i + 1] = sums_[i] + static_cast<double>(cubemap::luminance(map.texels[i])) *
                                          solid_angles_[i % solid_angles_.size()];
    }

    struct Sample {
        glm::dvec3 direction{0.0};
        glm::dvec3 radiance{0.0};
        /// Per steradian; 0: no light.
        double density = 0.0;
    };

    Sample draw(Random& random) const {
        if (sums_.back() <= 0.0)
            return {};
        const auto found =
            std::upper_bound(sums_.begin() + 1, sums_.end() - 1, random() * sums_.back());
        const auto texel = static_cast<std::size_t>(found - sums_.begin()) - 1;
        const std::size_t r = map_.resolution;
        const auto face = static_cast<cubemap::Face>(texel / (r * r));
        const double s = (static_cast<double>(texel % r) + random()) / static_cast<double>(r);
        const double t = (static_cast<double>(texel / r % r) + random()) / static_cast<double>(r);
        return {.direction = cubemap::direction(face, s, t),
                .radiance = glm::dvec3(map_.texels[texel]),
                .density = density(texel, cubemap::cube_point(face, s, t))};
    }

    [[nodiscard]] Sample at(const glm::dvec3& direction) const {
        const cubemap::FacePoint point = cubemap::face_point(direction);
        const std::uint32_t r = map_.resolution;
        const auto index = [r](double s) {
            return std::min(static_cast<std::uint32_t>(s * r), r - 1);
        };
        const std::size_t texel = map_.index(point.face, index(point.s), index(point.t));
        return {.direction = direction,
                .radiance = glm::dvec3(map_.texels[texel]),
                .density = density(texel, cubemap::cube_point(point.face, point.s, point.t))};
    }

private:
    /// Points are even over the texel's square, so the density follows the cube's projection.
    [[nodiscard]] double density(std::size_t texel, const glm::dvec3& cube_point) const {
        if (sums_.back() <= 0.0)
            return 0.0;
        const double chance = (sums_[texel + 1] - sums_[texel]) / sums_.back();
        const double distance = glm::length(cube_point);
        const double side = 2.0 / map_.resolution;
        return chance * distance * distance * distance / (side * side);
    }

    const cubemap::CubeMap& map_;
    /// [R * R]
    std::vector<double> solid_angles_;
    /// [6 R^2 + 1] power of the texels before.
    std::vector<double> sums_;
};

/// Draws points of what glows by its power.
class EmitterSampler {
public:
    EmitterSampler(const mesh::TriangleMesh& mesh, std::span<const prt::Emitter> emitters,
                   bool two_sided)
        : mesh_(mesh), emitters_(emitters), two_sided_(two_sided) {
        for (const prt::Emitter& emitter : emitters) {
            const auto [a, b, c] = prt::corners_of(mesh, emitter);
            const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
            sums_.push_back(sums_.back() + area * brightness(emitter));
        }
    }

    struct Sample {
        /// From the place that asks; not of unit length.
        glm::dvec3 way{0.0};
        glm::dvec3 radiance{0.0};
        /// Per steradian; 0: no light.
        double density = 0.0;
    };

    Sample draw(const glm::dvec3& from, Random& random) const {
        if (sums_.back() <= 0.0)
            return {};
        const auto found =
            std::upper_bound(sums_.begin() + 1, sums_.end() - 1, random() * sums_.back());
        const auto index = static_cast<std::size_t>(found - sums_.begin()) - 1;
        const auto [a, b, c] = prt::corners_of(mesh_, emitters_[index]);
        const double root = std::sqrt(random()), part = random();
        return sample(index, a + root * (1.0 - part) * (b - a) + root * part * (c - a) - from);
    }

    /// What a ray meets.
    [[nodiscard]] Sample at(const prt::Hit& hit, const glm::dvec3& way) const {
        const auto [first, last] = std::equal_range(
            emitters_.begin(), emitters_.end(), prt::Emitter{.triangle = hit.triangle},
            [](const prt::Emitter& x, const prt::Emitter& y) { return x.triangle < y.triangle; });
        const prt::MeshPoint point{.triangle = hit.triangle, .barycentric = hit.barycentric};
        const glm::dvec3 place(prt::value_at(mesh_, mesh_.positions, point));
        for (auto emitter = first; emitter != last; ++emitter)
            if (first->part == 1 || contains(prt::corners_of(mesh_, *emitter), place))
                return sample(static_cast<std::size_t>(emitter - emitters_.begin()), way);
        return {};
    }

private:
    static double brightness(const prt::Emitter& emitter) {
        return double{emitter.radiance.r} + double{emitter.radiance.g} + double{emitter.radiance.b};
    }

    /// Whether a triangle contains a point of its plane.
    static bool contains(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& place) {
        const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        for (std::size_t i = 0; i < 3; ++i)
            if (glm::dot(normal,
                         glm::cross(corners[(i + 1) % 3] - corners[i], place - corners[i])) < 0.0)
                return false;
        return true;
    }

    [[nodiscard]] Sample sample(std::size_t index, const glm::dvec3& way) const {
        const double distance = glm::length(way);
        double cosine = -glm::dot(prt::front_of(mesh_, emitters_[index].triangle), way) / distance;
        if (two_sided_)
            cosine = std::abs(cosine);
        if (!(cosine > 0.0))
            return {};
        const double chance = brightness(emitters_[index]) / sums_.back();
        return {.way = way,
                .radiance = glm::dvec3(emitters_[index].radiance),
                .density = chance * distance * distance / cosine};
    }

    const mesh::TriangleMesh& mesh_;
    std::span<const prt::Emitter> emitters_;
    bool two_sided_;
    /// [emitters + 1] power of those before.
    std::vector<double> sums_ = {0.0};
};

/// A point of a path.
struct PathPoint {
    glm::vec3 origin{0.0f};
    glm::dvec3 normal{0.0};
};

glm::dvec3 cosine_direction(const glm::dvec3& normal, Random& random) {
    // A point of the unit sphere, added to the normal.
    const double z = 1.0 - 2.0 * random();
    const double angle = 2.0 * std::numbers::pi * random();
    const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
    const glm::dvec3 sum =
        normal + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), z);
    const double length = glm::length(sum);
    return length > 0.0 ? sum / length : normal;
}

class PathTracer {
public:
    PathTracer(const mesh::TriangleMesh& mesh, std::span<const glm::vec3> albedo,
               const prt::RayScene& rays, const cubemap::CubeMap& environment,
               const PathTracerOptions& options)
        : mesh_(mesh), albedo_(albedo), rays_(rays), lights_(environment),
          emitters_(mesh, options.emitters, options.two_sided), options_(options) {}

    /// One path's light from surfaces, for albedo 1 at its start.
    [[nodiscard]] glm::dvec3 trace(PathPoint point, Random& random) const {
        glm::dvec3 sum(0.0);
        glm::dvec3 throughput(1.0);
        for (std::uint32_t bounce = 0;; ++bounce) {
            sum += throughput * lamp_sample(point, random);
            const glm::dvec3 direction = cosine_direction(point.normal, random);
            const auto hit = rays_.closest_hit(point.origin, glm::vec3(direction));
            if (!hit) {
                // The start's own direct light is no bounce.
                if (bounce > 0)
                    sum += throughput * weighted_sky(point, direction);
                return sum;
            }
            sum += throughput * weighted_lamp(point, *hit, direction);
            if (options_.num_bounces && bounce == *options_.num_bounces)
                return sum;
            const prt::MeshPoint at{.triangle = hit->triangle, .barycentric = hit->barycentric};
            // A back sends what its front does, or nothing: the path goes on from the front.
            if (!options_.two_sided && !prt::meets_front(mesh_, at, glm::vec3(direction)))
                return sum;
            const glm::dvec3 normal(prt::shading_normal(mesh_, at));
            throughput *= glm::dvec3(prt::value_at(mesh_, albedo_, at));
            if (bounce >= BouncesBeforeRoulette) {
                const double survival =
                    std::min(LargestSurvival, std::max({throughput.r, throughput.g, throughput.b}));
                if (random() >= survival)
                    return sum;
                throughput /= survival;
            }
            point = {.origin = prt::ray_origin(prt::value_at(mesh_, mesh_.positions, at),
                                               glm::vec3(normal), options_.bias),
                     .normal = normal};
            sum += throughput * light_sample(point, random);
        }
    }

private:
    /// The sample of the environment: radiance times cosine over pi, weighted.
    [[nodiscard]] glm::dvec3 light_sample(const PathPoint& point, Random& random) const {
        const EnvironmentSampler::Sample light = lights_.draw(random);
        const double cosine = glm::dot(point.normal, light.direction);
        if (!(light.density > 0.0 && cosine > 0.0) ||
            rays_.occluded(point.origin, glm::vec3(light.direction)))
            return glm::dvec3(0.0);
        const double diffuse = cosine / std::numbers::pi;
        return light.radiance * (diffuse / (light.density + diffuse));
    }

    /// The sample of what glows, and all lights without a surface.
    [[nodiscard]] glm::dvec3 lamp_sample(const PathPoint& point, Random& random) const {
        glm::dvec3 sum(0.0);
        for (const mesh::PunctualLight& light : options_.lights)
            sum += punctual_light(light, point.origin, point.normal, rays_);
        const EmitterSampler::Sample lamp = emitters_.draw(glm::dvec3(point.origin), random);
        if (!(lamp.density > 0.0))
            return sum;
        const double distance = glm::length(lamp.way);
        const double cosine = glm::dot(point.normal, lamp.way) / distance;
        constexpr float Before = 1.0f - 1e-4f; // the lamp itself is no obstacle
        if (!(cosine > 0.0) || rays_.occluded(point.origin, glm::vec3(lamp.way), Before))
            return sum;
        const double diffuse = cosine / std::numbers::pi;
        return sum + lamp.radiance * (diffuse / (lamp.density + diffuse));
    }

    /// The sample of the hemisphere, which met a surface.
    [[nodiscard]] glm::dvec3 weighted_lamp(const PathPoint& point, const prt::Hit& hit,
                                           const glm::dvec3& direction) const {
        const EmitterSampler::Sample lamp =
            emitters_.at(hit, direction * static_cast<double>(hit.distance));
        const double diffuse = std::max(glm::dot(point.normal, direction), 0.0) / std::numbers::pi;
        return lamp.density > 0.0 ? lamp.radiance * (diffuse / (lamp.density + diffuse))
                                  : glm::dvec3(0.0);
    }

    /// The sample of the hemisphere, which met nothing.
    [[nodiscard]] glm::dvec3 weighted_sky(const PathPoint& point,
                                          const glm::dvec3& direction) const {
        const EnvironmentSampler::Sample light = lights_.at(direction);
        const double diffuse = std::max(glm::dot(point.normal, direction), 0.0) / std::numbers::pi;
        return diffuse > 0.0 ? light.radiance * (diffuse / (light.density + diffuse))
                             : glm::dvec3(0.0);
    }

    const mesh::TriangleMesh& mesh_;
    std::span<const glm::vec3> albedo_;
    const prt::RayScene& rays_;
    EnvironmentSampler lights_;
    EmitterSampler emitters_;
    const PathTracerOptions& options_;
};

} // namespace

std::vector<TracedBounces>
trace_bounces(const mesh::TriangleMesh& mesh, std::span<const glm::vec3> albedo,
              const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices,
              const prt::RayScene& rays, const cubemap::CubeMap& environment,
              const PathTracerOptions& options, const prt::Work& work) {
    if (albedo.size() != mesh.num_vertices())
        throw std::invalid_argument(fmt::format("expected the albedo of {} vertices, got {}",
                                                mesh.num_vertices(), albedo.size()));
    if (environment.resolution == 0)
        throw std::invalid_argument("expected an environment with texels");
    if (options.num_paths == 0)
        throw std::invalid_argument("expected at least one path per receiver");
    for (const std::uint32_t index : receiver_indices)
        if (index >= receivers.size())
            throw std::invalid_argument("expected indices of receivers");

    const PathTracer tracer(mesh, albedo, rays, environment, options);
    std::vector<TracedBounces> result(receiver_indices.size());
    std::size_t num_done = 0;
    std::mutex progress;
    files::parallel_for(std::size_t{0}, receiver_indices.size(), [&](std::size_t i) {
        const std::uint32_t index = receiver_indices[i];
        const glm::vec3& normal = receivers.normals[index];
        if (work.stop.stop_requested() || normal == glm::vec3(0.0f))
            return;
        Random random(options.seed * cubemap::SplitMix64::Step ^ cubemap::SplitMix64(index).next());
        const PathPoint start{.origin =
                                  prt::ray_origin(receivers.positions[index], normal, options.bias),
                              .normal = glm::dvec3(normal)};
        glm::dvec3 sum(0.0), squares(0.0);
        for (std::uint32_t path = 0; path < options.num_paths; ++path) {
            const glm::dvec3 light = tracer.trace(start, random);
            sum += light;
            squares += light * light;
        }
        const double n = options.num_paths;
        result[i].radiance = sum / n;
        const glm::dvec3 variance =
            glm::max(squares / n - result[i].radiance * result[i].radiance, glm::dvec3(0.0));
        result[i].standard_error = glm::sqrt(variance / std::max(n - 1.0, 1.0));
        const std::scoped_lock lock(progress);
        ++num_done;
        work.tell(static_cast<double>(num_done) / static_cast<double>(receiver_indices.size()));
    });
    work.poll();
    return result;
}

} // namespace relumine::relight
