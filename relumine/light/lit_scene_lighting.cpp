// How LitScene sums the parts of its light, and what it tells of it.
#include <chrono>
#include <memory>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "prt/clusters/dealt_tiles.h"
#include "relight/harmonics/harmonics.h"
#include "relight/receiver_light.h"
#include "relight/sharp/light_packets.h"
#include "relumine/light/gathered.h"
#include "relumine/light/layer_compositor.h"
#include "relumine/light/lit_scene.h"

namespace relumine {

namespace {

void add(std::span<const glm::vec3> values, std::span<glm::vec3> sum) {
    std::transform(sum.begin(), sum.end(), values.begin(), sum.begin(), std::plus<>());
}

std::vector<glm::vec3> copy_of(std::span<const glm::vec3> values) {
    return {values.begin(), values.end()};
}

} // namespace

/// Values of this process's receivers become those of all, in every process.
std::vector<glm::vec3> LitScene::of_all(std::span<const glm::vec3> own) const {
    if (!team_->has_others())
        return copy_of(own);
    const std::vector<std::uint32_t>& order = scene_->transfer.order;
    const std::vector<std::uint32_t> places = prt::places_of(team_->part(), order.size());
    std::vector<glm::vec3> by_place(order.size());
    for (std::size_t i = 0; i < places.size(); ++i)
        by_place[places[i]] = own[i];
    prt::share_by_place(*team_, std::span(by_place));
    std::vector<glm::vec3> result(order.size());
    for (std::size_t place = 0; place < order.size(); ++place)
        result[order[place]] = by_place[place];
    return result;
}

BounceReport LitScene::find_bounces(bool is_step) {
    std::span<const glm::vec3> direct = relighter_->diffuse_radiance();
    std::vector<glm::vec3> sum;
    if (!added_.diffuse.empty() || team_->has_others()) {
        sum = copy_of(direct);
        if (!added_.diffuse.empty())
            add(added_.diffuse, sum);
        if (team_->has_others())
            sum = of_all(sum);
        direct = sum;
    }
    return is_step ? bounces_.step(direct) : bounces_.find(direct);
}

/// Adds values of all receivers, or none, to those of this process's.
void LitScene::add_of_all(std::span<const glm::vec3> of_all, std::span<glm::vec3> own) const {
    if (of_all.empty())
        return;
    if (!part_)
        return add(of_all, own);
    for (std::size_t i = 0; i < own.size(); ++i)
        own[i] += of_all[part_->receivers[i]];
}

/// Adds what surfaces send, and what lamps give, to values of this process's receivers.
void LitScene::add_surfaces(std::span<glm::vec3> own) const {
    for (const auto& of_all : {bounces_.bounced(), lamps_.direct(), lamps_.bounced()})
        add_of_all(of_all, own);
}

/// Sums the parts of the light.
LitScene::FinishTimes LitScene::finish() {
    using Clock = std::chrono::steady_clock;
    const auto seconds_since = [](Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    FinishTimes times;
    const auto start = Clock::now();
    lamps_.find();
    times.seconds_lamps = seconds_since(start);
    const bool has_mirrors = relighter_ && is_lit_ && mirrors_.is_needed();
    if (relighter_ && bounces_.bounced().empty() && added_.radiance.empty() &&
        lamps_.direct().empty() && !has_mirrors) {
        total_.clear();
        return times;
    }
    if (!relighter_) {
        total_ = added_.radiance;
        add_surfaces(total_);
        return times;
    }
    total_.assign(relighter_->radiance().begin(), relighter_->radiance().end());
    add_surfaces(total_);
    if (!added_.radiance.empty())
        add(added_.radiance, total_);
    if (has_mirrors) {
        const auto start_mirrors = Clock::now();
        add_mirrored();
        times.seconds_highlights = seconds_since(start_mirrors);
    }
    return times;
}

/// Adds the highlights that rays find.
void LitScene::add_mirrored() {
    SceneMirrors::Surfaces surfaces{.emission = lamps_.gains()};
    std::vector<glm::vec3> whole;
    if (mirrors_.shows_surfaces()) {
        whole = of_all(total_);
        surfaces.radiance = whole;
        if (bounces_.is_set())
            surfaces.albedo = bounces_.surfaces().albedo;
    }
    std::vector<std::uint32_t> receivers;
    if (!part_) {
        receivers.resize(total_.size());
        std::iota(receivers.begin(), receivers.end(), 0u);
    }
    mirrors_.add(*relighter_, surfaces,
                 part_ ? std::span<const std::uint32_t>(part_->receivers) : receivers, total_);
}

std::vector<glm::vec3> LitScene::harmonics() const {
    if (!is_lit_ || harmonics_ == 0)
        throw std::logic_error("expected a scene that is lit, with LightOptions::harmonics");
    std::vector<glm::vec3> result = relighter().harmonics();
    for (std::size_t i = 0; i < added_.harmonics.size(); ++i)
        result[i] += added_.harmonics[i];
    const prt::Transfer& transfer = relighter().transfer();
    const std::size_t width = relight::num_harmonics(harmonics_);
    if (!bounces_.bounced().empty() || !lamps_.direct().empty()) {
        std::vector<glm::vec3> bounced(transfer.num_receivers(), glm::vec3(0.0f));
        add_surfaces(bounced);
        add_to_points(result);
        for (std::size_t place = transfer.num_points; place < transfer.num_receivers(); ++place) {
            const std::uint32_t receiver = transfer.order[place];
            glm::dvec3 arriving(bounced[receiver]);
            // What surfaces send on, before their colours.
            for (int channel = 0; channel < 3 && !transfer.surfaces.empty(); ++channel) {
                const float albedo = transfer.surfaces[place].albedo[channel];
                arriving[channel] = albedo > 0.0f ? arriving[channel] / albedo : 0.0;
            }
            const std::span<glm::vec3> light = std::span(result).subspan(receiver * width, width);
            const glm::vec3& normal = transfer.normals[place];
            relight::bind_irradiance(
                light, normal, relight::irradiance(light, normal) + std::numbers::pi * arriving);
        }
    }
    return team_->has_others() ? gathered(*team_, scene_->transfer.order, result, width) : result;
}

/// Adds what surfaces send to the coefficients of this process's points in space.
void LitScene::add_to_points(std::span<glm::vec3> harmonics) const {
    const prt::Transfer& transfer = relighter().transfer();
    if (transfer.num_points == 0 || bounces_.bounced().empty())
        return;
    const std::size_t width = relight::num_harmonics(harmonics_);
    const std::vector<glm::vec3> of_all = bounces_.point_harmonics(harmonics_);
    const std::vector<std::uint32_t> places =
        prt::places_of(team_->part(), scene_->transfer.num_receivers());
    for (std::size_t place = 0; place < transfer.num_points; ++place)
        for (std::size_t k = 0; k < width; ++k)
            harmonics[transfer.order[place] * width + k] += of_all[places[place] * width + k];
}

/// The first process gets what all have.
void LitScene::gather(Lighting& lighting) const {
    const std::vector<std::uint32_t>& order = scene_->transfer.order;
    lighting.gathered =
        std::make_shared<const std::vector<glm::vec3>>(gathered(*team_, order, lighting.radiance));
    lighting.radiance = *lighting.gathered;
    if (!lighting.lights.empty())
        lighting.soft = gathered(*team_, order, lighting.soft);
    if (!lighting.harmonics.empty())
        lighting.harmonics =
            gathered(*team_, order, lighting.harmonics,
                     relight::num_harmonics(relighter_->receiver_light().harmonic_order()));
}

Lighting LitScene::lighting(bool is_drawn) const {
    if (!is_lit_)
        throw std::logic_error("expected a scene that is lit");
    Lighting result{.radiance = radiance()};
    if (is_drawn) {
        if (relighter_)
            result.lights = relight::picture_lights(*relighter_);
        if (relighter_ && relighter_->environment().resolution != 0)
            result.num_environment_lights = result.lights.size();
        result.lights.insert(result.lights.end(), added_.lights.begin(), added_.lights.end());
    }
    if (is_drawn && relighter_ && scene_->transfer.glossy && !scene_->mesh.textures.empty())
        result.lobes =
            relighter_->receiver_light().lobes(result.lights.size() == added_.lights.size());
    if (is_drawn && relighter_ && has_mapped_vertices(*scene_))
        result.harmonics =
            relighter_->receiver_light().harmonics(result.lights.size() == added_.lights.size());
    result.open_floor =
        added_.open_floor +
        (relighter_ ? relighter_->open_radiance({0.0f, 1.0f, 0.0f}) : glm::dvec3(0.0));
    if (!result.lights.empty()) {
        if (!relighter_)
            result.soft.resize(added_.soft.size());
        else if (result.lights.size() > added_.lights.size())
            result.soft = relighter_->receiver_light().soft_radiance();
        else
            result.soft.assign(relighter_->radiance().begin(), relighter_->radiance().end());
        add_surfaces(result.soft);
        const std::vector<glm::vec3>& of_list =
            added_.lights.empty() ? added_.radiance : added_.soft;
        for (std::size_t i = 0; i < of_list.size(); ++i)
            result.soft[i] += of_list[i];
    }
    if (team_->has_others()) {
        gather(result);
        if (!team_->is_first())
            return {};
    }
    if (!relighter_ || relighter_->environment().resolution == 0)
        return result;
    result.environment = &relighter_->environment();
    if (is_drawn)
        result.seen = seen_environment(state_);
    if (!is_drawn || !state_.base || !state_.base->backdrop())
        return result;
    if (!is_edited())
        result.sharp = state_.base->backdrop();
    else if (state_.shows_base())
        result.sharp =
            relight::edited_backdrop(state_.base->backdrop(), *state_.base->map(), result.behind());
    return result;
}

std::vector<glm::vec3> bounced(const LitScene& lit) {
    std::vector<glm::vec3> result = copy_of(lit.bounces().bounced());
    if (!result.empty() && !lit.lamps().bounced().empty())
        add(lit.lamps().bounced(), result);
    return result;
}

} // namespace relumine
