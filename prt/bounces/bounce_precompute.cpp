#include "prt/bounces/bounce_precompute.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/vector_relational.hpp>

#include "files/packed_parts.h"
#include "files/parallel.h"
#include "prt/bounces/bounce_sampler.h"
#include "prt/clusters/dealt_tiles.h"
#include "prt/steps.h"

namespace relumine::prt {

namespace {

/// Writes what a receiver's rays met for a checkpoint.
void add(files::ByteWriter& writer, const RayHits& hits) {
    writer.add(hits.num_directions);
    writer.add(hits.sum_inverse_distances);
    for (const std::vector<std::uint32_t>& half : hits.halves) {
        writer.add<std::uint64_t>(half.size());
        writer.add_all(std::span(half));
    }
}

RayHits next_hits(files::ByteReader& reader) {
    RayHits hits;
    hits.num_directions = reader.next<std::uint32_t>();
    hits.sum_inverse_distances = reader.next<double>();
    for (std::vector<std::uint32_t>& half : hits.halves) {
        const auto size = reader.next<std::uint64_t>();
        half = reader.next_all<std::uint32_t>(static_cast<std::size_t>(size));
    }
    return hits;
}

/// Finds what the rays of a part's receivers meet, block by block, in two passes: the first finds
/// how far away surfaces are and how different the hits, the second adds rays where those of
/// similar receivers together are too few. A checkpoint has the blocks of each pass.
class BouncePrecompute {
public:
    /// `is_planned`: parts know nothing of each other.
    BouncePrecompute(const Receivers& receivers, const Transfer& transfer,
                     const BounceSampler& sampler, const BounceOptions& options, const Work& work,
                     bool is_planned)
        : receivers_(receivers), transfer_(transfer), sampler_(sampler), options_(options),
          work_(work), is_planned_(is_planned), progress_(work),
          places_(places_of(work.team.part(), transfer.num_receivers())), hits_(places_.size()),
          blocks_(transfer.counts.num_blocks()) {}

    BounceSamples run() {
        look("bounces", 0.0, std::vector<std::uint32_t>(hits_.size(), 1));
        BounceSamples result;
        for (const RayHits& hits : hits_)
            result.distances.push_back(hits.num_hits() == 0 ? 0.0f : hits.distance());
        if (!is_planned_)
            result.averaged = lists_of_similar(result.distances);
        std::vector<std::uint32_t> factors(hits_.size());
        choose_factors(result.averaged ? *result.averaged : lists_in_tiles(result.distances),
                       factors);
        require_memory(factors);
        look("more_bounces", 0.5, factors);
        look_around(result);
        collect(result);
        return result;
    }

private:
    /// What is known of a block beside its hits.
    struct Block {
        std::uint64_t num_rays = 0;
        /// Sum over its receivers, with the samples of the second pass.
        double squared_errors = 0.0;
    };

    [[nodiscard]] PartReceiver receiver(std::size_t index) const {
        return {.place = places_[index], .index = index};
    }
    [[nodiscard]] std::size_t begin_of(std::size_t block) const {
        return std::min(block * BlockSize, hits_.size());
    }

    /// A pass: all receivers look into so many times the first directions.
    void look(const std::string& part, double progress_before,
              std::span<const std::uint32_t> factors) {
        BlockWork blocks{.part = part,
                         .num_blocks = blocks_.size(),
                         .blocks_per_tile = VisibleCounts::TileBlocks,
                         // Of all processes: about a tenth of a second.
                         .blocks_per_step =
                             std::max<std::size_t>(256 / work_.team.part().count, 16)};
        blocks.work = [&](std::size_t block) {
            for (std::size_t i = begin_of(block); i < begin_of(block + 1); ++i)
                blocks_[block].num_rays +=
                    sampler_.look(receiver(i), factors[i] * options_.min_directions, hits_[i]);
        };
        blocks.write = [this](std::size_t block, files::ByteWriter& writer) {
            writer.add(blocks_[block].num_rays);
            for (std::size_t i = begin_of(block); i < begin_of(block + 1); ++i)
                add(writer, hits_[i]);
        };
        blocks.read = [this](std::size_t block, files::ByteReader& reader) {
            blocks_[block].num_rays = reader.next<std::uint64_t>();
            for (std::size_t i = begin_of(block); i < begin_of(block + 1); ++i)
                hits_[i] = next_hits(reader);
        };
        progress_.start_stage(progress_before, progress_before + 0.5);
        do_blocks(work_, blocks, progress_);
    }

