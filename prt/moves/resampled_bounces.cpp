#include "prt/moves/resampled_bounces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "cubemap/face.h"
#include "files/parallel.h"
#include "prt/bounces/bounce_precompute.h"
#include "prt/bounces/bounce_sampler.h"
#include "prt/bounces/bounce_samples.h"
#include "prt/bounces/matrix_rows.h"
#include "prt/moves/met_boxes.h"
#include "prt/steps.h"

namespace relumine::prt {

namespace {

/// What a sampler is asked with: rays that know no probe lights.
struct Asked {
    explicit Asked(const BounceView& view)
        : probes{.open_parts = view.open_parts, .values = {}, .index = {}},
          options{.two_sided = view.scene.settings.two_sided_bounces,
                  .bias = view.scene.settings.bias},
          sampler(view.scene.mesh, view.scene.receivers, view.scene.transfer, probes, view.rays,
                  options) {}
    BounceProbes probes;
    BounceOptions options;
    BounceSampler sampler;
};

/// For which receivers of a block rays of bounces go into other clusters: where a receiver sees all
/// of a cluster, none does.
class OpenedClusters {
public:
    OpenedClusters(const VisibleCounts& counts, const CountsPatch& patch)
        : counts_(counts), patch_(patch), index_(counts.num_blocks() * counts.words_per_block()) {
        for (std::uint32_t i = 0; i < patch.words.size(); ++i)
            index_[patch.words[i].word] = i + 1;
    }

    /// [clusters] of a block, a bit for each receiver
    using OfBlock = std::vector<std::uint16_t>;
    /// Calls visit(cluster) for those with a bit that is set.
    template<typename Visit>
    void find(std::size_t block, OfBlock& found, const Visit& visit) const {
        found.assign(counts_.num_leaves, 0);
        for (std::size_t w = 0; w < counts_.words_per_block(); ++w) {
            const std::size_t word = counts_.word(block, w);
            if (index_[word] == 0)
                continue;
            const CountsPatch::Word& own = patch_.words[index_[word] - 1];
            const std::uint8_t* now = patch_.counts.data() + own.first * BlockSize;
            for (std::uint64_t bits = own.clusters; bits != 0; bits &= bits - 1) {
                const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
                const bool is_mixed = (own.mixed >> bit & 1u) != 0;
                const std::uint16_t other =
                    full(counts_.visible[word], counts_.mixed[word], bit,
                         (counts_.mixed[word] >> bit & 1u) != 0 ? counts_.mixed_counts(word, bit)
                                                                : nullptr) ^
                    full(own.visible, own.mixed, bit, is_mixed ? now : nullptr);
                now += is_mixed ? BlockSize : 0;
                if (other == 0)
                    continue;
                found[64 * w + bit] = other;
                visit(static_cast<std::uint32_t>(64 * w) + bit);
            }
        }
    }

private:
    /// Which receivers see all of a cluster. `counts`: where these are mixed.
    static std::uint16_t full(std::uint64_t visible, std::uint64_t mixed, std::uint32_t bit,
                              const std::uint8_t* counts) {
        if ((mixed >> bit & 1u) == 0)
            return (visible >> bit & 1u) != 0 ? 0xffff : 0;
        unsigned result = 0;
        for (std::size_t i = 0; i < BlockSize; ++i)
            result |= static_cast<unsigned>(counts[i] == FullCount) << i;
        return static_cast<std::uint16_t>(result);
    }

    const VisibleCounts& counts_;
    const CountsPatch& patch_;
    /// [words] one more than the patch's, or 0
    std::vector<std::uint32_t> index_;
};

/// A cone around a centre and all within an angle of it.
DirectionCone cone(const glm::dvec3& centre, double angle) {
    constexpr double Roundings = 1e-5;
    return {.axis = glm::vec3(glm::normalize(centre)),
            .cosine = angle < std::numbers::pi
                          ? static_cast<float>(std::cos(angle + Roundings) - Roundings)
                          : -1.0f};
}

/// Finds cones with all directions from a block's places that may meet a box of a difference or lie
/// in one of some clusters.
class ConesOfBlocks {
public:
    ConesOfBlocks(const Quadtree& quadtree, const SceneDifference& difference)
        : difference_(difference) {
        for (const Cell& cell : quadtree.leaves()) {
            const auto at = [&](double x, double y) {
                return cubemap::direction(cell.face, (cell.x + x) * cell.size(),
                                          (cell.y + y) * cell.size());
            };
            const glm::dvec3 centre = at(0.5, 0.5);
            double least = 1.0;
            for (std::uint32_t i = 0; i < 4; ++i)
                least = std::min(least, glm::dot(centre, at(i & 1u, i >> 1u)));
            cells_.push_back({centre, std::acos(least)});
        }
    }

