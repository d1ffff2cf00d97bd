#include "relumine/light/harmonics_file.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/luminance.h"
#include "files/extension.h"
#include "files/json.h"
#include "files/output_file.h"
#include "relight/harmonics/harmonics.h"
#include "relight/pictures/array_file.h"
#include "relight/pictures/layered_picture.h"
#include "relight/pictures/receiver_picture.h"
#include "relumine/in/place_report.h"

namespace relumine {

namespace {

/// Makes a picture of values of the receivers: how it is shown is its alpha.
relight::Picture picture_of(const Scene& scene, std::span<const glm::vec3> values) {
    const std::span<const glm::vec3> own = values.first(scene.receivers.num_own());
    if (const auto* texels = std::get_if<prt::TexelLayout>(&scene.layout))
        return relight::compose(*texels, own);
    if (const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout))
        return relight::compose_cut_out(*pixels, own);
    if (const auto* points = std::get_if<prt::PointLayout>(&scene.layout))
        return relight::compose_rows(points->grid(), own);
    return relight::compose_rows(std::get<prt::GridLayout>(scene.layout).grid(), own);
}

/// Every count-th value, from `first` on.
std::vector<glm::vec3> coefficient(std::span<const glm::vec3> light, std::size_t first,
                                   std::size_t count) {
    std::vector<glm::vec3> values;
    values.reserve(light.size() / count);
    for (std::size_t i = first; i < light.size(); i += count)
        values.push_back(light[i]);
    return values;
}

/// The light of a surface as one direction: its own length, 0 to 1, is the part of the light that
/// comes from there. `weight` is what the surface's own normal gets.
struct DominantLight {
    glm::vec3 direction{0.0f};
    float weight = 0.5f;
};

/// The shading of engines with directional lightmaps multiplies a texel by (0.5 + 0.5 n.d) over the
/// weight, which is this sum for the texel's own normal.
DominantLight dominant_light(std::span<const glm::vec3> light, const glm::vec3& normal) {
    const auto luminance = [&](std::size_t k) {
        return cubemap::luminance(double{light[k].r}, double{light[k].g}, double{light[k].b});
    };
    // Light from one direction d has first coefficients y, z, x of sqrt(3) d times the zeroth.
    const glm::dvec3 first = glm::dvec3(luminance(3), luminance(1), luminance(2)) / std::sqrt(3.0);
    const double all = luminance(0);
    const double length = glm::length(first);
    DominantLight result;
    if (!(all > 0.0) || !(length > 0.0))
        return result;
    result.direction = first / std::max(all, length);
    result.weight = std::max(1e-4f, 0.5f + 0.5f * glm::dot(normal, result.direction));
    return result;
}

void add_directional_layers(const Scene& scene, std::span<const glm::vec3> light, std::size_t count,
                            relight::LayeredPicture& picture) {
    std::vector<glm::vec3> directions, weights;
    for (std::size_t i = 0; i < scene.receivers.num_own(); ++i) {
        const DominantLight dominant =
            dominant_light(light.subspan(i * count, count), scene.receivers.normals[i]);
        directions.push_back(0.5f + 0.5f * dominant.direction);
        weights.emplace_back(dominant.weight);
    }
    picture.layers.push_back({"direction", picture_of(scene, directions).pixels});
    picture.layers.push_back({"direction_weight", picture_of(scene, weights).pixels});
}

void save_exr(const std::filesystem::path& path, const Scene& scene,
              std::span<const glm::vec3> radiance, std::span<const glm::vec3> light,
              std::size_t count) {
    relight::LayeredPicture picture{.whole = picture_of(scene, radiance), .layers = {}};
    for (std::size_t k = 0; k < count; ++k)
        picture.layers.push_back({std::string(relight::HarmonicNames[k]),
                                  picture_of(scene, coefficient(light, k, count)).pixels});
    if (std::holds_alternative<prt::TexelLayout>(scene.layout))
        add_directional_layers(scene, light, count, picture);
    relight::save_layered_picture(path, std::move(picture));
}

void save_npy(const std::filesystem::path& path, std::span<const glm::vec3> light,
              std::size_t count) {
    relight::NpyFrames file(path, light.size() / count, count);
    for (std::size_t i = 0; i < light.size(); i += count)
        file.append(light.subspan(i, count));
    file.commit();
}

files::Json probe_json(const Scene& scene, std::size_t index, std::span<const glm::vec3> light) {
    const prt::Receivers& receivers = scene.receivers;
    const files::Json at = place_json(scene.mesh, receivers.places()[index]);
    files::Json::Array sh;
    for (std::size_t k = 0; k < relight::MaxHarmonics; ++k)
        for (int channel = 0; channel < 3; ++channel)
            sh.emplace_back(k < light.size() ? light[k][channel] : 0.0f);
    files::Json probe = files::Json::Object();
    probe.set("type", "LightProbe");
    probe.set("uuid", fmt::format("00000000-0000-4000-8000-{:012x}", index + 1));
    probe.set("name", fmt::format("probe {}", index));
    files::Json::Array matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    matrix.insert(matrix.end(), at.values().begin(), at.values().end());
    matrix.emplace_back(1);
    probe.set("matrix", std::move(matrix));
    probe.set("intensity", 1);
    probe.set("sh", std::move(sh));
    if (receivers.is_inside(index)) {
        files::Json data = files::Json::Object();
        data.set("inside", true);
        probe.set("userData", std::move(data));
    }
    return probe;
}

void save_three_json(const std::filesystem::path& path, const Scene& scene,
                     std::span<const glm::vec3> light, std::size_t count) {
    files::Json::Array probes;
    for (std::size_t i = 0; i < scene.receivers.num_own(); ++i)
        probes.push_back(probe_json(scene, i, light.subspan(i * count, count)));
    files::Json group = files::Json::Object();
    group.set("type", "Group");
    group.set("uuid", "00000000-0000-4000-8000-000000000000");
    group.set("name", prt::description(scene.layout));
    group.set("children", std::move(probes));
    if (const auto* grid = std::get_if<prt::GridLayout>(&scene.layout)) {
        files::Json data = files::Json::Object();
        data.set("cells", files::Json::Array{grid->nx, grid->ny, grid->nz});
        data.set("low", place_json(scene.mesh, grid->low));
        data.set("high", place_json(scene.mesh, grid->high));
        group.set("userData", std::move(data));
    }
    files::Json metadata = files::Json::Object();
    metadata.set("version", 4.5);
    metadata.set("type", "Object");
    metadata.set("generator", "Relumine");
    files::Json file = files::Json::Object();
    file.set("metadata", std::move(metadata));
    file.set("object", std::move(group));
    files::save_text(path, file.text() + "\n");
}

} // namespace

