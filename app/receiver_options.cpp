#include "app/receiver_options.h"

#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/size_text.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/receivers/texel_receivers.h"
#include "relight/pictures/picture.h"

namespace relumine::app {

namespace {

nlohmann::json array(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

} // namespace

void ReceiverOptions::add_to(CLI::App& command) {
    command
        .add_option(
            "--receivers", receivers_,
            "what is lit: vertices, pixels:WxH[:N] (of --view, N x N samples each) or texels:WxH "
            "(a lightmap on the mesh's uvs)")
        ->capture_default_str();
    command.add_option(
        "--view", view_,
        "the camera of pixels, and the eye that highlights are for: EX,EY,EZ,TX,TY,TZ[,FOV] "
        "(eye, target, vertical degrees: 35) or auto");
}

ReceiverOptions::Wanted ReceiverOptions::wanted() const {
    Wanted wanted;
    if (receivers_ == "vertices")
        return wanted;
    const auto refuse = [&] {
        throw CLI::ValidationError(
            "--receivers",
            fmt::format("expected vertices, pixels:WxH, pixels:WxH:N or texels:WxH, got '{}'",
                        receivers_));
    };
    // KIND:SIZE, for pixels also KIND:SIZE:SAMPLES.
    const std::string_view text = receivers_;
    const std::size_t colon = text.find(':');
    const std::string_view kind = text.substr(0, colon);
    if ((kind != "pixels" && kind != "texels") || colon == std::string_view::npos)
        refuse();
    wanted.kind = kind == "pixels" ? Kind::Pixels : Kind::Texels;
    const std::size_t second_colon = text.find(':', colon + 1);
    const bool has_samples = second_colon != std::string_view::npos;
    const auto size = parse_size_text(text.substr(colon + 1, second_colon - colon - 1));
    const auto samples =
        has_samples ? parse_side(text.substr(second_colon + 1)) : std::optional<std::uint32_t>(1);
    if (!size || !samples || (has_samples && wanted.kind != Kind::Pixels))
        refuse();
    const auto is_size = [](std::uint32_t side) {
        return side >= 1 && side <= prt::MaxPictureSize;
    };
    if (!is_size(size->width) || !is_size(size->height))
        throw CLI::ValidationError("--receivers",
                                   fmt::format("expected a size of 1 to {} a side, got '{}'",
                                               prt::MaxPictureSize, receivers_));
    if (*samples < 1 || *samples > prt::MaxSamplesPerAxis)
        throw CLI::ValidationError("--receivers",
                                   fmt::format("expected 1 to {} samples a side, got '{}'",
                                               prt::MaxSamplesPerAxis, receivers_));
    if (std::size_t{size->width} * size->height * *samples * *samples > prt::MaxLayoutPlaces)
        throw CLI::ValidationError("--receivers",
                                   fmt::format("expected at most {} samples in all, got '{}'",
                                               prt::MaxLayoutPlaces, receivers_));
    wanted.width = size->width;
    wanted.height = size->height;
    wanted.samples_per_axis = *samples;
    return wanted;
}

std::optional<prt::Camera> ReceiverOptions::camera() const {
    if (view_ == "auto")
        return std::nullopt;
    std::vector<float> numbers;
    std::istringstream text(view_);
    for (std::string word; std::getline(text, word, ',');) {
        float number = 0.0f;
        if (!CLI::detail::lexical_cast(word, number))
            numbers.clear();
        else
            numbers.push_back(number);
    }
    if (numbers.size() != 6 && numbers.size() != 7)
        throw CLI::ValidationError(
            "--view", fmt::format("expected auto or EX,EY,EZ,TX,TY,TZ[,FOV], got '{}'", view_));
    prt::Camera camera{.eye = {numbers[0], numbers[1], numbers[2]},
                       .target = {numbers[3], numbers[4], numbers[5]}};
    if (numbers.size() == 7)
        camera.fov_degrees = numbers[6];
    try {
        static_cast<void>(prt::axes_of(camera, 1.0f));
    } catch (const std::invalid_argument& error) {
        throw CLI::ValidationError("--view", error.what());
    }
    return camera;
}

void ReceiverOptions::check() const {
    const bool pixels = wanted().kind == Kind::Pixels;
    if (pixels && view_.empty())
        throw CLI::ValidationError("--receivers",
                                   "expected --view (a camera, or auto) with pixels");
    if (!view_.empty())
        static_cast<void>(camera());
}

void ReceiverOptions::apply(prt::Scene& scene, const prt::RayScene& rays,
                            const std::string& mesh_name, const Session& session,
                            nlohmann::json& report) const {
    const Wanted wanted = this->wanted();
    try {
        if (wanted.kind == Kind::Pixels)
            apply_pixels(wanted, scene, rays, session, report);
        else if (wanted.kind == Kind::Texels)
            apply_texels(wanted, scene, session, report);
        else
            scene.receivers = prt::vertex_receivers(scene.mesh);
        if (wanted.kind != Kind::Pixels && !view_.empty())
            apply_eye(scene);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", mesh_name, error.what()));
    }
}

/// Receivers that are no pixels of the view but seen from it.
void ReceiverOptions::apply_eye(prt::Scene& scene) const {
    const std::optional<prt::Camera> own = camera();
    scene.settings.view = own ? *own : relight::automatic_camera(scene.mesh);
    prt::look_from(scene.receivers, scene.settings.view->eye);
}

void ReceiverOptions::apply_pixels(const Wanted& wanted, prt::Scene& scene,
                                   const prt::RayScene& rays, const Session& session,
                                   nlohmann::json& report) const {
    const std::optional<prt::Camera> own = camera();
    prt::PixelReceivers pixels = prt::pixel_receivers(
        scene.mesh, rays,
        {.camera = own ? *own
                       : relight::automatic_camera(
                             scene.mesh, {.width = wanted.width, .height = wanted.height}),
         .width = wanted.width,
         .height = wanted.height,
         .samples_per_axis = wanted.samples_per_axis});
    scene.receivers = std::move(pixels.receivers);
    scene.layout = std::move(pixels.layout);
    report["layout"] = layout_json(scene);
    session.detail(fmt::format("{}: {} samples hit the mesh", prt::description(scene.layout),
                               scene.receivers.size()));
}

void ReceiverOptions::apply_texels(const Wanted& wanted, prt::Scene& scene, const Session& session,
                                   nlohmann::json& report) {
    prt::TexelReceivers texels =
        prt::texel_receivers(scene.mesh, {.width = wanted.width, .height = wanted.height});
    const prt::AtlasReport& atlas = texels.report;
    if (atlas.num_overlapping > 0)
        session.say(
            fmt::format("warning: {} texels lie in several triangles, the first at column {}, row "
                        "{}: charts overlap, the first triangle of the mesh wins",
                        atlas.num_overlapping, atlas.first_overlap % wanted.width,
                        atlas.first_overlap / wanted.width));
    if (atlas.num_outside > 0)
        session.say(fmt::format("warning: {} triangles have uvs outside of 0 to 1: cut off there",
                                atlas.num_outside));
    if (atlas.num_flat > 0)
        session.detail(
            fmt::format("{} triangles have no area in uv and get no texels", atlas.num_flat));
    scene.receivers = std::move(texels.receivers);
    scene.layout = std::move(texels.layout);
    report["layout"] = layout_json(scene);
    report["texels_overlapping"] = atlas.num_overlapping;
    report["texels_on_borders"] = atlas.num_borders;
    report["triangles_outside"] = atlas.num_outside;
    report["triangles_flat_in_uv"] = atlas.num_flat;
    if (atlas.num_overlapping > 0)
        report["first_overlap"] = {atlas.first_overlap % wanted.width,
                                   atlas.first_overlap / wanted.width};
}

nlohmann::json layout_json(const prt::Scene& scene) {
    const auto num_receivers = static_cast<double>(scene.receivers.size());
    if (const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout))
        return {{"kind", "pixels"},
                {"width", pixels->width},
                {"height", pixels->height},
                {"samples_per_axis", pixels->samples_per_axis},
                {"eye", array(pixels->camera.eye)},
                {"target", array(pixels->camera.target)},
                {"fov", pixels->camera.fov_degrees},
                {"coverage", num_receivers / static_cast<double>(pixels->num_samples())}};
    if (const auto* texels = std::get_if<prt::TexelLayout>(&scene.layout))
        return {{"kind", "texels"},
                {"width", texels->width},
                {"height", texels->height},
                {"coverage", num_receivers / static_cast<double>(texels->num_texels())}};
    return nlohmann::json::object();
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
