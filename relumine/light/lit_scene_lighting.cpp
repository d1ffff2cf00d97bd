// How LitScene sums the parts of its light, and what it tells of it.
#include <chrono>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "relight/harmonics/harmonics.h"
#include "relight/receiver_light.h"
#include "relight/sharp/light_packets.h"
#include "relumine/light/layer_compositor.h"
#include "relumine/light/lit_scene.h"

namespace relumine {

namespace {

/// Adds values, or none.
void add(std::span<const glm::vec3> values, std::span<glm::vec3> sum) {
    for (std::size_t i = 0; i < values.size(); ++i)
        sum[i] += values[i];
}

std::vector<glm::vec3> copy_of(std::span<const glm::vec3> values) {
    return {values.begin(), values.end()};
}

} // namespace

BounceReport LitScene::find_bounces(bool is_step) {
    std::span<const glm::vec3> direct = relighter_->diffuse_radiance();
    std::vector<glm::vec3> sum;
    if (!listed_.diffuse.empty() || receivers_.are_in_others()) {
        sum = copy_of(direct);
        add(listed_.diffuse, sum);
        sum = receivers_.of_all(sum);
        direct = sum;
    }
    return is_step ? bounces_.step(direct) : bounces_.find(direct);
}

/// Adds what surfaces send, and what lamps give, to values of this process's receivers.
void LitScene::add_surfaces(std::span<glm::vec3> own) const {
    for (const auto& of_all : {bounces_.bounced(), lamps_.direct(), lamps_.bounced()})
        receivers_.add_of_all(of_all, own);
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
    if (relighter_ && bounces_.bounced().empty() && listed_.radiance.empty() &&
        lamps_.direct().empty() && !has_mirrors) {
        total_.clear();
        return times;
    }
    if (relighter_) {
        total_.assign(relighter_->radiance().begin(), relighter_->radiance().end());
        add_surfaces(total_);
        add(listed_.radiance, total_);
    } else {
        total_ = listed_.radiance;
        add_surfaces(total_);
    }
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
        whole = receivers_.of_all(total_);
        surfaces.radiance = whole;
        if (bounces_.is_set())
            surfaces.albedo = bounces_.surfaces().albedo;
    }
    mirrors_.add(*relighter_, surfaces, receivers_.indices(total_.size()), total_);
}

std::vector<glm::vec3> LitScene::harmonics() const {
    if (!is_lit_ || harmonics_ == 0)
        throw std::logic_error("expected a scene that is lit, with LightOptions::harmonics");
    std::vector<glm::vec3> result = relighter().harmonics();
    add(listed_.harmonics, result);
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
    return receivers_.are_in_others() ? receivers_.gathered(result, width) : result;
}

/// Adds what surfaces send to the coefficients of this process's points in space.
void LitScene::add_to_points(std::span<glm::vec3> harmonics) const {
    const prt::Transfer& transfer = relighter().transfer();
    if (transfer.num_points == 0 || bounces_.bounced().empty())
        return;
    const std::size_t width = relight::num_harmonics(harmonics_);
    const std::vector<glm::vec3> of_all = bounces_.point_harmonics(harmonics_);
    const std::vector<std::uint32_t> places = receivers_.places();
    for (std::size_t place = 0; place < transfer.num_points; ++place)
        for (std::size_t k = 0; k < width; ++k)
            harmonics[transfer.order[place] * width + k] += of_all[places[place] * width + k];
}

/// Adds what pictures draw with: the lights that are traced one by one, and the rest of the light.
void LitScene::take_apart(Lighting& lighting) const {
    std::vector<relight::SharpLight>& lights = lighting.lights;
    if (relighter_)
        lights = relight::picture_lights(*relighter_);
    const bool has_own = !lights.empty();
    if (has_environment(*this))
        lighting.num_environment_lights = lights.size();
    lights.insert(lights.end(), listed_.lights.begin(), listed_.lights.end());
    if (relighter_ && scene_->transfer.glossy && !scene_->mesh.textures.empty())
        lighting.lobes = relighter_->receiver_light().lobes(!has_own);
    if (relighter_ && has_mapped_vertices(*scene_))
        lighting.harmonics = relighter_->receiver_light().harmonics(!has_own);
    if (lights.empty())
        return;
    if (!relighter_)
        lighting.soft.resize(listed_.soft.size());
    else
        lighting.soft = has_own ? relighter_->receiver_light().soft_radiance()
                                : copy_of(relighter_->radiance());
    add_surfaces(lighting.soft);
    add(listed_.without_traced(), lighting.soft);
}

/// Gives the first process what all have.
void LitScene::gather(Lighting& lighting) const {
    lighting.gathered =
        std::make_shared<const std::vector<glm::vec3>>(receivers_.gathered(lighting.radiance));
    lighting.radiance = *lighting.gathered;
    if (!lighting.lights.empty())
        lighting.soft = receivers_.gathered(lighting.soft);
    if (!lighting.harmonics.empty())
        lighting.harmonics = receivers_.gathered(
            lighting.harmonics,
            relight::num_harmonics(relighter_->receiver_light().harmonic_order()));
}

/// Adds what is seen of the environment behind the mesh.
void LitScene::show_environment(Lighting& lighting) const {
    const LightState& state = environment_.state();
    lighting.seen = seen_environment(state);
    if (!state.base || !state.base->backdrop())
        return;
    if (!environment_.is_edited())
        lighting.sharp = state.base->backdrop();
    else if (state.shows_base())
        lighting.sharp =
            relight::edited_backdrop(state.base->backdrop(), *state.base->map(), lighting.behind());
}

Lighting LitScene::lighting(bool is_drawn) const {
    if (!is_lit_)
        throw std::logic_error("expected a scene that is lit");
    Lighting result{.radiance = radiance()};
    result.open_floor =
        listed_.open_floor +
        (relighter_ ? relighter_->open_radiance({0.0f, 1.0f, 0.0f}) : glm::dvec3(0.0));
    if (is_drawn)
        take_apart(result);
    if (receivers_.are_in_others()) {
        gather(result);
        if (!receivers_.is_first())
            return {};
    }
    if (!has_environment(*this))
        return result;
    result.environment = &relighter_->environment();
    if (is_drawn)
        show_environment(result);
    return result;
}

std::vector<glm::vec3> bounced(const LitScene& lit) {
    std::vector<glm::vec3> result = copy_of(lit.bounces().bounced());
    if (!result.empty() && !lit.lamps().bounced().empty())
        add(lit.lamps().bounced(), result);
    return result;
}

} // namespace relumine
