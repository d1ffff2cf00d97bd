#include "prt/bounces/bounce_precompute.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>

#include "cubemap/face.h"
#include "cubemap/split_mix64.h"
#include "prt/bounces/similar_receivers.h"
#include "prt/precompute.h"
#include "prt/receivers/mesh_point.h"

namespace relumine::prt {

namespace {

/// Sets the choice of vertices apart from the shift of directions.
constexpr std::uint64_t ChoiceSeed = 0x5851f42d4c957f2du;

/// The column of a hit on a surface that radiates nothing.
constexpr std::uint32_t NoEmitter = std::numeric_limits<std::uint32_t>::max();

/// Returns a number in [0, 1) from the upper bits.
double unit_interval(std::uint64_t bits) {
    return static_cast<double>(bits >> 11u) * 0x1p-53;
}

/// Cosine-distributed directions around a normal: Roberts' R2 sequence, shifted by the receiver, so
/// that any beginning of it is stratified.
class CosineDirections {
public:
    CosineDirections(const glm::vec3& normal, std::uint32_t receiver)
        : normal_(normal),
          shift_s_(unit_interval(cubemap::SplitMix64(2 * std::uint64_t{receiver}).next())),
          shift_t_(unit_interval(cubemap::SplitMix64(2 * std::uint64_t{receiver} + 1).next())) {
        // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
        const double sign = std::copysign(1.0, normal_.z);
        const double a = -1.0 / (sign + normal_.z);
        const double b = normal_.x * normal_.y * a;
        tangent_ = {1.0 + sign * normal_.x * normal_.x * a, sign * b, -sign * normal_.x};
        bitangent_ = {b, sign + normal_.y * normal_.y * a, -normal_.y};
    }

    [[nodiscard]] glm::dvec3 operator[](std::uint32_t i) const {
        constexpr double StepS = 0.7548776662466927, StepT = 0.5698402909980532;
        const double s = fraction(shift_s_ + StepS * i);
        const double t = fraction(shift_t_ + StepT * i);
        const double radius = std::sqrt(s);
        const double angle = 2.0 * std::numbers::pi * t;
        return radius * std::cos(angle) * tangent_ + radius * std::sin(angle) * bitangent_ +
               std::sqrt(1.0 - s) * normal_;
    }

private:
    static double fraction(double value) { return value - std::floor(value); }

    glm::dvec3 normal_;
    double shift_s_;
    double shift_t_;
    glm::dvec3 tangent_{};
    glm::dvec3 bitangent_{};
};

/// What a receiver's rays met.
struct Samples {
    /// Place of each emitter, or NoEmitter, of every second direction: two halves, whose difference
    /// tells the error.
    std::array<std::vector<std::uint32_t>, 2> halves;
    std::uint32_t num_directions = 0;
    /// Over the hits.
    double sum_inverse_distances = 0.0;

    [[nodiscard]] std::size_t num_hits() const { return halves[0].size() + halves[1].size(); }
    /// Harmonic mean of the distances of surfaces; sky is infinitely far away.
    [[nodiscard]] float distance() const {
        return static_cast<float>(num_directions / sum_inverse_distances);
    }
};

/// Traces the samples of receivers.
class Sampler {
public:
    Sampler(const mesh::TriangleMesh& mesh, const Receivers& receivers, const Transfer& transfer,
            std::span<const ProbeRadiance> probes, const RayScene& rays,
            const BounceOptions& options)
        : mesh_(mesh), receivers_(receivers), transfer_(transfer), probes_(probes), rays_(rays),
          options_(options), place_of_(receivers.size()) {
        for (std::uint32_t place = 0; place < transfer.order.size(); ++place)
            place_of_[transfer.order[place]] = place;
    }

    /// Returns the part of the hemisphere that surfaces close.
    [[nodiscard]] double closure_of(std::size_t place) const {
        const glm::vec3& normal = transfer_.normals[place];
        if (normal == glm::vec3(0.0f))
            return 0.0;
        return std::clamp(1.0 - static_cast<double>(probes_[place][0]), 0.0, 1.0);
    }

