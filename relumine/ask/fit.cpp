#include "relumine/ask/fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "prt/receivers/lit_position.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/work.h"
#include "relight/light_fit/non_negative_fit.h"
#include "relight/light_fit/projected_gradient.h"
#include "relight/light_fit/transfer_lights.h"
#include "relumine/ask/questions.h"

namespace relumine {

namespace {

void require_fitting(const FitTarget& target, const LitScene& lit) {
    const std::size_t size = lit.relighter().transfer().num_receivers();
    if (target.radiance.size() != size || target.weights.size() != size)
        throw std::invalid_argument(
            fmt::format("expected a target of {} receivers, got {}", size, target.radiance.size()));
}

void require_diffuse(const LitScene& lit) {
    if (lit.scene().transfer.glossy)
        throw std::invalid_argument("expected a scene without highlights, got one with");
}

void require_surfaces(const LitScene& lit) {
    require_diffuse(lit);
    if (lit.scene().transfer.num_points != 0)
        throw std::invalid_argument("expected a scene of surfaces, got points in space");
}

/// Returns the light that colours tell of in the least squares: the sums are those of colour times
/// value, the weights those of colour squared. A channel of which the colours say next to nothing
/// is taken as grey.
glm::vec3 light_of(const glm::dvec3& sums, const glm::dvec3& weights) {
    constexpr double PartOfGrey = 1e-4; // a hundredth of the brightest channel's colour
    const double all = weights.r + weights.g + weights.b;
    if (!(all > 0.0))
        return glm::vec3(0.0f);
    const double grey = (sums.r + sums.g + sums.b) / all, weight = PartOfGrey * all;
    return glm::vec3((sums + weight * grey) / (weights + weight));
}

/// Gathers what receivers should look like.
class Gathered {
public:
    explicit Gathered(std::size_t size) : sums_(size), weights_(size) {}

    /// `value` is what is seen of a receiver of this albedo.
    void add(std::size_t receiver, const glm::vec3& value, const glm::vec3& albedo, double weight) {
        for (int channel = 0; channel < 3; ++channel)
            if (!(value[channel] >= 0.0f && std::isfinite(value[channel])))
                throw std::invalid_argument(
                    fmt::format("expected finite values >= 0, got {}", value[channel]));
        sums_[receiver] += weight * glm::dvec3(albedo) * glm::dvec3(value);
        weights_[receiver] += weight * glm::dvec3(albedo) * glm::dvec3(albedo);
    }

