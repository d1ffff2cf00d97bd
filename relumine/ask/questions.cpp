#include "relumine/ask/questions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/layers/layer_composite.h"
#include "cubemap/resample/resample.h"
#include "files/parallel.h"
#include "prt/receivers/lit_position.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/receivers/point_receivers.h"
#include "relight/adjoint/adjoint.h"
#include "relight/adjoint/contribution.h"
#include "relight/adjoint/harmonic_adjoint.h"
#include "relight/batch.h"
#include "relight/pictures/framing.h"
#include "relight/pictures/receiver_picture.h"
#include "relight/receiver_light.h"
#include "relight/reference/path_tracer.h"
#include "relight/sharp/light_packets.h"
#include "relumine/out/receiver_colors.h"

namespace relumine {

namespace {

void require_environment(const LitScene& lit) {
    if (!has_environment(lit))
        throw std::logic_error("expected a scene lit by an environment");
}

/// Null: no light bounces.
const relight::SurfaceBounces* surfaces_of(const LitScene& lit) {
    return lit.bounces().bounced().empty() ? nullptr : &lit.bounces().surfaces();
}

/// Returns compute(indices): a value for each index. Where processes share the work, each computes
/// a slice of neighbours, and all get all values.
template<typename Value, typename Compute>
std::vector<Value> in_slices(prt::Team& team, std::span<const std::uint32_t> indices,
                             const Compute& compute) {
    const auto begin_of = [&](std::size_t process) {
        return indices.size() * process / team.part().count;
    };
    const std::size_t begin = begin_of(team.part().index);
    const std::vector<Value> own =
        compute(indices.subspan(begin, begin_of(team.part().index + 1) - begin));
    std::vector<std::byte> bytes;
    for (const std::vector<std::byte>& slice : team.all_gather(prt::to_send(std::span(own))))
        bytes.insert(bytes.end(), slice.begin(), slice.end());
    std::vector<Value> values(indices.size());
    if (bytes.size() != values.size() * sizeof(Value))
        throw std::runtime_error("expected a value of each index");
    if (!bytes.empty())
        std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

/// What the environment was made from, while nothing has changed it; null otherwise.
const cubemap::EnvironmentFile* file_of(const LitScene& lit) {
    const LightBase* base = lit.environment().state().base.get();
    return base != nullptr && !base->map() && base->file().image ? &base->file() : nullptr;
}

/// Integrates the light of receivers exactly.
std::vector<glm::dvec3> exact_radiance(const LitScene& lit, const prt::Receivers& receivers,
                                       std::span<const std::uint32_t> indices,
                                       const prt::Work& work) {
    return in_slices<glm::dvec3>(work.team, indices, [&](std::span<const std::uint32_t> slice) {
        const relight::ExactOptions options{.bias = lit.scene().settings.bias};
        const cubemap::EnvironmentFile* file = file_of(lit);
        return file != nullptr
                   ? relight::exact_radiance(receivers, slice, lit.rays().blockers(), *file,
                                             options, work)
                   : relight::exact_radiance(receivers, slice, lit.rays().blockers(),
                                             lit.relighter().environment(), options, work);
    });
}

/// Adds the bounces of a path tracer to exact direct light. Returns the standard error of the
/// sum, relative to it, L2 over the receivers.
double add_traced(const LitScene& lit, std::span<const std::uint32_t> receivers,
                  const VerifyOptions& options, const prt::Work& work,
                  std::vector<glm::dvec3>& exact) {
    const Scene& scene = lit.scene();
    const bool is_bounced = !lit.bounces().bounced().empty();
    const std::vector<glm::vec3> albedo_of_vertices =
        is_bounced
            ? prt::vertex_values(scene.mesh, scene.receivers, lit.bounces().surfaces().albedo)
            : std::vector<glm::vec3>(scene.mesh.num_vertices());
    const prt::Lamps lamps = dimmed(scene.lamps, lit.lamps().gains());
    const auto traced = in_slices<relight::TracedBounces>(
        work.team, receivers, [&](std::span<const std::uint32_t> slice) {
            return relight::trace_bounces(
                scene.mesh, albedo_of_vertices, scene.receivers, slice, lit.rays().of_mesh(),
                lit.relighter().environment(),
                {.num_paths = options.num_paths,
                 .num_bounces = is_bounced ? std::nullopt : std::optional(0u),
                 .seed = options.seed,
                 .emitters = lamps.emitters,
                 .lights = lamps.lights,
                 .two_sided = scene.settings.two_sided_bounces,
                 .bias = scene.settings.bias},
                work);
        });
    double errors = 0.0, all = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const glm::dvec3 albedo = scene.receivers.surfaces.empty()
                                      ? glm::dvec3(1.0)
                                      : glm::dvec3(scene.receivers.surfaces[receivers[i]].albedo);
        const glm::dvec3 error = albedo * traced[i].standard_error;
        exact[i] += albedo * traced[i].radiance;
        errors += glm::dot(error, error);
        all += glm::dot(exact[i], exact[i]);
    }
    return all > 0.0 ? std::sqrt(errors / all) : 0.0;
}

/// What a picture shows of points of the surface against exact integration: what the vertices
/// interpolate, and lights that are traced at every point.
std::optional<Verification::Surface> verify_points(const LitScene& lit,
                                                   std::vector<prt::MeshPoint> points,
                                                   std::span<const glm::vec3> at_vertices,
                                                   std::span<const relight::SharpLight> lights,
                                                   const prt::Work& work) {
    if (points.empty())
        return std::nullopt;
    const Scene& scene = lit.scene();
    const relight::LightPackets packets(lights);
    const relight::ShadowRays rays{.blockers = &lit.rays().of_mesh(), .bias = scene.settings.bias};
    prt::Receivers receivers;
    std::vector<std::uint32_t> indices;
    std::vector<glm::vec3> shown;
    for (const prt::MeshPoint& point : points) {
        indices.push_back(static_cast<std::uint32_t>(indices.size()));
        const glm::vec3 normal = prt::shading_normal(scene.mesh, point);
        const glm::vec3 position =
            prt::lit_position(scene.mesh, lit.rays().of_mesh(), point, normal, rays.bias);
        receivers.positions.push_back(position);
        receivers.normals.push_back(normal);
        shown.push_back(prt::value_at(scene.mesh, at_vertices, point) +
                        glm::vec3(packets.radiance(position, normal, rays)));
    }
    const auto exact = exact_radiance(lit, receivers, indices, work);
    Verification::Surface result{.points = std::move(points), .error = {}};
    result.error = relight::compare(indices, exact, shown);
    return result;
}

/// Points of fronts that a picture of the whole mesh shows, spread evenly over it.
std::vector<prt::MeshPoint> points_of_picture(const LitScene& lit, std::size_t most) {
    constexpr std::uint32_t Width = 64, Height = 48;
    const Scene& scene = lit.scene();
    if (most == 0)
        return {};
    prt::Receivers seen;
    try {
        seen = prt::pixel_receivers(
                   scene.mesh, lit.rays().of_mesh(),
                   {.camera = relight::framed(scene.mesh), .width = Width, .height = Height})
                   .receivers;
    } catch (const std::invalid_argument&) {
        // There is nothing to see, as of a mesh in one point.
        return {};
    }
    std::vector<prt::MeshPoint> fronts;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (glm::dot(seen.normals[i], prt::shading_normal(scene.mesh, seen.points[i])) > 0.0f)
            fronts.push_back(seen.points[i]);
    std::vector<prt::MeshPoint> result;
    const std::size_t count = std::min(most, fronts.size());
    for (std::size_t i = 0; i < count; ++i)
        result.push_back(fronts[i * fronts.size() / count]);
    return result;
}

/// Returns the diffuse light of vertices. Of those around the points that of sharp lights is left
/// out, which pictures trace by themselves.
std::vector<glm::vec3> soft_around(const LitScene& lit, std::span<const prt::MeshPoint> points) {
    const Scene& scene = lit.scene();
    const relight::Relighter& relighter = lit.relighter();
    const std::span<const glm::vec3> all = relighter.diffuse_radiance();
    std::vector<glm::vec3> soft(all.begin(), all.end());
    const relight::ShadowRays& rays = relighter.shadow_rays();
    if (rays.blockers == nullptr)
        return soft;
    const relight::LightPackets packets(relighter.sharp_lights());
    std::set<std::uint32_t> vertices;
    for (const prt::MeshPoint& point : points) {
        const mesh::Triangle& triangle = scene.mesh.triangles[point.triangle];
        vertices.insert(triangle.begin(), triangle.end());
    }
    for (const std::uint32_t vertex : vertices)
        soft[vertex] -= glm::vec3(packets.radiance(scene.receivers.positions[vertex],
                                                   scene.receivers.normals[vertex], rays));
    return soft;
}

std::optional<Verification::Surface> verify_picture(const LitScene& lit, std::size_t most,
                                                    const prt::Work& work) {
    const std::vector<prt::MeshPoint> points = points_of_picture(lit, most);
    return verify_points(lit, points, soft_around(lit, points),
                         relight::picture_lights(lit.relighter()), work);
}

/// Returns the receivers where they stand. Vertices that a solid hides look from outside of it, and
/// are not seen: they are taken out of `indices`. Others that look from elsewhere are asked at
/// their own places.
prt::Receivers at_own_places(const LitScene& lit, std::vector<std::uint32_t>& indices) {
    constexpr double PartInSolid = 0.75;
    const Scene& scene = lit.scene();
    prt::Receivers result = scene.receivers;
    if (!prt::on_vertices(scene.layout) || scene.mesh.lifts.empty())
        return result;
    std::erase_if(indices, [&](std::uint32_t i) {
        const glm::vec3 &lift = scene.mesh.lifts[i], &normal = result.normals[i];
        if (!prt::leads_along(lift, normal))
            return false;
        result.positions[i] -= lift;
        return prt::part_of_backs(prt::ray_origin(result.positions[i], normal, scene.settings.bias),
                                  scene.mesh, lit.rays().of_mesh()) > PartInSolid;
    });
    return result;
}

double sum_of(std::span<const glm::vec3> radiance) {
    double sum = 0.0;
    for (const glm::vec3& value : radiance)
        sum += static_cast<double>(value.r) + static_cast<double>(value.g) +
               static_cast<double>(value.b);
    return sum;
}

/// Compares the light towards an eye.
Verification verify_eye(const LitScene& lit, const glm::vec3& eye, const VerifyOptions& options,
                        const prt::Work& work) {
    if (!lit.bounces().bounced().empty() || !lit.scene().lamps.empty())
        throw std::invalid_argument("expected the direct light of an environment for an eye");
    const Scene& scene = lit.scene();
    LiveEye live(lit);
    prt::Receivers seen = scene.receivers;
    seen.surfaces.assign(live.surfaces().begin(), live.surfaces().end());
    prt::look_from(seen, eye);
    Verification result;
    result.receivers = relight::random_receivers(scene.transfer, options.num_samples, options.seed);
    // Backs are not seen.
    std::erase_if(result.receivers, [&](std::uint32_t i) {
        return !(glm::dot(seen.normals[i], seen.to_eye[i]) > 0.0f);
    });
    if (result.receivers.empty())
        throw std::invalid_argument("expected an eye that sees a front of the mesh");
    result.of_file = file_of(lit) != nullptr;
    result.num_too_smooth = live.num_too_smooth();
    const std::vector<glm::dvec3> exact = exact_radiance(lit, seen, result.receivers, work);
    result.error = relight::compare(result.receivers, exact, live.look(eye, options.eye_options));
    return result;
}

} // namespace

Verification verify(const LitScene& lit, const VerifyOptions& options, const prt::Work& work) {
    require_environment(lit);
    if (options.eye)
        return verify_eye(lit, *options.eye, options, work);
    const Scene& scene = lit.scene();
    Verification result;
    result.receivers = relight::random_receivers(scene.transfer, options.num_samples, options.seed,
                                                 scene.receivers.num_own());
    const bool is_traced = !lit.bounces().bounced().empty() || !scene.lamps.empty();
    const bool has_surface = options.num_surface_points != 0 && prt::on_vertices(scene.layout);
    const prt::Receivers receivers = at_own_places(lit, result.receivers);
    const auto num_receivers = static_cast<double>(result.receivers.size());
    const double num_points = has_surface ? static_cast<double>(options.num_surface_points) : 0.0;
    const double all = (is_traced ? 2.0 : 1.0) * num_receivers + 2.0 * num_points;
    double done = 0.0;
    const auto next = [&](double size) {
        return work.part(std::exchange(done, done + size) / all, size / all);
    };
    result.of_file = file_of(lit) != nullptr;
    std::vector<glm::dvec3> exact =
        exact_radiance(lit, receivers, result.receivers, next(num_receivers));
    if (is_traced)
        result.noise = add_traced(lit, result.receivers, options, next(num_receivers), exact);
    result.error = relight::compare(result.receivers, exact, lit.lighting(false).drawn());
    if (!has_surface)
        return result;
    result.surface =
        verify_points(lit, prt::random_points(scene.mesh, options.num_surface_points, options.seed),
                      lit.relighter().diffuse_radiance(), {}, next(num_points));
    result.picture = verify_picture(lit, options.num_surface_points, next(num_points));
    return result;
}

WorstError worst_of(const Verification& verification) {
    WorstError result{.relative_l2 = verification.error.relative_l2};
    const std::array parts = {&verification.surface, &verification.picture};
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (*parts[i] && (*parts[i])->error.relative_l2 > result.relative_l2)
            result = {(*parts[i])->error.relative_l2, VerifiedPlaces[i + 1]};
    return result;
}

cubemap::CubeMap contribution_map(const LitScene& lit, std::span<const std::uint32_t> receivers) {
    require_environment(lit);
    return relight::contribution_map(lit.relighter(), receivers,
                                     lit.bounces().bounced().empty() ? nullptr
                                                                     : &lit.bounces().surfaces());
}

cubemap::CubeMap adjoint(const LitScene& lit, std::span<const glm::vec3> weights) {
    require_environment(lit);
    if (lit.mirrors().is_needed())
        throw std::invalid_argument(
            "expected receivers without highlights, got some with; highlight_rays of 0 leave them "
            "out");
    return relight::adjoint(lit.relighter(), weights, surfaces_of(lit));
}

std::vector<glm::vec3> lat_long_adjoint(const cubemap::CubeMap& by_texels, std::uint32_t width,
                                        std::uint32_t height) {
    // A texel is the mean of pixels by the overlaps: overlap / texel. The means over pixels, which
    // to_image() takes, are by the same overlaps: overlap / pixel.
    const std::vector<double> texels = cubemap::texel_solid_angles(by_texels.resolution);
    cubemap::CubeMap map = by_texels;
    for (std::size_t i = 0; i < map.texels.size(); ++i)
        map.texels[i] /= static_cast<float>(texels[i % texels.size()]);
    const cubemap::EnvironmentImage image =
        cubemap::to_image(map, cubemap::Layout::LatLong, width, height);
    std::vector<glm::vec3> result(image.pixels.begin(), image.pixels.end());
    for (std::size_t i = 0; i < result.size(); ++i) {
        const std::size_t rows_above = i / width;
        const double row = std::numbers::pi / height, top = static_cast<double>(rows_above) * row;
        const double solid_angle =
            2.0 * std::numbers::pi / width * (std::cos(top) - std::cos(top + row));
        result[i] *= static_cast<float>(solid_angle);
    }
    return result;
}

cubemap::CubeMap picture_adjoint(const LitScene& lit, std::span<const glm::vec3> weights,
                                 const OutputOptions& options) {
    const Scene& scene = lit.scene();
    const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout);
    if (pixels == nullptr)
        throw std::invalid_argument(
            fmt::format("expected a scene of pixels, got {}", prt::description(scene.layout)));
    if (first_floor_vertex(scene))
        throw std::invalid_argument("expected a scene without an added floor, got one with");
    std::vector<glm::vec3> of_receivers =
        relight::cut_out_transpose(*pixels, weights, scene.receivers.veils);
    of_receivers.resize(scene.receivers.size(), glm::vec3(0.0f));
    return adjoint(lit, product(of_receivers, picture_albedo(scene, options)));
}

