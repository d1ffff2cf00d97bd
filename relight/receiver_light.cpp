// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN],
// Section 5.
#include "relight/receiver_light.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <stdexcept>

#include <fmt/format.h>

#include "files/large_vector.h"
#include "files/parallel.h"
#include "prt/moves/scene_change.h"
#include "relight/kernels/update_kernel.h"

namespace relumine::relight {

namespace {

/// Calls visit(block, bit) for blocks of a tile, each one's number in the scene and its bit.
template<typename Visit>
void for_blocks(const prt::VisibleCounts& counts, std::size_t tile, std::uint64_t blocks,
                const Visit& visit) {
    for (blocks &= counts.tile_blocks(tile); blocks != 0; blocks &= blocks - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(blocks));
        visit(counts.tile_begin(tile) + bit, std::uint64_t{1} << bit);
    }
}

} // namespace

ReceiverLight::ReceiverLight(const prt::Transfer& transfer, const ShadowRays& rays,
                             std::uint32_t harmonics)
    : transfer_(transfer), traced_(transfer, rays), normals_(block_normals(transfer.normals)),
      words_(tile_words(transfer, normals_)),
      light_(files::large_vector<BlockLight>(transfer.counts.num_blocks())),
      lights_(transfer.num_clusters()),
      radiance_(files::large_vector<glm::vec3>(transfer.num_receivers())),
      diffuse_(transfer.surfaces.size()) {
    if ((!transfer.surfaces.empty() || transfer.glossy) &&
        transfer.surfaces.size() != transfer.num_receivers())
        throw std::invalid_argument(
            "expected one surface per receiver, or none without a glossy part");
    if (transfer.glossy && transfer.glossy->to_eye.size() != transfer.num_receivers())
        throw std::invalid_argument(
            "expected a direction to the eye per receiver, see prt::set_surfaces()");
    if (transfer.glossy) {
        pyramid_.emplace(transfer.glossy->deepest_level());
        glossy_.resize(transfer.counts.num_blocks());
        eye_cosines_.resize(transfer.num_receivers());
        for (std::size_t i = 0; i < eye_cosines_.size(); ++i)
            eye_cosines_[i] = {transfer.surfaces[i], transfer.normals[i],
                               transfer.glossy->to_eye[i]};
    }
    if (harmonics > MaxHarmonicOrder)
        throw std::invalid_argument(fmt::format("expected harmonics of order 1 to {}, got {}",
                                                MaxHarmonicOrder, harmonics));
    // The light of points is the first coefficient.
    if (harmonics != 0 || transfer.num_points != 0)
        harmonics_.emplace(transfer, std::max(harmonics, 1u));
}

std::size_t ReceiverLight::trace(std::span<const SharpLight> lights) {
    const std::size_t num_fresh = traced_.trace(lights);
    if (harmonics_)
        harmonics_->take_traced(lights, traced_);
    return num_fresh;
}

void ReceiverLight::write_points() {
    write_means(true, radiance_);
    if (!diffuse_.empty())
        write_means(true, diffuse_);
}

void ReceiverLight::write_means(bool with_sharp_lights, std::span<glm::vec3> radiance) const {
    files::parallel_for(std::size_t{0}, transfer_.num_points, [&](std::size_t place) {
        radiance[transfer_.order[place]] = harmonics_->mean(place, with_sharp_lights);
    });
}

std::vector<glm::vec3> ReceiverLight::harmonics(bool with_sharp_lights) const {
    if (!harmonics_)
        throw std::logic_error("expected a Relighter with harmonics, got one without");
    const std::size_t count = num_harmonics(harmonics_->order());
    std::vector<glm::vec3> result(radiance_.size() * count);
    files::parallel_for(std::size_t{0}, light_.size(), [&](std::size_t block) {
        const std::size_t begin = block * prt::BlockSize;
        for (std::size_t place = begin; place < std::min(begin + prt::BlockSize, radiance_.size());
             ++place)
            harmonics_->read(place,
                             std::span(result).subspan(transfer_.order[place] * count, count),
                             with_sharp_lights);
    });
    return result;
}

