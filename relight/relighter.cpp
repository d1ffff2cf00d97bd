// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN],
// Section 5.
#include "relight/relighter.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "files/seconds.h"
#include "prt/moves/scene_change.h"
#include "relight/harmonics/harmonics.h"
#include "relight/receiver_light.h"
#include "relight/sharp/light_packets.h"

namespace relumine::relight {

namespace {

/// Tolerance for the length of a light's direction, as in files of lights.
constexpr double UnitTolerance = 1e-3;

/// Whether summing all clusters is less work than updating the changed ones, which ascend. An
/// update looks at each word of 64 clusters that holds a changed one, and at each changed cluster.
/// The weights are relative to the time of the full sum, and measured: `./dev bench frames`.
bool is_cheaper_to_sum_all(std::span<const std::uint32_t> changed, std::size_t num_clusters) {
    constexpr double CostOfWords = 0.3, CostOfClusters = 4.2;
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

void sort_unique(std::vector<std::uint32_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Refuses a rectangle outside a face of the map.
void require_inside(const TexelRectangle& rectangle, const cubemap::CubeMap& map) {
    const std::uint32_t r = map.resolution;
    if (r == 0)
        throw std::invalid_argument("expected an environment before its first update");
    if (static_cast<std::size_t>(rectangle.face) >= cubemap::NumFaces)
        throw std::invalid_argument(fmt::format("expected one of {} faces, got number {}",
                                                cubemap::NumFaces,
                                                static_cast<std::size_t>(rectangle.face)));
    if (rectangle.x0 >= rectangle.x1 || rectangle.y0 >= rectangle.y1 || rectangle.x1 > r ||
        rectangle.y1 > r)
        throw std::invalid_argument(
            fmt::format("expected a rectangle inside the {0} x {0} face", r));
}

} // namespace

Relighter::Relighter(const prt::Transfer& transfer, const ShadowRays& rays, std::uint32_t harmonics)
    : transfer_(transfer), rays_(rays), sums_(transfer.num_clusters()),
      powers_(transfer.num_clusters()),
      binner_(transfer, rays.blockers != nullptr ? rays.tolerance : 0.0f),
      light_(std::make_unique<ReceiverLight>(transfer, rays, harmonics)) {}
Relighter::~Relighter() = default;
Relighter::Relighter(Relighter&&) noexcept = default;

UpdateReport Relighter::set_environment(cubemap::CubeMap environment) {
    auto own = std::make_shared<cubemap::CubeMap>(std::move(environment));
    BinnedEnvironment binned = binner_.bin(own);
    return light_by(std::move(binned), std::move(own));
}

UpdateReport Relighter::set_environment(std::shared_ptr<const cubemap::CubeMap> environment) {
    return light_by(binner_.bin(std::move(environment)), nullptr);
}

/// `own`: the map, if nobody else holds it.
UpdateReport Relighter::light_by(BinnedEnvironment binned, std::shared_ptr<cubemap::CubeMap> own) {
    UpdateReport report{.seconds_bin = binned.seconds_bin, .seconds_trace = binned.seconds_sharp};
    auto start = std::chrono::steady_clock::now();
    environment_ = std::move(binned.map);
    own_environment_ = std::move(own);
    binning_ = std::move(binned.binning);
    sums_ = std::move(binned.sums);
    powers_ = std::move(binned.powers);
    sharp_lights_ = std::move(binned.sharp_lights);
    static_cast<void>(light_->trace(sharp_lights_));
    report.seconds_trace += files::seconds_since(start);

    start = std::chrono::steady_clock::now();
    set_cells();
    report.seconds_bin += files::seconds_since(start);
    sum_all(report);
    return report;
}

cubemap::CubeMap Relighter::lend_environment() {
    // environment_ and own_environment_
    if (!own_environment_ || own_environment_.use_count() > 2)
        return {};
    return std::exchange(*own_environment_, {});
}

void Relighter::return_environment(cubemap::CubeMap environment) {
    hold_own(std::make_shared<cubemap::CubeMap>(std::move(environment)));
}

/// Ends the report of light that is wholly new.
void Relighter::sum_all(UpdateReport& report) {
    const auto start = std::chrono::steady_clock::now();
    resum();
    report.seconds_relight = files::seconds_since(start);
    report.seconds = report.seconds_bin + report.seconds_trace + report.seconds_relight;
    report.num_clusters = sums_.size();
    report.num_receivers = radiance().size();
    report.num_sharp_lights = sharp_lights_.size();
    report.resummed = true;
}

/// Holds a map that nobody else does.
void Relighter::hold_own(std::shared_ptr<cubemap::CubeMap> map) {
    own_environment_ = std::move(map);
    environment_ = own_environment_;
}

UpdateReport Relighter::set_frame(BinnedEnvironment frame) {
    const auto start = std::chrono::steady_clock::now();
    if (frame.sums.size() != sums_.size() || frame.powers.size() != sums_.size() ||
        !frame.binning || !frame.map)
        throw std::invalid_argument("expected an environment binned for this scene");
    UpdateReport report;
    const bool is_first = environment_->resolution == 0;
    changed_.clear();
    for (std::uint32_t cluster = 0; cluster < sums_.size(); ++cluster)
        if (is_first || sums_[cluster] != frame.sums[cluster])
            changed_.push_back(cluster);

    const auto trace_start = std::chrono::steady_clock::now();
    const std::optional<std::size_t> traced = replace_sharp_lights(std::move(frame.sharp_lights));
    report.seconds_trace = files::seconds_since(trace_start);
    report.num_sharp_lights = traced.value_or(0);
    report.num_clusters = changed_.size();

    for (const std::uint32_t cluster : changed_) {
        sums_[cluster] = frame.sums[cluster];
        powers_[cluster] = frame.powers[cluster];
    }
    environment_ = std::move(frame.map);
    own_environment_.reset();
    binning_ = std::move(frame.binning);
    set_cells();
    if (is_first || is_cheaper_to_sum_all(changed_, sums_.size())) {
        resum();
        report.resummed = true;
        report.num_receivers = radiance().size();
    } else {
        report.num_receivers =
            light_->update({.all = sums_, .sharp = sharp_lights_}, changed_, traced.has_value());
    }
    report.seconds = files::seconds_since(start);
    return report;
}

UpdateReport Relighter::set_lights(std::span<const lights::DistantLight> lights) {
    for (const lights::DistantLight& light : lights) {
        const glm::vec3 irradiance(light.irradiance);
        require_radiance({&irradiance, 1});
        if (!(std::abs(glm::length(light.direction) - 1.0) < UnitTolerance))
            throw std::invalid_argument("expected directions of unit length");
    }
    UpdateReport report;
    auto start = std::chrono::steady_clock::now();
    hold_own(std::make_shared<cubemap::CubeMap>());
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
                                     .irradiance = irradiance,
                                     .is_of_list = true});
    }
    std::stable_sort(
        sharp_lights_.begin(), sharp_lights_.end(),
        [](const SharpLight& a, const SharpLight& b) { return a.cluster < b.cluster; });
    std::transform(sums_.begin(), sums_.end(), powers_.begin(),
                   std::mem_fn(&VectorIrradiance::power));
    if (LightPyramid* pyramid = light_->pyramid())
        pyramid->set_lights(rays_.blockers == nullptr ? lights
                                                      : std::span<const lights::DistantLight>());
    report.seconds_bin = files::seconds_since(start);

