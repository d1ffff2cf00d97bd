#include "relumine/light/lit_part.h"

#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/hash.h"
#include "prt/parts/scene_part.h"
#include "relight/pictures/array_file.h"
#include "relumine/light/lit_scene.h"

namespace relumine {

namespace {

prt::LitPart lit(const LitPartOptions& options, cubemap::CubeMap environment,
                 UpdateReport& report) {
    prt::ScenePart part = prt::load_scene_part(options.scene, options.part);
    if (part.bounces && !options.is_direct)
        throw std::runtime_error(fmt::format(
            "{}: expected a scene without bounces for parts that know nothing of each other, got "
            "one with; its direct light alone may be lit in parts (--bounces 0)",
            options.scene.string()));
    const std::size_t num_receivers = part.scene.receivers.size();
    prt::LitPart lit{.part = options.part,
                     .num_receivers = static_cast<std::uint32_t>(num_receivers),
                     .light =
                         fmt::format("{:016x} {:016x} {}", files::file_hash(options.scene),
                                     files::hash_of(std::as_bytes(std::span(environment.texels))),
                                     options.clusters_only ? "clusters" : "rays")};
    lit.receivers = part.receivers;
    prt::Alone alone(options.part);
    LitScene own(std::move(part), {.clusters_only = options.clusters_only, .team = &alone});
    report = own.light(std::move(environment));
    lit.radiance.assign(own.radiance().begin(), own.radiance().end());
    return lit;
}

} // namespace

UpdateReport light_part(const LitPartOptions& options, cubemap::CubeMap environment,
                        std::size_t* num_receivers) {
    UpdateReport report;
    const prt::LitPart part = lit(options, std::move(environment), report);
    if (num_receivers != nullptr)
        *num_receivers = part.receivers.size();
    prt::save_lit_part(options.output, part);
    return report;
}

std::size_t join_light(std::span<const std::filesystem::path> parts,
                       const std::filesystem::path& output) {
    const std::vector<glm::vec3> radiance = prt::join_lit_parts(parts);
    relight::save_npy(output, radiance);
    return radiance.size();
}

} // namespace relumine
