#include "app/web/web_lamps.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include "app/web/web_look.h"
#include "files/gzip.h"
#include "files/pixel_values.h"
#include "relumine/in/emission.h"
#include "relumine/light/bounces.h"
#include "relumine/light/lit_scene.h"
#include "relumine/light/live_eye.h"
#include "relumine/out/receiver_colors.h"

namespace relumine::app {

namespace {

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
            result.push_back(glm::packHalf1x16(std::min(channel, files::LargestHalf)));
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
    const std::vector<std::string> names = scene.lamps.names();
    const auto light_of = [&](const std::string& name) {
        session.poll();
        lit.dim(only(names, name));
        std::vector<glm::vec3> light(lit.radiance().begin(), lit.radiance().end());
        light.resize(scene.receivers.num_own());
        return light;
    };
    std::vector<std::vector<glm::vec3>> direct;
    direct.reserve(names.size());
    for (const std::string& name : names)
        direct.push_back(light_of(name));
    if (scene.bounces)
        lit.bounce({.albedo = bounces_of(scene, bounce_albedo(scene)).albedo});

    // What shines has a colour that is not what its light is multiplied with, so glow is apart.
    const bool is_apart = has_live_highlights(scene);
    std::optional<Scene> glowing;
    if (is_apart)
        glowing = with_page_glow(scene);
    files::Json::Array list;
    for (std::size_t lamp = 0; lamp < names.size(); ++lamp) {
        const std::string& name = names[lamp];
        const std::string stem = fmt::format("lamps/{}", lamp + 1);
        files::Json entry = {{"name", name.empty() ? std::string("Lamps") : name},
                             {"file", stem + ".bin.gz"}};
        if (scene.bounces) {
            std::vector<glm::vec3> bounced = light_of(name);
            for (std::size_t i = 0; i < bounced.size(); ++i)
                bounced[i] = glm::max(bounced[i] - direct[lamp][i], glm::vec3(0.0f));
            entry.set("bounced", stem + "_bounced.bin.gz");
            result.files.push_back({stem + "_bounced.bin.gz", files::gzipped(halves(bounced))});
        }
        std::vector<glm::vec3> glow = emission_of(is_apart ? *glowing : scene, only(names, name));
        if (is_apart && std::any_of(glow.begin(), glow.end(),
                                    [](const glm::vec3& own) { return own != glm::vec3(0.0f); })) {
            glow.resize(scene.receivers.num_own());
            entry.set("glow", stem + "_glow.bin.gz");
            result.files.push_back({stem + "_glow.bin.gz", files::gzipped(halves(glow))});
        }
        if (is_apart)
            glow.clear();
        for (std::size_t i = 0; i < glow.size() && i < direct[lamp].size(); ++i)
            direct[lamp][i] += glow[i] / albedo[i];
        result.files.push_back({stem + ".bin.gz", files::gzipped(halves(direct[lamp]))});
        list.push_back(std::move(entry));
    }
    result.list = std::move(list);
    return result;
}

} // namespace relumine::app