    /// The radiance that fits all values of a receiver best, in the least squares.
    [[nodiscard]] FitTarget target() const {
        FitTarget result{.radiance = std::vector<glm::vec3>(sums_.size(), glm::vec3(0.0f)),
                         .weights = std::vector<float>(sums_.size())};
        bool is_known = false, is_dark = true;
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const double weight = (weights_[i].r + weights_[i].g + weights_[i].b) / 3.0;
            result.weights[i] = static_cast<float>(weight);
            result.radiance[i] = light_of(sums_[i], weights_[i]);
            is_known = is_known || weight > 0.0;
            is_dark = is_dark && result.radiance[i] == glm::vec3(0.0f);
        }
        if (!is_known)
            throw std::invalid_argument("expected surfaces that reflect light, got none");
        if (is_dark)
            throw std::invalid_argument("expected light to fit to, got black");
        return result;
    }

private:
    std::vector<glm::dvec3> sums_, weights_;
};

void require_size(const Picture& picture, std::uint32_t width, std::uint32_t height) {
    if (picture.width != width || picture.height != height)
        throw std::invalid_argument(fmt::format("expected {} x {} pixels, got {} x {}", width,
                                                height, picture.width, picture.height));
}

/// Gathers a picture of the scene's own pixels. Of a pixel with an edge it tells nothing of the
/// surfaces on either side.
FitTarget target_of_pixels(const Picture& picture, const prt::PixelLayout& pixels,
                           std::span<const glm::vec3> albedo) {
    require_size(picture, pixels.width, pixels.height);
    const std::size_t per_pixel = pixels.samples_per_pixel();
    Gathered gathered(pixels.samples.size());
    for (std::size_t i = 0; i < pixels.samples.size(); ++i)
        if (pixels.shares.empty() || pixels.num_shown(i) == per_pixel)
            gathered.add(i, picture.pixels[pixels.samples[i] / per_pixel], albedo[i], 1.0);
    return gathered.target();
}

/// Gathers a lightmap of the scene's own texels.
FitTarget target_of_texels(const Picture& picture, const prt::TexelLayout& texels,
                           std::span<const glm::vec3> albedo) {
    require_size(picture, texels.width, texels.height);
    Gathered gathered(texels.texels.size());
    for (std::size_t i = 0; i < texels.texels.size(); ++i)
        gathered.add(i, picture.pixels[texels.texels[i]], albedo[i], 1.0);
    return gathered.target();
}

/// What a pixel of a picture of vertices shows.
struct SeenPoint {
    std::size_t pixel = 0;
    prt::MeshPoint point;
};

/// Returns the fronts that pixels show, but for an added floor. Pixels at an outline are left out,
/// because they show the background, too.
std::vector<SeenPoint> seen_points(const LitScene& lit, const Picture& picture,
                                   const OutputOptions& options) {
    const Scene& scene = lit.scene();
    const mesh::TriangleMesh& mesh = scene.mesh;
    const prt::PixelReceivers seen = prt::pixel_receivers(
        mesh, lit.rays().of_mesh(),
        {.camera = camera_of(scene, options), .width = picture.width, .height = picture.height});
    std::vector<bool> is_seen(picture.pixels.size());
    for (const std::uint32_t sample : seen.layout.samples)
        is_seen[sample] = true;
    const auto is_inside = [&](std::size_t pixel) {
        const std::size_t x = pixel % picture.width, y = pixel / picture.width;
        if (x == 0 || y == 0 || x + 1 == picture.width || y + 1 == picture.height)
            return false;
        return is_seen[pixel - 1] && is_seen[pixel + 1] && is_seen[pixel - picture.width] &&
               is_seen[pixel + picture.width];
    };
    const std::size_t floor = first_floor_vertex(scene).value_or(mesh.num_vertices());
    std::vector<SeenPoint> result;
    for (std::size_t i = 0; i < seen.receivers.size(); ++i) {
        const prt::MeshPoint& point = seen.receivers.points[i];
        const mesh::Triangle& corners = mesh.triangles[point.triangle];
        const bool is_front =
            glm::dot(seen.receivers.normals[i], prt::shading_normal(mesh, point)) > 0.0f;
        if (is_front && std::max({corners[0], corners[1], corners[2]}) < floor &&
            is_inside(seen.layout.samples[i]))
            result.push_back({.pixel = seen.layout.samples[i], .point = point});
    }
    return result;
}

/// Pairs of texels that are neighbours, across the edges of faces, too.
std::vector<std::pair<std::size_t, std::size_t>> neighbours_of_texels(std::uint32_t resolution) {
    const cubemap::CubeMap map(resolution);
    const double r = resolution;
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < resolution; ++y)
            for (std::uint32_t x = 0; x < resolution; ++x)
                for (const auto& [right, down] : {std::pair(1, 0), {0, 1}, {-1, 0}, {0, -1}}) {
                    const cubemap::FacePoint there = cubemap::face_point(
                        cubemap::cube_point(face, (x + 0.5 + right) / r, (y + 0.5 + down) / r));
                    const auto texel = [&](double at) {
                        return std::min(static_cast<std::uint32_t>(at * r), resolution - 1);
                    };
                    const std::size_t here = map.index(face, x, y);
                    const std::size_t other = map.index(there.face, texel(there.s), texel(there.t));
                    if (here < other)
                        pairs.emplace_back(here, other);
                }
    return pairs;
}

