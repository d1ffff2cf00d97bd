#include "relight/exact.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/split_mix64.h"
#include "prt/glossy/brdf.h"
#include "prt/precompute.h"

namespace relumine::relight {

namespace {

// A packet is a 4 x 4 tile of texels. The 64 receivers of one task share the work of setting it up.
constexpr std::uint32_t TileSize = 4;
constexpr std::size_t ReceiversPerTask = 64;
static_assert(std::size_t{TileSize} * TileSize == prt::PacketSize);

struct Tile {
    prt::DirectionPacket packet;
    /// L dw.
    std::array<glm::dvec3, prt::PacketSize> power{};
    /// Lanes with any light.
    std::uint32_t lit = 0;
};

Tile tile_at(const cubemap::CubeMap& environment, std::span<const double> solid_angles,
             cubemap::Face face, std::uint32_t x0, std::uint32_t y0) {
    Tile tile;
    const std::uint32_t r = environment.resolution;
    tile.packet.num_directions = prt::PacketSize;
    for (std::uint32_t i = 0; i < prt::PacketSize; ++i) {
        // Lanes outside of the face repeat its last texel, without light.
        const std::uint32_t x = x0 + i % TileSize;
        const std::uint32_t y = y0 + i / TileSize;
        const std::uint32_t inner_x = std::min(x, r - 1);
        const std::uint32_t inner_y = std::min(y, r - 1);
        tile.packet.set(i, cubemap::texel_direction(face, inner_x, inner_y, r));
        if (x >= r || y >= r)
            continue;
        tile.power[i] =
            glm::dvec3(environment.at(face, x, y)) * solid_angles[std::size_t{y} * r + x];
        tile.lit |= static_cast<std::uint32_t>(tile.power[i] != glm::dvec3(0.0)) << i;
    }
    return tile;
}

/// Computes the light that one receiver sends back. Colours are put in last.
class ExactReceiver {
public:
    ExactReceiver(const prt::Receivers& receivers, std::uint32_t index, float bias)
        : normal_(receivers.normals[index]),
          origin_(prt::ray_origin(receivers.positions[index], normal_, bias)) {
        if (!receivers.surfaces.empty())
            surface_ = receivers.surfaces[index];
        if (!receivers.to_eye.empty())
            to_eye_ = receivers.to_eye[index];
    }

    void add(const Tile& tile, const prt::Blockers& blockers, prt::Lobes<glm::dvec3>& sums) const {
        const bool diffuse_only = surface_.highlight == prt::Highlight::None;
        std::uint32_t lit = prt::lit_lanes(blockers, origin_, normal_, tile.packet, tile.lit);
        for (; lit != 0; lit &= lit - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(lit));
            const glm::vec3 w(tile.packet.x[i], tile.packet.y[i], tile.packet.z[i]);
            const float cosine = normal_.x * w.x + normal_.y * w.y + normal_.z * w.z;
            sums.diffuse += tile.power[i] * (static_cast<double>(cosine) / std::numbers::pi);
            if (diffuse_only)
                continue;
            const prt::Lobes<float> lobes = prt::evaluate_lobes(surface_, normal_, to_eye_, w);
            sums.diffuse_grazing += tile.power[i] * static_cast<double>(lobes.diffuse_grazing);
            sums.specular += tile.power[i] * static_cast<double>(lobes.specular);
            sums.specular_grazing += tile.power[i] * static_cast<double>(lobes.specular_grazing);
        }
    }

    [[nodiscard]] glm::dvec3 radiance(const prt::Lobes<glm::dvec3>& sums) const {
        if (surface_ == prt::Surface())
            return sums.diffuse;
        return prt::reflect(surface_, {.diffuse = sums.diffuse,
                                       .diffuse_grazing = sums.diffuse_grazing,
                                       .specular = sums.specular,
                                       .specular_grazing = sums.specular_grazing});
    }

private:
    glm::vec3 normal_;
    glm::vec3 origin_;
    /// Zero is below every horizon: no highlight.
    glm::vec3 to_eye_{0.0f};
    prt::Surface surface_;
};

void require(bool condition, const char* message) {
    if (!condition)
        throw std::invalid_argument(message);
}

void check(const prt::Receivers& receivers, std::span<const std::uint32_t> receiver_indices,
           const cubemap::CubeMap& environment) {
    const std::size_t n = receivers.size();
    require(receivers.normals.size() == n, "expected one normal per receiver");
    require(receivers.surfaces.empty() || receivers.surfaces.size() == n,
            "expected one surface per receiver, or none");
    require(receivers.to_eye.empty() || receivers.to_eye.size() == n,
            "expected one direction to the eye per receiver, or none");
    require(std::all_of(receiver_indices.begin(), receiver_indices.end(),
                        [n](std::uint32_t i) { return i < n; }),
            "expected indices of receivers");
    const std::size_t r = environment.resolution;
    require(r > 0 && environment.texels.size() == cubemap::NumFaces * r * r,
            "expected an environment of 6 x R x R texels");
}

} // namespace

