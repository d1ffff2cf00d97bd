#include "cubemap/image/environment.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "cubemap/image/environment_checks.h"
#include "cubemap/image/image_file.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/luminance.h"
#include "files/extension.h"
#include "files/joined.h"
#include "files/output_file.h"
#include "files/pixel_values.h"

namespace relumine::cubemap {

namespace {

/// Width of an octahedral map over a cube face's resolution R. Its pixels are as wide as those of a
/// lat-long of width 4 R if the width is 4 R / sqrt(pi).
constexpr double OctahedralWidth = 2.25;

/// Returns the layout that the proportions suggest. A square image may be any of three layouts.
std::optional<Layout> guess_layout(std::uint32_t width, std::uint32_t height) {
    if (width == 2 * std::uint64_t{height})
        return Layout::LatLong;
    for (const Layout layout : AllLayouts) {
        if (has_faces(layout) && fits(layout, width, height))
            return layout;
    }
    return std::nullopt;
}

std::string proportions(Layout layout) {
    if (has_faces(layout))
        return fmt::format("{}:{}", squares_of(layout).width, squares_of(layout).height);
    return layout == Layout::LatLong ? "2:1" : "1:1";
}

} // namespace

namespace detail {

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
    } else if (file.layout) {
        image.layout = *file.layout;
        why = fmt::format("{} as the file says", name(image.layout));
    } else {
        const auto layout = guess_layout(image.width, image.height);
        if (!layout)
            throw std::runtime_error(
                image.width == image.height
                    ? fmt::format(
                          "{}: expected --layout angular, mirrorball or octahedral for a square "
                          "picture "
                          "(or a 2:1 lat-long, a 1:6 or 6:1 cube, a 3:4 or 4:3 cross), got {}",
                          path, size)
                    : fmt::format("{}: expected a 2:1 lat-long, a 1:6 or 6:1 cube, a 3:4 or 4:3 "
                                  "cross, or a 1:1 "
                                  "picture with --layout, got {}",
                                  path, size));
        image.layout = *layout;
        why = fmt::format("{} image without envmap attribute", proportions(image.layout));
    }
    if (!fits(image.layout, image.width, image.height))
        throw std::runtime_error(fmt::format("{}: expected a {} image for layout {}, got {}", path,
                                             proportions(image.layout), name(image.layout), size));
    // The attribute's rule about borders holds only for the attribute's layout.
    image.faces_of = file.faces_of;
    image.sampling = file.envmap == image.layout ? Sampling::Borders : Sampling::TexelCentres;
    why += image.sampling == Sampling::Borders ? ", samples on the borders"
                                               : ", samples at texel centres";
    image.assumptions = fmt::format("{}{}{}", why, file.remarks.empty() ? "" : ", ",
                                    files::joined(file.remarks, ", "));
}

void count_if_bad(const glm::vec3& pixel, std::uint32_t x, std::uint32_t y, BadPixels& bad) {
    if (pixel.x >= 0.0f && pixel.y >= 0.0f && pixel.z >= 0.0f &&
        std::max({pixel.x, pixel.y, pixel.z}) <= BadPixels::MostRadiance)
        return;
    const auto any = [&](auto test) {
        return test(pixel.x) || test(pixel.y) || test(pixel.z);
    };
    if (bad.count() == 0) {
        bad.first_x = x;
        bad.first_y = y;
    }
    if (any([](float value) { return std::isnan(value); }))
        ++bad.num_nan;
    else if (any([](float value) { return std::abs(value) > BadPixels::MostRadiance; }))
        ++bad.num_infinite;
    else
        ++bad.num_negative;
}

bool are_fixed(const BadPixels& bad, const LoadOptions& options, const std::string& path) {
    if (bad.count() == 0)
        return false;
    if (options.fix_bad_pixels || (bad.is_harmless() && options.refuse_bad_pixels))
        return true;
    if (options.refuse_bad_pixels)
        throw std::runtime_error(fmt::format(
            "{}: expected finite radiance >= 0, got {} NaN/Inf and {} negative pixels{}, first at "
            "({}, {}); use --fix-env",
            path, bad.num_nan + bad.num_infinite, bad.num_negative,
            bad.num_negative == 0
                ? ""
                : fmt::format(" ({:.2g} % of the light)", 100.0 * bad.negative_share),
            bad.first_x, bad.first_y));
    return false;
}

float least_infinity(const ImageFile& file) {
    return file.is_half ? files::LargestHalf : 0.0f;
}

float largest_finite(const glm::vec3& pixel, float largest) {
    for (int channel = 0; channel < 3; ++channel)
        if (pixel[channel] <= BadPixels::MostRadiance)
            largest = std::max(largest, pixel[channel]);
    return largest;
}

