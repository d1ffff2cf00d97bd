#include "relumine/shared_light.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/hash.h"
#include "prt/clusters/dealt_tiles.h"
#include "prt/scene/scene_file.h"

namespace relumine {

namespace {

void require_same_hash(prt::Team& team, const std::filesystem::path& path, std::uint64_t own) {
    const std::vector<std::byte> bytes = prt::to_send(std::span(&own, 1));
    if (team.broadcast(bytes) != bytes)
        throw std::runtime_error(
            fmt::format("{}: expected the scene and the light of the first process, got others",
                        path.string()));
}

} // namespace

void require_same(prt::Team& team, const std::filesystem::path& path,
                  const cubemap::CubeMap* environment) {
    require_same_hash(team, path,
                      environment == nullptr
                          ? files::file_hash(path)
                          : files::hash_of(std::as_bytes(std::span(environment->texels))));
}

struct SharedLight::Impl {
    Impl(prt::Team& of_all, const std::filesystem::path& of_scene, prt::ScenePart&& part,
         const LightOptions& options)
        : team(of_all), path(of_scene), lit(std::move(part.scene), options),
          transfer(std::move(part.transfer)), positions(std::move(part.positions)),
          rows(std::move(part.bounces)), clusters_only(options.clusters_only) {
        require_same(team, path);
        places = prt::places_of(team.part(), lit.scene().transfer.num_receivers());
        const std::vector<prt::Surface>& surfaces = lit.scene().receivers.surfaces;
        transfer.surfaces.clear();
        if (!surfaces.empty())
            for (const std::uint32_t place : places)
                transfer.surfaces.push_back(surfaces[lit.scene().transfer.order[place]]);
        restart();
    }

    /// A process may have no receivers.
    void restart() {
        relighter.reset();
        if (places.empty())
            return;
        relight::ShadowRays rays;
        if (!clusters_only) {
            rays = lit.shadow_rays();
            rays.positions = positions;
        }
        relighter.emplace(transfer, rays);
    }

    /// The part's values by the receivers' order, in the first process.
    std::vector<glm::vec3> gathered(std::span<const glm::vec3> own) {
        const std::vector<std::vector<std::byte>> of_all = team.gather(prt::to_send(own));
        const std::vector<std::uint32_t>& order = lit.scene().transfer.order;
        std::vector<glm::vec3> values;
        for (std::uint32_t process = 0; process < of_all.size(); ++process) {
            const std::vector<std::byte>& bytes = of_all[process];
            if (bytes.empty())
                continue;
            values.resize(order.size());
            const std::vector<std::uint32_t> of_process =
                prt::places_of({process, team.part().count}, order.size());
            if (bytes.size() != of_process.size() * sizeof(glm::vec3))
                throw std::runtime_error("expected the light of all receivers");
            for (std::size_t i = 0; i < of_process.size(); ++i)
                std::memcpy(&values[order[of_process[i]]], bytes.data() + i * sizeof(glm::vec3),
                            sizeof(glm::vec3));
        }
        return values;
    }

    /// The diffuse light of all receivers, in all processes.
    std::vector<glm::vec3> diffuse_of_all() {
        const prt::Transfer& whole = lit.scene().transfer;
        std::vector<glm::vec3> by_place(whole.num_receivers());
        if (relighter)
            for (std::size_t i = 0; i < places.size(); ++i)
                by_place[places[i]] = relighter->diffuse_radiance()[i];
        prt::share_by_place(team, std::span(by_place));
        std::vector<glm::vec3> diffuse(by_place.size());
        for (std::size_t place = 0; place < by_place.size(); ++place)
            diffuse[whole.order[place]] = by_place[place];
        return diffuse;
    }

    BounceReport bounce(std::span<const glm::vec3> more) {
        if (!bounce_light)
            return {};
        bounced.clear();
        std::vector<glm::vec3> direct = diffuse_of_all();
        if (!more.empty()) {
            if (more.size() != direct.size())
                throw std::invalid_argument(fmt::format(
                    "expected the light of {} receivers, got {}", direct.size(), more.size()));
            std::transform(direct.begin(), direct.end(), more.begin(), direct.begin(),
                           std::plus<>());
        }
        const BounceReport report = bounce_light->solve(direct, limits);
        const std::span<const glm::vec3> indirect = bounce_light->indirect();
        bounced.assign(indirect.begin(), indirect.end());
        const std::vector<prt::Surface>& surfaces = lit.scene().receivers.surfaces;
        for (std::size_t i = 0; i < surfaces.size(); ++i)
            bounced[i] *= surfaces[i].albedo;
        return report;
    }

