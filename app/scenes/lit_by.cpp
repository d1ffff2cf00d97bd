#include "app/scenes/lit_by.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/session.h"
#include "files/joined.h"
#include "files/nearest_name.h"

namespace relumine::app {

cubemap::Disc DiscText::read(const std::string& text) {
    const std::size_t last_comma = text.rfind(',');
    const auto radius =
        last_comma == std::string::npos ? std::nullopt : parse_number(text.substr(last_comma + 1));
    if (!radius)
        refuse_text("X,Y,Z,RADIUS with a RADIUS in degrees", text);
    const cubemap::Disc disc{.direction = PointText::read(text.substr(0, last_comma)),
                             .radius_degrees = *radius};
    cubemap::validate(cubemap::Region(disc));
    return disc;
}

std::string DiscText::show(const cubemap::Disc& disc) {
    return fmt::format("{},{}", PointText::show(disc.direction), disc.radius_degrees);
}

cubemap::Region lit_by_region(const std::string& text,
                              std::span<const cubemap::LightLayer> layers) {
    const auto layer =
        std::find_if(layers.begin(), layers.end(), [&](const auto& l) { return l.name == text; });
    if (layer != layers.end())
        return layer->region;
    const auto refusal = [&](const std::string& why) {
        std::vector<std::string> names;
        for (const cubemap::LightLayer& each : layers)
            names.push_back(each.name);
        return UsageError(
            "--lit-by",
            fmt::format("expected a layer ({}) or X,Y,Z,RADIUS with a RADIUS in degrees, got "
                        "'{}'{}{}",
                        names.empty() ? "there is none" : files::joined(names, ", "), text, why,
                        files::did_you_mean(text, names)));
    };
    const auto numbers = parse_numbers(text);
    if (!numbers || numbers->size() != 4)
        throw refusal("");
    try {
        return DiscText::read(text);
    } catch (const std::invalid_argument& error) {
        throw refusal(fmt::format(": {}", error.what()));
    }
}

} // namespace relumine::app