    /// Looks into as many directions as `num_directions`, after those that are there. Returns the
    /// number of rays.
    std::uint64_t look(std::size_t place, std::uint32_t num_directions, Samples& samples) const {
        const std::uint32_t begin = std::exchange(samples.num_directions, num_directions);
        if (closure_of(place) == 0.0)
            return 0;
        const std::uint32_t receiver = transfer_.order[place];
        const CosineDirections directions(transfer_.normals[place], receiver);
        const glm::vec3 origin =
            ray_origin(receivers_.positions[receiver], transfer_.normals[place], options_.bias);
        std::uint64_t num_rays = 0;
        for (std::uint32_t i = begin; i < num_directions; ++i) {
            const glm::dvec3 direction = directions[i];
            const std::uint32_t leaf = transfer_.quadtree.leaf_at(cubemap::face_point(direction));
            if (transfer_.counts.count(place, leaf) == 16)
                continue;
            ++num_rays;
            const auto hit = rays_.closest_hit(origin, glm::vec3(direction));
            if (!hit)
                continue;
            const double choice = unit_interval(
                cubemap::SplitMix64((std::uint64_t{receiver} << 32u | i) ^ ChoiceSeed).next());
            samples.halves[i % 2].push_back(emitter_of(*hit, glm::vec3(direction), choice));
            const MeshPoint at{hit->triangle, hit->barycentric};
            const auto distance =
                static_cast<double>(glm::distance(value_at(mesh_, mesh_.positions, at), origin));
            samples.sum_inverse_distances += 1.0 / distance;
        }
        return num_rays;
    }

    /// Returns the squared standard error of one bounce under the worst of the probe lights, from
    /// the difference of the halves.
    [[nodiscard]] double squared_error(std::size_t place, const Samples& samples) const {
        const double closure = closure_of(place);
        if (samples.num_hits() == 0)
            return closure * closure;
        std::array<std::array<double, NumProbeLights>, 2> means{};
        for (std::size_t half = 0; half < 2; ++half) {
            for (const std::uint32_t emitter : samples.halves[half])
                if (emitter != NoEmitter)
                    for (std::size_t light = 0; light < NumProbeLights; ++light)
                        means[half][light] += static_cast<double>(probes_[emitter][light]);
            for (double& mean : means[half])
                mean /= std::max(static_cast<double>(samples.halves[half].size()), 1.0);
        }
        double worst = 0.0;
        for (std::size_t light = 0; light < NumProbeLights; ++light)
            worst = std::max(worst, std::abs(means[0][light] - means[1][light]));
        return 0.25 * closure * closure * worst * worst;
    }

private:
    /// Draws a vertex of the triangle by its barycentric weight; `choice` is in [0, 1).
    [[nodiscard]] std::uint32_t emitter_of(const Hit& hit, const glm::vec3& direction,
                                           double choice) const {
        const mesh::Triangle& corners = mesh_.triangles[hit.triangle];
        const float u = hit.barycentric.x;
        const float v = hit.barycentric.y;
        if (!options_.two_sided && !meets_front(mesh_, {hit.triangle, hit.barycentric}, direction))
            return NoEmitter;
        const std::size_t corner = choice < static_cast<double>(u)       ? 1
                                   : choice < static_cast<double>(u + v) ? 2
                                                                         : 0;
        return place_of_[corners[corner]];
    }

