#include "app/options/receiver_options.h"

#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/options/size_text.h"

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
    // KIND:SIZE, for pixels also KIND:SIZE:SAMPLES.
    const std::string_view text = receivers_;
    const std::size_t colon = text.find(':');
    const std::string_view kind = text.substr(0, colon);
    if ((kind != "pixels" && kind != "texels") || colon == std::string_view::npos)
        refuse();
    const bool are_pixels = kind == "pixels";
    const std::size_t second_colon = text.find(':', colon + 1);
    const bool has_samples = second_colon != std::string_view::npos;
    const auto size = parse_size_text(text.substr(colon + 1, second_colon - colon - 1));
    const auto samples =
        has_samples ? parse_count(text.substr(second_colon + 1)) : std::optional<std::uint32_t>(1);
    if (!size || !samples || (has_samples && !are_pixels))
        refuse();
    const auto is_size = [](std::uint32_t side) {
        return side >= 1 && side <= prt::MaxPictureSize;
    };
    if (!is_size(size->width) || !is_size(size->height))
        throw UsageError("--receivers", fmt::format("expected a size of 1 to {} a side, got '{}'",
                                                    prt::MaxPictureSize, receivers_));
    if (*samples < 1 || *samples > prt::MaxSamplesPerAxis)
        throw UsageError("--receivers", fmt::format("expected 1 to {} samples a side, got '{}'",
                                                    prt::MaxSamplesPerAxis, receivers_));
    if (std::size_t{size->width} * size->height * *samples * *samples > prt::MaxLayoutPlaces)
        throw UsageError("--receivers", fmt::format("expected at most {} samples in all, got '{}'",
                                                    prt::MaxLayoutPlaces, receivers_));
    if (!are_pixels)
        return Texels{.width = size->width, .height = size->height};
    return Pixels{.width = size->width, .height = size->height, .samples_per_axis = *samples};
}

std::optional<View> ReceiverOptions::view() const {
    if (view_.empty())
        return std::nullopt;
    if (view_ == "auto")
        return View{};
    std::vector<float> numbers;
    std::istringstream text(view_);
    for (std::string word; std::getline(text, word, ',');) {
        if (const std::optional<double> number = parse_number(word);
            number && std::abs(*number) <= LargestPosition)
            numbers.push_back(static_cast<float>(*number));
        else
            numbers.clear();
    }
    if (numbers.size() != 6 && numbers.size() != 7)
        throw UsageError("--view",
                         fmt::format("expected auto or EX,EY,EZ,TX,TY,TZ[,FOV] within {}, got '{}'",
                                     LargestPosition, view_));
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
    if (prt::on_vertices(scene.layout))
        return {};
    Report report;
    report.set("kind", prt::kind_of(scene.layout).name);
    prt::ReceiverLayout layout = scene.layout;
    std::visit(
        [&](auto& own) {
            auto member = [&](std::string_view name, const auto& value) {
                report.set(name == "fov_degrees" ? "fov" : name, value);
            };
            own.members(member);
        },
        layout);
    report.set("coverage", coverage_of(scene));
    return report;
}

double coverage_of(const prt::Scene& scene) {
    return static_cast<double>(scene.receivers.num_own()) /
           static_cast<double>(prt::num_places(scene.layout));
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
    if (!prt::on_vertices(scene.layout))
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