std::vector<glm::dvec3> exact_radiance(const prt::Receivers& receivers,
                                       std::span<const std::uint32_t> receiver_indices,
                                       const prt::Blockers& blockers,
                                       const cubemap::CubeMap& environment,
                                       const ExactOptions& options) {
    check(receivers, receiver_indices, environment);
    const std::uint32_t r = environment.resolution;
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(r);
    std::vector<prt::Lobes<glm::dvec3>> sums(receiver_indices.size());
    std::vector<ExactReceiver> exact;
    exact.reserve(receiver_indices.size());
    for (const std::uint32_t receiver : receiver_indices)
        exact.emplace_back(receivers, receiver, options.bias);
    std::mutex mutex;
    std::size_t rows_done = 0;
    const std::size_t num_tasks =
        (receiver_indices.size() + ReceiversPerTask - 1) / ReceiversPerTask;
    const std::size_t rows_per_task = cubemap::NumFaces * ((r + TileSize - 1) / TileSize);

    const auto report_row = [&] {
        if (options.stop.stop_requested())
            throw prt::Cancelled();
        const std::scoped_lock lock(mutex);
        ++rows_done;
        if (options.on_progress)
            options.on_progress(static_cast<double>(rows_done) /
                                static_cast<double>(num_tasks * rows_per_task));
    };
    tbb::parallel_for(std::size_t{0}, num_tasks, [&](std::size_t task) {
        const std::size_t begin = task * ReceiversPerTask;
        const std::size_t end = std::min(begin + ReceiversPerTask, receiver_indices.size());
        for (const cubemap::Face face : cubemap::AllFaces)
            for (std::uint32_t y = 0; y < r; y += TileSize) {
                for (std::uint32_t x = 0; x < r; x += TileSize) {
                    const Tile tile = tile_at(environment, solid_angles, face, x, y);
                    if (tile.lit == 0)
                        continue;
                    for (std::size_t i = begin; i < end; ++i)
                        exact[i].add(tile, blockers, sums[i]);
                }
                report_row();
            }
    });
    std::vector<glm::dvec3> radiance(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        radiance[i] = exact[i].radiance(sums[i]);
    return radiance;
}

std::vector<std::uint32_t> random_receivers(const prt::Transfer& transfer, std::size_t count,
                                            std::uint64_t seed) {
    const std::size_t num_receivers = transfer.num_receivers();
    if (count == 0 || count > num_receivers)
        count = num_receivers;
    std::vector<std::uint32_t> places(num_receivers);
    std::iota(places.begin(), places.end(), 0u);
    // Fisher and Yates' shuffle of the first `count` places.
    cubemap::SplitMix64 random(seed);
    for (std::size_t i = 0; i < count; ++i)
        std::swap(places[i], places[i + random.below(num_receivers - i)]);
    places.resize(count);
    std::sort(places.begin(), places.end());
    std::transform(places.begin(), places.end(), places.begin(),
                   [&](std::uint32_t p) { return transfer.order[p]; });
    return places;
}

ErrorReport compare(std::span<const std::uint32_t> receiver_indices,
                    std::span<const glm::dvec3> exact, std::span<const glm::vec3> relit) {
    require(exact.size() == receiver_indices.size(), "expected one exact radiance per index");
    require(std::all_of(receiver_indices.begin(), receiver_indices.end(),
                        [&](std::uint32_t i) { return i < relit.size(); }),
            "expected indices of relit receivers");
    ErrorReport report;
    double error_squares = 0.0;
    double exact_squares = 0.0;
    double error_sum = 0.0;
    double exact_sum = 0.0;
    double largest = -1.0;
    for (std::size_t i = 0; i < receiver_indices.size(); ++i) {
        const glm::dvec3 error = glm::abs(glm::dvec3(relit[receiver_indices[i]]) - exact[i]);
        error_squares += glm::dot(error, error);
        exact_squares += glm::dot(exact[i], exact[i]);
        error_sum += error.r + error.g + error.b;
        exact_sum += exact[i].r + exact[i].g + exact[i].b;
        if (const double worst = std::max({error.r, error.g, error.b}); worst > largest) {
            largest = worst;
            report.worst_receiver = receiver_indices[i];
        }
    }
    if (receiver_indices.empty())
        return report;
    const double num_values = 3.0 * static_cast<double>(receiver_indices.size());
    report.mean_radiance = exact_sum / num_values;
    if (error_sum == 0.0)
        return report;
    report.relative_l2 = std::sqrt(error_squares / exact_squares);
    report.mean_abs = error_sum / exact_sum;
    report.max_abs = largest / report.mean_radiance;
    return report;
}

} // namespace relumine::relight
