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
#include "relumine/in/scene_rays.h"
#include "relumine/light/layer_compositor.h"
#include "relumine/light/listed_light.h"
#include "relumine/light/passed_on.h"
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

/// Stays in its place, so that its parts can refer to each other.
struct LitScene::Impl {
    Impl(std::shared_ptr<const Scene> whole, std::unique_ptr<prt::ScenePart> part,
         const LightOptions& options);

    /// Throws where there are no clusters.
    [[nodiscard]] relight::Relighter& clusters() const;
    void require_lit() const;
    void require_same(const Light& light) const;
    BounceReport find_bounces(bool is_step);
    void forget_bounces();
    void require_own() const;
    void finish(UpdateReport& report);
    void pass_on();
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
               !bounces.surfaces().limits.num_bounces && !receivers.are_in_others();
    }
    [[nodiscard]] bool is_room() const {
        if (!gathers)
            gathers = is_gathered(*scene);
        return *gathers;
    }
    [[nodiscard]] bool has_environment() const {
        return relighter && relighter->environment().resolution != 0;
    }

    std::shared_ptr<const Scene> scene;
    /// The same, where nobody else has it.
    Scene* own_scene = nullptr;
    SceneRays rays;
    SharedReceivers receivers;
    std::uint32_t harmonics;
    /// LightOptions::blockers
    std::shared_ptr<const prt::Blockers> own_blockers;
    relight::ShadowRays shadow_rays;
    bool is_lit = false;
    /// is_gathered(), when it is known.
    mutable std::optional<bool> gathers;

    EditedEnvironment environment;
    /// The light of a level floor in the open under a base alone.
    mutable std::shared_ptr<const LightBase> open_of;
    mutable glm::dvec3 open_of_base{0.0};
    /// The environment's light, or a list's alone. Null without clusters.
    std::unique_ptr<relight::Relighter> relighter;
    ListedLight listed;
    /// What `listed`, or the clusters' light, was made of.
    std::vector<lights::DistantLight> listed_lights;
    /// Null where the scene is shared.
    std::unique_ptr<SceneMoves> moves;
    SceneBounces bounces;
    SceneLamps lamps;
    SceneMirrors mirrors;
    /// In the order in which they are added. Where there are clusters, theirs is the first.
    std::vector<std::unique_ptr<const LightTerm>> terms;
    /// [receivers of this process] the sum; empty where the clusters' term is all.
    std::vector<glm::vec3> total;
    /// What surfaces pass on, as a part of the other receiver's radiance, and the sum with it.
    std::vector<relight::PassedOn> passed;
    std::vector<glm::vec3> with_passed;
};

LitScene::Impl::Impl(std::shared_ptr<const Scene> whole, std::unique_ptr<prt::ScenePart> part,
                     const LightOptions& options)
    : scene(part ? std::make_shared<const Scene>(std::move(part->scene)) : std::move(whole)),
      rays(*scene), receivers(*scene, std::move(part), options.team, options.path),
      harmonics(options.harmonics), own_blockers(options.blockers), lamps(*scene, rays),
      mirrors(*scene, rays, options.highlight_rays) {
    if (harmonics != 0)
        relight::require_order(harmonics);
    const bool has_clusters = relumine::has_clusters(*scene);
    if (has_clusters && scene->receivers.size() != scene->transfer.num_receivers())
        throw std::invalid_argument(fmt::format("expected the transfer of {} receivers, got {}",
                                                scene->receivers.size(),
                                                scene->transfer.num_receivers()));
    if (!options.clusters_only)
        shadow_rays = {.blockers = own_blockers ? own_blockers.get() : &rays.for_moving_lights(),
                       .positions = receivers.positions(),
                       .bias = scene->settings.bias,
                       .tolerance = rms_tolerance(*scene)};
    if (has_clusters) {
        relighter = std::make_unique<relight::Relighter>(
            receivers.transfer(), shadow_rays,
            harmonics == 0 && has_mapped_vertices(*scene) ? relight::MaxHarmonicOrder : harmonics);
        terms.push_back(std::make_unique<ClusterTerm>(*relighter));
    } else if (options.clusters_only) {
        static_cast<void>(clusters());
    }
    passed = passed_on(*scene);
    for (relight::PassedOn& own : passed)
        own.part /= scene->receivers.surfaces[own.other].albedo;
    terms.push_back(std::make_unique<BounceTerm>(bounces, receivers));
    terms.push_back(std::make_unique<LampTerm>(lamps, receivers));
    terms.push_back(std::make_unique<ListTerm>(listed));
    if (has_clusters)
        terms.push_back(
            std::make_unique<MirrorTerm>(mirrors, *relighter, bounces, lamps, receivers));
}

