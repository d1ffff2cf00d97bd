#include "prt/bounces/bounce_precompute.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>

#include "cubemap/face.h"
#include "cubemap/split_mix64.h"
#include "prt/precompute.h"

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
struct RowHits {
    /// [num_hits] place of the emitter, or NoEmitter.
    std::vector<std::uint32_t> emitters;
    /// [num_hits] index of the direction.
    std::vector<std::uint32_t> directions;
};

/// Makes the rows of a block of receivers.
class RowBuilder {
public:
    RowBuilder(const mesh::TriangleMesh& mesh, const Receivers& receivers, const Transfer& transfer,
               std::span<const ProbeRadiance> probes, const RayScene& rays,
               const BounceOptions& options)
        : mesh_(mesh), receivers_(receivers), transfer_(transfer), probes_(probes), rays_(rays),
          options_(options), place_of_(receivers.size()) {
        for (std::uint32_t place = 0; place < transfer.order.size(); ++place)
            place_of_[transfer.order[place]] = place;
    }

    struct Block {
        std::array<std::vector<std::uint32_t>, BlockSize> columns;
        std::array<float, BlockSize> weights{};
        std::uint64_t num_rays = 0;
        std::uint64_t num_hits = 0;
        double sum_closure = 0.0;
        /// Sum over the rows of the squared standard error, worst of the probe lights.
        double sum_squared_error = 0.0;
    };

    [[nodiscard]] Block make(std::size_t block) const {
        Block result;
        const std::size_t begin = block * BlockSize;
        const std::size_t size = std::min(BlockSize, transfer_.num_receivers() - begin);
        std::array<RowHits, BlockSize> hits;
        std::uint32_t num_directions = 0;
        double error = 0.0;
        do {
            const std::uint32_t next =
                num_directions == 0 ? options_.min_directions : 2 * num_directions;
            error = 0.0;
            for (std::size_t i = 0; i < size; ++i) {
                look(begin + i, num_directions, next, hits[i], result.num_rays);
                error += squared_error(begin + i, hits[i]);
            }
            num_directions = next;
        } while (num_directions < options_.max_directions &&
                 error > static_cast<double>(size) * options_.tolerance * options_.tolerance);
        result.sum_squared_error = error;
        for (std::size_t i = 0; i < size; ++i) {
            const double closure = closure_of(begin + i);
            result.sum_closure += closure;
            result.num_hits += hits[i].emitters.size();
            if (!hits[i].emitters.empty())
                result.weights[i] =
                    static_cast<float>(closure / static_cast<double>(hits[i].emitters.size()));
            result.columns[i] = std::move(hits[i].emitters);
            std::erase(result.columns[i], NoEmitter);
            std::sort(result.columns[i].begin(), result.columns[i].end());
            if (result.columns[i].empty())
                result.weights[i] = 0.0f;
        }
        return result;
    }

private:
    /// Returns the part of the hemisphere that surfaces close.
    [[nodiscard]] double closure_of(std::size_t place) const {
        const glm::vec3& normal = transfer_.normals[place];
        if (normal == glm::vec3(0.0f))
            return 0.0;
        return std::clamp(1.0 - static_cast<double>(probes_[place][0]), 0.0, 1.0);
    }

    /// Traces the directions begin .. end - 1 of a receiver.
    void look(std::size_t place, std::uint32_t begin, std::uint32_t end, RowHits& hits,
              std::uint64_t& num_rays) const {
        if (closure_of(place) == 0.0)
            return;
        const std::uint32_t receiver = transfer_.order[place];
        const CosineDirections directions(transfer_.normals[place], receiver);
        const glm::vec3 origin =
            ray_origin(receivers_.positions[receiver], transfer_.normals[place], options_.bias);
        for (std::uint32_t i = begin; i < end; ++i) {
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
            hits.emitters.push_back(emitter_of(*hit, glm::vec3(direction), choice));
            hits.directions.push_back(i);
        }
    }

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

    /// Returns the squared standard error of a row under the worst of the probe lights, from the
    /// difference of its halves: every second direction.
    [[nodiscard]] double squared_error(std::size_t place, const RowHits& hits) const {
        const double closure = closure_of(place);
        if (hits.emitters.empty())
            return closure * closure;
        std::array<std::array<double, NumProbeLights>, 2> sums{};
        std::array<double, 2> sizes{};
        for (std::size_t i = 0; i < hits.emitters.size(); ++i) {
            const std::size_t half = hits.directions[i] % 2;
            sizes[half] += 1.0;
            if (hits.emitters[i] != NoEmitter)
                for (std::size_t light = 0; light < NumProbeLights; ++light)
                    sums[half][light] += static_cast<double>(probes_[hits.emitters[i]][light]);
        }
        double worst = 0.0;
        for (std::size_t light = 0; light < NumProbeLights; ++light) {
            const double a = sizes[0] > 0.0 ? sums[0][light] / sizes[0] : 0.0;
            const double b = sizes[1] > 0.0 ? sums[1][light] / sizes[1] : 0.0;
            worst = std::max(worst, std::abs(a - b));
        }
        return 0.25 * closure * closure * worst * worst;
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
    const RowBuilder builder(mesh, receivers, transfer, probes, rays, options);
    const std::size_t num_blocks = transfer.counts.num_blocks();
    std::vector<RowBuilder::Block> blocks(num_blocks);
    std::size_t num_done = 0;
    std::mutex progress;
    tbb::parallel_for(std::size_t{0}, num_blocks, [&](std::size_t block) {
        if (options.stop.stop_requested())
            return;
        blocks[block] = builder.make(block);
        const std::scoped_lock lock(progress);
        ++num_done;
        if (options.on_progress && (num_done % 64 == 0 || num_done == num_blocks))
            options.on_progress(static_cast<double>(num_done) / static_cast<double>(num_blocks));
    });
    if (options.stop.stop_requested())
        throw Cancelled();

    BounceMatrix result;
    BounceStatistics found;
    const std::size_t num_rows = transfer.num_receivers();
    result.weights.reserve(num_rows);
    result.row_begin.reserve(num_rows + 1);
    double squared_error = 0.0;
    for (std::size_t block = 0; block < num_blocks; ++block) {
        RowBuilder::Block& made = blocks[block];
        for (std::size_t i = 0; i < std::min(BlockSize, num_rows - block * BlockSize); ++i) {
            result.weights.push_back(made.weights[i]);
            result.columns.insert(result.columns.end(), made.columns[i].begin(),
                                  made.columns[i].end());
            result.row_begin.push_back(result.columns.size());
            made.columns[i] = {};
        }
        found.num_rays += made.num_rays;
        found.num_hits += made.num_hits;
        found.mean_closure += made.sum_closure;
        squared_error += made.sum_squared_error;
    }
    result.spectral_radius = spectral_radius(result);
    found.num_columns = result.columns.size();
    found.mean_closure /= static_cast<double>(num_rows);
    found.rms_error = std::sqrt(squared_error / static_cast<double>(num_rows));
    found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (statistics != nullptr)
        *statistics = found;
    return result;
}

} // namespace relumine::prt
