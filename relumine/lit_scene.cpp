#include "relumine/lit_scene.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/layers/layer_composite.h"
#include "prt/visibility/lazy_beam_scene.h"
#include "relight/contribution.h"
#include "relight/reference/path_tracer.h"
#include "relight/sharp/shadow_rays.h"
#include "relumine/shared_slices.h"

namespace relumine {

relight::SurfaceBounces bounces_of(const Scene& scene, std::span<const glm::vec3> albedo,
                                   const BounceLimits& limits) {
    if (!scene.bounces)
        throw std::invalid_argument("expected a scene with bounces, got one without");
    relight::SurfaceBounces bounces{
        .matrix = &*scene.bounces, .albedo = {albedo.begin(), albedo.end()}, .limits = limits};
    const std::vector<prt::Surface>& surfaces = scene.receivers.surfaces;
    if (surfaces.size() == bounces.albedo.size())
        for (std::size_t i = 0; i < surfaces.size(); ++i)
            bounces.albedo[i] *= surfaces[i].albedo;
    return bounces;
}

namespace {

/// The pixels of an environment's file as a backdrop, made when it is first drawn: to resample
/// pictures of faces takes as long as to light a scene.
class FileBackdrop {
public:
    FileBackdrop() = default;
    explicit FileBackdrop(cubemap::EnvironmentFile file) : state_(std::make_shared<State>()) {
        state_->file = std::move(file);
    }
    /// Returns the backdrop; empty without a file.
    [[nodiscard]] relight::Backdrop get() const {
        if (!state_)
            return {};
        std::call_once(state_->once,
                       [&] { state_->backdrop = relight::backdrop_of(state_->file); });
        return state_->backdrop;
    }

private:
    struct State {
        cubemap::EnvironmentFile file;
        std::once_flag once;
        relight::Backdrop backdrop;
    };
    std::shared_ptr<State> state_;
};

} // namespace

struct LitScene::Impl {
    Impl(std::shared_ptr<const Scene>&& given, const LightOptions& options)
        : owned_scene(std::move(given)), scene(*owned_scene), rays(scene.mesh),
          clusters_only(options.clusters_only) {
        if (scene.blockers)
            others.emplace(*scene.blockers);
        moving_light_rays.emplace(scene.blockers ? *scene.blockers : scene.mesh, blockers());
    }

    [[nodiscard]] const prt::RayScene& blockers() const { return others ? *others : rays; }

    [[nodiscard]] bool has_clusters() const { return scene.transfer.num_receivers() != 0; }

    [[nodiscard]] relight::ShadowRays shadow_rays() const {
        if (clusters_only)
            return {};
        return {.blockers = &*moving_light_rays,
                .positions = scene.receivers.positions,
                .bias = scene.settings.bias,
                .tolerance = rms_tolerance(scene)};
    }

    /// Of sharp lights; 0 where they are not traced.
    [[nodiscard]] float sharp_tolerance() const {
        return clusters_only ? 0.0f : rms_tolerance(scene);
    }

    void require_clusters() const {
        if (!has_clusters())
            throw std::invalid_argument(
                "expected a precomputed scene, got a mesh without clusters");
    }

    relight::Relighter& plain_relighter() {
        require_clusters();
        if (!relighter)
            relighter.emplace(scene.transfer, shadow_rays());
        return *relighter;
    }

    [[nodiscard]] const relight::Relighter* present_relighter() const {
        if (editor)
            return &editor->relighter();
        return relighter ? &*relighter : nullptr;
    }

    [[nodiscard]] bool has_environment() const {
        return present_relighter() != nullptr && present_relighter()->environment().resolution != 0;
    }

    /// For what only an environment can do.
    const relight::Relighter& lit_relighter() const {
        if (!has_environment())
            throw std::logic_error("expected a scene lit by an environment");
        return *present_relighter();
    }

    /// The editor takes over what lights the scene.
    relight::LightEditor& edited() {
        require_clusters();
        if (editor)
            return *editor;
        auto made = std::make_unique<relight::LightEditor>(scene.transfer, shadow_rays());
        if (has_environment())
            made->set_base(relighter->environment());
        if (relighter && !relighter->bounced().empty()) {
            made->set_bounces(relighter->bounces());
            made->settle();
        }
        editor = std::move(made);
        relighter.reset();
        file = {};
        is_lit_by_list = false;
        return *editor;
    }

