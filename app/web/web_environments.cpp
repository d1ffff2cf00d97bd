#include "app/web/web_environments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "data_gen/environments.h"
#include "files/pixel_values.h"
#include "relumine/ask/questions.h"
#include "relumine/in/environment.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/mesh_files.h"
#include "relumine/out/pictures.h"

namespace relumine::app {

namespace {

/// A lat-long of 1024 x 512: as fine as a page's background.
constexpr std::uint32_t PictureResolution = 256;
constexpr std::uint32_t ThumbWidth = 236, ThumbHeight = 124;

/// Environments that are made in code, where none are given.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> Made = {
    {{"soft_boxes", "Two soft boxes"}, {"sun_sky", "Sun and sky"}}};

std::vector<std::byte> hdr_of(const cubemap::CubeMap& map) {
    return bytes_written("environment.hdr", [&](const std::filesystem::path& path) {
        cubemap::save_environment(path, map, cubemap::Layout::LatLong);
    });
}

/// The middle of the environment, with the horizon, as a screen shows it.
std::vector<std::byte> thumbnail(const cubemap::CubeMap& map) {
    std::vector<glm::vec3> pixels;
    double sum = 0.0;
    constexpr int Samples = 3;
    for (std::uint32_t y = 0; y < ThumbHeight; ++y)
        for (std::uint32_t x = 0; x < ThumbWidth; ++x) {
            glm::vec3 mean(0.0f);
            for (int i = 0; i < Samples * Samples; ++i) {
                const int column = i % Samples, row = i / Samples;
                const double u = (x + (column + 0.5) / Samples) / ThumbWidth;
                const double v = (y + (row + 0.5) / Samples) / ThumbHeight;
                const double longitude = std::numbers::pi * (1.0 - 2.0 * u);
                const double latitude = 0.5 * std::numbers::pi * (1.0 - 2.0 * v) * 0.92;
                const cubemap::FacePoint point = cubemap::face_point(
                    {std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                     std::cos(longitude) * std::cos(latitude)});
                const auto texel = [&](double at) {
                    return std::min(static_cast<std::uint32_t>(at * map.resolution),
                                    map.resolution - 1);
                };
                mean += map.at(point.face, texel(point.s), texel(point.t));
            }
            pixels.push_back(mean / static_cast<float>(Samples * Samples));
            sum += std::log2(1e-4 + cubemap::luminance(pixels.back()));
        }
    // Photographers' middle grey for the mean of the logarithms.
    const auto exposure =
        static_cast<float>(0.2 / std::exp2(sum / static_cast<double>(pixels.size())));
    std::vector<std::uint8_t> bytes;
    for (const glm::vec3& pixel : pixels) {
        const glm::vec3 shown = relight::on_screen(relight::ToneCurve::Agx, pixel * exposure);
        for (const float value : {shown.r, shown.g, shown.b})
            bytes.push_back(
                static_cast<std::uint8_t>(std::lround(255.0f * files::srgb_of_linear(value))));
    }
    return relight::encode_png(ThumbWidth, ThumbHeight, 3, bytes);
}

struct Named {
    std::string name = {};
    cubemap::CubeMap map = {};
};

std::vector<Named> environments_of(const std::vector<std::string>& paths, Session& session) {
    std::vector<Named> result;
    for (const std::string& path : paths) {
        Named named{.name = std::filesystem::path(path).stem().string()};
        Environment environment = load_environment(path, {.face_resolution = PictureResolution});
        named.map = std::move(environment.map);
        for (const std::string& warning : environment.warnings)
            session.warn(fmt::format("{}: {}", path, warning));
        result.push_back(std::move(named));
        session.poll();
    }
    for (const auto& [name, title] : Made)
        for (const data_gen::Environment& made : data_gen::environments())
            if (paths.empty() && made.name == name)
                result.push_back({.name = std::string(title), .map = made.make(PictureResolution)});
    return result;
}

double error_under(const Named& named, LitScene& lit, const std::string& path,
                   std::size_t num_samples, Session& session) {
    if (path.empty())
        lit.light(cubemap::CubeMap(named.map));
    else
        lit.light(load_environment(path, {.face_resolution = PageLightResolution}));
    return verify(lit, {.num_samples = num_samples, .num_surface_points = 0},
                  session.work("exact integration"))
        .error.relative_l2;
}

} // namespace

WebEnvironments web_environments(const std::vector<std::string>& paths, const Scene& scene,
                                 std::size_t num_samples, Session& session) {
    const std::vector<Named> environments = environments_of(paths, session);
    std::unique_ptr<LitScene> lit;
    if (num_samples != 0) {
        // The light of lamps is not the environment's.
        Scene without_lamps = scene;
        without_lamps.lamps = {};
        lit = std::make_unique<LitScene>(std::move(without_lamps),
                                         LightOptions{.clusters_only = true});
    }
    WebEnvironments result;
    files::Json::Array list;
    for (std::size_t i = 0; i < environments.size(); ++i) {
        const Named& named = environments[i];
        const std::string stem = fmt::format("environments/{}", i + 1);
        result.files.push_back({stem + ".hdr", hdr_of(named.map)});
        result.files.push_back({stem + ".png", thumbnail(named.map)});
        files::Json entry = {{"id", fmt::format("environment-{}", i + 1)},
                             {"name", named.name},
                             {"file", stem + ".hdr"},
                             {"thumb", stem + ".png"}};
        if (lit) {
            const double error =
                error_under(named, *lit, paths.empty() ? "" : paths[i], num_samples, session);
            entry.set("verified", files::Json({{"relativeL2", error}, {"samples", num_samples}}));
            result.worst = std::max(result.worst, error);
        }
        list.push_back(std::move(entry));
    }
    session.end_progress();
    result.list = std::move(list);
    return result;
}

} // namespace relumine::app