glm::vec3 fixed(const glm::vec3& pixel, float infinity) {
    glm::vec3 result = pixel;
    for (int channel = 0; channel < 3; ++channel)
        if (!(result[channel] >= 0.0f))
            result[channel] = 0.0f; // NaN too
        else if (result[channel] > BadPixels::MostRadiance)
            result[channel] = infinity;
    return result;
}

} // namespace detail

namespace {

BadPixels find_bad_pixels(const EnvironmentImage& image) {
    BadPixels bad;
    std::size_t index = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x)
            detail::count_if_bad(image.pixels[index++], x, y, bad);
    return bad;
}

/// Returns BadPixels::negative_share.
double negative_share(const EnvironmentImage& image) {
    double below = 0.0, above = 0.0;
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        for (int channel = 0; channel < 3; ++channel) {
            const double value = image.pixels[index][channel];
            if (std::isfinite(value))
                (value < 0.0 ? below : above) += std::abs(value) * place.solid_angle;
        }
    });
    return below == 0.0 ? 0.0 : below / above; // infinite without any light
}

/// NaN and negative values become 0, infinity becomes the largest finite value, but not less than
/// what is known of it.
void fix_bad_pixels(EnvironmentImage& image, float least_infinity) {
    float largest = least_infinity;
    for (const glm::vec3& pixel : image.pixels)
        largest = detail::largest_finite(pixel, largest);
    for (glm::vec3& pixel : image.pixels)
        pixel = detail::fixed(pixel, largest);
    image.fixed = true;
    image.infinity_became = largest;
}

/// In a path of six files, `{face}` stands for px, nx, ...
constexpr std::string_view FacePlace = "{face}";

ImageFile decode(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    return format_of(bytes, path).decode(bytes, path.string());
}

/// Reads six square files, one below the other.
ImageFile decode_faces(const std::vector<std::filesystem::path>& paths) {
    ImageFile all;
    for (const std::filesystem::path& path : paths) {
        ImageFile face = decode(path);
        if (face.width != face.height)
            throw std::runtime_error(fmt::format("{}: expected a square cube face, got {}x{}",
                                                 path.string(), face.width, face.height));
        if (!all.pixels.empty() && face.width != all.width)
            throw std::runtime_error(fmt::format("{}: expected {}x{} pixels as in {}, got {}x{}",
                                                 path.string(), all.width, all.width,
                                                 paths.front().string(), face.width, face.height));
        all.width = face.width;
        all.height += face.height;
        all.pixels.insert(all.pixels.end(), face.pixels.begin(), face.pixels.end());
        if (all.remarks.empty())
            all.remarks = face.remarks;
    }
    return all;
}

/// Finds out the layout, and looks at every pixel.
EnvironmentImage understood(ImageFile file, const LoadOptions& options, const std::string& path) {
    EnvironmentImage image;
    const float least_infinity = detail::least_infinity(file);
    static_cast<Picture&>(image) = static_cast<Picture&&>(file);
    image.num_file_pixels = image.pixels.size();
    detail::interpret(file, options, path, image);
    if (image.layout == Layout::LatLong) // of others some pixels show no direction
        image.num_transparent = file.num_transparent;
    image.bad_pixels = find_bad_pixels(image);
    BadPixels& bad = image.bad_pixels;
    if (bad.count() == 0)
        return image;
    if (bad.num_negative > 0)
        bad.negative_share = negative_share(image);
    if (detail::are_fixed(bad, options, path))
        fix_bad_pixels(image, least_infinity);
    return image;
}

} // namespace

std::vector<std::filesystem::path> environment_files(const std::filesystem::path& path) {
    const std::string text = path.string();
    const std::size_t place = text.find(FacePlace);
    if (place == std::string::npos)
        return {path};
    std::vector<std::filesystem::path> paths;
    paths.reserve(FaceFileNames.size());
    for (const std::string_view face : FaceFileNames)
        paths.emplace_back(fmt::format("{}{}{}", text.substr(0, place), face,
                                       text.substr(place + FacePlace.size())));
    return paths;
}

EnvironmentImage load_environment(const std::filesystem::path& path, const LoadOptions& options) {
    const std::vector<std::filesystem::path> paths = environment_files(path);
    if (paths.size() > 1 && options.layout && *options.layout != Layout::Cube)
        throw std::runtime_error(fmt::format("{}: expected layout cube for six files, got {}",
                                             path.string(), name(*options.layout)));
    EnvironmentImage image = understood(
        paths.size() > 1 ? decode_faces(paths) : decode(paths.front()), options, path.string());
    if (paths.size() > 1)
        image.assumptions = fmt::format("cube of six files, {}", image.assumptions);
    return image;
}

