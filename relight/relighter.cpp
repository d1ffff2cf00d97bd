// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN],
// Section 5.
#include "relight/relighter.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "relight/kernels/block_kernels.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/kernels/glossy_kernels.h"
#include "relight/light_pyramid.h"
#include "relight/sharp/light_packets.h"
#include "relight/sharp/traced_light.h"

namespace relumine::relight {

namespace {

/// Tolerance for the length of a light's direction, as in files of lights.
constexpr double UnitTolerance = 1e-3;

/// Whether summing all clusters is less work than updating the changed ones, which ascend. An
/// update looks at each word of 64 clusters that holds a changed one, and at each changed cluster.
/// The weights are relative to the time of the full sum, and measured: `./dev bench frames`.
bool is_cheaper_to_sum_all(std::span<const std::uint32_t> changed, std::size_t num_clusters) {
    constexpr double CostOfWords = 0.2, CostOfClusters = 4.8;
    constexpr std::size_t ClustersPerWord = 64;
    std::size_t num_words = 0;
    for (std::size_t i = 0; i < changed.size(); ++i)
        if (i == 0 || changed[i] / ClustersPerWord != changed[i - 1] / ClustersPerWord)
            ++num_words;
    const double all_words = std::ceil(static_cast<double>(num_clusters) / ClustersPerWord);
    return CostOfWords * static_cast<double>(num_words) / all_words +
               CostOfClusters * static_cast<double>(changed.size()) /
                   static_cast<double>(num_clusters) >
           1.0;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Returns the sum of all squares, over channels and axes.
double squared_norm(const VectorIrradiance& sum) {
    return glm::dot(sum.red, sum.red) + glm::dot(sum.green, sum.green) +
           glm::dot(sum.blue, sum.blue);
}

/// Whether a cluster's light changed by more than `bound` of its new light.
bool differs(const VectorIrradiance& before, const VectorIrradiance& after, double bound) {
    if (bound == 0.0)
        return before != after;
    VectorIrradiance difference = after;
    difference -= before;
    return squared_norm(difference) > bound * bound * squared_norm(after);
}

void sort_unique(std::vector<std::uint32_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

} // namespace

/// The parts of a Relighter.
class Relighter::Impl {
public:
    Impl(const prt::Transfer& transfer, const ShadowRays& rays);

    RelightTimes set_environment(cubemap::CubeMap environment);
    UpdateReport set_frame(BinnedEnvironment frame, double bound);
    RelightTimes set_lights(std::span<const lights::DistantLight> lights);
    UpdateReport update_region(const TexelRectangle& rectangle,
                               std::span<const glm::vec3> radiance);
    UpdateReport update_regions(std::span<const TexelRectangle> rectangles,
                                const std::function<void(cubemap::CubeMap&)>& edit);
    void resum();
    void set_bounces(SurfaceBounces bounces);
    [[nodiscard]] const SurfaceBounces& bounces() const { return bounces_; }
    BounceReport bounce(std::span<const glm::vec3> more);
    BounceReport step();
    [[nodiscard]] std::span<const glm::vec3> bounced() const { return bounced_; }
    [[nodiscard]] bool is_settled() const { return !bounce_light_ || is_settled_; }

    [[nodiscard]] std::span<const glm::vec3> radiance() const {
        return bounced_.empty() ? radiance_ : total_;
    }
    [[nodiscard]] std::vector<glm::vec3> soft_radiance() const;
    [[nodiscard]] std::span<const glm::vec3> diffuse_radiance() const {
        return diffuse_.empty() ? radiance_ : diffuse_;
    }
    [[nodiscard]] const cubemap::CubeMap& environment() const { return *environment_; }
    [[nodiscard]] const prt::Transfer& transfer() const { return transfer_; }
    [[nodiscard]] glm::dvec3 from_cluster(std::size_t place, std::size_t cluster) const;
    [[nodiscard]] std::span<const SharpLight> sharp_lights() const { return sharp_lights_; }
    [[nodiscard]] const ShadowRays& shadow_rays() const { return rays_; }

private:
    void check(const TexelRectangle& rectangle) const;
    [[nodiscard]] VectorIrradiance light_of(std::size_t cluster) const;
    void take(BinnedEnvironment binned);
    /// Holds a map that others may hold, too.
    void hold(std::shared_ptr<const cubemap::CubeMap> map);
    /// Holds a map that nobody else does.
    void hold_own(std::shared_ptr<cubemap::CubeMap> map);
    std::optional<std::size_t> replace_sharp_lights(std::vector<SharpLight> lights);
    std::size_t update_changed(bool sharp_changed);
    void set_pyramid();
    void light_glossy(std::size_t block);
    void take_bounces();
    void forget_bounces();
    void finish_change();
    /// Returns the block's brightness.
    double write_radiance(std::size_t block);
    /// Of radiance for albedo 1 in `diffuse`, too, unless that is empty.
    double write_radiance(std::size_t block, bool with_sharp_lights, std::span<glm::vec3> radiance,
                          std::span<glm::vec3> diffuse) const;
    [[nodiscard]] glm::vec3 through_surface(std::size_t place, const glm::vec3& diffuse,
                                            bool with_sharp_lights) const;

    const prt::Transfer& transfer_;
    ShadowRays rays_;
    /// [num_clusters] all light of each cluster.
    std::vector<VectorIrradiance> sums_;
    /// [num_clusters] power of each cluster: the length of its luminance vector.
    std::vector<double> powers_;
    std::vector<SharpLight> sharp_lights_;
    /// The light of sharp_lights_.
    TracedLight traced_;
    /// Set where the transfer has a glossy part.
    std::optional<LightPyramid> pyramid_;
    /// [num_blocks]; empty without a glossy part.
    std::vector<GlossyLight> glossy_;
    /// [num_blocks]
    std::vector<BlockNormals> normals_;
    /// From tile_words().
    TileWords words_;
    /// [num_blocks]
    std::vector<BlockLight> light_;
    ClusterLights lights_;
    EnvironmentBinner binner_;
    /// For environment_.
    std::shared_ptr<const LightBinning> binning_;
    std::shared_ptr<const cubemap::CubeMap> environment_ =
        std::make_shared<const cubemap::CubeMap>();
    /// environment_ for updates; null where others may hold it, too.
    std::shared_ptr<cubemap::CubeMap> own_environment_;
    std::vector<glm::vec3> radiance_;
    /// For albedo 1; empty without surfaces.
    std::vector<glm::vec3> diffuse_;
    SurfaceBounces bounces_;
    std::optional<BounceLight> bounce_light_;
    /// Whether bounced_ is for the present light.
    bool is_settled_ = false;
    /// [num_receivers] from other surfaces, and with it; empty without bounces.
    std::vector<glm::vec3> bounced_;
    std::vector<glm::vec3> total_;
    /// Scratch: clusters whose light changes, and how.
    std::vector<std::uint32_t> changed_;
    LightChanges changes_;
    /// Scratch, [num_tiles]: blocks that are summed anew after a change.
    std::vector<std::uint64_t> dimmed_;
};

Relighter::Impl::Impl(const prt::Transfer& transfer, const ShadowRays& rays)
    : transfer_(transfer), rays_(rays), sums_(transfer.num_clusters()),
      powers_(transfer.num_clusters()), traced_(transfer, rays),
      normals_(block_normals(transfer.normals)), words_(tile_words(transfer, normals_)),
      light_(transfer.counts.num_blocks()), lights_(transfer.num_clusters()),
      binner_(transfer, rays.blockers != nullptr ? rays.tolerance : 0.0f),
      radiance_(transfer.num_receivers()), diffuse_(transfer.surfaces.size()) {
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
    }
}

RelightTimes Relighter::Impl::set_environment(cubemap::CubeMap environment) {
    const auto own = std::make_shared<cubemap::CubeMap>(std::move(environment));
    BinnedEnvironment binned = binner_.bin(own);
    forget_bounces();
    RelightTimes times{.seconds_bin = binned.seconds_bin, .seconds_trace = binned.seconds_sharp};
    auto start = std::chrono::steady_clock::now();
    take(std::move(binned));
    hold_own(own);
    static_cast<void>(traced_.trace(sharp_lights_));
    times.num_sharp_lights = sharp_lights_.size();
    times.seconds_trace += seconds_since(start);

    start = std::chrono::steady_clock::now();
    set_pyramid();
    times.seconds_bin += seconds_since(start);
    start = std::chrono::steady_clock::now();
    resum();
    times.seconds_relight = seconds_since(start);
    return times;
}

/// Takes everything of an environment and drops the one before.
void Relighter::Impl::take(BinnedEnvironment binned) {
    hold(std::move(binned.map));
    binning_ = std::move(binned.binning);
    sums_ = std::move(binned.sums);
    powers_ = std::move(binned.powers);
    sharp_lights_ = std::move(binned.sharp_lights);
}

void Relighter::Impl::hold(std::shared_ptr<const cubemap::CubeMap> map) {
    environment_ = std::move(map);
    own_environment_.reset();
}

void Relighter::Impl::hold_own(std::shared_ptr<cubemap::CubeMap> map) {
    own_environment_ = std::move(map);
    environment_ = own_environment_;
}

UpdateReport Relighter::Impl::set_frame(BinnedEnvironment frame, double bound) {
    const auto start = std::chrono::steady_clock::now();
    if (frame.sums.size() != sums_.size() || frame.powers.size() != sums_.size() ||
        !frame.binning || !frame.map)
        throw std::invalid_argument("expected an environment binned for this scene");
    if (!(bound >= 0.0))
        throw std::invalid_argument("expected a bound >= 0");
    forget_bounces();
    UpdateReport report;
    const bool is_first = environment_->resolution == 0;
    changed_.clear();
    for (std::uint32_t cluster = 0; cluster < sums_.size(); ++cluster)
        if (is_first || differs(sums_[cluster], frame.sums[cluster], bound))
            changed_.push_back(cluster);

    const auto trace_start = std::chrono::steady_clock::now();
    const std::optional<std::size_t> traced = replace_sharp_lights(std::move(frame.sharp_lights));
    report.seconds_trace = seconds_since(trace_start);
    report.num_sharp_lights = traced.value_or(0);
    report.num_clusters = changed_.size();

    for (const std::uint32_t cluster : changed_) {
        sums_[cluster] = frame.sums[cluster];
        powers_[cluster] = frame.powers[cluster];
    }
    hold(std::move(frame.map));
    binning_ = std::move(frame.binning);
    set_pyramid();
    if (is_first || is_cheaper_to_sum_all(changed_, sums_.size())) {
        resum();
        report.resummed = true;
        report.num_receivers = radiance_.size();
    } else {
        report.num_receivers = update_changed(traced.has_value());
    }
    report.seconds = seconds_since(start);
    return report;
}

RelightTimes Relighter::Impl::set_lights(std::span<const lights::DistantLight> lights) {
    for (const lights::DistantLight& light : lights) {
        const glm::vec3 irradiance(light.irradiance);
        require_radiance({&irradiance, 1});
        if (!(std::abs(glm::length(light.direction) - 1.0) < UnitTolerance))
            throw std::invalid_argument("expected directions of unit length");
    }
    forget_bounces();
    RelightTimes times;
    auto start = std::chrono::steady_clock::now();
    hold(std::make_shared<const cubemap::CubeMap>());
    sharp_lights_.clear();
    std::fill(sums_.begin(), sums_.end(), VectorIrradiance());
    for (const lights::DistantLight& light : lights) {
        const cubemap::FacePoint point = cubemap::face_point(light.direction);
        const std::uint32_t cluster = transfer_.quadtree.leaf_at(point);
        const VectorIrradiance irradiance = vector_irradiance(light);
        sums_[cluster] += irradiance;
        if (rays_.blockers != nullptr)
            sharp_lights_.push_back({.cluster = cluster,
                                     .cell = transfer_.quadtree.leaves()[cluster],
                                     .direction = light.direction,
                                     .irradiance = irradiance});
    }
    std::stable_sort(
        sharp_lights_.begin(), sharp_lights_.end(),
        [](const SharpLight& a, const SharpLight& b) { return a.cluster < b.cluster; });
    std::transform(sums_.begin(), sums_.end(), powers_.begin(),
                   std::mem_fn(&VectorIrradiance::power));
    if (pyramid_)
        pyramid_->set_lights(rays_.blockers == nullptr ? lights
                                                       : std::span<const lights::DistantLight>());
    times.seconds_bin = seconds_since(start);

    start = std::chrono::steady_clock::now();
    static_cast<void>(traced_.trace(sharp_lights_));
    times.num_sharp_lights = sharp_lights_.size();
    times.seconds_trace = seconds_since(start);

    start = std::chrono::steady_clock::now();
    resum();
    times.seconds_relight = seconds_since(start);
    return times;
}

void Relighter::Impl::resum() {
    files::parallel_for(files::IndexRange<std::size_t>(0, lights_.spread.size()),
                        [&](const auto& words) {
                            const std::size_t end = std::min(words.end() * 64, sums_.size());
                            for (std::size_t cluster = words.begin() * 64; cluster < end; ++cluster)
                                lights_.set(cluster, light_of(cluster));
                        });
    lights_.sum_prefix();
    const BlockScene scene{.counts = transfer_.counts, .words = words_, .normals = normals_};
    files::parallel_for(std::size_t{0}, transfer_.counts.num_tiles(), [&](std::size_t tile) {
        light_tile(scene, tile, lights_, light_);
        for (std::size_t block = transfer_.counts.tile_begin(tile);
             block < transfer_.counts.tile_begin(tile + 1); ++block) {
            light_glossy(block);
            light_[block].set_summed(write_radiance(block));
        }
    });
    finish_change();
}

void Relighter::Impl::set_bounces(SurfaceBounces bounces) {
    if (bounces.matrix == nullptr) {
        bounce_light_.reset();
    } else if (bounce_light_ && bounces_.matrix == bounces.matrix) {
        bounce_light_->set_albedo(bounces.albedo);
    } else {
        BounceLight made(*bounces.matrix, transfer_);
        made.set_albedo(bounces.albedo);
        bounce_light_ = std::move(made);
    }
    bounces_ = std::move(bounces);
    forget_bounces();
}

BounceReport Relighter::Impl::bounce(std::span<const glm::vec3> more) {
    if (!bounce_light_)
        throw std::logic_error("expected bounces to be set before light bounces");
    const std::span<const glm::vec3> own = diffuse_radiance();
    std::vector<glm::vec3> sum;
    if (!more.empty()) {
        if (more.size() != own.size())
            throw std::invalid_argument(
                fmt::format("expected the light of {} receivers, got {}", own.size(), more.size()));
        sum.assign(more.begin(), more.end());
        std::transform(own.begin(), own.end(), sum.begin(), sum.begin(), std::plus<>());
    }
    const BounceReport report = bounce_light_->solve(more.empty() ? own : sum, bounces_.limits);
    is_settled_ = true;
    take_bounces();
    return report;
}

BounceReport Relighter::Impl::step() {
    // A number of bounces has no light to go on from.
    if (!bounce_light_ || bounces_.limits.num_bounces)
        return bounce({});
    const BounceReport report = bounce_light_->step(diffuse_radiance());
    constexpr double Visible = 1e-4;
    is_settled_ = report.error < Visible;
    take_bounces();
    return report;
}

/// Puts the bounces into the radiance.
void Relighter::Impl::take_bounces() {
    const std::span<const glm::vec3> indirect = bounce_light_->indirect();
    bounced_.assign(indirect.begin(), indirect.end());
    for (std::size_t place = 0; place < transfer_.surfaces.size(); ++place)
        bounced_[transfer_.order[place]] *= transfer_.surfaces[place].albedo;
    total_.resize(radiance_.size());
    std::transform(radiance_.begin(), radiance_.end(), bounced_.begin(), total_.begin(),
                   std::plus<>());
}

void Relighter::Impl::forget_bounces() {
    bounced_.clear();
    total_.clear();
    is_settled_ = false;
}

/// The direct light has changed; the bounces of the light before stay until the next.
void Relighter::Impl::finish_change() {
    is_settled_ = false;
    if (!bounced_.empty())
        std::transform(radiance_.begin(), radiance_.end(), bounced_.begin(), total_.begin(),
                       std::plus<>());
}

/// Returns the light of a cluster: all light of its cell minus the sharp lights in it.
VectorIrradiance Relighter::Impl::light_of(std::size_t cluster) const {
    VectorIrradiance rest = sums_[cluster];
    for (auto sharp = std::lower_bound(
             sharp_lights_.begin(), sharp_lights_.end(), cluster,
             [](const SharpLight&light, std::size_t c) { return light.cluster < c; });
         sharp != sharp_lights_.end() && sharp->cluster == cluster; ++sharp)
        rest -= sharp->irradiance;
    return rest;
}

void Relighter::Impl::check(const TexelRectangle& rectangle) const {
    const std::uint32_t r = environment_->resolution;
    if (r == 0)
        throw std::invalid_argument("expected an environment before its first update");
    if (rectangle.x0 >= rectangle.x1 || rectangle.y0 >= rectangle.y1 || rectangle.x1 > r ||
        rectangle.y1 > r)
        throw std::invalid_argument(
            fmt::format("expected a rectangle inside the {0} x {0} face", r));
}

UpdateReport Relighter::Impl::update_region(const TexelRectangle& rectangle,
                                            std::span<const glm::vec3> radiance) {
    check(rectangle);
    const std::size_t width = rectangle.x1 - rectangle.x0;
    if (radiance.size() != width * (rectangle.y1 - rectangle.y0))
        throw std::invalid_argument("expected one radiance per texel of the rectangle");
    require_radiance(radiance);

    return update_regions({&rectangle, 1}, [&](cubemap::CubeMap& environment) {
        for (std::uint32_t y = rectangle.y0; y < rectangle.y1; ++y)
            std::copy_n(radiance.data() + (y - rectangle.y0) * width, width,
                        &environment.at(rectangle.face, rectangle.x0, y));
    });
}

UpdateReport Relighter::Impl::update_regions(std::span<const TexelRectangle> rectangles,
                                             const std::function<void(cubemap::CubeMap&)>& edit) {
    const auto start = std::chrono::steady_clock::now();
    for (const TexelRectangle& rectangle : rectangles)
        check(rectangle);
    if (!own_environment_)
        hold_own(std::make_shared<cubemap::CubeMap>(*environment_));
    edit(*own_environment_);

    // The light of clusters under the rectangles is summed anew, not by differences. So nothing can
    // drift.
    changed_.clear();
    const auto r = static_cast<double>(environment_->resolution);
    for (const TexelRectangle& rectangle : rectangles)
        transfer_.quadtree.find_leaves({.face = rectangle.face,
                                        .s0 = rectangle.x0 / r,
                                        .t0 = rectangle.y0 / r,
                                        .s1 = rectangle.x1 / r,
                                        .t1 = rectangle.y1 / r},
                                       changed_);
    sort_unique(changed_);
    const std::size_t num_changed = changed_.size();
    files::parallel_for(std::size_t{0}, num_changed, [&](std::size_t i) {
        const std::uint32_t cluster = changed_[i];
        sums_[cluster] = binning_->sum(*environment_, transfer_.quadtree.leaves()[cluster]);
        powers_[cluster] = sums_[cluster].power();
    });
    // Which lights are sharp depends on the whole map.
    std::optional<std::size_t> traced;
    if (rays_.blockers != nullptr)
        traced = replace_sharp_lights(
            find_sharp_lights(*environment_, *binning_, transfer_.quadtree.leaves(), powers_,
                              rays_.tolerance, transfer_.glossy.has_value()));
    set_pyramid();
    const std::size_t num_receivers = update_changed(traced.has_value());
    return {.num_clusters = num_changed,
            .num_receivers = num_receivers,
            .num_sharp_lights = traced.value_or(0),
            .seconds = seconds_since(start)};
}

glm::dvec3 Relighter::Impl::from_cluster(std::size_t place, std::size_t cluster) const {
    const prt::VisibleCounts& counts = transfer_.counts;
    const double count = counts.count(place, cluster);
    if (count == 0.0)
        return glm::dvec3(0.0);
    const std::size_t block = place / prt::BlockSize, w = cluster / 64;
    const std::size_t tile = block / prt::VisibleCounts::TileBlocks;
    const std::uint64_t whole = counts.visible[counts.word(block, w)] &
                                ~words_.across_of(words_.words[tile * counts.words_per_block() + w],
                                                  block % prt::VisibleCounts::TileBlocks);
    const glm::vec3& normal = transfer_.normals[place];
    return count * ((whole >> (cluster % 64) & 1u) != 0 ? lights_.of_vectors(cluster, normal)
                                                        : lights_.of_directional(cluster, normal));
}

/// Updates the radiance for the clusters in `changed_`, which ascend and whose sums_ are new.
/// Returns the number of receivers that see any of them.
std::size_t Relighter::Impl::update_changed(bool sharp_changed) {
    changes_.clear();
    for (const std::uint32_t cluster : changed_)
        changes_.set(lights_, cluster, light_of(cluster));
    const BlockScene scene{.counts = transfer_.counts, .words = words_, .normals = normals_};
    const std::size_t num_tiles = transfer_.counts.num_tiles();
    // Calls visit(block, bit) for blocks of a tile, each one's number in the scene and its bit.
    const auto for_blocks = [&](std::size_t tile, std::uint64_t blocks, const auto& visit) {
        for (; blocks != 0; blocks &= blocks - 1) {
            const auto bit = static_cast<std::size_t>(std::countr_zero(blocks));
            visit(transfer_.counts.tile_begin(tile) + bit, std::uint64_t{1} << bit);
        }
    };
    dimmed_.assign(num_tiles, 0);
    std::atomic<std::size_t> num_blocks = 0;
    files::parallel_for(std::size_t{0}, num_tiles, [&](std::size_t tile) {
        std::uint64_t touched = update_tile(scene, tile, changes_, light_);
        if (sharp_changed || transfer_.glossy)
            touched = transfer_.counts.tile_blocks(tile);
        for_blocks(tile, touched, [&](std::size_t block, std::uint64_t bit) {
            light_glossy(block);
            if (light_[block].has_dimmed_to(write_radiance(block)))
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
            for_blocks(tile, dimmed_[tile], [&](std::size_t block, std::uint64_t) {
                light_[block].set_summed(write_radiance(block));
            });
        });
    }
    finish_change();
    return std::min(num_blocks * prt::BlockSize, radiance_.size());
}

/// Replaces the sharp lights where any came or went, and adds their clusters to `changed_`. Returns
/// how many directions were traced; nothing where all lights are as they were.
std::optional<std::size_t> Relighter::Impl::replace_sharp_lights(std::vector<SharpLight> lights) {
    if (lights == sharp_lights_)
        return std::nullopt;
    for (const std::vector<SharpLight>* set : {&lights, &sharp_lights_})
        for (const SharpLight& light : *set)
            changed_.push_back(light.cluster);
    sort_unique(changed_);
    sharp_lights_ = std::move(lights);
    return traced_.trace(sharp_lights_);
}

void Relighter::Impl::set_pyramid() {
    if (pyramid_)
        pyramid_->set(*environment_, *binning_, sharp_lights_);
}

void Relighter::Impl::light_glossy(std::size_t block) {
    if (!pyramid_)
        return;
    for (std::size_t lobe = 0; lobe < prt::NumGlossyLobes; ++lobe)
        light_block(transfer_.glossy->lobes[lobe], block, pyramid_->light(), glossy_[block][lobe]);
}

/// Returns the radiance that a receiver with a surface sends on. `diffuse` is its radiance for
/// albedo 1.
glm::vec3 Relighter::Impl::through_surface(std::size_t place, const glm::vec3& diffuse,
                                           bool with_sharp_lights) const {
    prt::Lobes<glm::vec3> lobes =
        with_sharp_lights ? traced_.highlights(place) : prt::Lobes<glm::vec3>();
    lobes.diffuse = diffuse;
    if (!glossy_.empty()) {
        const GlossyLight& light = glossy_[place / prt::BlockSize];
        const auto through = [&](prt::GlossyLobe lobe) {
            return light[static_cast<std::size_t>(lobe)].of(place % prt::BlockSize);
        };
        lobes.specular += through(prt::GlossyLobe::Specular);
        lobes.specular_grazing += through(prt::GlossyLobe::SpecularGrazing);
        lobes.diffuse_grazing += through(prt::GlossyLobe::DiffuseGrazing);
    }
    return prt::reflect(transfer_.surfaces[place], lobes);
}

double Relighter::Impl::write_radiance(std::size_t block) {
    return write_radiance(block, true, radiance_, diffuse_);
}

double Relighter::Impl::write_radiance(std::size_t block, bool with_sharp_lights,
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
            radiance[receivers[i]] = through_surface(begin + i, sums.of(i), with_sharp_lights);
    return brightness;
}

std::vector<glm::vec3> Relighter::Impl::soft_radiance() const {
    std::vector<glm::vec3> radiance(radiance_.size());
    files::parallel_for(std::size_t{0}, light_.size(),
                        [&](std::size_t block) { write_radiance(block, false, radiance, {}); });
    for (std::size_t i = 0; i < bounced_.size(); ++i)
        radiance[i] += bounced_[i];
    return radiance;
}

Relighter::Relighter(const prt::Transfer& transfer, const ShadowRays& rays)
    : impl_(std::make_unique<Impl>(transfer, rays)) {}
Relighter::~Relighter() = default;
Relighter::Relighter(Relighter&&) noexcept = default;
Relighter& Relighter::operator=(Relighter&&) noexcept = default;

RelightTimes Relighter::set_environment(cubemap::CubeMap environment) {
    return impl_->set_environment(std::move(environment));
}

UpdateReport Relighter::set_frame(BinnedEnvironment frame, double bound) {
    return impl_->set_frame(std::move(frame), bound);
}

RelightTimes Relighter::set_lights(std::span<const lights::DistantLight> lights) {
    return impl_->set_lights(lights);
}

UpdateReport Relighter::update_region(const TexelRectangle& rectangle,
                                      std::span<const glm::vec3> radiance) {
    return impl_->update_region(rectangle, radiance);
}

UpdateReport Relighter::update_regions(std::span<const TexelRectangle> rectangles,
                                       const std::function<void(cubemap::CubeMap&)>& edit) {
    return impl_->update_regions(rectangles, edit);
}

void Relighter::resum() {
    impl_->resum();
}

void Relighter::set_bounces(SurfaceBounces bounces) {
    impl_->set_bounces(std::move(bounces));
}
const SurfaceBounces& Relighter::bounces() const {
    return impl_->bounces();
}
BounceReport Relighter::bounce(std::span<const glm::vec3> more) {
    return impl_->bounce(more);
}
BounceReport Relighter::step() {
    return impl_->step();
}
std::span<const glm::vec3> Relighter::bounced() const {
    return impl_->bounced();
}
bool Relighter::is_settled() const {
    return impl_->is_settled();
}

std::span<const glm::vec3> Relighter::radiance() const {
    return impl_->radiance();
}
std::vector<glm::vec3> Relighter::soft_radiance() const {
    return impl_->soft_radiance();
}
std::span<const glm::vec3> Relighter::diffuse_radiance() const {
    return impl_->diffuse_radiance();
}
const cubemap::CubeMap& Relighter::environment() const {
    return impl_->environment();
}
const prt::Transfer& Relighter::transfer() const {
    return impl_->transfer();
}
glm::dvec3 Relighter::from_cluster(std::size_t place, std::size_t cluster) const {
    return impl_->from_cluster(place, cluster);
}
std::span<const SharpLight> Relighter::sharp_lights() const {
    return impl_->sharp_lights();
}
const ShadowRays& Relighter::shadow_rays() const {
    return impl_->shadow_rays();
}

std::span<const SharpLight> picture_lights(const Relighter& relighter) {
    constexpr std::size_t Most = 64;
    const bool is_traced =
        relighter.shadow_rays().blockers != nullptr &&
        (relighter.environment().resolution == 0 || relighter.sharp_lights().size() <= Most);
    return is_traced ? relighter.sharp_lights() : std::span<const SharpLight>();
}

std::vector<glm::vec3> relight(const prt::Transfer& transfer, const cubemap::CubeMap& environment,
                               const ShadowRays& rays) {
    Relighter relighter(transfer, rays);
    relighter.set_environment(environment);
    return {relighter.radiance().begin(), relighter.radiance().end()};
}

} // namespace relumine::relight
