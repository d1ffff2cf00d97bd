#include "runtime/runtime_scene.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "relight/adjoint/contribution.h"
#include "relight/harmonics/harmonics.h"
#include "relight/radiance.h"
#include "relight/receiver_light.h"
#include "relight/visible_parts.h"

namespace relumine::runtime {

RuntimeScene::RuntimeScene(prt::RelightingScene given, std::uint32_t harmonics,
                           const CallerJobs& jobs)
    : jobs_(jobs), scene_(std::move(given.scene)), relighter_(scene_.transfer, {}, harmonics),
      has_harmonics_(harmonics != 0) {
    if (scene_.bounces && !given.albedo.empty())
        set_albedo(given.albedo);
}

std::size_t RuntimeScene::num_harmonics() const {
    return has_harmonics_ ? relight::num_harmonics(relighter_.receiver_light().harmonic_order())
                          : 0;
}

void RuntimeScene::light(cubemap::CubeMap map) {
    relighter_.set_environment(std::move(map));
    unturned_ = {};
    coarse_ = {};
    is_lit_ = true;
    has_bounced_ = false;
}

void RuntimeScene::light(std::span<const lights::DistantLight> lights) {
    relighter_.set_lights(lights);
    unturned_ = {};
    coarse_ = {};
    is_lit_ = true;
    has_bounced_ = false;
}

void RuntimeScene::turn(double degrees, std::uint32_t most_resolution) {
    require_environment();
    if (most_resolution == 0)
        throw std::invalid_argument("resolution: expected at least 1, got 0");
    const bool is_first = unturned_.resolution == 0;
    const cubemap::CubeMap* from = is_first ? &relighter_.environment() : &unturned_;
    const auto is_too_fine = [&](const cubemap::CubeMap& map) {
        return map.resolution > most_resolution && map.resolution % 2 == 0;
    };
    if (is_too_fine(*from)) {
        // The last one serves again unless it is too fine, or coarser than it need be.
        if (coarse_.resolution == 0 || is_too_fine(coarse_) ||
            2 * std::uint64_t{coarse_.resolution} <= most_resolution)
            coarse_ = cubemap::halved_to(*from, most_resolution);
        from = &coarse_;
    }
    cubemap::CubeMap turned = cubemap::rotated(*from, degrees);
    if (is_first)
        unturned_ = relighter_.environment();
    relighter_.set_environment(std::move(turned));
    has_bounced_ = false;
}

void RuntimeScene::update(const cubemap::TexelRectangle& rectangle,
                          std::span<const glm::vec3> radiance) {
    require_environment();
    relight::require_radiance(radiance);
    relighter_.update_regions(std::span(&rectangle, 1), [&](cubemap::CubeMap& map) {
        auto from = radiance.begin();
        for (std::uint32_t y = rectangle.y0; y != rectangle.y1; ++y)
            for (std::uint32_t x = rectangle.x0; x != rectangle.x1; ++x)
                map.at(rectangle.face, x, y) = *from++;
    });
}

void RuntimeScene::set_albedo(std::span<const glm::vec3> albedo) {
    if (!scene_.bounces)
        throw NotThere{"a scene made with bounces"};
    if (albedo.size() != scene_.receivers.size())
        throw NotThere{"an albedo for the vertices behind pixels and texels, too: a file of "
                       "`relumine export runtime` has it"};
    relight::BounceLight bounces(*scene_.bounces, scene_.transfer);
    bounces.set_albedo(albedo);
    bounces_.emplace(std::move(bounces));
    surface_bounces_ = {.matrix = &*scene_.bounces, .albedo = {albedo.begin(), albedo.end()}};
    has_bounced_ = false;
}

void RuntimeScene::bounce(const relight::BounceLimits& limits, bool is_step) {
    require_light();
    if (!scene_.bounces)
        throw NotThere{"a scene made with bounces"};
    if (!bounces_)
        throw NotThere{"an albedo: relumine_set_albedo() gives it, and a file of `relumine export "
                       "runtime` has it"};
    const std::span<const glm::vec3> direct = relighter_.diffuse_radiance();
    if (is_step)
        bounces_->step(direct);
    else
        bounces_->solve(direct, limits);
    surface_bounces_.limits = limits;
    has_bounced_ = true;
}

glm::vec3 RuntimeScene::radiance(std::size_t receiver) const {
    const glm::vec3 direct = relighter_.diffuse_radiance()[receiver];
    return has_bounced_ ? direct + bounces_->indirect()[receiver] : direct;
}

std::vector<glm::vec3> RuntimeScene::harmonics() const {
    require_light();
    if (!has_harmonics_)
        throw NotThere{"a scene opened with harmonics"};
    std::vector<glm::vec3> all = relighter_.harmonics();
    all.resize(num_receivers() * num_harmonics());
    return all;
}

void RuntimeScene::visible_parts(std::span<const glm::vec3> directions, float radius,
                                 std::span<std::uint8_t> parts) const {
    relight::VisibleParts(scene_.transfer, directions, radius).find(parts);
}

cubemap::CubeMap RuntimeScene::contribution(std::uint32_t receiver) const {
    require_environment();
    if (receiver >= num_receivers())
        throw std::invalid_argument(
            fmt::format("receiver: expected less than {}, got {}", num_receivers(), receiver));
    return relight::contribution_map(relighter_, {&receiver, 1},
                                     has_bounced_ ? &surface_bounces_ : nullptr);
}

void RuntimeScene::require_environment() const {
    require_light();
    if (relighter_.environment().resolution == 0)
        throw NotLit{"expected light of an environment, got a list of lights, which has no texels"};
}

void RuntimeScene::require_light() const {
    if (!is_lit_)
        throw NotLit();
}

} // namespace relumine::runtime