EnvironmentImage environment_image(Picture picture, const std::string& name,
                                   const LoadOptions& options) {
    ImageFile file;
    static_cast<Picture&>(file) = std::move(picture);
    return understood(std::move(file), options, name);
}

std::uint32_t natural_resolution(const ImageShape& shape) {
    if (has_faces(shape.layout))
        return FaceSquares(shape.layout, shape.width, shape.height).resolution();
    if (shape.layout == Layout::Octahedral)
        return std::max(1U, static_cast<std::uint32_t>(std::lround(shape.width / OctahedralWidth)));
    return std::max(1U, (shape.width + 2) / 4);
}

std::uint32_t natural_resolution(const EnvironmentImage& image) {
    return natural_resolution(shape_of(image));
}

std::uint32_t automatic_resolution(const EnvironmentImage& image) {
    constexpr double SharpShare = 0.01;
    constexpr std::uint32_t Least = 256, Most = 1024;
    const std::uint32_t natural = natural_resolution(image);
    // Four texels a pixel are small enough, however wide the pixels are.
    const std::uint32_t finer = std::min(std::max(2 * natural, std::min(4 * natural, Least)), Most);
    // A pixel of a face is a texel of the cube map.
    if (has_faces(image.layout) || finer <= natural)
        return natural;
    double brightest = 0.0;
    double sum = 0.0;
    for (std::uint32_t y = 0; y < image.height; ++y) {
        // Pixels of other layouts differ little in solid angle.
        const double weight =
            image.layout == Layout::LatLong
                ? std::sin(std::numbers::pi * (y + 0.5) / static_cast<double>(image.height))
                : 1.0;
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const double light = weight * luminance(image.pixels[std::size_t{y} * image.width + x]);
            brightest = std::max(brightest, light);
            sum += light;
        }
    }
    return brightest > SharpShare * sum ? finer : natural;
}

ImageSize natural_size(Layout layout, std::uint32_t face_resolution) {
    const std::uint32_t r = face_resolution;
    if (has_faces(layout))
        return {squares_of(layout).width * r, squares_of(layout).height * r};
    if (layout == Layout::LatLong)
        return {4 * r, 2 * r};
    const std::uint32_t width =
        layout != Layout::Octahedral
            ? 4 * r
            : std::max(1U, static_cast<std::uint32_t>(std::lround(OctahedralWidth * r)));
    return {width, width};
}

bool is_environment_name(const std::filesystem::path& path) {
    return format_of_name(path) != nullptr;
}

void check_environment_name(const std::filesystem::path& path) {
    const ImageFormat* format = format_of_name(path);
    if (format == nullptr || format->write == nullptr)
        throw std::invalid_argument(fmt::format("{}: expected a name that ends in {}, got '{}'",
                                                path.string(), written_extensions(),
                                                files::extension_of(path)));
}

void save_image(const std::filesystem::path& path, const EnvironmentImage& image) {
    check_environment_name(path);
    const std::vector<std::filesystem::path> paths = environment_files(path);
    if (paths.size() > 1 && image.layout != Layout::Cube)
        throw std::invalid_argument(fmt::format("{}: expected layout cube for six files, got {}",
                                                path.string(), name(image.layout)));
    const auto write = [&](files::OutputFile& file, const EnvironmentImage& part) {
        format_of_name(path)->write(file, part);
    };
    std::vector<std::unique_ptr<files::OutputFile>> outputs;
    outputs.reserve(paths.size());
    for (const std::filesystem::path& each : paths)
        outputs.push_back(std::make_unique<files::OutputFile>(each));
    try {
        if (paths.size() == 1) {
            write(*outputs.front(), image);
        } else {
            EnvironmentImage face;
            face.width = face.height = image.width;
            face.sampling = Sampling::TexelCentres;
            const std::size_t num_pixels = std::size_t{face.width} * face.width;
            for (std::size_t i = 0; i < paths.size(); ++i) {
                const auto first =
                    image.pixels.begin() + static_cast<std::ptrdiff_t>(i * num_pixels);
                face.pixels.assign(first, first + static_cast<std::ptrdiff_t>(num_pixels));
                write(*outputs[i], face);
            }
        }
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
    for (const auto& output : outputs)
        output->commit();
}

Sampling default_sampling(const std::filesystem::path& path, Layout layout) {
    // The specification of the `envmap` attribute puts samples on the borders. It knows two
    // layouts; .hdr has no attribute.
    const ImageFormat* format = format_of_name(path);
    const bool has_attribute = format != nullptr && format->has_envmap &&
                               environment_files(path).size() == 1 &&
                               (layout == Layout::LatLong || layout == Layout::Cube);
    return has_attribute ? Sampling::Borders : Sampling::TexelCentres;
}

} // namespace relumine::cubemap