    /// Adds the bounces of a path tracer to exact direct light. Returns the standard error of the
    /// sum, relative to it, L2 over the receivers.
    double add_traced(std::span<const std::uint32_t> receivers, const VerifyOptions& options,
                      std::vector<glm::dvec3>& exact) const {
        const std::vector<glm::vec3> albedo_of_vertices =
            prt::vertex_values(scene.mesh, scene.receivers, lit_relighter().bounces().albedo);
        const auto traced = in_slices<relight::TracedBounces>(
            options.reduction, receivers, [&](std::span<const std::uint32_t> slice) {
                return relight::trace_bounces(scene.mesh, albedo_of_vertices, scene.receivers,
                                              slice, rays, lit_relighter().environment(),
                                              {.num_paths = options.num_paths,
                                               .seed = options.seed,
                                               .two_sided = scene.settings.two_sided_bounces,
                                               .bias = scene.settings.bias,
                                               .stop = options.stop,
                                               .on_progress = options.on_progress});
            });
        double errors = 0.0, all = 0.0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            const glm::dvec3 albedo =
                scene.receivers.surfaces.empty()
                    ? glm::dvec3(1.0)
                    : glm::dvec3(scene.receivers.surfaces[receivers[i]].albedo);
            const glm::dvec3 error = albedo * traced[i].standard_error;
            exact[i] += albedo * traced[i].radiance;
            errors += glm::dot(error, error);
            all += glm::dot(exact[i], exact[i]);
        }
        return all > 0.0 ? std::sqrt(errors / all) : 0.0;
    }

    /// What the vertices interpolate against exact integration, at random points between them.
    [[nodiscard]] std::optional<Verification::Surface>
    verify_surface(const VerifyOptions& options) const {
        Verification::Surface result{
            .points = prt::random_points(scene.mesh, options.num_surface_points, options.seed),
            .error = {}};
        if (result.points.empty())
            return std::nullopt;
        const std::span<const glm::vec3> at_vertices = lit_relighter().diffuse_radiance();
        prt::Receivers receivers;
        std::vector<std::uint32_t> indices;
        std::vector<glm::vec3> interpolated;
        for (const prt::MeshPoint& point : result.points) {
            indices.push_back(static_cast<std::uint32_t>(indices.size()));
            receivers.positions.push_back(prt::smooth_position(scene.mesh, point));
            receivers.normals.push_back(prt::shading_normal(scene.mesh, point));
            interpolated.push_back(prt::value_at(scene.mesh, at_vertices, point));
        }
        const relight::ExactOptions exact_options{.bias = scene.settings.bias,
                                                  .stop = options.stop};
        const auto exact = in_slices<glm::dvec3>(
            options.reduction, std::span<const std::uint32_t>(indices),
            [&](std::span<const std::uint32_t> slice) {
                return file.image != nullptr
                           ? relight::exact_radiance(receivers, slice, blockers(), file,
                                                     exact_options)
                           : relight::exact_radiance(receivers, slice, blockers(),
                                                     lit_relighter().environment(), exact_options);
            });
        result.error = relight::compare(indices, exact, interpolated);
        return result;
    }

    std::shared_ptr<const Scene> owned_scene;
    const Scene& scene;
    prt::RayScene rays;
    /// Of the scene's own blockers
    std::optional<prt::RayScene> others;
    /// Of sharp lights, which may move with every frame
    std::optional<prt::LazyBeamScene> moving_light_rays;
    bool clusters_only;
    /// One of the two lights the scene; none before the first light()
    std::optional<relight::Relighter> relighter;
    std::unique_ptr<relight::LightEditor> editor;
    /// What the environment was made from, while nothing has changed it
    cubemap::EnvironmentFile file;
    /// Behind light lists
    cubemap::CubeMap black{1};
    cubemap::CubeMap nothing;
    bool is_lit_by_list = false;
    /// The pixels of the environment that was given to light(). Empty: there are none, or the
    /// environment has changed without a layer.
    FileBackdrop sharp;
    /// Of a scene without clusters
    std::vector<glm::vec3> radiance;
    std::vector<lights::DistantLight> list;
};

LitScene::LitScene(Scene scene, const LightOptions& options)
    : LitScene(std::make_shared<const Scene>(std::move(scene)), options) {}

LitScene::LitScene(std::shared_ptr<const Scene> scene, const LightOptions& options)
    : impl_(std::make_unique<Impl>(std::move(scene), options)) {
    const Scene& own = impl_->scene;
    if (has_clusters() && own.receivers.size() != own.transfer.num_receivers())
        throw std::invalid_argument(fmt::format("expected the transfer of {} receivers, got {}",
                                                own.receivers.size(),
                                                own.transfer.num_receivers()));
    if (options.clusters_only)
        impl_->require_clusters();
}

LitScene::~LitScene() = default;
LitScene::LitScene(LitScene&&) noexcept = default;
LitScene& LitScene::operator=(LitScene&&) noexcept = default;

const Scene& LitScene::scene() const {
    return impl_->scene;
}

bool LitScene::has_clusters() const {
    return impl_->has_clusters();
}

const prt::RayScene& LitScene::rays() const {
    return impl_->rays;
}

const prt::RayScene& LitScene::blockers() const {
    return impl_->blockers();
}

