#include "prt/bounces/bounce_precompute.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>

#include "cubemap/face.h"
#include "cubemap/split_mix64.h"
#include "files/packed_parts.h"
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
          options_(options), place_of_(mesh.num_vertices(), NoEmitter) {
        for (std::uint32_t place = 0; place < transfer.order.size(); ++place) {
            const std::uint32_t receiver = transfer.order[place];
            if (receivers.points.empty())
                place_of_[receiver] = place;
            else if (receiver >= receivers.num_own())
                place_of_[vertex_at(mesh, receivers.points[receiver])] = place;
        }
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
    /// [num_vertices] place of each vertex.
    std::vector<std::uint32_t> place_of_;
};

/// Finds the rows of all receivers, block by block, in two passes: the first finds how far away
/// surfaces are and how different the samples, the second adds samples where those of similar
/// receivers together are too few. A checkpoint has the blocks of each pass.
class BouncePrecompute {
public:
    BouncePrecompute(const Receivers& receivers, const Transfer& transfer, const Sampler& sampler,
                     const BounceOptions& options)
        : receivers_(receivers), transfer_(transfer), sampler_(sampler), options_(options),
          samples_(transfer.num_receivers()), blocks_(transfer.counts.num_blocks()) {}

    BounceMatrix run(BounceStatistics& found) {
        run_pass("bounces", 0.0, [this](std::size_t block) {
            for (std::size_t place = begin_of(block); place < begin_of(block + 1); ++place)
                blocks_[block].num_rays +=
                    sampler_.look(place, options_.min_directions, samples_[place]);
        });
        BounceMatrix result;
        result.averaged = lists_of_similar();
        std::vector<std::uint32_t> factors(samples_.size());
        choose_factors(result.averaged, factors);
        require_memory(factors);
        run_pass("more_bounces", 0.5, [&](std::size_t block) {
            for (std::size_t place = begin_of(block); place < begin_of(block + 1); ++place)
                blocks_[block].num_rays +=
                    sampler_.look(place, factors[place] * options_.min_directions, samples_[place]);
        });
        collect(result, found);
        return result;
    }

private:
    /// What is known of a block beside its samples.
    struct Block {
        std::uint64_t num_rays = 0;
        /// Sum over its receivers, with the samples of the second pass.
        double squared_errors = 0.0;
    };

    [[nodiscard]] std::size_t begin_of(std::size_t block) const {
        return std::min(block * BlockSize, samples_.size());
    }

    /// Calls work(block) for every block that a checkpoint does not have.
    template<typename Work>
    void run_pass(const std::string& part, double progress_before, const Work& work) {
        // Work between two looks at the checkpoint: about a tenth of a second.
        constexpr std::size_t BlocksPerStep = 256;
        std::size_t num_saved = options_.checkpoint != nullptr ? take_up(part) : 0;
        std::size_t num_done = num_saved;
        std::mutex mutex;
        std::size_t num_reported = num_done;
        const auto save = [&] {
            if (options_.checkpoint->save(part, record(num_saved, num_done), {}))
                num_saved = num_done;
        };
        while (num_done < blocks_.size()) {
            const std::size_t end = std::min(num_done + BlocksPerStep, blocks_.size());
            tbb::parallel_for(num_done, end, [&](std::size_t block) {
                if (options_.stop.stop_requested())
                    return;
                work(block);
                const std::scoped_lock lock(mutex);
                ++num_reported;
                if (options_.on_progress && num_reported % 64 == 0)
                    options_.on_progress(progress_before + 0.5 * static_cast<double>(num_reported) /
                                                               static_cast<double>(blocks_.size()));
            });
            const bool is_stopped = options_.stop.stop_requested();
            if (is_stopped && options_.checkpoint != nullptr && num_saved != num_done &&
                options_.checkpoint->is_worthwhile())
                save();
            if (is_stopped)
                throw Cancelled();
            num_done = end;
            if (options_.checkpoint != nullptr && options_.checkpoint->is_due())
                save();
        }
    }

