#include "app/receiver_options.h"

#include <sstream>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace relumine::app {

void ReceiverOptions::add_to(Command& command) {
    command
        .add_option(
            "--receivers", receivers_,
            "what is lit: vertices, pixels:WxH[:N] (of --view, N x N samples each) or texels:WxH "
            "(a lightmap on the mesh's uvs)")
        .show_default();
    command.add_option(
        "--view", view_,
        "the camera of pixels, and the eye that highlights are for: EX,EY,EZ,TX,TY,TZ[,FOV] "
        "(eye, target, vertical degrees: 35) or auto");
}

std::variant<Vertices, Pixels, Texels> ReceiverOptions::receivers() const {
    if (receivers_ == "vertices")
        return Vertices{};
    const auto refuse = [&] {
        throw UsageError(
            "--receivers",
            fmt::format("expected vertices, pixels:WxH, pixels:WxH:N or texels:WxH, got '{}'",
                        receivers_));
    };
    std::istringstream text(receivers_);
    std::string kind;
    std::getline(text, kind, ':');
    if (kind != "pixels" && kind != "texels")
        refuse();
    const bool are_pixels = kind == "pixels";
    // Unsigned numbers would take a minus sign.
    std::int64_t width = 0, height = 0, samples = 1;
    char x = 0, colon = ':', rest = 0;
    if (!(text >> width >> x >> height) || x != 'x')
        refuse();
    if (are_pixels && text.peek() == ':' && !(text >> colon >> samples))
        refuse();
    if (text >> rest)
        refuse();
    const auto is_size = [](std::int64_t size) {
        return size >= 1 && size <= prt::MaxPictureSize;
    };
    if (!is_size(width) || !is_size(height))
        throw UsageError("--receivers", fmt::format("expected a size of 1 to {} a side, got '{}'",
                                                    prt::MaxPictureSize, receivers_));
    if (samples < 1 || samples > prt::MaxSamplesPerAxis)
        throw UsageError("--receivers", fmt::format("expected 1 to {} samples a side, got '{}'",
                                                    prt::MaxSamplesPerAxis, receivers_));
    if (static_cast<std::size_t>(width * height * samples * samples) > prt::MaxLayoutPlaces)
        throw UsageError("--receivers", fmt::format("expected at most {} samples in all, got '{}'",
                                                    prt::MaxLayoutPlaces, receivers_));
    const Texels size{.width = static_cast<std::uint32_t>(width),
                      .height = static_cast<std::uint32_t>(height)};
    if (!are_pixels)
        return size;
    return Pixels{.width = size.width,
                  .height = size.height,
                  .samples_per_axis = static_cast<std::uint32_t>(samples)};
}

std::optional<View> ReceiverOptions::view() const {
    if (view_.empty())
        return std::nullopt;
    if (view_ == "auto")
        return View{};
    std::vector<float> numbers;
    std::istringstream text(view_);
    for (std::string word; std::getline(text, word, ',');) {
        if (const std::optional<double> number = parse_number(word))
            numbers.push_back(static_cast<float>(*number));
        else
            numbers.clear();
    }
    if (numbers.size() != 6 && numbers.size() != 7)
        throw UsageError("--view",
                         fmt::format("expected auto or EX,EY,EZ,TX,TY,TZ[,FOV], got '{}'", view_));
    prt::Camera camera{.eye = {numbers[0], numbers[1], numbers[2]},
                       .target = {numbers[3], numbers[4], numbers[5]}};
    if (numbers.size() == 7)
        camera.fov_degrees = numbers[6];
    try {
        static_cast<void>(prt::axes_of(camera, 1.0f));
    } catch (const std::invalid_argument& error) {
        throw UsageError("--view", error.what());
    }
    return View{camera};
}

void ReceiverOptions::check() const {
    if (std::holds_alternative<Pixels>(receivers()) && view_.empty())
        throw UsageError("--receivers", "expected --view (a camera, or auto) with pixels");
    static_cast<void>(view());
}

Report layout_json(const prt::Scene& scene) {
    const auto num_receivers = static_cast<double>(scene.receivers.size());
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