    start = std::chrono::steady_clock::now();
    static_cast<void>(light_->trace(sharp_lights_));
    report.seconds_trace = files::seconds_since(start);
    sum_all(report);
    return report;
}

UpdateReport Relighter::update_regions(std::span<const TexelRectangle> rectangles,
                                       const std::function<void(cubemap::CubeMap&)>& edit) {
    const auto start = std::chrono::steady_clock::now();
    for (const TexelRectangle& rectangle : rectangles)
        require_inside(rectangle, *environment_);
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
            find_sharp_lights(*environment_, *binning_, transfer_, powers_, rays_.tolerance));
    set_cells();
    const std::size_t num_receivers =
        light_->update({.all = sums_, .sharp = sharp_lights_}, changed_, traced.has_value());
    return {.num_clusters = num_changed,
            .num_receivers = num_receivers,
            .num_sharp_lights = traced.value_or(0),
            .seconds = files::seconds_since(start)};
}

/// Replaces the sharp lights where any came or went, and adds their clusters to `changed_`. Returns
/// how many directions were traced; nothing where all lights are as they were.
std::optional<std::size_t> Relighter::replace_sharp_lights(std::vector<SharpLight> lights) {
    if (lights == sharp_lights_)
        return std::nullopt;
    for (const std::vector<SharpLight>* set : {&lights, &sharp_lights_})
        for (const SharpLight& light : *set)
            changed_.push_back(light.cluster);
    sort_unique(changed_);
    sharp_lights_ = std::move(lights);
    return light_->trace(sharp_lights_);
}