    /// Writes all that is known of some blocks.
    [[nodiscard]] std::vector<std::byte> record(std::size_t first, std::size_t last) const {
        return files::pack(1, [&](std::size_t) {
            files::ByteWriter writer;
            for (std::size_t block = first; block < last; ++block) {
                writer.add(blocks_[block].num_rays);
                for (std::size_t place = begin_of(block); place < begin_of(block + 1); ++place) {
                    const Samples& samples = samples_[place];
                    writer.add(samples.num_directions);
                    writer.add(samples.sum_inverse_distances);
                    for (const std::vector<std::uint32_t>& half : samples.halves) {
                        writer.add<std::uint64_t>(half.size());
                        writer.add_all(std::span(half));
                    }
                }
            }
            return writer.take();
        });
    }

    /// Takes up the blocks of an earlier run; returns how many there are.
    std::size_t take_up(const std::string& part) {
        std::size_t block = 0;
        for (const std::vector<std::byte>& record : options_.checkpoint->load(part, false).records)
            files::unpack(record, [&](std::span<const std::byte> bytes) {
                for (files::ByteReader reader(bytes); !reader.at_end(); ++block) {
                    if (block == blocks_.size())
                        throw std::runtime_error("checkpoint: expected fewer blocks");
                    blocks_[block].num_rays = reader.next<std::uint64_t>();
                    for (std::size_t place = begin_of(block); place < begin_of(block + 1);
                         ++place) {
                        Samples& samples = samples_[place];
                        samples.num_directions = reader.next<std::uint32_t>();
                        samples.sum_inverse_distances = reader.next<double>();
                        for (std::vector<std::uint32_t>& half : samples.halves) {
                            const auto size = reader.next<std::uint64_t>();
                            half = reader.next_all<std::uint32_t>(static_cast<std::size_t>(size));
                        }
                    }
                }
            });
        return block;
    }

    /// Added vertices share samples among themselves: they are lit again and again, the pixels or
    /// texels before them once.
    [[nodiscard]] PlaceLists lists_of_similar() const {
        std::vector<glm::vec3> positions(samples_.size());
        std::vector<float> distances(samples_.size());
        for (std::size_t place = 0; place < samples_.size(); ++place) {
            positions[place] = receivers_.positions[transfer_.order[place]];
            distances[place] = samples_[place].num_hits() == 0 ? 0.0f : samples_[place].distance();
        }
        const auto is_added = [this](std::uint32_t receiver) {
            return receiver >= receivers_.num_own();
        };
        const auto first = static_cast<std::size_t>(
            std::find_if(transfer_.order.begin(), transfer_.order.end(), is_added) -
            transfer_.order.begin());
        PlaceLists lists;
        for (const auto& [begin, end] :
             {std::pair(std::size_t{0}, first), std::pair(first, samples_.size())}) {
            const std::size_t size = end - begin;
            PlaceLists part = similar_receivers(std::span(positions).subspan(begin, size),
                                                std::span(transfer_.normals).subspan(begin, size),
                                                std::span(distances).subspan(begin, size));
            for (std::uint32_t& place : part.places)
                place += static_cast<std::uint32_t>(begin);
            for (std::size_t i = 0; i < size; ++i)
                lists.append(part[i]);
        }
        return lists;
    }