    void add_bounced(std::vector<glm::vec3>& values) const {
        if (!values.empty() && !bounced.empty())
            std::transform(values.begin(), values.end(), bounced.begin(), values.begin(),
                           std::plus<>());
    }

    Lighting lighting() {
        std::span<const relight::SharpLight> lights;
        if (relighter)
            lights = relight::picture_lights(*relighter);
        radiance = gathered(relighter ? relighter->radiance() : std::span<const glm::vec3>());
        std::vector<glm::vec3> own_soft;
        if (!lights.empty())
            own_soft = relighter->soft_radiance();
        std::vector<glm::vec3> soft = gathered(own_soft);
        if (team.part().index != 0)
            return {};
        add_bounced(radiance);
        add_bounced(soft);
        Lighting result{.radiance = radiance};
        if (relighter->environment().resolution != 0)
            result.environment = &relighter->environment();
        if (!lights.empty()) {
            result.lights.assign(lights.begin(), lights.end());
            result.soft = std::move(soft);
        }
        return result;
    }

    prt::Team& team;
    std::filesystem::path path;
    LitScene lit;
    /// Of the part's receivers by themselves.
    prt::Transfer transfer;
    std::vector<glm::vec3> positions;
    std::optional<prt::SharedBounces> rows;
    bool clusters_only;
    /// [receivers of the part]
    std::vector<std::uint32_t> places;
    std::optional<relight::Relighter> relighter;
    std::optional<relight::BounceLight> bounce_light;
    BounceLimits limits;
    /// Of all receivers.
    std::vector<glm::vec3> bounced;
    std::vector<glm::vec3> radiance;
};

SharedLight::SharedLight(prt::Team& team, const std::filesystem::path& path, prt::ScenePart&& part,
                         const LightOptions& options)
    : impl_(std::make_unique<Impl>(team, path, std::move(part), options)) {}
SharedLight::~SharedLight() = default;
SharedLight::SharedLight(SharedLight&&) noexcept = default;
SharedLight& SharedLight::operator=(SharedLight&&) noexcept = default;

const LitScene& SharedLight::lit() const {
    return impl_->lit;
}
bool SharedLight::is_first() const {
    return impl_->team.part().index == 0;
}
prt::Team& SharedLight::team() const {
    return impl_->team;
}

RelightTimes SharedLight::light(cubemap::CubeMap environment) {
    require_same(impl_->team, impl_->path, &environment);
    impl_->bounced.clear();
    return impl_->relighter ? impl_->relighter->set_environment(std::move(environment))
                            : RelightTimes();
}

UpdateReport SharedLight::set_frame(BinnedEnvironment frame, double bound) {
    require_same(impl_->team, impl_->path, frame.map.get());
    impl_->bounced.clear();
    return impl_->relighter ? impl_->relighter->set_frame(std::move(frame), bound) : UpdateReport();
}

RelightTimes SharedLight::set_lights(std::span<const lights::DistantLight> lights) {
    require_same_hash(impl_->team, impl_->path, files::hash_of(std::as_bytes(lights)));
    impl_->bounced.clear();
    return impl_->relighter ? impl_->relighter->set_lights(lights) : RelightTimes();
}

void SharedLight::restart() {
    impl_->restart();
}

void SharedLight::set_bounces(const relight::SurfaceBounces& bounces) {
    if (!impl_->rows)
        throw std::invalid_argument("expected a scene with bounces, got one without");
    impl_->limits = bounces.limits;
    if (!impl_->bounce_light)
        impl_->bounce_light.emplace(*impl_->lit.scene().bounces, impl_->lit.scene().transfer,
                                    relight::SharedRows{.reduction = &impl_->team,
                                                        .first = impl_->rows->first,
                                                        .num_emitters = impl_->rows->num_emitters});
    impl_->bounce_light->set_albedo(bounces.albedo);
}

BounceReport SharedLight::bounce(std::span<const glm::vec3> more) {
    return impl_->bounce(more);
}

std::vector<glm::vec3> SharedLight::diffuse_radiance() {
    return impl_->diffuse_of_all();
}

Lighting SharedLight::lighting() {
    return impl_->lighting();
}

std::span<const glm::vec3> SharedLight::bounced() const {
    return impl_->bounced;
}

} // namespace relumine