    /// Finds what points see, which come first among the part's places. It takes seconds where
    /// vertices take minutes, so no checkpoint has it.
    void look_around(BounceSamples& result) {
        const std::size_t num_points = places_of(work_.team.part(), transfer_.num_points).size();
        if (num_points == 0)
            return;
        const std::vector<glm::dvec3> directions = even_directions(point_directions());
        result.points.num_directions = point_directions();
        result.points.emitters.resize(num_points * directions.size());
        std::vector<std::uint64_t> num_rays(num_points);
        const std::stop_token stop = work_.stop_in_step();
        files::parallel_for(std::size_t{0}, num_points, [&](std::size_t i) {
            if (stop.stop_requested())
                return;
            num_rays[i] =
                sampler_.look_around(receiver(i), directions,
                                     std::span(result.points.emitters)
                                         .subspan(i * directions.size(), directions.size()));
        });
        if (stop.stop_requested())
            throw Cancelled();
        result.num_rays += std::accumulate(num_rays.begin(), num_rays.end(), std::uint64_t{0});
    }

    [[nodiscard]] std::uint32_t point_directions() const {
        return num_point_directions(options_.tolerance);
    }

    /// Who shares samples with the part's receivers, of all there are.
    [[nodiscard]] PlaceLists lists_of_similar(std::span<const float> own_distances) {
        std::vector<float> distances(transfer_.num_receivers());
        for (std::size_t i = 0; i < places_.size(); ++i)
            distances[places_[i]] = own_distances[i];
        share_by_place(work_.team, std::span(distances));
        return shared_samples(receivers_, transfer_, 0, distances.size(), distances, places_);
    }

    /// Who shares samples, of the receivers in the same tile: what a part knows by itself.
    [[nodiscard]] PlaceLists lists_in_tiles(std::span<const float> own_distances) const {
        constexpr std::size_t Width = VisibleCounts::TileBlocks * BlockSize;
        PlaceLists lists;
        for (std::size_t begin = 0; begin < places_.size(); begin += Width) {
            const std::size_t size = std::min(Width, places_.size() - begin);
            const auto wanted = std::span(places_).subspan(begin, size);
            const PlaceLists of_tile =
                shared_samples(receivers_, transfer_, wanted.front(), wanted.front() + size,
                               own_distances.subspan(begin, size), wanted);
            for (std::size_t i = 0; i < of_tile.size(); ++i)
                lists.append(of_tile[i]);
        }
        return lists;
    }

    /// How many times the directions of the first pass each receiver needs: the variance falls as
    /// the number of directions and of those who share them grows. Where surfaces meet, few share;
    /// their noise would stand as a line beside even walls, the more the less sky they see. Probe
    /// lights know nothing of a sun that lights a small place through a window, so the smaller the
    /// tolerance, the more rays everywhere.
    void choose_factors(const PlaceLists& averaged, std::vector<std::uint32_t>& factors) {
        const double allowed = static_cast<double>(options_.tolerance * options_.tolerance);
        const double by_default = static_cast<double>(BounceOptions{}.tolerance);
        const double least_shared = 8.0 * by_default * by_default / allowed;
        files::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t block) {
            const std::size_t begin = begin_of(block), end = begin_of(block + 1);
            double error = 0.0;
            for (std::size_t i = begin; i < end; ++i)
                error += sampler_.squared_error(receiver(i), hits_[i]) /
                         static_cast<double>(end - begin);
            blocks_[block].squared_errors = 0.0;
            for (std::size_t i = begin; i < end; ++i) {
                const auto num_shared = static_cast<double>(averaged[i].size());
                const double shared = error / num_shared;
                const double least = hits_[i].num_hits() == 0
                                         ? 1.0
                                         : least_shared * sampler_.closure_of(receiver(i));
                factors[i] = 1;
                while ((shared > factors[i] * allowed || factors[i] * num_shared < least) &&
                       2 * factors[i] * options_.min_directions <= options_.max_directions)
                    factors[i] *= 2;
                blocks_[block].squared_errors += shared / factors[i];
            }
        });
    }

    void require_memory(const std::vector<std::uint32_t>& factors) const {
        std::uint64_t num_hits = std::uint64_t{transfer_.num_points} * point_directions();
        for (std::size_t i = 0; i < hits_.size(); ++i)
            num_hits += factors[i] * hits_[i].num_hits();
        if (num_hits * BytesPerHit > options_.max_bytes)
            throw TooLarge("hits of bounces", num_hits, num_hits * BytesPerHit);
    }