    /// How many times the directions of the first pass each receiver needs: the variance falls as
    /// the number of directions and of those who share them grows. Where surfaces meet, few share;
    /// their noise would stand as a line beside even walls, the more the less sky they see.
    void choose_factors(const PlaceLists& averaged, std::vector<std::uint32_t>& factors) {
        const double allowed = static_cast<double>(options_.tolerance * options_.tolerance);
        tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t block) {
            const std::size_t begin = begin_of(block), end = begin_of(block + 1);
            double error = 0.0;
            for (std::size_t place = begin; place < end; ++place)
                error += sampler_.squared_error(place, samples_[place]) /
                         static_cast<double>(end - begin);
            blocks_[block].squared_errors = 0.0;
            for (std::size_t place = begin; place < end; ++place) {
                constexpr double LeastShared = 8.0;
                const auto num_shared = static_cast<double>(averaged[place].size());
                const double shared = error / num_shared;
                const double least = samples_[place].num_hits() == 0
                                         ? 1.0
                                         : LeastShared * sampler_.closure_of(place);
                factors[place] = 1;
                while ((shared > factors[place] * allowed || factors[place] * num_shared < least) &&
                       2 * factors[place] * options_.min_directions <= options_.max_directions)
                    factors[place] *= 2;
                blocks_[block].squared_errors += shared / factors[place];
            }
        });
    }

    void require_memory(const std::vector<std::uint32_t>& factors) const {
        std::uint64_t num_hits = 0;
        for (std::size_t place = 0; place < samples_.size(); ++place)
            num_hits += factors[place] * samples_[place].num_hits();
        if (num_hits * BytesPerHit > options_.max_bytes)
            throw TooManyHits(num_hits);
    }

    /// Makes the rows of the samples, and frees these.
    void collect(BounceMatrix& result, BounceStatistics& found) {
        const auto num_rows = static_cast<double>(samples_.size());
        for (std::size_t place = 0; place < samples_.size(); ++place) {
            const double closure = sampler_.closure_of(place);
            double num_hits = 0.0, num_emitters = 0.0;
            for (const std::uint32_t other : result.averaged[place]) {
                num_hits += static_cast<double>(samples_[other].num_hits());
                num_emitters += static_cast<double>(samples_[other].num_hits());
                for (const std::vector<std::uint32_t>& half : samples_[other].halves)
                    num_emitters -=
                        static_cast<double>(std::count(half.begin(), half.end(), NoEmitter));
            }
            result.weights.push_back(num_emitters > 0.0 ? static_cast<float>(closure / num_hits)
                                                        : 0.0f);
            found.mean_closure += closure / num_rows;
            found.num_hits += samples_[place].num_hits();
        }
        for (Samples& each : samples_) {
            std::vector<std::uint32_t>& row = each.halves[0];
            row.insert(row.end(), each.halves[1].begin(), each.halves[1].end());
            std::erase(row, NoEmitter);
            std::sort(row.begin(), row.end());
            result.emitters.append(row);
            each = {};
        }
        result.spectral_radius = spectral_radius(result);
        double squared_errors = 0.0;
        for (const Block& block : blocks_) {
            found.num_rays += block.num_rays;
            squared_errors += block.squared_errors;
        }
        found.num_emitters = result.emitters.places.size();
        found.mean_averaged = static_cast<double>(result.averaged.places.size()) / num_rows;
        found.rms_error = std::sqrt(squared_errors / num_rows);
    }

    const Receivers& receivers_;
    const Transfer& transfer_;
    const Sampler& sampler_;
    const BounceOptions& options_;
    /// By place.
    std::vector<Samples> samples_;
    std::vector<Block> blocks_;
};

void require_options(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                     const Transfer& transfer, std::span<const ProbeRadiance> probes,
                     const BounceOptions& options) {
    const bool has_vertices = receivers.points.empty() ? receivers.size() == mesh.num_vertices()
                                                       : receivers.num_added != 0;
    if (!has_vertices || transfer.num_receivers() != receivers.size() ||
        probes.size() != receivers.size())
        throw std::invalid_argument("expected bounces between the vertices of the mesh");
    if (!(options.tolerance > 0.0f))
        throw std::invalid_argument(
            fmt::format("expected a tolerance of bounces > 0, got {}", options.tolerance));
    if (options.min_directions < 2 || options.max_directions < options.min_directions)
        throw std::invalid_argument("expected at least two directions");
}

} // namespace

TooManyHits::TooManyHits(std::uint64_t hits)
    : std::runtime_error(fmt::format("too many hits of bounces: {}", hits)), num_hits(hits) {}

BounceMatrix precompute_bounces(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                                const Transfer& transfer, std::span<const ProbeRadiance> probes,
                                const RayScene& rays, const BounceOptions& options,
                                BounceStatistics* statistics) {
    const auto start = std::chrono::steady_clock::now();
    require_options(mesh, receivers, transfer, probes, options);
    const Sampler sampler(mesh, receivers, transfer, probes, rays, options);
    BounceStatistics found;
    BounceMatrix result = BouncePrecompute(receivers, transfer, sampler, options).run(found);
    found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (statistics != nullptr)
        *statistics = found;
    return result;
}

} // namespace relumine::prt
