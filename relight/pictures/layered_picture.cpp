#include "relight/pictures/layered_picture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "cubemap/image/image_file.h"
#include "files/output_file.h"

namespace relumine::relight {

std::vector<std::string> layer_names(std::vector<std::string> names) {
    constexpr std::size_t Longest = 200; // OpenEXR takes 255 with the channel
    for (std::size_t i = 0; i < names.size(); ++i) {
        std::string plain = names[i].empty() ? "light" : names[i].substr(0, Longest);
        std::replace(plain.begin(), plain.end(), '.', '_');
        names[i] = plain;
        const auto end = names.begin() + static_cast<std::ptrdiff_t>(i);
        for (int number = 2; std::find(names.begin(), end, names[i]) != end; ++number)
            names[i] = fmt::format("{} {}", plain, number);
    }
    return names;
}

void save_layered_picture(const std::filesystem::path& path, LayeredPicture picture,
                          double exposure_ev) {
    const auto scale = static_cast<float>(std::exp2(exposure_ev));
    cubemap::EnvironmentImage image;
    static_cast<cubemap::Picture&>(image) = std::move(picture.whole);
    std::vector<std::string> names;
    for (const LayeredPicture::Layer& layer : picture.layers)
        names.push_back(layer.name);
    names = layer_names(std::move(names));
    std::vector<cubemap::ExrLayer> layers;
    for (LayeredPicture::Layer& layer : picture.layers) {
        if (layer.pixels.size() != image.pixels.size())
            throw std::invalid_argument(fmt::format("{}: expected {} pixels of \"{}\", got {}",
                                                    path.string(), image.pixels.size(), layer.name,
                                                    layer.pixels.size()));
        for (glm::vec3& pixel : layer.pixels)
            pixel *= scale;
        layers.push_back({names[layers.size()], layer.pixels});
    }
    for (glm::vec3& pixel : image.pixels)
        pixel *= scale;
    files::OutputFile file(path);
    cubemap::write_exr(file, image, layers);
    file.commit();
}

} // namespace relumine::relight