void require_harmonics_path(const std::filesystem::path& path, const Scene& scene) {
    const std::string extension = files::extension_of(path);
    const bool has_picture = !prt::on_vertices(scene.layout);
    const bool are_points = !prt::kind_of(scene.layout).have_surface;
    if (extension == ".npy" || (extension == ".exr" && has_picture) ||
        (extension == ".json" && are_points))
        return;
    throw std::invalid_argument(
        fmt::format("{}: expected .npy{}{} for harmonics of a scene whose receivers are {}, got "
                    "'{}'",
                    path.string(), has_picture ? ", .exr" : "", are_points ? ", .json" : "",
                    prt::description(scene.layout), extension));
}

void save_harmonics(const LitScene& lit, const std::filesystem::path& path) {
    const Scene& scene = lit.scene();
    require_harmonics_path(path, scene);
    std::vector<glm::vec3> light = lit.harmonics();
    const Lighting lighting = lit.lighting(false);
    if (light.empty())
        return; // the first process writes
    const std::size_t count = light.size() / scene.receivers.size();
    light.resize(scene.receivers.num_own() * count);
    const std::string extension = files::extension_of(path);
    if (extension == ".npy")
        save_npy(path, light, count);
    else if (extension == ".exr")
        save_exr(path, scene, lighting.radiance, light, count);
    else
        save_three_json(path, scene, light, count);
}

} // namespace relumine