/// The value of an environment, and its gradient: half the squared distance to the target relative
/// to the target, and what smoothness and sparsity ask for. Unknowns are radiances over a unit.
class EnvironmentObjective {
public:
    EnvironmentObjective(LitScene& lit, const FitTarget& target, const EnvironmentFit& options)
        : lit_(lit), target_(target), options_(options), map_(options.face_resolution),
          pairs_(neighbours_of_texels(options.face_resolution)),
          solid_angles_(cubemap::texel_solid_angles(options.face_resolution)) {
        double light = 0.0, all = 0.0;
        for (std::size_t i = 0; i < target.radiance.size(); ++i) {
            const glm::dvec3 radiance(target.radiance[i]);
            const auto weight = static_cast<double>(target.weights[i]);
            size_ += weight * glm::dot(radiance, radiance);
            light += weight * (radiance.r + radiance.g + radiance.b) / 3.0;
            all += weight;
        }
        unit_ = light / all;
    }

    [[nodiscard]] std::size_t num_unknowns() const { return 3 * map_.texels.size(); }

    [[nodiscard]] const cubemap::CubeMap& map_of(std::span<const double> x) {
        for (std::size_t i = 0; i < x.size(); ++i)
            map_.texels[i / 3][static_cast<int>(i % 3)] = static_cast<float>(unit_ * x[i]);
        return map_;
    }

    double operator()(std::span<const double> x, std::span<double> gradient) {
        light(map_of(x));
        std::vector<glm::vec3> weights(target_.radiance.size());
        double value = 0.0;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            const glm::dvec3 error =
                glm::dvec3(lit_.radiance()[i]) - glm::dvec3(target_.radiance[i]);
            const double weight = static_cast<double>(target_.weights[i]) / size_;
            value += 0.5 * weight * glm::dot(error, error);
            // Their size suits float, however many receivers there are.
            weights[i] = glm::vec3(weight * size_ / unit_ * error);
        }
        const cubemap::CubeMap derivative = adjoint(lit_, weights);
        const double scale = unit_ * unit_ / size_;
        for (std::size_t i = 0; i < gradient.size(); ++i)
            gradient[i] =
                scale * static_cast<double>(derivative.texels[i / 3][static_cast<int>(i % 3)]);
        return value + smoothed(x, gradient) + thinned(x, gradient);
    }

    void light(const cubemap::CubeMap& map) {
        const bool bounces = lit_.bounces().is_set();
        lit_.light(map);
        if (bounces)
            lit_.bounce();
    }

private:
    double smoothed(std::span<const double> x, std::span<double> gradient) const {
        const double factor = options_.smoothness / static_cast<double>(3 * pairs_.size());
        double value = 0.0;
        for (const auto& [a, b] : pairs_)
            for (std::size_t channel = 0; channel < 3 && factor > 0.0; ++channel) {
                const double difference = x[3 * a + channel] - x[3 * b + channel];
                value += 0.5 * factor * difference * difference;
                gradient[3 * a + channel] += factor * difference;
                gradient[3 * b + channel] -= factor * difference;
            }
        return value;
    }
    double thinned(std::span<const double> x, std::span<double> gradient) const {
        double value = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double factor = options_.sparsity * solid_angles_[i / 3 % solid_angles_.size()] /
                                  (12.0 * std::numbers::pi);
            value += factor * x[i];
            gradient[i] += factor;
        }
        return value;
    }

    LitScene& lit_;
    const FitTarget& target_;
    const EnvironmentFit& options_;
    cubemap::CubeMap map_;
    std::vector<std::pair<std::size_t, std::size_t>> pairs_;
    /// Solid angles of a face's texels
    std::vector<double> solid_angles_;
    /// The target's squared length
    double size_ = 0.0;
    /// The target's mean radiance
    double unit_ = 0.0;
};

} // namespace

