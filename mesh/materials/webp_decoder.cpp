#include "mesh/materials/webp_decoder.h"

#include <stdexcept>

#include <fmt/format.h>
#include <webp/decode.h>

namespace relumine::mesh {

void decode_webp(std::span<const std::byte> file, bool with_alpha,
                 const std::function<std::uint8_t*(std::uint32_t, std::uint32_t)>& allocate) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(file.data());
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(bytes, file.size(), &features) != VP8_STATUS_OK)
        throw std::runtime_error("expected a WebP image, got broken data");
    if (features.has_animation != 0)
        throw std::runtime_error("expected a WebP image, got an animation");
    const auto width = static_cast<std::uint32_t>(features.width);
    const auto height = static_cast<std::uint32_t>(features.height);
    std::uint8_t* pixels = allocate(width, height);
    const int num_channels = with_alpha ? 4 : 3;
    const auto decode = with_alpha ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
    if (decode(bytes, file.size(), pixels,
               std::size_t{width} * height * static_cast<std::size_t>(num_channels),
               features.width * num_channels) == nullptr)
        throw std::runtime_error(fmt::format(
            "expected a whole image of {} x {} pixels, got broken data", width, height));
}

} // namespace relumine::mesh
