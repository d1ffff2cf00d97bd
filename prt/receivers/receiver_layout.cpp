#include "prt/receivers/receiver_layout.h"

#include <fmt/format.h>

namespace relumine::prt {

std::string receiver_name(const ReceiverLayout& layout) {
    if (std::holds_alternative<PixelLayout>(layout))
        return "pixel sample";
    return std::holds_alternative<TexelLayout>(layout) ? "texel" : "vertex";
}

std::string description(const ReceiverLayout& layout) {
    if (const auto* pixels = std::get_if<PixelLayout>(&layout))
        return pixels->samples_per_axis == 1
                   ? fmt::format("pixels {} x {}", pixels->width, pixels->height)
                   : fmt::format("pixels {} x {}, {} x {} samples each", pixels->width,
                                 pixels->height, pixels->samples_per_axis,
                                 pixels->samples_per_axis);
    if (const auto* texels = std::get_if<TexelLayout>(&layout))
        return fmt::format("texels {} x {}", texels->width, texels->height);
    return "vertices";
}

} // namespace relumine::prt