FitTarget target_of_values(const Scene& scene, std::span<const glm::vec3> values,
                           std::span<const glm::vec3> albedo) {
    const std::size_t size = scene.receivers.num_own();
    if (values.size() != size || albedo.size() != scene.receivers.size())
        throw std::invalid_argument(fmt::format("expected {} values, one for each {}, got {}", size,
                                                prt::kind_of(scene.layout).one, values.size()));
    Gathered gathered(scene.receivers.size());
    for (std::size_t i = 0; i < size; ++i)
        gathered.add(i, values[i], albedo[i], 1.0);
    return gathered.target();
}

FitTarget target_of_picture(const LitScene& lit, const Picture& picture,
                            const OutputOptions& options) {
    const Scene& scene = lit.scene();
    const std::vector<glm::vec3> albedo = picture_albedo(scene, options);
    if (const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout))
        return target_of_pixels(picture, *pixels, albedo);
    if (const auto* texels = std::get_if<prt::TexelLayout>(&scene.layout))
        return target_of_texels(picture, *texels, albedo);
    if (!prt::on_vertices(scene.layout))
        throw std::invalid_argument("expected a scene of which there are pictures");
    Gathered gathered(scene.receivers.size());
    const mesh::TriangleMesh& mesh = scene.mesh;
    for (const SeenPoint& seen : seen_points(lit, picture, options)) {
        const mesh::Triangle& corners = mesh.triangles[seen.point.triangle];
        const glm::vec2& b = seen.point.barycentric;
        const std::array<float, 3> parts = {1.0f - b.x - b.y, b.x, b.y};
        for (std::size_t corner = 0; corner < 3; ++corner)
            gathered.add(corners[corner], picture.pixels[seen.pixel], albedo[corners[corner]],
                         std::max(0.0, static_cast<double>(parts[corner])));
    }
    return gathered.target();
}

namespace {

/// Relative L2 of radiance against a target.
double distance_between(const FitTarget& target, std::span<const glm::vec3> radiance) {
    double distance = 0.0, size = 0.0;
    for (std::size_t i = 0; i < target.radiance.size(); ++i) {
        const glm::dvec3 wanted(target.radiance[i]);
        const glm::dvec3 error = glm::dvec3(radiance[i]) - wanted;
        const auto weight = static_cast<double>(target.weights[i]);
        distance += weight * glm::dot(error, error);
        size += weight * glm::dot(wanted, wanted);
    }
    return std::sqrt(distance / size);
}

} // namespace

double distance_to(const FitTarget& target, const LitScene& lit) {
    require_fitting(target, lit);
    return distance_between(target, lit.radiance());
}

cubemap::CubeMap fit_environment(LitScene& lit, const FitTarget& target,
                                 const EnvironmentFit& options, const prt::Work& work) {
    require_fitting(target, lit);
    require_diffuse(lit);
    EnvironmentObjective objective(lit, target, options);
    std::vector<double> x(objective.num_unknowns(), 1.0);
    relight::minimise_non_negative(
        [&](std::span<const double> at, std::span<double> gradient) {
            return objective(at, gradient);
        },
        x, {.max_iterations = options.max_iterations}, work);
    const cubemap::CubeMap& result = objective.map_of(x);
    objective.light(result);
    return result;
}

std::vector<lights::DistantLight> fit_lights(LitScene& lit, const FitTarget& target,
                                             std::size_t count, const prt::Work& work) {
    require_fitting(target, lit);
    require_surfaces(lit);
    // Surfaces reflect a part of what receivers of albedo 1 would.
    std::vector<glm::vec3> radiance = target.radiance;
    std::vector<float> weights = target.weights;
    const std::vector<prt::Surface>& surfaces = lit.scene().receivers.surfaces;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const glm::dvec3 albedo(surfaces[i].albedo);
        radiance[i] = light_of(albedo * glm::dvec3(radiance[i]), albedo * albedo);
        weights[i] *= static_cast<float>(glm::dot(albedo, albedo) / 3.0);
    }
    std::vector<lights::DistantLight> result = relight::fit_lights(
        lit.relighter(), {.radiance = radiance, .weights = weights}, count, work);
    lit.light(Light(result));
    return result;
}

