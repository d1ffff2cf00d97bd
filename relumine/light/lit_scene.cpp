#include "relumine/light/lit_scene.h"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/seconds.h"
#include "relight/bright_clusters.h"
#include "relight/harmonics/harmonics.h"
#include "relight/receiver_light.h"
#include "relight/sharp/light_packets.h"
#include "relight/sharp/shadow_rays.h"
#include "relight/surfaces/surface_colors.h"
#include "relumine/in/scene_rays.h"
#include "relumine/light/layer_compositor.h"
#include "relumine/light/light_sum.h"
#include "relumine/light/listed_light.h"
#include "relumine/light/scene_moves.h"
#include "relumine/light/sent_light.h"
#include "relumine/light/shared_receivers.h"
#include "relumine/light/terms.h"

namespace relumine {

namespace {

using Clock = std::chrono::steady_clock;

/// Returns the map of a light, or null.
const cubemap::CubeMap* map_of(const Light& light) {
    if (const auto* binned = std::get_if<BinnedEnvironment>(&light.environment))
        return binned->map.get();
    if (const auto* shared =
            std::get_if<std::shared_ptr<const cubemap::CubeMap>>(&light.environment))
        return shared->get();
    return std::get_if<cubemap::CubeMap>(&light.environment);
}

} // namespace

/// What is lit: a scene, or the part of it that this process has.
struct HeldScene {
    HeldScene(std::shared_ptr<const Scene> whole, Scene* of_own,
              std::unique_ptr<prt::ScenePart> part, const LightOptions& options)
        : scene(part ? std::make_shared<const Scene>(std::move(part->scene)) : std::move(whole)),
          own(of_own), rays(*scene),
          receivers(*scene, std::move(part), options.team, options.path) {}

    std::shared_ptr<const Scene> scene;
    /// What may be changed: the scene, where nobody else has it. Otherwise null.
    Scene* own;
    SceneRays rays;
    SharedReceivers receivers;

    [[nodiscard]] bool is_gathered() const {
        if (!gathered_)
            gathered_ = relumine::is_gathered(*scene);
        return *gathered_;
    }

private:
    mutable std::optional<bool> gathered_;
};

namespace {

relight::ShadowRays shadow_rays(const HeldScene& held, const LightOptions& options) {
    if (options.clusters_only)
        return {};
    return {.blockers = options.blockers ? options.blockers.get() : &held.rays.for_moving_lights(),
            .positions = held.receivers.positions(),
            .bias = held.scene->settings.bias,
            .tolerance = rms_tolerance(*held.scene)};
}

/// Returns what sums the clusters' light, or null.
std::unique_ptr<relight::Relighter> relighter_of(const HeldScene& held,
                                                 const LightOptions& options) {
    const Scene& scene = *held.scene;
    if (options.harmonics != 0)
        relight::require_order(options.harmonics);
    if (!has_clusters(scene)) {
        if (options.clusters_only)
            static_cast<void>(require_clusters(nullptr));
        return nullptr;
    }
    if (scene.receivers.size() != scene.transfer.num_receivers())
        throw std::invalid_argument(fmt::format("expected the transfer of {} receivers, got {}",
                                                scene.receivers.size(),
                                                scene.transfer.num_receivers()));
    return std::make_unique<relight::Relighter>(
        held.receivers.transfer(), shadow_rays(held, options),
        options.harmonics == 0 && has_mapped_vertices(scene) ? relight::MaxHarmonicOrder
                                                             : options.harmonics);
}

} // namespace

/// Stays in its place, so that its parts can refer to each other.
struct LitScene::Impl final : LightFollower {
    Impl(std::shared_ptr<const Scene> whole, Scene* own, std::unique_ptr<prt::ScenePart> part,
         const LightOptions& options);

    void require_lit() const;
    void require_same(const Light& light) const;
    UpdateReport light(Light light);
    BounceReport bounce(const Bouncing& how);
    BounceReport find_bounces(bool is_step);
    void forget_bounces();
    void follow_first_edit() override;
    void follow(EnvironmentChange& change, Ending ending) override;
    void follow(const prt::SceneChange& change, bool is_quick) override;
    void finish(UpdateReport& report);
    void bind_sent(ArrivingLight& arriving) const;
    void take_apart(Lighting& lighting) const;
    void take_floor_apart(Lighting& lighting) const;
    void add_sent(Lighting& lighting, std::vector<glm::vec3> gathered) const;
    void gather(Lighting& lighting) const;
    void show_environment(Lighting& lighting) const;
    [[nodiscard]] glm::vec3 open_gain(const glm::vec3& open_floor) const;
    /// Whether all bounces of the present light are there, without a limit of their number.
    [[nodiscard]] bool has_all_bounces() const {
        return !bounces.bounced().empty() && bounces.is_settled() &&
               !bounces.surfaces().limits.num_bounces && !held.receivers.are_in_others();
    }

