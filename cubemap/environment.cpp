#include "cubemap/environment.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cubemap/image_file.h"
#include "cubemap/image_layout.h"
#include "cubemap/resample.h"
#include "files/output_file.h"

namespace relumine::cubemap {

namespace {

/// The layout that the proportions suggest.
std::optional<Layout> guess_layout(std::uint32_t width, std::uint32_t height) {
    if (width == 2 * std::uint64_t{height})
        return Layout::LatLong;
    for (const Layout layout : {Layout::Cube, Layout::VerticalCross}) {
        if (fits(layout, width, height))
            return layout;
    }
    return std::nullopt;
}

std::string_view proportions(Layout layout) {
    switch (layout) {
    case Layout::LatLong:
        return "2:1";
    case Layout::Cube:
        return "1:6";
    case Layout::VerticalCross:
        break;
    }
    return "3:4";
}

/// Decides layout and sampling and says why.
void interpret(const ImageFile& file, const LoadOptions& options, const std::string& path,
               EnvironmentImage& image) {
    const std::string size = fmt::format("{}x{}", image.width, image.height);
    std::string why;
    if (options.layout) {
        image.layout = *options.layout;
        why = fmt::format("{} as asked for", name(image.layout));
    } else if (file.envmap) {
        image.layout = *file.envmap;
        why = fmt::format("{} as the envmap attribute says", name(image.layout));
    } else {
        const auto layout = guess_layout(image.width, image.height);
        if (!layout)
            throw std::runtime_error(
                fmt::format("{}: expected a 2:1 lat-long, a 1:6 cube or a 3:4 cross, got {}", path, size));
        image.layout = *layout;
        why = fmt::format("{} image without envmap attribute", proportions(image.layout));
    }
    if (!fits(image.layout, image.width, image.height))
        throw std::runtime_error(fmt::format("{}: expected a {} image for a {}, got {}", path,
                                             proportions(image.layout), name(image.layout), size));
    // The attribute's border rule belongs to the attribute's layout.
    image.sampling = file.envmap == image.layout ? Sampling::Borders : Sampling::TexelCentres;
    why += image.sampling == Sampling::Borders ? ", samples on the borders" : ", samples at texel centres";
    image.assumptions =
        fmt::format("{}{}{}", why, file.remarks.empty() ? "" : ", ", fmt::join(file.remarks, ", "));
}

BadPixels find_bad_pixels(const EnvironmentImage& image) {
    BadPixels bad;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::vec3& pixel = image.pixels[i];
        if (pixel.x >= 0.0f && pixel.y >= 0.0f && pixel.z >= 0.0f &&
            std::isfinite(pixel.x + pixel.y + pixel.z))
            continue;
        const auto any = [&](auto test) {
            return test(pixel.x) || test(pixel.y) || test(pixel.z);
        };
        std::size_t* count = nullptr;
        if (any([](float value) { return std::isnan(value); }))
            count = &bad.num_nan;
        else if (any([](float value) { return std::isinf(value); }))
            count = &bad.num_infinite;
        else if (any([](float value) { return value < 0.0f; }))
            count = &bad.num_negative;
        else
            continue; // only the sum of the three was infinite
        if (bad.count() == 0) {
            bad.first_x = static_cast<std::uint32_t>(i % image.width);
            bad.first_y = static_cast<std::uint32_t>(i / image.width);
        }
        ++*count;
    }
    return bad;
}

/// NaN and negative become 0, infinity the largest finite value.
void fix_bad_pixels(EnvironmentImage& image) {
    float largest = 0.0f;
    for (const glm::vec3& pixel : image.pixels) {
        for (int channel = 0; channel < 3; ++channel) {
            if (std::isfinite(pixel[channel]))
                largest = std::max(largest, pixel[channel]);
        }
    }
    for (glm::vec3& pixel : image.pixels) {
        for (int channel = 0; channel < 3; ++channel) {
            float& value = pixel[channel];
            if (!(value >= 0.0f))
                value = 0.0f; // NaN too
            else if (std::isinf(value))
                value = largest;
        }
    }
    image.fixed = true;
}

} // namespace

EnvironmentImage load_environment(const std::filesystem::path& path, const LoadOptions& options) {
    const std::vector<std::byte> bytes = files::read(path);
    if (!is_exr(bytes) && !is_hdr(bytes))
        throw std::runtime_error(fmt::format("{}: expected an OpenEXR or Radiance .hdr file, got {}",
                                             path.string(),
                                             bytes.empty() ? "an empty file" : "something else"));
    ImageFile file = is_exr(bytes) ? decode_exr(bytes, path.string()) : decode_hdr(bytes, path.string());
    EnvironmentImage image;
    image.width = file.width;
    image.height = file.height;
    image.pixels = std::move(file.pixels);
    interpret(file, options, path.string(), image);

    image.bad_pixels = find_bad_pixels(image);
    if (image.bad_pixels.count() == 0)
        return image;
    if (options.fix_bad_pixels)
        fix_bad_pixels(image);
    else if (options.refuse_bad_pixels)
        throw std::runtime_error(
            fmt::format("{}: expected finite radiance >= 0, got {} NaN/Inf and {} negative pixels, first at "
                        "({}, {}); use --fix-env",
                        path.string(), image.bad_pixels.num_nan + image.bad_pixels.num_infinite,
                        image.bad_pixels.num_negative, image.bad_pixels.first_x, image.bad_pixels.first_y));
    return image;
}

std::uint32_t natural_resolution(const EnvironmentImage& image) {
    switch (image.layout) {
    case Layout::LatLong:
        return std::max(1U, (image.width + 2) / 4);
    case Layout::Cube:
        return image.width;
    case Layout::VerticalCross:
        break;
    }
    return std::max(1U, image.width / 3);
}

void save_environment(const std::filesystem::path& path, const CubeMap& map, Layout layout) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension != ".exr" && extension != ".hdr")
        throw std::invalid_argument(
            fmt::format("{}: expected a name that ends in .exr or .hdr, got '{}'", path.string(), extension));

    files::OutputFile file(path);
    const std::uint32_t resolution = map.resolution;
    // The specification of the `envmap` attribute puts samples on the borders; it knows no cross, and .hdr no attribute.
    const Sampling sampling =
        extension == ".exr" && layout != Layout::VerticalCross ? Sampling::Borders : Sampling::TexelCentres;
    EnvironmentImage image;
    switch (layout) {
    case Layout::LatLong:
        image = to_image(map, layout, 4 * resolution, 2 * resolution, sampling);
        break;
    case Layout::Cube:
        image = to_image(map, layout, resolution, 6 * resolution, sampling);
        break;
    case Layout::VerticalCross:
        image = to_image(map, layout, 3 * resolution, 4 * resolution, sampling);
        break;
    }
    try {
        file.write(extension == ".exr" ? encode_exr(image) : encode_hdr(image));
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
    file.commit();
}

} // namespace relumine::cubemap