std::vector<lights::DistantLight> fit_lights_to_picture(LitScene& lit, const Picture& picture,
                                                        const OutputOptions& options,
                                                        std::size_t count, double& distance,
                                                        const prt::Work& work) {
    require_surfaces(lit);
    const Scene& scene = lit.scene();
    if (!prt::on_vertices(scene.layout))
        throw std::invalid_argument("expected a scene of vertices");
    std::vector<glm::vec3> of_vertices = picture_albedo(scene, options);
    for (std::size_t i = 0; i < scene.receivers.surfaces.size(); ++i)
        of_vertices[i] *= scene.receivers.surfaces[i].albedo;
    const std::vector<SeenPoint> points = seen_points(lit, picture, options);
    std::vector<glm::vec3> positions;
    // Receivers of their own, in the order of the pixels, which see no clusters.
    prt::Transfer transfer;
    Gathered gathered(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const prt::MeshPoint& point = points[i].point;
        const glm::vec3 normal = prt::shading_normal(scene.mesh, point);
        positions.push_back(prt::lit_position(scene.mesh, lit.rays().of_mesh(), point, normal,
                                              scene.settings.bias));
        transfer.normals.push_back(normal);
        transfer.order.push_back(static_cast<std::uint32_t>(i));
        gathered.add(i, picture.pixels[points[i].pixel],
                     prt::value_at(scene.mesh, of_vertices, point), 1.0);
    }
    transfer.counts.num_receivers = points.size();
    transfer.counts.num_leaves = transfer.num_clusters();
    const std::size_t num_words = transfer.counts.num_blocks() * transfer.counts.words_per_block();
    transfer.counts.visible.resize(num_words);
    transfer.counts.mixed.resize(num_words);
    transfer.counts.index();
    const FitTarget target = gathered.target();
    relight::Relighter relighter(transfer, {.blockers = &lit.rays().for_moving_lights(),
                                            .positions = positions,
                                            .bias = scene.settings.bias,
                                            .tolerance = rms_tolerance(scene)});
    std::vector<lights::DistantLight> result = relight::fit_lights(
        relighter, {.radiance = target.radiance, .weights = target.weights}, count, work);
    relighter.set_lights(result);
    distance = distance_between(target, relighter.radiance());
    lit.light(Light(result));
    return result;
}

std::vector<double> fit_gains(LitScene& lit, const FitTarget& target, std::span<const Light> lights,
                              const prt::Work& work) {
    require_fitting(target, lit);
    if (lights.empty())
        throw std::invalid_argument("expected at least one light");
    const bool bounces = lit.bounces().is_set();
    std::vector<std::vector<glm::vec3>> columns;
    for (const Light& light : lights) {
        work.poll();
        lit.light(light);
        if (bounces)
            lit.bounce();
        columns.emplace_back(lit.radiance().begin(), lit.radiance().end());
        work.tell(static_cast<double>(columns.size()) / static_cast<double>(lights.size()));
    }
    const auto product = [&](std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
        double sum = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i)
            sum += static_cast<double>(target.weights[i]) *
                   glm::dot(glm::dvec3(a[i]), glm::dvec3(b[i]));
        return sum;
    };
    const std::size_t n = columns.size();
    std::vector<double> gram(n * n), goal(n), gains(n, 1.0);
    for (std::size_t i = 0; i < n; ++i) {
        goal[i] = product(columns[i], target.radiance);
        for (std::size_t j = 0; j <= i; ++j)
            gram[i * n + j] = gram[j * n + i] = product(columns[i], columns[j]);
    }
    relight::fit_non_negative(gram, goal, gains);
    return gains;
}

} // namespace relumine