    /// `places`: the box of the block's origins. `for_changed(visit)` calls visit(cluster).
    template<typename ForChanged>
    [[nodiscard]] std::array<DirectionCone, 2> of(const mesh::Bounds& places,
                                                  const ForChanged& for_changed) const {
        std::array<Cap, 2> caps;
        for (std::size_t side = 0; side < caps.size(); ++side)
            caps[side] = cap_of(difference_.around[side], places);
        for_changed([&](std::uint32_t cluster) {
            const Cap& cell = cells_[cluster];
            const auto needed = [&](const Cap& cap) {
                return std::acos(std::clamp(glm::dot(cap.centre, cell.centre), -1.0, 1.0)) +
                       cell.angle;
            };
            const std::array<double, 2> angles = {needed(caps[0]), needed(caps[1])};
            const std::size_t side = angles[0] - caps[0].angle <= angles[1] - caps[1].angle ? 0 : 1;
            caps[side].angle = std::max(caps[side].angle, angles[side]);
        });
        return {cone(caps[0].centre, caps[0].angle), cone(caps[1].centre, caps[1].angle)};
    }

private:
    /// Directions within an angle of a centre.
    struct Cap {
        glm::dvec3 centre{0.0, 1.0, 0.0};
        double angle = 0.0;
    };

    /// Returns what a box fills as seen from places: a sphere around it.
    static Cap cap_of(const mesh::Bounds& box, const mesh::Bounds& places) {
        constexpr double Margin = 1e-5; // more than that of MetBoxes
        if (!(box.min.x <= box.max.x))
            return {};
        const glm::dvec3 way = glm::dvec3(box.center()) - glm::dvec3(places.center());
        const double distance = glm::length(way);
        const double radius = 0.5 * static_cast<double>(box.diagonal() + places.diagonal()) +
                              Margin * static_cast<double>(reach(box) + reach(places));
        return distance > radius ? Cap{way / distance, std::asin(radius / distance)}
                                 : Cap{{0.0, 1.0, 0.0}, std::numbers::pi};
    }

    const SceneDifference& difference_;
    std::vector<Cap> cells_;
};

/// How light grows within a few bounces: after a small change of the matrix its largest eigenvalue
/// is another in proportion.
class Growth {
public:
    explicit Growth(const BounceMatrix& matrix)
        : radius_(matrix.spectral_radius),
          few_(matrix.rays.early_radius > 0.0f ? matrix.rays.early_radius
                                               : spectral_radius(matrix, FewBounces)) {}