void ReceiverLight::sum(const ClusterSums& sums) {
    if (harmonics_)
        harmonics_->sum(block_scene(), sums);
    if (!has_surfaces())
        return write_points();
    files::parallel_for(files::IndexRange<std::size_t>(0, lights_.spread.size()),
                        [&](const auto& words) {
                            const std::size_t end = std::min(words.end() * 64, sums.all.size());
                            for (std::size_t cluster = words.begin() * 64; cluster < end; ++cluster)
                                lights_.set(cluster, sums.without_sharp(cluster));
                        });
    lights_.sum_prefix();
    is_updated_ = false;
    light_blocks(std::vector<std::uint64_t>(transfer_.counts.num_tiles(), ~std::uint64_t{0}));
    write_points();
}

void ReceiverLight::light_blocks(std::span<const std::uint64_t> blocks) {
    const BlockScene scene = block_scene();
    files::parallel_for(std::size_t{0}, transfer_.counts.num_tiles(), [&](std::size_t tile) {
        if (blocks[tile] == 0)
            return;
        light_tile(scene, tile, lights_, light_, blocks[tile]);
        for_blocks(transfer_.counts, tile, blocks[tile], [&](std::size_t block, std::uint64_t) {
            light_glossy(block);
            light_[block].brightness.set_summed(write_radiance(block));
        });
    });
}

void ReceiverLight::follow(const ClusterSums& sums, const prt::SceneChange& change) {
    for (const std::uint32_t place : change.places)
        set_normal(normals_, place, transfer_.normals[place]);
    std::vector<std::uint64_t> changed = prt::changed_blocks(transfer_.counts, change);
    relight::update(words_, transfer_, normals_, changed);
    traced_.follow(sums.sharp, change.difference, changed);
    if (harmonics_)
        harmonics_->take_traced(sums.sharp, traced_);
    if (is_updated_ || harmonics_ || !has_surfaces())
        sum(sums);
    else
        light_blocks(changed);
}

std::size_t ReceiverLight::update(const ClusterSums& sums, std::span<const std::uint32_t> changed,
                                  bool sharp_changed) {
    const std::size_t num_lit = harmonics_ ? harmonics_->update(block_scene(), sums, changed) : 0;
    if (!has_surfaces()) {
        write_points();
        return std::min((sharp_changed ? light_.size() : num_lit) * prt::BlockSize,
                        radiance_.size());
    }
    changes_.clear();
    for (const std::uint32_t cluster : changed)
        changes_.set(lights_, cluster, sums.without_sharp(cluster));
    const BlockScene scene = block_scene();
    const std::size_t num_tiles = transfer_.counts.num_tiles();
    is_updated_ = true;
    dimmed_.assign(num_tiles, 0);
    std::atomic<std::size_t> num_blocks = 0;
    files::parallel_for(std::size_t{0}, num_tiles, [&](std::size_t tile) {
        std::uint64_t touched = update_tile(scene, tile, changes_, light_);
        if (sharp_changed || transfer_.glossy)
            touched = transfer_.counts.tile_blocks(tile);
        for_blocks(transfer_.counts, tile, touched, [&](std::size_t block, std::uint64_t bit) {
            light_glossy(block);
            if (light_[block].brightness.has_dimmed_to(write_radiance(block)))
                dimmed_[tile] |= bit;
        });
        num_blocks += static_cast<std::size_t>(std::popcount(touched));
    });
    const auto any = [](std::uint64_t blocks) {
        return blocks != 0;
    };
    if (std::any_of(dimmed_.begin(), dimmed_.end(), any)) {
        lights_.sum_prefix();
        files::parallel_for(std::size_t{0}, num_tiles, [&](std::size_t tile) {
            if (dimmed_[tile] == 0)
                return;
            light_tile(scene, tile, lights_, light_, dimmed_[tile]);
            for_blocks(transfer_.counts, tile, dimmed_[tile],
                       [&](std::size_t block, std::uint64_t) {
                           light_[block].brightness.set_summed(write_radiance(block));
                       });
        });
    }
    write_points();
    return std::min(num_blocks * prt::BlockSize, radiance_.size());
}

