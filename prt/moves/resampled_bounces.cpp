#include "prt/moves/resampled_bounces.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "files/parallel.h"
#include "prt/bounces/bounce_precompute.h"
#include "prt/bounces/bounce_sampler.h"
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

/// Which clusters of a block have other counts: a bit each.
std::vector<std::uint64_t> changed_clusters(const VisibleCounts& counts, const CountsPatch& patch) {
    std::vector<std::uint64_t> result(counts.num_blocks() * counts.words_per_block());
    for (const CountsPatch::Word& word : patch.words)
        result[word.word] = word.clusters;
    return result;
}

std::vector<std::uint32_t> without(std::span<const std::uint32_t> row,
                                   const std::vector<std::uint32_t>& some) {
    std::vector<std::uint32_t> result;
    std::ranges::set_difference(row, some, std::back_inserter(result));
    return result;
}

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
    const std::vector<std::uint64_t> changed = changed_clusters(transfer.counts, counts);
    Progress progress(work);
    files::parallel_for(std::size_t{0}, rows_.size(), [&](std::size_t place) {
        progress.poll();
        Row& row = rows_[place];
        const std::uint32_t receiver = transfer.order[place];
        const PartReceiver own{.place = place, .index = place};
        // Who saw no surface looked into no direction.
        row.is_whole = difference.receivers[receiver] || asked.sampler.closure_of(own) == 0.0;
        if (row.is_whole)
            return;
        const glm::vec3 origin = ray_origin(receivers.positions[receiver], transfer.normals[place],
                                            before.scene.settings.bias);
        const MetBoxes boxes(difference.boxes, {origin, origin});
        const std::size_t block = place / BlockSize;
        row.directions = asked.sampler.chosen(
            own, rays.num_directions[place],
            [&](const glm::dvec3& direction, std::uint32_t cluster) {
                return (changed[transfer.counts.word(block, cluster / 64)] >> cluster % 64 & 1u) !=
                           0 ||
                       boxes.meets(inverse(glm::vec3(direction)));
            });
        asked.sampler.look(own, row.directions, [&](std::uint32_t direction, const RayFate& fate) {
            ++row.num_hits;
            if (fate.emitter != NoEmitter)
                row.emitters.push_back(fate.emitter);
            if (direction < asked.options.min_directions)
                row.sum_inverse_distances += fate.inverse_distance;
        });
        std::ranges::sort(row.emitters);
    });
}

BounceSamples ResampledBounces::samples(const BounceView& now, const BounceMatrix& before,
                                        const Work& work) {
    const Scene& scene = now.scene;
    const Transfer& transfer = scene.transfer;
    const Asked asked(now);
    const std::uint32_t first_look = asked.options.min_directions;
    BounceSamples result;
    result.open_parts.assign(now.open_parts.begin(), now.open_parts.end());
    result.num_directions = before.rays.num_directions;
    result.num_hits.resize(rows_.size());
    result.distances.resize(rows_.size());
    std::vector<std::vector<std::uint32_t>> rows(rows_.size());
    Progress progress(work);
    files::parallel_for(std::size_t{0}, rows_.size(), [&](std::size_t place) {
        progress.poll();
        Row& row = rows_[place];
        const PartReceiver own{.place = place, .index = place};
        const bool is_whole = row.is_whole || asked.sampler.closure_of(own) == 0.0;
        const float distance = before.rays.distances[place];
        std::uint32_t num_hits = 0;
        double sum = 0.0, sum_before = 0.0;
        if (is_whole) {
            row.directions.resize(result.num_directions[place]);
            std::iota(row.directions.begin(), row.directions.end(), 0u);
        } else {
            rows[place] = without(before.emitters[place], row.emitters);
            num_hits = before.rays.num_hits[place] - row.num_hits;
            sum_before = distance > 0.0f ? first_look / static_cast<double>(distance) : 0.0;
            sum = sum_before - row.sum_inverse_distances;
        }
        asked.sampler.look(own, row.directions, [&](std::uint32_t direction, const RayFate& fate) {
            ++num_hits;
            if (fate.emitter != NoEmitter)
                rows[place].push_back(fate.emitter);
            if (direction < first_look)
                sum += fate.inverse_distance;
        });
        std::ranges::sort(rows[place]);
        result.num_hits[place] = num_hits;
        constexpr double Roundings = 1e-6; // of floats, where all was taken away
        result.distances[place] =
            sum > Roundings * sum_before ? static_cast<float>(first_look / sum) : 0.0f;
        row = {};
    });
    for (const std::vector<std::uint32_t>& row : rows)
        result.emitters.append(row);
    std::vector<std::uint32_t> all(rows.size());
    std::iota(all.begin(), all.end(), 0u);
    result.averaged =
        shared_samples(scene.receivers, transfer, 0, rows.size(), result.distances, all);
    return result;
}

} // namespace relumine::prt