    const mesh::TriangleMesh& mesh_;
    const Receivers& receivers_;
    const Transfer& transfer_;
    std::span<const ProbeRadiance> probes_;
    const RayScene& rays_;
    const BounceOptions& options_;
    /// [num_receivers] place by receiver.
    std::vector<std::uint32_t> place_of_;
};

void require_options(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                     const Transfer& transfer, std::span<const ProbeRadiance> probes,
                     const BounceOptions& options) {
    if (!receivers.points.empty() || receivers.size() != mesh.num_vertices() ||
        transfer.num_receivers() != receivers.size() || probes.size() != receivers.size())
        throw std::invalid_argument("expected bounces between the vertices of the mesh");
    if (!(options.tolerance > 0.0f))
        throw std::invalid_argument(
            fmt::format("expected a tolerance of bounces > 0, got {}", options.tolerance));
    if (options.min_directions < 2 || options.max_directions < options.min_directions)
        throw std::invalid_argument("expected at least two directions");
}

} // namespace

BounceMatrix precompute_bounces(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                                const Transfer& transfer, std::span<const ProbeRadiance> probes,
                                const RayScene& rays, const BounceOptions& options,
                                BounceStatistics* statistics) {
    const auto start = std::chrono::steady_clock::now();
    require_options(mesh, receivers, transfer, probes, options);
    const Sampler sampler(mesh, receivers, transfer, probes, rays, options);
    const std::size_t num_rows = transfer.num_receivers();
    const std::size_t num_blocks = transfer.counts.num_blocks();

    // Two rounds over all blocks: the first finds how far surfaces are and how different samples,
    // the second adds samples where those of similar receivers together are too few.
    std::size_t num_done = 0;
    std::mutex progress;
    const auto for_blocks = [&](const auto& work) {
        tbb::parallel_for(std::size_t{0}, num_blocks, [&](std::size_t block) {
            if (options.stop.stop_requested())
                return;
            work(block * BlockSize, std::min((block + 1) * BlockSize, num_rows), block);
            const std::scoped_lock lock(progress);
            ++num_done;
            if (options.on_progress && num_done % 64 == 0)
                options.on_progress(0.5 * static_cast<double>(num_done) /
                                    static_cast<double>(num_blocks));
        });
        if (options.stop.stop_requested())
            throw Cancelled();
    };
    std::vector<Samples> samples(num_rows);
    std::vector<std::uint64_t> num_rays(num_blocks);
    std::vector<glm::vec3> positions(num_rows);
    std::vector<float> distances(num_rows);
    for_blocks([&](std::size_t begin, std::size_t end, std::size_t block) {
        for (std::size_t place = begin; place < end; ++place) {
            num_rays[block] += sampler.look(place, options.min_directions, samples[place]);
            positions[place] = receivers.positions[transfer.order[place]];
            distances[place] = samples[place].num_hits() == 0 ? 0.0f : samples[place].distance();
        }
    });

    BounceMatrix result;
    result.averaged = similar_receivers(positions, transfer.normals, distances);
    std::vector<double> squared_errors(num_blocks);
    for_blocks([&](std::size_t begin, std::size_t end, std::size_t block) {
        double error = 0.0;
        for (std::size_t place = begin; place < end; ++place)
            error +=
                sampler.squared_error(place, samples[place]) / static_cast<double>(end - begin);
        // The variance falls as the number of directions and of those who share them grows.
        for (std::size_t place = begin; place < end; ++place) {
            const double shared = error / static_cast<double>(result.averaged[place].size());
            std::uint32_t factor = 1;
            while (shared > factor * static_cast<double>(options.tolerance * options.tolerance) &&
                   2 * factor * options.min_directions <= options.max_directions)
                factor *= 2;
            num_rays[block] += sampler.look(place, factor * options.min_directions, samples[place]);
            squared_errors[block] += shared / factor;
        }
    });

    BounceStatistics found;
    for (std::size_t place = 0; place < num_rows; ++place) {
        const double closure = sampler.closure_of(place);
        double num_hits = 0.0, num_emitters = 0.0;
        for (const std::uint32_t other : result.averaged[place]) {
            num_hits += static_cast<double>(samples[other].num_hits());
            num_emitters += static_cast<double>(samples[other].num_hits());
            for (const std::vector<std::uint32_t>& half : samples[other].halves)
                num_emitters -=
                    static_cast<double>(std::count(half.begin(), half.end(), NoEmitter));
        }
        result.weights.push_back(num_emitters > 0.0 ? static_cast<float>(closure / num_hits)
                                                    : 0.0f);
        found.mean_closure += closure / static_cast<double>(num_rows);
        found.num_hits += samples[place].num_hits();
    }
    for (Samples& each : samples) {
        std::vector<std::uint32_t>& row = each.halves[0];
        row.insert(row.end(), each.halves[1].begin(), each.halves[1].end());
        std::erase(row, NoEmitter);
        std::sort(row.begin(), row.end());
        result.emitters.append(row);
        each = {};
    }
    result.spectral_radius = spectral_radius(result);
    found.num_rays = std::accumulate(num_rays.begin(), num_rays.end(), std::uint64_t{0});
    found.num_emitters = result.emitters.places.size();
    found.mean_averaged =
        static_cast<double>(result.averaged.places.size()) / static_cast<double>(num_rows);
    found.rms_error = std::sqrt(std::accumulate(squared_errors.begin(), squared_errors.end(), 0.0) /
                                static_cast<double>(num_rows));
    found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (statistics != nullptr)
        *statistics = found;
    return result;
}

} // namespace relumine::prt