    void set_radius_of(BounceMatrix& next) const {
        constexpr float Small = 0.01f;
        const float few = spectral_radius(next, FewBounces);
        next.rays.early_radius = few;
        next.spectral_radius = std::abs(few - few_) < Small * few_
                                   ? std::min(radius_ * (few / few_), 1.0f)
                                   : spectral_radius(next);
    }

private:
    static constexpr int FewBounces = 3;
    float radius_, few_;
};

} // namespace

bool ResampledBounces::are_possible(const Scene& scene) {
    return scene.bounces && scene.transfer.num_points == 0 &&
           scene.bounces->rays.num_directions.size() == scene.transfer.num_receivers();
}

ResampledBounces::ResampledBounces(const BounceView& before, const SceneDifference& difference,
                                   const CountsPatch& counts, const Work& work)
    : rows_(before.scene.transfer.num_receivers()) {
    const Transfer& transfer = before.scene.transfer;
    const Receivers& receivers = before.scene.receivers;
    const BounceRays& rays = before.scene.bounces->rays;
    const Asked asked(before);
    const OpenedClusters opened(transfer.counts, counts);
    const ConesOfBlocks cones_of(transfer.quadtree, difference);
    Progress progress(work);
    const auto origin_of = [&](std::size_t place) {
        return ray_origin(receivers.positions[transfer.order[place]], transfer.normals[place],
                          before.scene.settings.bias);
    };
    files::parallel_for(std::size_t{0}, transfer.counts.num_blocks(), [&](std::size_t block) {
        progress.poll();
        const std::size_t begin = block * BlockSize;
        const std::size_t end = std::min(begin + BlockSize, rows_.size());
        mesh::Bounds places = no_box();
        for (std::size_t place = begin; place < end; ++place)
            include(places, origin_of(place));
        thread_local OpenedClusters::OfBlock of_block;
        const auto cones =
            cones_of.of(places, [&](const auto& visit) { opened.find(block, of_block, visit); });
        for (std::size_t place = begin; place < end; ++place) {
            Row& row = rows_[place];
            const PartReceiver own{.place = place, .index = place};
            // Who saw no surface looked into no direction.
            row.is_whole =
                difference.receivers[transfer.order[place]] || asked.sampler.closure_of(own) == 0.0;
            if (row.is_whole)
                continue;
            const glm::vec3 origin = origin_of(place);
            std::optional<MetBoxes> boxes;
            float reach = 0.0f; // of the present ray: up to where nothing changed
            asked.sampler.look_near(
                own, rays.num_directions[place], cones,
                [&](std::uint32_t direction_number, const glm::dvec3& direction,
                    std::uint32_t cluster) {
                    if (!boxes)
                        boxes.emplace(difference.boxes, mesh::Bounds{origin, origin});
                    const bool is_opened = (of_block[cluster] >> (place - begin) & 1u) != 0;
                    reach = is_opened ? 0.0f : boxes->nearest(inverse(glm::vec3(direction)));
                    const bool is_wanted = reach < std::numeric_limits<float>::infinity();
                    if (is_wanted)
                        row.directions.push_back(direction_number);
                    return is_wanted;
                },
                [&](std::uint32_t direction_number, const RayFate& fate) {
                    constexpr double Margin = 1.0 + 1e-4;
                    if (static_cast<double>(reach) * fate.inverse_distance > Margin) {
                        row.directions.pop_back(); // it ends before
                        return;
                    }
                    ++row.num_hits;
                    if (fate.emitter != NoEmitter)
                        row.emitters.push_back(fate.emitter);
                    if (direction_number < asked.options.min_directions)
                        row.sum_inverse_distances += fate.inverse_distance;
                });
            std::ranges::sort(row.emitters);
        }
    });
}

BouncesPatch ResampledBounces::update(BounceMatrix& matrix, const BounceView& now,
                                      const Work& work) {
    const Scene& scene = now.scene;
    const Transfer& transfer = scene.transfer;
    const Asked asked(now);
    const std::uint32_t first_look = asked.options.min_directions;
    BouncesPatch patch{.distances = matrix.rays.distances, .num_hits = matrix.rays.num_hits};
    Progress progress(work);
    files::parallel_for(std::size_t{0}, rows_.size(), [&](std::size_t place) {
        progress.poll();
        Row& row = rows_[place];
        const PartReceiver own{.place = place, .index = place};
        const bool is_whole = row.is_whole || asked.sampler.closure_of(own) == 0.0;
        if (!is_whole && row.directions.empty())
            return;
        const float distance = matrix.rays.distances[place];
        std::uint32_t num_hits = 0;
        double sum = 0.0, sum_before = 0.0;
        if (is_whole) {
            row.directions.resize(matrix.rays.num_directions[place]);
            std::iota(row.directions.begin(), row.directions.end(), 0u);
            const std::span<const std::uint32_t> all = matrix.emitters[place];
            row.emitters.assign(all.begin(), all.end());
        } else {
            num_hits = matrix.rays.num_hits[place] - row.num_hits;
            sum_before = distance > 0.0f ? first_look / static_cast<double>(distance) : 0.0;
            sum = sum_before - row.sum_inverse_distances;
        }
        asked.sampler.look(own, row.directions, [&](std::uint32_t direction, const RayFate& fate) {
            ++num_hits;
            if (fate.emitter != NoEmitter)
                row.now.push_back(fate.emitter);
            if (direction < first_look)
                sum += fate.inverse_distance;
        });
        std::ranges::sort(row.now);
        row.directions = {};
        patch.num_hits[place] = num_hits;
        constexpr double Roundings = 1e-6; // of floats, where all was taken away
        patch.distances[place] =
            sum > Roundings * sum_before ? static_cast<float>(first_look / sum) : 0.0f;
    });
    for (std::uint32_t place = 0; place < rows_.size(); ++place)
        patch.emitters.append(place, rows_[place].emitters, rows_[place].now);
    rows_ = {};
    std::vector<std::uint32_t> all(transfer.num_receivers());
    std::iota(all.begin(), all.end(), 0u);
    patch.averaged =
        difference(matrix.averaged, shared_samples(scene.receivers, transfer, 0, all.size(),
                                                   patch.distances, all, &matrix.averaged));
    const Growth growth_before(matrix);
    patch.weights = matrix.weights;
    exchange(matrix, patch);
    for (std::size_t place = 0; place < all.size(); ++place)
        matrix.weights[place] =
            row_weight(matrix, place, closed_part(transfer.normals[place], now.open_parts[place]),
                       matrix.rays.num_hits);
    growth_before.set_radius_of(matrix);
    return patch;
}

} // namespace relumine::prt