cubemap::CubeMap harmonics_adjoint(const LitScene& lit, std::span<const glm::vec3> weights) {
    require_environment(lit);
    if (lit.relighter().receiver_light().harmonic_order() == 0)
        throw std::logic_error("expected a scene lit with harmonics, got one without");
    return relight::harmonics_adjoint(lit.relighter(), weights, surfaces_of(lit));
}

void relight_batch(const LitScene& lit, std::span<const cubemap::CubeMap> environments,
                   std::span<glm::vec3> radiance) {
    relight::relight_batch(lit.relighter(), environments, radiance);
}

Share lit_by(const LitScene& lit, const cubemap::Region& region) {
    require_environment(lit);
    cubemap::validate(region);
    const relight::Relighter& relighter = lit.relighter();
    Share result{.radiance = {}, .environment = relighter.environment()};
    const std::vector<float> weights = cubemap::coverage_map(region, result.environment.resolution);
    for (std::size_t texel = 0; texel < weights.size(); ++texel)
        result.environment.texels[texel] *= weights[texel];

    relight::Relighter part(relighter.transfer(), relighter.shadow_rays());
    part.set_environment(result.environment);
    result.radiance.assign(part.radiance().begin(), part.radiance().end());
    result.lights = relight::picture_lights(part);
    if (!result.lights.empty())
        result.soft = part.receiver_light().soft_radiance();
    if (!lit.bounces().bounced().empty()) {
        SceneBounces bounces;
        bounces.set(lit.scene(), lit.bounces().surfaces());
        bounces.find(part.diffuse_radiance());
        for (std::vector<glm::vec3>* values : {&result.radiance, &result.soft})
            for (std::size_t i = 0; i < values->size(); ++i)
                (*values)[i] += bounces.bounced()[i];
    }
    const double all = sum_of(lit.radiance());
    result.share = all > 0.0 ? sum_of(result.radiance) / all : 0.0;
    return result;
}

