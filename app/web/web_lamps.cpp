#include "app/web/web_lamps.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include "app/web/web_look.h"
#include "files/gzip.h"
#include "relumine/emission.h"
#include "relumine/lit_scene.h"
#include "relumine/receiver_colors.h"
#include "relumine/scene_bounces.h"

namespace relumine::app {

namespace {

constexpr float LargestHalf = 65504.0f;

/// Factors that leave one lamp.
std::vector<EmissionGain> only(const std::vector<std::string>& names, const std::string& shining) {
    std::vector<EmissionGain> gains;
    gains.reserve(names.size());
    for (const std::string& name : names)
        gains.push_back({.name = name, .gain = glm::vec3(name == shining ? 1.0f : 0.0f)});
    return gains;
}

std::vector<std::byte> halves(std::span<const glm::vec3> values) {
    std::vector<std::uint16_t> result;
    result.reserve(3 * values.size());
    for (const glm::vec3& value : values)
        for (const float channel : {value.x, value.y, value.z})
            result.push_back(glm::packHalf1x16(std::min(channel, LargestHalf)));
    const auto bytes = std::as_bytes(std::span(result));
    return {bytes.begin(), bytes.end()};
}

} // namespace

WebLamps web_lamps(const Scene& scene, Session& session) {
    WebLamps result;
    if (scene.lamps.empty())
        return result;
    const std::vector<glm::vec3> albedo = web_albedo(scene);
    // Without surfaces, radiance is for albedo 1.
    Scene plain = scene;
    plain.receivers.surfaces.clear();
    plain.transfer.surfaces.clear();
    plain.transfer.glossy.reset();
    LitScene lit(std::move(plain), {.clusters_only = true});
    lit.light(cubemap::CubeMap(1));
    if (scene.bounces)
        lit.bounce({.albedo = bounces_of(scene, bounce_albedo(scene)).albedo});
    const std::vector<std::string> names = scene.lamps.names();
    files::Json::Array list;
    for (const std::string& name : names) {
        session.poll();
        const std::vector<EmissionGain> gains = only(names, name);
        lit.dim(gains);
        std::vector<glm::vec3> light(lit.radiance().begin(), lit.radiance().end());
        light.resize(scene.receivers.num_own());
        const std::vector<glm::vec3> glow = emission_of(scene, gains);
        for (std::size_t i = 0; i < glow.size() && i < light.size(); ++i)
            light[i] += glow[i] / albedo[i];
        const std::string file = fmt::format("lamps/{}.bin.gz", list.size() + 1);
        result.files.push_back({file, files::gzipped(halves(light))});
        list.push_back({{"name", name.empty() ? std::string("Lamps") : name}, {"file", file}});
    }
    result.list = std::move(list);
    return result;
}

} // namespace relumine::app
