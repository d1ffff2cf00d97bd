#include "relumine/lit_part.h"

#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/hash.h"
#include "prt/parts/scene_part.h"
#include "prt/tolerance.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/array_file.h"

namespace relumine {

namespace {

prt::LitPart lit(const LitPartOptions& options, cubemap::CubeMap environment,
                 relight::RelightTimes& times) {
    prt::ScenePart part = prt::load_scene_part(options.scene, options.part);
    if (part.bounces)
        throw std::runtime_error(fmt::format(
            "{}: expected a scene without bounces for parts that know nothing of each other, got "
            "one with",
            options.scene.string()));
    const std::size_t num_receivers = part.scene.receivers.size();
    prt::LitPart lit{.part = options.part,
                     .num_receivers = static_cast<std::uint32_t>(num_receivers),
                     .light =
                         fmt::format("{:016x} {:016x} {}", files::file_hash(options.scene),
                                     files::hash_of(std::as_bytes(std::span(environment.texels))),
                                     options.clusters_only ? "clusters" : "rays")};
    const prt::Scene& scene = part.scene;
    if (!part.receivers.empty()) {
        const prt::RayScene rays(scene.blockers ? *scene.blockers : scene.mesh);
        const prt::SceneSettings& settings = scene.settings;
        relight::ShadowRays shadow_rays;
        if (!options.clusters_only)
            shadow_rays = {.blockers = &rays,
                           .positions = part.positions,
                           .bias = settings.bias,
                           .tolerance = prt::rms_tolerance(settings.tolerance, settings.epsilon,
                                                           num_receivers)};
        relight::Relighter relighter(part.transfer, shadow_rays);
        times = relighter.set_environment(std::move(environment));
        lit.radiance.assign(relighter.radiance().begin(), relighter.radiance().end());
    }
    lit.receivers = std::move(part.receivers);
    return lit;
}

} // namespace

relight::RelightTimes light_part(const LitPartOptions& options, cubemap::CubeMap environment,
                                 std::size_t* num_receivers) {
    relight::RelightTimes times;
    const prt::LitPart part = lit(options, std::move(environment), times);
    if (num_receivers != nullptr)
        *num_receivers = part.receivers.size();
    prt::save_lit_part(options.output, part);
    return times;
}

std::size_t join_light(std::span<const std::filesystem::path> parts,
                       const std::filesystem::path& output) {
    const std::vector<glm::vec3> radiance = prt::join_lit_parts(parts);
    relight::save_npy(output, radiance);
    return radiance.size();
}

} // namespace relumine