relight::ShadowRays LitScene::shadow_rays() const {
    return impl_->shadow_rays();
}

RelightTimes LitScene::light(cubemap::CubeMap environment) {
    const RelightTimes times =
        impl_->editor ? impl_->editor->set_base(std::move(environment))
                      : impl_->plain_relighter().set_environment(std::move(environment));
    impl_->is_lit_by_list = false;
    impl_->sharp = {};
    impl_->file = {};
    return times;
}

RelightTimes LitScene::light(Environment environment) {
    const RelightTimes times = light(std::move(environment.map));
    impl_->sharp = FileBackdrop(environment.file);
    if (!impl_->editor)
        impl_->file = std::move(environment.file);
    return times;
}

UpdateReport LitScene::update(Environment environment) {
    const UpdateReport report = impl_->edited().update_base(std::move(environment.map));
    impl_->sharp = FileBackdrop(environment.file);
    return report;
}

BinnedEnvironment LitScene::bin(std::shared_ptr<const cubemap::CubeMap> environment) const {
    impl_->require_clusters();
    return relight::EnvironmentBinner(impl_->scene.transfer, impl_->sharp_tolerance())
        .bin(std::move(environment));
}

void LitScene::light(BinnedEnvironment environment, const cubemap::EnvironmentFile& file) {
    if (impl_->editor)
        impl_->editor->set_base(std::move(environment.map));
    else
        impl_->plain_relighter().set_frame(std::move(environment));
    impl_->is_lit_by_list = false;
    impl_->sharp = FileBackdrop(file);
}

RelightTimes LitScene::light(std::span<const lights::DistantLight> lights) {
    RelightTimes times;
    if (!has_clusters()) {
        impl_->radiance =
            relight::radiance_under(lights, impl_->scene.receivers.normals, shadow_rays());
        impl_->list.assign(lights.begin(), lights.end());
    } else {
        times = impl_->plain_relighter().set_lights(lights);
        impl_->editor.reset();
    }
    impl_->is_lit_by_list = true;
    impl_->file = {};
    return times;
}

UpdateReport LitScene::update_region(const cubemap::TexelRectangle& rectangle,
                                     std::span<const glm::vec3> radiance) {
    impl_->sharp = {};
    if (!impl_->editor) {
        const UpdateReport report = impl_->plain_relighter().update_region(rectangle, radiance);
        impl_->file = {};
        return report;
    }
    if (!impl_->has_environment())
        throw std::invalid_argument("expected an environment before its first update");
    cubemap::CubeMap base = *impl_->editor->base();
    const std::uint32_t r = base.resolution;
    if (rectangle.x0 >= rectangle.x1 || rectangle.y0 >= rectangle.y1 || rectangle.x1 > r ||
        rectangle.y1 > r)
        throw std::invalid_argument(
            fmt::format("expected a rectangle inside the {0} x {0} face", r));
    const std::size_t width = rectangle.x1 - rectangle.x0;
    if (radiance.size() != width * (rectangle.y1 - rectangle.y0))
        throw std::invalid_argument("expected one radiance per texel of the rectangle");
    auto value = radiance.begin();
    for (std::uint32_t y = rectangle.y0; y < rectangle.y1; ++y)
        for (std::uint32_t x = rectangle.x0; x < rectangle.x1; ++x)
            base.at(rectangle.face, x, y) = *value++;
    return impl_->editor->update_base(std::move(base));
}

UpdateReport LitScene::set_layers(std::vector<cubemap::LightLayer> layers) {
    if (!impl_->has_environment())
        throw std::invalid_argument("expected an environment before its layers");
    return impl_->edited().set_layers(std::move(layers));
}

UpdateReport LitScene::set_layer(std::size_t index, const cubemap::LightLayer& layer) {
    if (!impl_->has_environment())
        throw std::invalid_argument("expected an environment before its layers");
    return impl_->edited().set_layer(index, layer);
}

relight::LightEditor& LitScene::editor() {
    return impl_->edited();
}

std::span<const glm::vec3> LitScene::radiance() const {
    const relight::Relighter* lit = impl_->present_relighter();
    if (lit != nullptr && (impl_->is_lit_by_list || impl_->has_environment()))
        return lit->radiance();
    return impl_->radiance;
}

BounceReport LitScene::bounce(std::span<const glm::vec3> albedo, const BounceLimits& limits,
                              std::span<const glm::vec3> more) {
    relight::SurfaceBounces bounces = bounces_of(impl_->scene, albedo, limits);
    if (radiance().empty())
        throw std::logic_error("expected a scene that is lit");
    if (impl_->editor) {
        impl_->editor->set_bounces(std::move(bounces));
        return impl_->editor->settle(more);
    }
    impl_->relighter->set_bounces(std::move(bounces));
    return impl_->relighter->bounce(more);
}

