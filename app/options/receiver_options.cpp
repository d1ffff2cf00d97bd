#include "app/options/receiver_options.h"

#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace relumine::app {

Report layout_json(const prt::Scene& scene) {
    const auto num_receivers = static_cast<double>(scene.receivers.num_own());
    if (const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout))
        return {{"kind", "pixels"},
                {"width", pixels->width},
                {"height", pixels->height},
                {"samples_per_axis", pixels->samples_per_axis},
                {"eye", pixels->camera.eye},
                {"target", pixels->camera.target},
                {"fov", pixels->camera.fov_degrees},
                {"coverage", num_receivers / static_cast<double>(pixels->num_samples())}};
    if (const auto* texels = std::get_if<prt::TexelLayout>(&scene.layout))
        return {{"kind", "texels"},
                {"width", texels->width},
                {"height", texels->height},
                {"coverage", num_receivers / static_cast<double>(texels->num_texels())}};
    return {};
}

Report atlas_json(const prt::AtlasReport& atlas, const prt::TexelLayout& texels) {
    Report report = {{"texels_overlapping", atlas.num_overlapping},
                     {"texels_on_borders", atlas.num_borders},
                     {"triangles_outside", atlas.num_outside},
                     {"triangles_flat_in_uv", atlas.num_flat}};
    if (atlas.num_overlapping > 0)
        report.set("first_overlap", std::vector<Report>{atlas.first_overlap % texels.width,
                                                        atlas.first_overlap / texels.width});
    return report;
}

void require_vertices(const prt::Scene& scene, const std::string& path) {
    if (!std::holds_alternative<prt::VertexLayout>(scene.layout))
        throw std::runtime_error(
            fmt::format("{}: expected a scene whose receivers are vertices, got {}", path,
                        prt::description(scene.layout)));
}

void require_diffuse(const prt::Scene& scene, const std::string& path) {
    if (!scene.receivers.surfaces.empty())
        throw std::runtime_error(fmt::format(
            "{}: expected a scene without materials (highlights or albedo), as lights are chosen "
            "for plain white surfaces",
            path));
}

} // namespace relumine::app
