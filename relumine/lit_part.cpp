#include "relumine/lit_part.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "prt/parts/scene_part.h"
#include "prt/tolerance.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/array_file.h"

namespace relumine {

namespace {

prt::LitPart lit(const LitPartOptions& options, cubemap::CubeMap environment,
                 relight::RelightTimes& times) {
    prt::ScenePart part = prt::load_scene_part(options.scene, options.part);
    prt::LitPart lit{.part = options.part,
                     .num_receivers = static_cast<std::uint32_t>(part.num_receivers),
                     .light =
                         fmt::format("{:016x} {:016x} {}", prt::file_hash(options.scene),
                                     prt::bytes_hash(std::as_bytes(std::span(environment.texels))),
                                     options.clusters_only ? "clusters" : "rays")};
    const prt::Scene& scene = part.scene;
    if (!part.receivers.empty()) {
        const prt::RayScene rays(scene.blockers ? *scene.blockers : scene.mesh);
        const prt::SceneSettings& settings = scene.settings;
        relight::ShadowRays shadow_rays;
        if (!options.clusters_only)
            shadow_rays = {.blockers = &rays,
                           .positions = scene.receivers.positions,
                           .bias = settings.bias,
                           .tolerance = prt::rms_tolerance(settings.tolerance, settings.epsilon,
                                                           part.num_receivers)};
        relight::Relighter relighter(scene.transfer, shadow_rays);
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

std::size_t light_shared(prt::Team& team, const LitPartOptions& options,
                         cubemap::CubeMap environment) {
    LitPartOptions of_process = options;
    of_process.part = team.part();
    relight::RelightTimes times;
    const prt::LitPart own = lit(of_process, std::move(environment), times);
    const auto bytes_of = [](const auto& elements) {
        const auto bytes = std::as_bytes(std::span(elements));
        return std::vector<std::byte>(bytes.begin(), bytes.end());
    };
    const std::vector<std::byte> light = bytes_of(own.light);
    if (team.broadcast(light) != light)
        throw std::runtime_error(fmt::format(
            "{}: expected the scene and the environment of the first process, got others",
            options.scene.string()));
    const std::vector<std::vector<std::byte>> receivers = team.gather(bytes_of(own.receivers));
    const std::vector<std::vector<std::byte>> radiance = team.gather(bytes_of(own.radiance));
    std::vector<glm::vec3> of_all(receivers.empty() ? 0 : own.num_receivers);
    for (std::size_t process = 0; process < receivers.size(); ++process)
        for (std::size_t i = 0; i < receivers[process].size() / sizeof(std::uint32_t); ++i) {
            std::uint32_t receiver = 0;
            std::memcpy(&receiver, receivers[process].data() + i * sizeof receiver,
                        sizeof receiver);
            std::memcpy(&of_all.at(receiver), radiance[process].data() + i * sizeof(glm::vec3),
                        sizeof(glm::vec3));
        }
    if (team.part().index == 0)
        relight::save_npy(options.output, of_all);
    return own.num_receivers;
}

std::size_t join_light(std::span<const std::filesystem::path> parts,
                       const std::filesystem::path& output) {
    const std::vector<glm::vec3> radiance = prt::join_lit_parts(parts);
    relight::save_npy(output, radiance);
    return radiance.size();
}

} // namespace relumine
