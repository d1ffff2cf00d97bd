#include "relight/pictures/picture.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "cubemap/image/image_file.h"
#include "files/extension.h"
#include "files/output_file.h"
#include "files/parallel.h"
#include "files/pixel_values.h"
#include "relight/pictures/png_file.h"

namespace relumine::relight {

namespace {

std::uint8_t srgb_byte(float linear) {
    const float x = std::clamp(linear, 0.0f, 1.0f);
    return static_cast<std::uint8_t>(std::lround(files::srgb_of_linear(x) * 255.0f));
}

/// Puts the colours of some pixels through a tone curve.
void curve(std::span<glm::vec3> colors, const Development& development) {
    if (development.display == nullptr) {
        for (glm::vec3& color : colors)
            color = on_screen(development.tone, color);
        return;
    }
    // The display's values are encoded; the file will encode them again.
    development.display->apply(colors);
    for (glm::vec3& color : colors)
        color = {files::linear_of_srgb(color.r), files::linear_of_srgb(color.g),
                 files::linear_of_srgb(color.b)};
}

/// Exposes the picture and puts its colours through a tone curve.
Picture curved(const Picture& picture, float scale, const Development& development) {
    Picture result = picture;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, result.pixels.size(), 4096), [&](const auto& pixels) {
            // The curve is for the colour itself, not for its covered part.
            const auto alpha = [&](std::size_t i) {
                return result.alpha.empty() ? 1.0f : result.alpha[i];
            };
            const std::span part =
                std::span(result.pixels).subspan(pixels.begin(), pixels.end() - pixels.begin());
            for (std::size_t i = 0; i < part.size(); ++i)
                if (const float covered = alpha(pixels.begin() + i); covered > 0.0f)
                    part[i] *= scale / covered;
            curve(part, development);
            for (std::size_t i = 0; i < part.size(); ++i)
                part[i] *= alpha(pixels.begin() + i);
        });
    return result;
}

std::vector<std::byte> png_of(const Picture& picture, float scale) {
    const std::size_t num_channels = picture.alpha.empty() ? 3 : 4;
    std::vector<std::uint8_t> bytes(picture.pixels.size() * num_channels);
    files::parallel_for(std::uint32_t{0}, picture.height, [&](std::uint32_t y) {
        for (std::size_t i = std::size_t{y} * picture.width;
             i < (std::size_t{y} + 1) * picture.width; ++i) {
            // The colours of PNG are not multiplied by alpha.
            const float alpha =
                num_channels == 4 && picture.alpha[i] > 0.0f ? picture.alpha[i] : 1.0f;
            std::uint8_t* out = &bytes[i * num_channels];
            for (int channel = 0; channel < 3; ++channel)
                out[channel] = srgb_byte(picture.pixels[i][channel] / alpha * scale);
            if (num_channels == 4) // linear
                out[3] = static_cast<std::uint8_t>(
                    std::lround(std::clamp(picture.alpha[i], 0.0f, 1.0f) * 255.0f));
        }
    });
    return encode_png(picture.width, picture.height, num_channels, bytes);
}

void require_pixels(const Picture& picture) {
    if (picture.pixels.empty() ||
        picture.pixels.size() != std::size_t{picture.width} * picture.height)
        throw std::invalid_argument(fmt::format("picture: expected {} x {} pixels, got {}",
                                                picture.width, picture.height,
                                                picture.pixels.size()));
    if (!picture.alpha.empty() && picture.alpha.size() != picture.pixels.size())
        throw std::invalid_argument(
            fmt::format("picture: expected one alpha per pixel, got {} for {}",
                        picture.alpha.size(), picture.pixels.size()));
}

} // namespace

std::vector<std::byte> png_file(const Picture& picture, const Development& development) {
    require_pixels(picture);
    const auto scale = static_cast<float>(std::exp2(development.exposure_ev));
    return development.tone == ToneCurve::None && development.display == nullptr
               ? png_of(picture, scale)
               : png_of(curved(picture, scale, development), 1.0f);
}

void save_picture(const std::filesystem::path& path, const Picture& picture,
                  const Development& development) {
    std::vector<std::byte> bytes;
    const std::string extension = files::extension_of(path);
    try {
        if (extension == ".png") {
            bytes = png_file(picture, development);
        } else if (extension == ".exr") {
            require_pixels(picture);
            cubemap::EnvironmentImage image;
            static_cast<Picture&>(image) = picture;
            for (glm::vec3& pixel : image.pixels)
                pixel *= static_cast<float>(std::exp2(development.exposure_ev));
            bytes = cubemap::encode_exr(image);
        }
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(fmt::format("{}: {}", path.string(), error.what()));
    }
    if (bytes.empty())
        throw std::invalid_argument(fmt::format("{}: expected .png or .exr, got '{}'",
                                                path.string(), path.extension().string()));
    files::OutputFile file(path);
    file.write(bytes);
    file.commit();
}

} // namespace relumine::relight