std::span<const glm::vec3> LitScene::bounced() const {
    const relight::Relighter* lit = impl_->present_relighter();
    return lit == nullptr ? std::span<const glm::vec3>() : lit->bounced();
}

const cubemap::CubeMap& LitScene::environment() const {
    if (impl_->is_lit_by_list)
        return impl_->black;
    return impl_->has_environment() ? impl_->present_relighter()->environment() : impl_->nothing;
}

const relight::Relighter& LitScene::relighter() const {
    const relight::Relighter* relighter = impl_->present_relighter();
    if (relighter == nullptr)
        throw std::logic_error("expected a scene that is lit");
    return *relighter;
}

Verification LitScene::verify(const VerifyOptions& options) const {
    const relight::Relighter& relighter = impl_->lit_relighter();
    Verification result;
    result.receivers = relight::random_receivers(impl_->scene.transfer, options.num_samples,
                                                 options.seed, impl_->scene.receivers.num_own());
    const relight::ExactOptions exact_options{.bias = impl_->scene.settings.bias,
                                              .stop = options.stop,
                                              .on_progress = options.on_progress};
    const auto exact_under = [&](const auto& light) {
        return in_slices<glm::dvec3>(
            options.reduction, std::span<const std::uint32_t>(result.receivers),
            [&](std::span<const std::uint32_t> slice) {
                return relight::exact_radiance(impl_->scene.receivers, slice, impl_->blockers(),
                                               light, exact_options);
            });
    };
    result.of_file = impl_->file.image != nullptr;
    std::vector<glm::dvec3> exact =
        result.of_file ? exact_under(impl_->file) : exact_under(relighter.environment());
    if (!bounced().empty())
        result.noise = impl_->add_traced(result.receivers, options, exact);
    result.error = relight::compare(result.receivers, exact, radiance());
    if (options.num_surface_points != 0 && prt::on_vertices(impl_->scene.layout))
        result.surface = impl_->verify_surface(options);
    return result;
}

cubemap::CubeMap LitScene::contribution_map(std::span<const std::uint32_t> receivers) const {
    return relight::contribution_map(impl_->lit_relighter(), receivers);
}

Share LitScene::lit_by(const cubemap::Region& region) const {
    const auto sum_of = [](std::span<const glm::vec3> radiance) {
        double sum = 0.0;
        for (const glm::vec3& value : radiance)
            sum += static_cast<double>(value.r) + static_cast<double>(value.g) +
                   static_cast<double>(value.b);
        return sum;
    };
    const relight::Relighter& relighter = impl_->lit_relighter();
    cubemap::validate(region);
    Share result{.radiance = {}, .environment = relighter.environment()};
    const std::vector<float> weights = cubemap::coverage_map(region, result.environment.resolution);
    for (std::size_t texel = 0; texel < weights.size(); ++texel)
        result.environment.texels[texel] *= weights[texel];
    const relight::Relighter part = relight::relit_by_part(relighter, weights);
    Lighting light = lighting_of(part);
    result.radiance.assign(light.radiance.begin(), light.radiance.end());
    result.lights = std::move(light.lights);
    result.soft = std::move(light.soft);
    const double all = sum_of(relighter.radiance());
    result.share = all > 0.0 ? sum_of(result.radiance) / all : 0.0;
    return result;
}

Lighting Share::lighting() const {
    return {.radiance = radiance, .environment = &environment, .lights = lights, .soft = soft};
}

Lighting LitScene::lighting() const {
    if (radiance().empty())
        throw std::logic_error("expected a scene that is lit");
    Lighting result;
    if (const relight::Relighter* relighter = impl_->present_relighter()) {
        result = lighting_of(*relighter);
    } else {
        for (const lights::DistantLight& light : impl_->list)
            result.lights.push_back({.cluster = 0,
                                     .cell = {},
                                     .direction = light.direction,
                                     .irradiance = {.red = light.irradiance.r * light.direction,
                                                    .green = light.irradiance.g * light.direction,
                                                    .blue = light.irradiance.b * light.direction}});
        result.soft.resize(impl_->radiance.size());
    }
    result.radiance = radiance();
    relight::Backdrop sharp = impl_->sharp.get();
    if (result.environment == nullptr || !sharp)
        return result;
    if (!impl_->editor)
        result.sharp = std::move(sharp);
    else if (impl_->editor->rotation() == 0.0)
        result.sharp =
            relight::edited_backdrop(std::move(sharp), *impl_->editor->base(), *result.environment);
    return result;
}

Picture LitScene::draw(const OutputOptions& options) const {
    return Painter(*this, options).draw(lighting());
}

void LitScene::save(const std::filesystem::path& path, const OutputOptions& options) const {
    Painter(*this, options).save(path, lighting());
}

} // namespace relumine