LitScene::LitScene(Scene scene, const LightOptions& options) {
    auto own = std::make_shared<Scene>(std::move(scene));
    impl_ = std::make_unique<Impl>(own, nullptr, options);
    impl_->own_scene = own.get();
    impl_->moves = std::make_unique<SceneMoves>(*own, impl_->rays);
}

LitScene::LitScene(std::shared_ptr<const Scene> scene, const LightOptions& options)
    : impl_(std::make_unique<Impl>(std::move(scene), nullptr, options)) {}

LitScene::LitScene(prt::ScenePart part, const LightOptions& options)
    : impl_(std::make_unique<Impl>(nullptr, std::make_unique<prt::ScenePart>(std::move(part)),
                                   options)) {}

LitScene::LitScene(LitScene&&) noexcept = default;
LitScene& LitScene::operator=(LitScene&&) noexcept = default;
LitScene::~LitScene() = default;

// Parts

const Scene& LitScene::scene() const {
    return *impl_->scene;
}

const SceneRays& LitScene::rays() const {
    return impl_->rays;
}

const relight::Relighter& LitScene::relighter() const {
    return impl_->clusters();
}

const LightState& LitScene::state() const {
    return impl_->environment.state();
}

LightHistory& LitScene::history() {
    return impl_->environment.history();
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

std::uint32_t LitScene::harmonic_order() const {
    return impl_->harmonics;
}

// Light

relight::Relighter& LitScene::Impl::clusters() const {
    if (!relighter)
        throw std::invalid_argument("expected a precomputed scene, got a mesh without clusters");
    return *relighter;
}

void LitScene::Impl::require_lit() const {
    if (!is_lit)
        throw std::logic_error("expected a scene that is lit, got one without light: light() comes "
                               "first, in Python set_environment()");
}

/// Throws where the first process has other light.
void LitScene::Impl::require_same(const Light& light) const {
    if (const cubemap::CubeMap* map = map_of(light))
        receivers.require_same(std::as_bytes(std::span(map->texels)));
    receivers.require_same(std::as_bytes(std::span(light.lights)));
}

void LitScene::Impl::forget_bounces() {
    bounces.forget();
    lamps.forget_bounces();
}

BounceReport LitScene::Impl::find_bounces(bool is_step) {
    std::span<const glm::vec3> direct = relighter->diffuse_radiance();
    std::vector<glm::vec3> sum;
    if (!listed.diffuse.empty() || receivers.are_in_others()) {
        sum.assign(direct.begin(), direct.end());
        for (std::size_t i = 0; i < listed.diffuse.size(); ++i)
            sum[i] += listed.diffuse[i];
        sum = receivers.of_all(sum);
        direct = sum;
    }
    return is_step ? bounces.step(direct) : bounces.find(direct);
}

/// Sums the terms.
void LitScene::Impl::finish(UpdateReport& report) {
    const auto start = Clock::now();
    lamps.find();
    report.seconds_lamps = files::seconds_since(start);
    total.clear();
    if (relighter && passed.empty() &&
        std::none_of(terms.begin() + 1, terms.end(),
                     [](const auto& term) { return term->is_lit(); }))
        return;
    total.assign(receivers.positions().size(), glm::vec3(0.0f));
    Clock::time_point start_term;
    for (const auto& term : terms) {
        start_term = Clock::now();
        if (term->is_lit())
            term->add_radiance(total);
    }
    // The last term is that of the highlights.
    if (mirrors.is_needed())
        report.seconds_highlights = files::seconds_since(start_term);
    pass_on();
}

/// Adds what surfaces pass on from behind them.
void LitScene::Impl::pass_on() {
    if (passed.empty())
        return;
    std::vector<glm::vec3> whole = receivers.of_all(total);
    const std::vector<glm::vec3> before = whole;
    for (const relight::PassedOn& own : passed)
        whole[own.receiver] += own.part * before[own.other];
    with_passed.clear();
    for (const std::uint32_t receiver : receivers.indices(total.size()))
        with_passed.push_back(whole[receiver]);
}

UpdateReport LitScene::light(Light light) {
    const auto start = Clock::now();
    Impl& own = *impl_;
    const bool has_environment = !std::holds_alternative<std::monostate>(light.environment);
    if (has_environment)
        static_cast<void>(relighter());
    own.require_same(light);
    UpdateReport report;
    ListedLight listed;
    if (!own.relighter) {
        listed = listed_light(light.lights, own.scene->receivers.normals, own.shadow_rays);
    } else if (!has_environment) {
        report = own.relighter->set_lights(light.lights);
    } else if (!light.lights.empty()) {
        if (!std::holds_alternative<BinnedEnvironment>(light.environment))
            relight::require_radiance(map_of(light)->texels);
        listed = listed_light(light.lights, *own.relighter, own.harmonics != 0);
    }
    own.listed_lights = light.lights;
    if (has_environment)
        report = own.environment.light(std::move(light), *own.relighter);
    else
        own.environment.clear();
    own.listed = std::move(listed);
    own.forget_bounces();
    own.is_lit = true;
    own.finish(report);
    report.seconds = files::seconds_since(start);
    return report;
}

UpdateReport LitScene::edit(LightState next, Ending ending) {
    require_valid(next);
    static_cast<void>(relighter());
    Impl& own = *impl_;
    if (own.environment.begin(*own.relighter)) {
        if (own.bounces.bounced().empty()) {
            own.bounces.unset();
            own.lamps.forget_bounces();
        } else {
            own.find_bounces(false);
        }
    }
    EditedEnvironment::Change change =
        own.environment.change(std::move(next), ending, *own.relighter);
    if (change.is_whole)
        own.forget_bounces();
    else if (change.is_other)
        own.bounces.unsettle();
    own.is_lit = true;
    if (ending == Ending::Exact) {
        if (!change.is_whole)
            own.relighter->resum();
        if (own.bounces.is_set())
            own.find_bounces(false);
    }
    own.finish(change.report);
    return change.report;
}

UpdateReport LitScene::update_region(const cubemap::TexelRectangle& rectangle,
                                     std::span<const glm::vec3> radiance) {
    Impl& own = *impl_;
    if (own.environment.is_edited())
        return edit(own.environment.with_region(rectangle, radiance));
    static_cast<void>(relighter());
    UpdateReport report = relight::update_region(*own.relighter, rectangle, radiance);
    own.environment.forget_file();
    own.bounces.unsettle();
    own.finish(report);
    return report;
}

BounceReport LitScene::bounce(const Bouncing& how) {
    Impl& own = *impl_;
    std::optional<relight::SurfaceBounces> surfaces;
    require_bounces(*own.scene);
    if (!how.albedo.empty())
        surfaces = bounces_of(*own.scene, how.albedo, how.limits);
    own.require_lit();
    if (!surfaces && !own.bounces.is_set())
        throw std::logic_error("expected an albedo, as bounce_albedo() returns it");
    const relight::SharedRows rows = own.receivers.rows();
    if (surfaces)
        own.bounces.set(*own.scene, std::move(*surfaces), rows);
    own.lamps.set_bounces(own.bounces.surfaces(), rows);
    BounceReport report = own.find_bounces(how.is_step);
    UpdateReport update;
    own.finish(update);
    const BounceReport& of_lamps = own.lamps.report();
    report.num_bounces = std::max(report.num_bounces, of_lamps.num_bounces);
    report.error = std::max(report.error, of_lamps.error);
    report.seconds += of_lamps.seconds;
    return report;
}

void LitScene::dim(std::vector<EmissionGain> gains) {
    if (gains == impl_->lamps.gains())
        return;
    impl_->lamps.set(std::move(gains));
    UpdateReport report;
    if (impl_->is_lit)
        impl_->finish(report);
}

void LitScene::set_roughness(float roughness) {
    if (impl_->own_scene == nullptr)
        throw std::logic_error("expected a scene that is not shared, to set its roughness");
    relumine::set_roughness(*impl_->own_scene, roughness);
}

void LitScene::Impl::require_own() const {
    require_movable(*scene);
    if (own_scene == nullptr || receivers.are_in_others())
        throw std::logic_error("expected a scene that is not shared, to move its groups");
    if (own_blockers)
        throw std::logic_error("expected triangles that block light where groups move, got others");
}

/// Lights what a move has changed, by the same light. Quickly: bounced light stays as it is, and
/// goes along with what moves.
void LitScene::follow(const prt::SceneChange& change, bool is_quick) {
    Impl& own = *impl_;
    if (own.relighter)
        own.relighter->follow(change);
    if (is_quick)
        own.lamps.forget_rays();
    else
        own.lamps.forget_light();
    if (!own.is_lit)
        return;
    // Other light would end them.
    SceneBounces bounces = std::exchange(own.bounces, SceneBounces());
    if (!own.listed.radiance.empty()) {
        Light light(own.listed_lights);
        if (own.has_environment()) {
            // A list beside an environment has the Relighter for a while.
            const std::shared_ptr<const LightBase> base = own.environment.state().base;
            light.environment =
                own.environment.is_edited()
                    ? base->map()
                    : std::make_shared<const cubemap::CubeMap>(own.relighter->environment());
            if (base) {
                light.file = base->file();
                light.path = base->path();
            }
        }
        this->light(std::move(light));
    }
    UpdateReport report;
    const relight::SharedRows rows = own.receivers.rows();
    if (!bounces.is_set()) {
        own.finish(report);
    } else if (is_quick) {
        own.bounces = std::move(bounces);
        own.lamps.set_bounces(own.bounces.surfaces(), rows);
        own.finish(report);
    } else {
        relight::SurfaceBounces surfaces = bounces.surfaces();
        bounces.unset(); // frees its memory
        surfaces.matrix = &*own.scene->bounces;
        own.bounces.set(*own.scene, std::move(surfaces), rows);
        bounce();
    }
}

MoveReport LitScene::move(const GroupMove& to, const PrecomputeWork& work) {
    Impl& own = *impl_;
    own.require_own();
    if (is_dragging())
        undo_move();
    MoveReport report;
    follow(own.moves->move(to, work, report), false);
    return report;
}

MoveReport LitScene::drag(const GroupMove& to) {
    Impl& own = *impl_;
    own.require_own();
    static_cast<void>(group_named(*own.scene, to.name));
    if (is_dragging() && own.moves->dragged()->name != to.name)
        undo_move();
    MoveReport report;
    follow(own.moves->drag(to, coarse_clusters(own.clusters()), report), true);
    return report;
}

MoveReport LitScene::drop(const PrecomputeWork& work) {
    Impl& own = *impl_;
    own.require_own();
    if (!is_dragging())
        throw std::logic_error("expected a group that is dragged");
    const GroupMove to = *own.moves->dragged();
    follow(own.moves->take_back(), true);
    try {
        return move(to, work);
    } catch (...) {
        follow({}, false);
        throw;
    }
}

bool LitScene::is_dragging() const {
    return impl_->moves && impl_->moves->dragged();
}

bool LitScene::exchange_move(bool is_undo) {
    Impl& own = *impl_;
    own.require_own();
    const prt::SceneChange* change =
        is_dragging() ? &own.moves->take_back() : own.moves->exchange(is_undo);
    if (change != nullptr)
        follow(*change, false);
    return change != nullptr;
}

bool LitScene::undo_move() {
    return exchange_move(true);
}

bool LitScene::redo_move() {
    return exchange_move(false);
}

// What it gives

std::span<const glm::vec3> LitScene::radiance() const {
    return impl_->with_passed.empty() ? reflected() : impl_->with_passed;
}

std::span<const glm::vec3> LitScene::reflected() const {
    const Impl& own = *impl_;
    if (!own.is_lit || !own.total.empty() || !own.relighter)
        return own.total;
    return own.relighter->radiance();
}

/// Lets the harmonics of surfaces have the irradiance that they send, too.
void LitScene::Impl::bind_sent(ArrivingLight& arriving) const {
    const prt::Transfer& transfer = relighter->transfer();
    const std::size_t width = relight::num_harmonics(arriving.order);
    for (std::size_t place = transfer.num_points; place < transfer.num_receivers(); ++place) {
        const std::uint32_t receiver = transfer.order[place];
        glm::dvec3 sent(arriving.sent[receiver]);
        // Before the surfaces' colours.
        for (int channel = 0; channel < 3 && !transfer.surfaces.empty(); ++channel) {
            const float albedo = transfer.surfaces[place].albedo[channel];
            sent[channel] = albedo > 0.0f ? sent[channel] / albedo : 0.0;
        }
        const std::span<glm::vec3> light =
            std::span(arriving.harmonics).subspan(receiver * width, width);
        const glm::vec3& normal = transfer.normals[place];
        relight::bind_irradiance(light, normal,
                                 relight::irradiance(light, normal) + std::numbers::pi * sent);
    }
}

std::vector<glm::vec3> LitScene::harmonics() const {
    const Impl& own = *impl_;
    if (!own.is_lit || own.harmonics == 0)
        throw std::logic_error("expected a scene that is lit, with LightOptions::harmonics");
    const std::size_t width = relight::num_harmonics(own.harmonics);
    ArrivingLight arriving{.order = own.harmonics,
                           .harmonics = std::vector<glm::vec3>(
                               relighter().transfer().num_receivers() * width, glm::vec3(0.0f))};
    for (const auto& term : own.terms)
        if (term->is_lit())
            term->add_harmonics(arriving);
    if (!arriving.sent.empty())
        own.bind_sent(arriving);
    return own.receivers.are_in_others() ? own.receivers.gathered(arriving.harmonics, width)
                                         : std::move(arriving.harmonics);
}

/// Adds what pictures draw with: the lights that are traced one by one, and the rest of the light.
void LitScene::Impl::take_apart(Lighting& lighting) const {
    std::vector<relight::SharpLight>& lights = lighting.lights;
    std::size_t num_own = 0;
    for (const auto& term : terms) {
        const std::vector<relight::SharpLight> further = term->lights();
        lights.insert(lights.end(), further.begin(), further.end());
        if (relighter && term == terms.front())
            num_own = lights.size();
    }
    if (has_environment())
        lighting.num_environment_lights = num_own;
    if (relighter && scene->transfer.glossy && !scene->mesh.textures.empty())
        lighting.lobes = relighter->receiver_light().lobes(num_own == 0);
    if (relighter && has_mapped_vertices(*scene))
        lighting.harmonics = relighter->receiver_light().harmonics(num_own == 0);
    if (lights.empty())
        return;
    lighting.soft.assign(lighting.radiance.size(), glm::vec3(0.0f));
    for (const auto& term : terms)
        if (term->is_lit())
            term->add_soft(lighting.soft);
}

/// Adds what pictures trace on an added floor.
void LitScene::Impl::take_floor_apart(Lighting& lighting) const {
    constexpr glm::vec3 Up(0.0f, 1.0f, 0.0f);
    const std::optional<std::size_t> first = first_floor_vertex(*scene);
    const std::vector<prt::Surface>& surfaces = scene->receivers.surfaces;
    if (!first || !has_environment() || receivers.are_in_others() ||
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
    if (has_environment())
        terms.front()->add_soft(gathered);
    lighting.gathered_light = sent_light(*scene, bounces, lighting.radiance, gathered);
}

/// Gives the first process what all have.
void LitScene::Impl::gather(Lighting& lighting) const {
    lighting.gathered =
        std::make_shared<const std::vector<glm::vec3>>(receivers.gathered(lighting.radiance));
    if (!passed.empty()) {
        lighting.gathered_reflected =
            std::make_shared<const std::vector<glm::vec3>>(receivers.gathered(lighting.reflected));
        lighting.reflected = *lighting.gathered_reflected;
    }
    lighting.radiance = *lighting.gathered;
    if (!lighting.lights.empty())
        lighting.soft = receivers.gathered(lighting.soft);
    if (!lighting.harmonics.empty())
        lighting.harmonics = receivers.gathered(
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
    constexpr glm::vec3 Up(0.0f, 1.0f, 0.0f);
    const LightState& state = environment.state();
    if (state.layers.empty() && listed.radiance.empty())
        return glm::vec3(1.0f);
    glm::dvec3 base(0.0);
    if (!environment.is_edited() || state.layers.empty()) {
        base = relighter->open_radiance(Up);
    } else {
        if (std::exchange(open_of, state.base) != state.base)
            open_of_base = cubemap::irradiance(*state.base->map(), Up) / std::numbers::pi;
        base = open_of_base;
    }
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
    for (const auto& term : own.terms)
        open_floor += term->open_floor();
    result.open_floor = open_floor;
    if (!own.passed.empty())
        result.reflected = reflected();
    if (is_drawn)
        own.take_apart(result);
    if (is_drawn && prt::on_vertices(own.scene->layout))
        own.take_floor_apart(result);
    if (is_drawn && own.has_all_bounces() && own.is_room())
        own.add_sent(result, bounced(*this));
    if (own.receivers.are_in_others()) {
        own.gather(result);
        if (!own.receivers.is_first())
            return {};
    } else if (own.relighter) {
        result.arriving = own.relighter->diffuse_radiance();
    }
    if (!own.has_environment())
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
    return has_clusters(lit.scene()) && lit.relighter().environment().resolution != 0;
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