    HeldScene held;
    LightOptions options;
    /// The environment's light, or a list's alone. Null without clusters.
    std::unique_ptr<relight::Relighter> relighter;
    EditedEnvironment environment;
    ListedLight listed;
    SceneBounces bounces;
    SceneLamps lamps;
    SceneMirrors mirrors;
    LightSum sum;
    SceneMoves moves;
};

LitScene::Impl::Impl(std::shared_ptr<const Scene> whole, Scene* own,
                     std::unique_ptr<prt::ScenePart> part, const LightOptions& of)
    : held(std::move(whole), own, std::move(part), of), options(of),
      relighter(relighter_of(held, options)), environment(relighter.get(), *this),
      lamps(*held.scene, held.rays), mirrors(*held.scene, held.rays, options.highlight_rays),
      sum(*held.scene, held.receivers, relighter.get()),
      moves(*held.scene, held.receivers.are_in_others() ? nullptr : own, held.rays, relighter.get(),
            *this) {
    if (relighter)
        sum.add(std::make_unique<ClusterTerm>(*relighter));
    sum.add(std::make_unique<BounceTerm>(bounces, held.receivers));
    sum.add(std::make_unique<LampTerm>(lamps, held.receivers));
    sum.add(std::make_unique<ListTerm>(listed));
    if (relighter)
        sum.add(std::make_unique<MirrorTerm>(mirrors, *relighter, bounces, lamps, held.receivers));
}

LitScene::LitScene(Scene scene, const LightOptions& options) {
    auto own = std::make_shared<Scene>(std::move(scene));
    impl_ = std::make_unique<Impl>(own, own.get(), nullptr, options);
}

LitScene::LitScene(std::shared_ptr<const Scene> scene, const LightOptions& options)
    : impl_(std::make_unique<Impl>(std::move(scene), nullptr, nullptr, options)) {}

LitScene::LitScene(prt::ScenePart part, const LightOptions& options)
    : impl_(std::make_unique<Impl>(nullptr, nullptr,
                                   std::make_unique<prt::ScenePart>(std::move(part)), options)) {}

LitScene::LitScene(LitScene&&) noexcept = default;
LitScene& LitScene::operator=(LitScene&&) noexcept = default;
LitScene::~LitScene() = default;

// Parts

const Scene& LitScene::scene() const {
    return *impl_->held.scene;
}

const SceneRays& LitScene::rays() const {
    return impl_->held.rays;
}

const relight::Relighter& LitScene::relighter() const {
    return require_clusters(impl_->relighter.get());
}

EditedEnvironment& LitScene::environment() {
    return impl_->environment;
}

const EditedEnvironment& LitScene::environment() const {
    return impl_->environment;
}

const SceneBounces& LitScene::bounces() const {
    return impl_->bounces;
}

const SceneLamps& LitScene::lamps() const {
    return impl_->lamps;
}

const SceneMirrors& LitScene::mirrors() const {
    return impl_->mirrors;
}

SceneMoves& LitScene::moves() {
    return impl_->moves;
}

// Light

void LitScene::Impl::require_lit() const {
    if (!sum.is_lit())
        throw std::logic_error("expected a scene that is lit, got one without light: light() comes "
                               "first, in Python set_environment()");
}

/// Throws where the first process has other light.
void LitScene::Impl::require_same(const Light& light) const {
    if (const cubemap::CubeMap* map = map_of(light))
        held.receivers.require_same(std::as_bytes(std::span(map->texels)));
    held.receivers.require_same(std::as_bytes(std::span(light.lights)));
}

void LitScene::Impl::forget_bounces() {
    bounces.forget();
    lamps.forget_bounces();
}

BounceReport LitScene::Impl::find_bounces(bool is_step) {
    std::span<const glm::vec3> direct = relighter->diffuse_radiance();
    std::vector<glm::vec3> all;
    if (!listed.diffuse.empty() || held.receivers.are_in_others()) {
        all.assign(direct.begin(), direct.end());
        for (std::size_t i = 0; i < listed.diffuse.size(); ++i)
            all[i] += listed.diffuse[i];
        all = held.receivers.of_all(all);
        direct = all;
    }
    return is_step ? bounces.step(direct) : bounces.find(direct);
}

/// Sums the terms.
void LitScene::Impl::finish(UpdateReport& report) {
    const auto start = Clock::now();
    lamps.find();
    report.seconds_lamps = files::seconds_since(start);
    // The last term is that of the highlights.
    const double seconds = sum.find();
    if (mirrors.is_needed())
        report.seconds_highlights = seconds;
}

UpdateReport LitScene::Impl::light(Light light) {
    const auto start = Clock::now();
    const bool has_environment = !std::holds_alternative<std::monostate>(light.environment);
    if (has_environment)
        static_cast<void>(require_clusters(relighter.get()));
    require_same(light);
    UpdateReport report;
    ListedLight next;
    if (!relighter) {
        next =
            listed_light(light.lights, held.scene->receivers.normals, shadow_rays(held, options));
    } else if (!has_environment) {
        report = relighter->set_lights(light.lights);
    } else if (!light.lights.empty()) {
        if (!std::holds_alternative<BinnedEnvironment>(light.environment))
            relight::require_radiance(map_of(light)->texels);
        next = listed_light(light.lights, *relighter, options.harmonics != 0);
    }
    next.made_of = light.lights;
    if (has_environment)
        report = environment.light(std::move(light));
    else
        environment.clear();
    listed = std::move(next);
    forget_bounces();
    finish(report);
    report.seconds = files::seconds_since(start);
    return report;
}

UpdateReport LitScene::light(Light light) {
    return impl_->light(std::move(light));
}

void LitScene::Impl::follow_first_edit() {
    if (bounces.bounced().empty()) {
        bounces.unset();
        lamps.forget_bounces();
    } else {
        find_bounces(false);
    }
}

void LitScene::Impl::follow(EnvironmentChange& change, Ending ending) {
    if (change.is_whole)
        forget_bounces();
    else if (change.is_other)
        bounces.unsettle();
    if (ending == Ending::Exact) {
        if (!change.is_whole)
            relighter->resum();
        if (bounces.is_set())
            find_bounces(false);
    }
    finish(change.report);
}

BounceReport LitScene::Impl::bounce(const Bouncing& how) {
    std::optional<relight::SurfaceBounces> surfaces;
    require_bounces(*held.scene);
    if (!how.albedo.empty())
        surfaces = bounces_of(*held.scene, how.albedo, how.limits);
    require_lit();
    if (!surfaces && !bounces.is_set())
        throw std::logic_error("expected an albedo, as bounce_albedo() returns it");
    const relight::SharedRows rows = held.receivers.rows();
    if (surfaces)
        bounces.set(*held.scene, std::move(*surfaces), rows);
    lamps.set_bounces(bounces.surfaces(), rows);
    BounceReport report = find_bounces(how.is_step);
    UpdateReport update;
    finish(update);
    const BounceReport& of_lamps = lamps.report();
    report.num_bounces = std::max(report.num_bounces, of_lamps.num_bounces);
    report.error = std::max(report.error, of_lamps.error);
    report.seconds += of_lamps.seconds;
    return report;
}

BounceReport LitScene::bounce(const Bouncing& how) {
    return impl_->bounce(how);
}

void LitScene::dim(std::vector<EmissionGain> gains) {
    if (gains == impl_->lamps.gains())
        return;
    impl_->lamps.set(std::move(gains));
    UpdateReport report;
    if (impl_->sum.is_lit())
        impl_->finish(report);
}

void LitScene::set_roughness(float roughness) {
    if (impl_->held.own == nullptr)
        throw std::logic_error("expected a scene that is not shared, to set its roughness");
    relumine::set_roughness(*impl_->held.own, roughness);
}

void LitScene::Impl::follow(const prt::SceneChange& change, bool is_quick) {
    if (relighter)
        relighter->follow(change);
    if (is_quick)
        lamps.forget_rays();
    else
        lamps.forget_light();
    if (!sum.is_lit())
        return;
    // Other light would end them.
    SceneBounces kept = std::exchange(bounces, SceneBounces());
    if (!listed.radiance.empty()) {
        Light again(listed.made_of);
        if (environment.is_lit()) {
            // A list beside an environment has the Relighter for a while.
            const std::shared_ptr<const LightBase> base = environment.state().base;
            again.environment =
                environment.is_edited()
                    ? base->map()
                    : std::make_shared<const cubemap::CubeMap>(relighter->environment());
            if (base) {
                again.file = base->file();
                again.path = base->path();
            }
        }
        light(std::move(again));
    }
    UpdateReport report;
    const relight::SharedRows rows = held.receivers.rows();
    if (!kept.is_set()) {
        finish(report);
    } else if (is_quick) {
        bounces = std::move(kept);
        lamps.set_bounces(bounces.surfaces(), rows);
        finish(report);
    } else {
        relight::SurfaceBounces surfaces = kept.surfaces();
        kept.unset(); // frees its memory
        surfaces.matrix = &*held.scene->bounces;
        bounces.set(*held.scene, std::move(surfaces), rows);
        bounce({});
    }
}

// What it gives

std::span<const glm::vec3> LitScene::radiance() const {
    return impl_->sum.radiance();
}

/// Lets the harmonics of surfaces have the irradiance that they send, too.
void LitScene::Impl::bind_sent(ArrivingLight& arriving) const {
    const prt::Transfer& transfer = relighter->transfer();
    const std::size_t width = relight::num_harmonics(arriving.order);
    for (std::size_t place = transfer.num_points; place < transfer.num_receivers(); ++place) {
        const std::uint32_t receiver = transfer.order[place];
        glm::dvec3 sent(arriving.sent[receiver]);
        if (!transfer.surfaces.empty())
            sent = relight::before_color(sent, transfer.surfaces[place].albedo);
        const std::span<glm::vec3> light =
            std::span(arriving.harmonics).subspan(receiver * width, width);
        const glm::vec3& normal = transfer.normals[place];
        relight::bind_irradiance(light, normal,
                                 relight::irradiance(light, normal) + std::numbers::pi * sent);
    }
}

std::vector<glm::vec3> LitScene::harmonics() const {
    const Impl& own = *impl_;
    if (!own.sum.is_lit() || own.options.harmonics == 0)
        throw std::logic_error("expected a scene that is lit, with LightOptions::harmonics");
    const std::size_t width = relight::num_harmonics(own.options.harmonics);
    ArrivingLight arriving{.order = own.options.harmonics,
                           .harmonics = std::vector<glm::vec3>(
                               relighter().transfer().num_receivers() * width, glm::vec3(0.0f))};
    for (const auto& term : own.sum.terms())
        if (term->is_lit())
            term->add_harmonics(arriving);
    if (!arriving.sent.empty())
        own.bind_sent(arriving);
    return own.held.receivers.are_in_others()
               ? own.held.receivers.gathered(arriving.harmonics, width)
               : std::move(arriving.harmonics);
}

/// Adds what pictures draw with: the lights that are traced one by one, and the rest of the light.
void LitScene::Impl::take_apart(Lighting& lighting) const {
    std::vector<relight::SharpLight>& lights = lighting.lights;
    std::size_t num_own = 0;
    for (const auto& term : sum.terms()) {
        const std::vector<relight::SharpLight> further = term->lights();
        lights.insert(lights.end(), further.begin(), further.end());
        if (relighter && term == sum.terms().front())
            num_own = lights.size();
    }
    if (environment.is_lit())
        lighting.num_environment_lights = num_own;
    if (relighter && held.scene->transfer.glossy && !held.scene->mesh.textures.empty())
        lighting.lobes = relighter->receiver_light().lobes(num_own == 0);
    if (relighter && has_mapped_vertices(*held.scene))
        lighting.harmonics = relighter->receiver_light().harmonics(num_own == 0);
    if (lights.empty())
        return;
    lighting.soft.assign(lighting.radiance.size(), glm::vec3(0.0f));
    for (const auto& term : sum.terms())
        if (term->is_lit())
            term->add_soft(lighting.soft);
}

/// Adds what pictures trace on an added floor.
void LitScene::Impl::take_floor_apart(Lighting& lighting) const {
    constexpr glm::vec3 Up(0.0f, 1.0f, 0.0f);
    const std::optional<std::size_t> first = first_floor_vertex(*held.scene);
    const std::vector<prt::Surface>& surfaces = held.scene->receivers.surfaces;
    if (!first || !environment.is_lit() || held.receivers.are_in_others() ||
        relighter->shadow_rays().blockers == nullptr ||
        !(surfaces.empty() || surfaces[*first] == prt::Surface()))
        return;
    relight::BrightClusters bright = relight::bright_clusters(*relighter, Up);
    if (bright.lights.empty())
        return;
    lighting.floor_lights = std::move(bright.lights);
    lighting.of_floor_lights = relight::radiance_from(bright.clusters, *relighter, *first);
}

/// Adds what pictures gather by rays: bounces, and the environment's light but for lights that are
/// traced.
void LitScene::Impl::add_sent(Lighting& lighting, std::vector<glm::vec3> gathered) const {
    if (environment.is_lit())
        sum.terms().front()->add_soft(gathered);
    add_sent_light(*held.scene, bounces, gathered, lighting);
}

/// Gives the first process what all have.
void LitScene::Impl::gather(Lighting& lighting) const {
    lighting.gathered =
        std::make_shared<const std::vector<glm::vec3>>(held.receivers.gathered(lighting.radiance));
    if (sum.passes_on()) {
        lighting.gathered_reflected = std::make_shared<const std::vector<glm::vec3>>(
            held.receivers.gathered(lighting.reflected));
        lighting.reflected = *lighting.gathered_reflected;
    }
    lighting.radiance = *lighting.gathered;
    if (!lighting.lights.empty())
        lighting.soft = held.receivers.gathered(lighting.soft);
    if (!lighting.harmonics.empty())
        lighting.harmonics = held.receivers.gathered(
            lighting.harmonics,
            relight::num_harmonics(relighter->receiver_light().harmonic_order()));
}

/// Adds what is seen of the environment behind the mesh.
void LitScene::Impl::show_environment(Lighting& lighting) const {
    const LightState& state = environment.state();
    lighting.seen = seen_environment(state);
    if (!state.base || !state.base->backdrop())
        return;
    if (!environment.is_edited())
        lighting.sharp = state.base->backdrop();
    else if (state.shows_base())
        lighting.sharp =
            relight::edited_backdrop(state.base->backdrop(), *state.base->map(), lighting.behind());
}

/// What layers and lists make of the light of a floor in the open.
glm::vec3 LitScene::Impl::open_gain(const glm::vec3& open_floor) const {
    const LightState& state = environment.state();
    if (state.layers.empty() && listed.radiance.empty())
        return glm::vec3(1.0f);
    const glm::dvec3 base = environment.open_floor_of_base();
    glm::vec3 gain(1.0f);
    for (int channel = 0; channel < 3; ++channel)
        if (base[channel] > 0.0)
            gain[channel] = open_floor[channel] / static_cast<float>(base[channel]);
    return gain;
}

Lighting LitScene::lighting(bool is_drawn) const {
    const Impl& own = *impl_;
    own.require_lit();
    Lighting result{.radiance = radiance()};
    glm::dvec3 open_floor(0.0);
    for (const auto& term : own.sum.terms())
        open_floor += term->open_floor();
    result.open_floor = open_floor;
    if (own.sum.passes_on())
        result.reflected = own.sum.reflected();
    if (is_drawn)
        own.take_apart(result);
    if (is_drawn && prt::on_vertices(own.held.scene->layout))
        own.take_floor_apart(result);
    if (is_drawn && own.has_all_bounces() && own.held.is_gathered())
        own.add_sent(result, bounced(*this));
    if (own.held.receivers.are_in_others()) {
        own.gather(result);
        if (!own.held.receivers.is_first())
            return {};
    } else if (own.relighter) {
        result.arriving = own.relighter->diffuse_radiance();
    }
    if (!own.environment.is_lit())
        return result;
    result.environment = &own.relighter->environment();
    if (is_drawn) {
        own.show_environment(result);
        result.state = &own.environment.state();
        result.open_gain = own.open_gain(*result.open_floor);
    }
    return result;
}

bool has_environment(const LitScene& lit) {
    return lit.environment().is_lit();
}

const cubemap::CubeMap& environment_of(const LitScene& lit) {
    static const cubemap::CubeMap Black(1), Nothing;
    if (has_environment(lit))
        return lit.relighter().environment();
    return lit.radiance().empty() ? Nothing : Black;
}

std::vector<glm::vec3> bounced(const LitScene& lit) {
    const std::span<const glm::vec3> of_lamps = lit.lamps().bounced();
    std::vector<glm::vec3> result(lit.bounces().bounced().begin(), lit.bounces().bounced().end());
    if (!result.empty())
        for (std::size_t i = 0; i < of_lamps.size(); ++i)
            result[i] += of_lamps[i];
    return result;
}

BinnedEnvironment bin(const LitScene& lit, cubemap::CubeMap environment) {
    return relight::binner_of(lit.relighter()).bin(std::move(environment));
}

} // namespace relumine
