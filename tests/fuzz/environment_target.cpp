#include "tests/fuzz/environment_target.h"

#include <algorithm>
#include <cmath>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_size.h"
#include "cubemap/layers/image_pyramid.h"
#include "cubemap/resample/resample.h"

namespace relumine::fuzz {

void read_environment(std::span<const std::byte> content) {
    const std::filesystem::path path = file("environment", content);
    const auto image =
        accepted([&] { return cubemap::load_environment(path, {.fix_bad_pixels = true}); });
    const auto size = accepted([&] { return cubemap::read_image_size(path); });
    // Pictures of light layers have other shapes and may not have bad pixels.
    const auto picture = accepted([&] { return cubemap::load_image_pyramid(path); });
    require(!picture || !(*picture)->levels().empty(), "a picture has pixels");
    if (!image)
        return;
    require(image->pixels.size() == std::size_t{image->width} * image->height,
            "an image has all its pixels");
    require(size && *size == cubemap::ImageSize{image->width, image->height},
            "header and image have one size");
    if (image->pixels.size() > 65536)
        return;
    const cubemap::CubeMap map = cubemap::resample(*image, 4);
    require(std::all_of(map.texels.begin(), map.texels.end(),
                        [](const glm::vec3& c) { return !std::isnan(c.x + c.y + c.z); }),
            "finite pixels make a map of numbers");
}

} // namespace relumine::fuzz