bool is_inside(const LitScene& lit, const glm::vec3& point) {
    return prt::part_of_backs(point, lit.scene().mesh, lit.rays().of_mesh()) > 0.75;
}

std::vector<std::uint8_t> sees(const LitScene& lit, std::span<const glm::vec3> points) {
    for (const glm::vec3& point : points)
        if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z))
            throw std::invalid_argument("points: expected finite numbers");
    const Scene& scene = lit.scene();
    const prt::RayScene& rays = lit.rays().blockers();
    std::vector<std::uint8_t> result(scene.receivers.size() * points.size(), 0);
    files::parallel_for(std::size_t{0}, scene.receivers.size(), [&](std::size_t i) {
        const glm::vec3 normal = scene.receivers.normals[i];
        const glm::vec3 origin = scene.receivers.positions[i] + scene.settings.bias * normal;
        for (std::size_t begin = 0; begin < points.size(); begin += prt::PacketSize) {
            const std::size_t count = std::min(points.size() - begin, prt::PacketSize);
            prt::DirectionPacket packet;
            packet.num_directions = static_cast<std::uint32_t>(count);
            std::array<float, prt::PacketSize> distance{};
            std::uint32_t active = 0;
            for (std::size_t lane = 0; lane < prt::PacketSize; ++lane) {
                const std::size_t used = lane < count ? lane : 0;
                const glm::vec3 way = points[begin + used] - origin;
                distance[lane] = glm::length(way);
                packet.set(lane, distance[lane] > 0.0f ? way / distance[lane] : normal);
                if (lane < count && glm::dot(way, normal) > 0.0f)
                    active |= 1u << lane;
            }
            std::array<prt::Hit, prt::PacketSize> hits;
            const std::uint32_t met =
                active == 0 ? 0 : rays.closest_hits(origin, packet, active, hits);
            for (std::size_t lane = 0; lane < count; ++lane) {
                const bool is_blocked =
                    (met >> lane & 1u) != 0 && hits[lane].distance < distance[lane];
                result[i * points.size() + begin + lane] =
                    (active >> lane & 1u) != 0 && !is_blocked ? 1 : 0;
            }
        }
    });
    return result;
}

std::optional<glm::vec3> light_direction(const LitScene& lit, const glm::vec3& eye,
                                         const glm::vec3& view_direction, Aim aim) {
    const glm::vec3 view = glm::normalize(view_direction);
    const std::optional<prt::Hit> hit =
        lit.rays().of_mesh().closest_hit(eye, view, prt::RayOf::Eye);
    if (!hit)
        return std::nullopt;
    const mesh::TriangleMesh& mesh = lit.scene().mesh;
    const prt::MeshPoint at{.triangle = hit->triangle, .barycentric = hit->barycentric};
    const glm::vec3 front = prt::shading_normal(mesh, at);
    const glm::vec3 normal = prt::meets_front(mesh, at, view) ? front : -front;
    return aim == Aim::Facing ? normal : glm::reflect(view, normal);
}

Lighting Share::lighting() const {
    return {.radiance = radiance, .environment = &environment, .lights = lights, .soft = soft};
}

} // namespace relumine