glm::dvec3 ReceiverLight::mean_from_cluster(std::size_t cluster) const {
    return harmonics_->mean_from_cluster(cluster);
}

void ReceiverLight::light_glossy(std::size_t block) {
    if (!pyramid_)
        return;
    for (std::size_t lobe = 0; lobe < prt::NumGlossyLobes; ++lobe)
        if (transfer_.glossy->lobes[lobe].num_entries() != 0)
            light_block(transfer_.glossy->lobes[lobe], block, pyramid_->light(),
                        glossy_[block][lobe]);
}

/// Returns the light of a receiver with a surface through each lobe. `diffuse` is its radiance for
/// albedo 1.
prt::Lobes<glm::vec3> ReceiverLight::lobes_at(std::size_t place, const glm::vec3& diffuse,
                                              bool with_sharp_lights) const {
    prt::Lobes<glm::vec3> lobes =
        with_sharp_lights ? traced_.highlights(place) : prt::Lobes<glm::vec3>();
    lobes.diffuse = diffuse;
    if (!glossy_.empty()) {
        const GlossyLight& light = glossy_[place / prt::BlockSize];
        for (std::size_t lobe = 0; lobe < prt::NumGlossyLobes; ++lobe)
            lobes.*prt::GlossyParts<glm::vec3>[lobe] += light[lobe].of(place % prt::BlockSize);
    }
    return lobes;
}

double ReceiverLight::write_radiance(std::size_t block) {
    return write_radiance(block, true, radiance_, diffuse_);
}

double ReceiverLight::write_radiance(std::size_t block, bool with_sharp_lights,
                                     std::span<glm::vec3> radiance,
                                     std::span<glm::vec3> diffuse) const {
    BlockRadiance sums;
    const double brightness = block_radiance(
        normals_[block], light_[block], with_sharp_lights ? traced_.diffuse(block) : nullptr, sums);
    const std::size_t begin = block * prt::BlockSize;
    const auto receivers = std::span(transfer_.order)
                               .subspan(begin, std::min(prt::BlockSize, radiance.size() - begin));
    if (!diffuse.empty())
        for (std::size_t i = 0; i < receivers.size(); ++i)
            diffuse[receivers[i]] = sums.of(i);
    if (transfer_.surfaces.empty())
        for (std::size_t i = 0; i < receivers.size(); ++i)
            radiance[receivers[i]] = sums.of(i);
    else
        for (std::size_t i = 0; i < receivers.size(); ++i)
            radiance[receivers[i]] = prt::reflect(
                transfer_.surfaces[begin + i], lobes_at(begin + i, sums.of(i), with_sharp_lights),
                eye_cosines_.empty() ? prt::EyeCosines() : eye_cosines_[begin + i]);
    return brightness;
}

std::vector<glm::vec3> ReceiverLight::soft_radiance() const {
    std::vector<glm::vec3> radiance(radiance_.size());
    files::parallel_for(std::size_t{0}, light_.size(),
                        [&](std::size_t block) { write_radiance(block, false, radiance, {}); });
    write_means(false, radiance);
    return radiance;
}

std::vector<prt::Lobes<glm::vec3>> ReceiverLight::lobes(bool with_sharp_lights) const {
    std::vector<prt::Lobes<glm::vec3>> lobes(radiance_.size());
    files::parallel_for(std::size_t{0}, light_.size(), [&](std::size_t block) {
        BlockRadiance sums;
        static_cast<void>(block_radiance(normals_[block], light_[block],
                                         with_sharp_lights ? traced_.diffuse(block) : nullptr,
                                         sums));
        const std::size_t begin = block * prt::BlockSize;
        for (std::size_t i = 0; i < std::min(prt::BlockSize, lobes.size() - begin); ++i)
            lobes[transfer_.order[begin + i]] = lobes_at(begin + i, sums.of(i), with_sharp_lights);
    });
    return lobes;
}

} // namespace relumine::relight