void Relighter::set_cells() {
    if (LightPyramid* pyramid = light_->pyramid())
        pyramid->set(*environment_, *binning_, sharp_lights_);
}

void Relighter::follow(const prt::SceneChange& change) {
    light_->follow({.all = sums_, .sharp = sharp_lights_}, change);
}

void Relighter::resum() {
    light_->sum({.all = sums_, .sharp = sharp_lights_});
}

std::span<const glm::vec3> Relighter::radiance() const {
    return light_->radiance();
}
std::vector<glm::vec3> Relighter::harmonics() const {
    std::vector<glm::vec3> result = light_->harmonics(true);
    bind_to(transfer_, diffuse_radiance(), result);
    return result;
}
std::span<const glm::vec3> Relighter::diffuse_radiance() const {
    return light_->diffuse_radiance();
}
VectorIrradiance Relighter::cluster_light(std::size_t cluster) const {
    return ClusterSums{.all = sums_, .sharp = sharp_lights_}.without_sharp(cluster);
}
glm::dvec3 Relighter::open_radiance(const glm::vec3& normal) const {
    glm::dvec3 sum(0.0);
    std::vector<VectorIrradiance> soft = sums_;
    for (const SharpLight& light : sharp_lights_) {
        soft[light.cluster] -= light.irradiance;
        sum += light.irradiance.on(normal);
    }
    for (const VectorIrradiance& cluster : soft)
        sum += cluster.on(normal);
    return sum / std::numbers::pi;
}

void require_texels(const TexelRectangle& rectangle, std::span<const glm::vec3> radiance,
                    const cubemap::CubeMap& map) {
    require_inside(rectangle, map);
    const std::size_t width = rectangle.x1 - rectangle.x0;
    if (radiance.size() != width * (rectangle.y1 - rectangle.y0))
        throw std::invalid_argument("expected one radiance per texel of the rectangle");
    require_radiance(radiance);
}

void bind_to(const prt::Transfer& transfer, std::span<const glm::vec3> radiance,
             std::span<glm::vec3> harmonics) {
    const std::size_t count = harmonics.size() / radiance.size();
    constexpr std::size_t Grain = 256;
    files::parallel_for(files::IndexRange<std::size_t>(transfer.num_points, radiance.size(), Grain),
                        [&](const auto& range) {
                            for (std::size_t place = range.begin(); place < range.end(); ++place) {
                                const std::size_t receiver = transfer.order[place];
                                bind_irradiance(harmonics.subspan(receiver * count, count),
                                                transfer.normals[place],
                                                glm::dvec3(radiance[receiver]) * std::numbers::pi);
                            }
                        });
}

void put_texels(const TexelRectangle& rectangle, std::span<const glm::vec3> radiance,
                cubemap::CubeMap& map) {
    const std::size_t width = rectangle.x1 - rectangle.x0;
    for (std::uint32_t y = rectangle.y0; y < rectangle.y1; ++y)
        std::copy_n(radiance.data() + (y - rectangle.y0) * width, width,
                    &map.at(rectangle.face, rectangle.x0, y));
}

UpdateReport update_region(Relighter& relighter, const TexelRectangle& rectangle,
                           std::span<const glm::vec3> radiance) {
    require_texels(rectangle, radiance, relighter.environment());
    return relighter.update_regions({&rectangle, 1}, [&](cubemap::CubeMap& environment) {
        put_texels(rectangle, radiance, environment);
    });
}

std::vector<SharpLight> picture_lights(const Relighter& relighter) {
    constexpr std::size_t Most = 64;
    const std::span<const SharpLight> lights = relighter.sharp_lights();
    if (relighter.shadow_rays().blockers == nullptr)
        return {};
    return merged(lights, relighter.environment().resolution == 0 ? lights.size() : Most);
}

EnvironmentBinner binner_of(const Relighter& relighter) {
    const ShadowRays& rays = relighter.shadow_rays();
    return {relighter.transfer(), rays.blockers != nullptr ? rays.tolerance : 0.0f};
}

std::vector<glm::vec3> relight(const prt::Transfer& transfer, const cubemap::CubeMap& environment,
                               const ShadowRays& rays) {
    Relighter relighter(transfer, rays);
    relighter.set_environment(environment);
    return {relighter.radiance().begin(), relighter.radiance().end()};
}

} // namespace relumine::relight