    /// Makes the rows of the hits, and frees these.
    void collect(BounceSamples& result) {
        for (RayHits& each : hits_) {
            result.num_hits.push_back(static_cast<std::uint32_t>(each.num_hits()));
            if (options_.is_kept)
                result.num_directions.push_back(each.num_directions);
            std::vector<std::uint32_t>& row = each.halves[0];
            row.insert(row.end(), each.halves[1].begin(), each.halves[1].end());
            std::erase(row, NoEmitter);
            std::sort(row.begin(), row.end());
            result.emitters.append(row);
            each = {};
        }
        for (const Block& block : blocks_) {
            result.num_rays += block.num_rays;
            result.squared_errors += block.squared_errors;
        }
    }

    const Receivers& receivers_;
    const Transfer& transfer_;
    const BounceSampler& sampler_;
    const BounceOptions& options_;
    const Work& work_;
    bool is_planned_;
    Progress progress_;
    /// [receivers of the part]
    std::vector<std::uint32_t> places_;
    std::vector<RayHits> hits_;
    /// [blocks of the part]
    std::vector<Block> blocks_;
};

void require_options(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                     const Transfer& transfer, const BounceProbes& probes,
                     const BounceOptions& options) {
    const bool has_vertices = receivers.points.empty() ? receivers.size() == mesh.num_vertices()
                                                       : receivers.num_added != 0;
    const std::size_t num_emitters =
        probes.index.empty() ? probes.values.size() : probes.index.size();
    if (!has_vertices || transfer.num_receivers() != receivers.size() ||
        num_emitters != receivers.size())
        throw std::invalid_argument("expected bounces between the vertices of the mesh");
    if (probes.open_parts.size() != transfer.counts.num_receivers)
        throw std::invalid_argument("expected the open part of each receiver's hemisphere");
    if (!(options.tolerance > 0.0f))
        throw std::invalid_argument(
            fmt::format("expected a tolerance of bounces > 0, got {}", options.tolerance));
    if (options.min_directions < 2 || options.max_directions < options.min_directions)
        throw std::invalid_argument("expected at least two directions");
}

} // namespace

float automatic_tolerance(std::size_t num_vertices, bool is_room) {
    const float part = is_room ? 0.5f : 2.0f;
    const float fine = is_room ? 25'000.0f : 400'000.0f;
    return BounceOptions{}.tolerance * part *
           std::max(1.0f, std::sqrt(static_cast<float>(num_vertices) / fine));
}

BounceSamples sample_bounces(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                             const Transfer& transfer, const BounceProbes& probes,
                             const RayScene& rays, const BounceOptions& options, const Work& work) {
    require_options(mesh, receivers, transfer, probes, options);
    const BounceSampler sampler(mesh, receivers, transfer, probes, rays, options);
    const bool is_planned = !probes.index.empty();
    BounceSamples samples =
        BouncePrecompute(receivers, transfer, sampler, options, work, is_planned).run();
    samples.open_parts.assign(probes.open_parts.begin(), probes.open_parts.end());
    return samples;
}

double estimated_closure(const Receivers& receivers, const Blockers& blockers, float bias) {
    constexpr std::size_t NumReceivers = 512;
    DirectionPatch sphere;
    for (std::size_t i = 0; i < DirectionPatch::Size; ++i) {
        // A spiral: equal areas, each next point a golden angle further.
        const double height = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / DirectionPatch::Size;
        const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(i);
        const double radius = std::sqrt(1.0 - height * height);
        sphere.add({radius * std::cos(angle), height, radius * std::sin(angle)});
    }
    double blocked = 0.0, all = 0.0;
    const std::size_t step = (receivers.size() + NumReceivers - 1) / NumReceivers;
    for (std::size_t i = 0; i < receivers.size(); i += step) {
        const glm::vec3& normal = receivers.normals[i];
        const glm::vec3 origin = ray_origin(receivers.positions[i], normal, bias);
        // precompute() will refuse it.
        if (!glm::all(glm::lessThan(glm::abs(origin), glm::vec3(LargestCoordinate))))
            return 0.0;
        for (const DirectionPacket& packet : sphere.packets) {
            const std::uint32_t lit = lit_lanes(blockers, origin, normal, packet, 0xffff);
            for (std::size_t lane = 0; lane < PacketSize; ++lane) {
                const glm::vec3 direction = packet.direction(lane);
                const double cosine = std::max(double{glm::dot(normal, direction)}, 0.0);
                all += cosine;
                blocked += (lit >> lane & 1u) != 0 ? 0.0 : cosine;
            }
        }
    }
    return all > 0.0 ? blocked / all : 0.0;
}

} // namespace relumine::prt
