#include "cubemap/resample/convert.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include "cubemap/resample/pixel_links.h"
#include "cubemap/resample/pixel_points.h"
#include "cubemap/resample/resample.h"
#include "cubemap/resample/resample_lat_long.h"
#include "cubemap/resample/resize_lat_long.h"
#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

using Pixels = std::vector<glm::vec3>;

EnvironmentImage image_of(const ImageShape& shape, Pixels pixels) {
    EnvironmentImage image;
    image.width = shape.width;
    image.height = shape.height;
    image.layout = shape.layout;
    image.sampling = shape.sampling;
    image.pixels = std::move(pixels);
    return image;
}

EnvironmentImage empty_image(const ImageShape& shape) {
    return image_of(shape, files::large_vector<glm::vec3>(std::size_t{shape.width} * shape.height));
}

/// Copies pixel by pixel. Returns nothing unless every target pixel lies on a source pixel.
std::optional<EnvironmentImage> copied(const EnvironmentImage& image, const ImageShape& target,
                                       const glm::dmat3& target_from_source) {
    if (has_faces(image.layout) != has_faces(target.layout) ||
        (!has_faces(image.layout) && image.layout != target.layout) ||
        image.sampling != target.sampling ||
        natural_resolution(target) != natural_resolution(image))
        return std::nullopt;
    // In a lat-long with samples on the borders, the whole row at a pole is one direction.
    if (image.layout == Layout::LatLong && image.sampling == Sampling::Borders &&
        target_from_source != glm::dmat3(1.0))
        return std::nullopt;
    const glm::dmat3 source_from_target = glm::transpose(target_from_source);
    if (shape_of(image) == target && source_from_target == glm::dmat3(1.0))
        return image;
    EnvironmentImage result = empty_image(target);
    const ImageShape source = shape_of(image);
    std::atomic<bool> complete = true;
    const PixelRows rows(target);
    files::parallel_for(std::uint32_t{0}, rows.size(), [&](std::uint32_t row) {
        if (complete)
            rows.visit(row, [&](std::size_t index, const PixelPlace& place) {
                const auto from = pixel_at(source, source_from_target * place.direction);
                if (from)
                    result.pixels[index] = image.pixels[*from];
                else
                    complete = false;
            });
    });
    return complete ? std::optional(std::move(result)) : std::nullopt;
}

/// Returns the resolution of a cube map that holds a cube image exactly. With samples on the
/// borders, cells are shifted by half a sample and become two texels wide.
std::uint32_t exact_resolution(const ImageShape& shape) {
    const std::uint32_t faces = natural_resolution(shape);
    return shape.sampling == Sampling::Borders && faces > 1 ? 2 * (faces - 1) : faces;
}

/// Returns the resolution of the cube map between source and target: the resolution of a layout
/// with faces, otherwise `finer` times the pictures' own. Twice is so fine that its blur does not
/// matter.
std::uint32_t resolution_between(const ImageShape& source, const ImageShape& target,
                                 std::uint32_t finer = 2) {
    if (has_faces(source.layout))
        return exact_resolution(source);
    if (has_faces(target.layout))
        return exact_resolution(target);
    constexpr std::uint32_t Finest = 4096;
    const std::uint32_t natural = std::max(natural_resolution(source), natural_resolution(target));
    return std::min(finer * natural, std::max(Finest, natural));
}

/// Whether pixels are averaged over footprints without a cube map, from either shape to the other.
bool is_direct(const ImageShape& source, const ImageShape& target,
               const glm::dmat3& target_from_source) {
    return source.layout == Layout::LatLong && target.layout == Layout::LatLong &&
           keeps_vertical(target_from_source);
}

/// Averages from one shape to another and back, by way of a cube map.
class Path {
public:
    Path(const ImageShape& source, const ImageShape& target, const glm::dmat3& target_from_source,
         std::uint32_t finer = 2)
        : source_(source), target_(target), target_from_source_(target_from_source), finer_(finer) {
    }
    /// Each target pixel is the mean over its footprint.
    [[nodiscard]] EnvironmentImage forth(const EnvironmentImage& image) const {
        return averaged(image, source_, target_, target_from_source_);
    }
    [[nodiscard]] EnvironmentImage back(const EnvironmentImage& image) const {
        return averaged(image, target_, source_, glm::transpose(target_from_source_));
    }

private:
    [[nodiscard]] EnvironmentImage averaged(const EnvironmentImage& image, const ImageShape& from,
                                            const ImageShape& to,
                                            const glm::dmat3& target_from_source) const {
        if (from.layout == Layout::LatLong && has_faces(to.layout) &&
            carries_axes_to_axes(target_from_source))
            return faces_from_lat_long(image, to, target_from_source);
        const CubeMap map =
            turned(resample(image, resolution_between(from, to, finer_)), target_from_source);
        return to_image(map, to.layout, to.width, to.height, to.sampling);
    }

    /// Averages directly into the cube's squares, for either sampling.
    [[nodiscard]] static EnvironmentImage
    faces_from_lat_long(const EnvironmentImage& image, const ImageShape& target,
                        const glm::dmat3& target_from_source) {
        const FaceSquares squares(target.layout, target.width, target.height);
        const CubeMap map =
            turned(detail::cube_from_lat_long(image, squares.resolution(), target.sampling),
                   target_from_source);
        EnvironmentImage result = empty_image(target);
        for (const Face face : AllFaces) {
            for (std::uint32_t y = 0; y < map.resolution; ++y) {
                for (std::uint32_t x = 0; x < map.resolution; ++x)
                    result.pixels[squares.pixel(face, x, y)] = map.at(face, x, y);
            }
        }
        return result;
    }

    ImageShape source_, target_;
    glm::dmat3 target_from_source_;
    std::uint32_t finer_;
};

/// Interpolates bilinearly over the sphere at four points of each pixel. The result is a smooth
/// start that keeps energy only roughly.
EnvironmentImage interpolated(const EnvironmentImage& image, const ImageShape& target,
                              const glm::dmat3& target_from_source) {
    // In the middle of a face, a lat-long's pixels are narrower than the texels of its natural
    // resolution.
    const std::uint32_t natural = natural_resolution(image);
    const std::uint32_t coarse = has_faces(image.layout) ? natural : natural + natural / 4 + 1;
    const CubeMap source = resample(image, coarse);
    const glm::dmat3 source_from_target = glm::transpose(target_from_source);
    const bool is_turned = source_from_target != glm::dmat3(1.0);
    EnvironmentImage result = empty_image(target);
    for_each_pixel_points(target, [&](std::size_t pixel, std::span<const glm::dvec3> directions) {
        glm::vec3 sum(0.0f);
        for (const glm::dvec3& direction : directions)
            sum +=
                sample(source, glm::vec3(is_turned ? source_from_target * direction : direction));
        result.pixels[pixel] = sum / static_cast<float>(directions.size());
    });
    return result;
}

/// Each target pixel is the mean over its footprint.
EnvironmentImage averaged(const EnvironmentImage& image, const ImageShape& target,
                          const glm::dmat3& target_from_source) {
    const ImageShape source = shape_of(image);
    if (!is_direct(source, target, target_from_source))
        return Path(source, target, target_from_source).forth(image);
    Pixels pixels;
    LatLongResize(source, target, target_from_source).average(image.pixels, pixels);
    return image_of(target, std::move(pixels));
}

constexpr std::size_t ChunkSize = 1 << 14;

/// Calls `work(chunk, begin, end)` for chunks of pixels, in parallel.
template<typename Work>
void for_each_chunk(std::size_t size, const Work& work) {
    files::parallel_for(std::size_t{0}, (size + ChunkSize - 1) / ChunkSize, [&](std::size_t chunk) {
        work(chunk, chunk * ChunkSize, std::min((chunk + 1) * ChunkSize, size));
    });
}

/// Pixels of zero become the means: a product never leaves zero, and the interpolation may have
/// missed a part of a wide pixel.
void fill_zeros(Pixels& grown, const std::function<const Pixels&()>& means_of_image) {
    const auto has_zero = [](const glm::vec3& pixel) {
        return pixel.x <= 0.0f || pixel.y <= 0.0f || pixel.z <= 0.0f;
    };
    if (std::none_of(grown.begin(), grown.end(), has_zero))
        return;
    const Pixels& means = means_of_image();
    for_each_chunk(grown.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            for (int channel = 0; channel < 3; ++channel)
                if (grown[i][channel] <= 0.0f)
                    grown[i][channel] = means[i][channel];
    });
}

struct Sums {
    /// The sums of |have - want| and of `want`.
    double difference = 0.0, all = 0.0;
};

/// Turns what there is into its ratio to what should be; 1 where there is nothing.
Sums take_ratio(Pixels& ratio, const Pixels& image) {
    // Chunks are summed in parallel, and their sums in order.
    std::vector<Sums> chunks((ratio.size() + ChunkSize - 1) / ChunkSize);
    for_each_chunk(ratio.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        Sums& sums = chunks[chunk];
        for (std::size_t i = begin; i < end; ++i) {
            for (int channel = 0; channel < 3; ++channel) {
                const float have = ratio[i][channel], want = image[i][channel];
                sums.difference += std::abs(static_cast<double>(have) - want);
                sums.all += want;
                ratio[i][channel] = have > 0.0f ? want / have : 1.0f;
            }
        }
    });
    Sums result;
    for (const Sums& sums : chunks) {
        result.difference += sums.difference;
        result.all += sums.all;
    }
    return result;
}

/// Multiplies `grown` by the ratio of the image to `back(grown)`, spread over the footprints by
/// `forth` (Richardson 1972, Lucy 1974). Every round keeps the image's total power exactly, makes
/// nothing negative, and leaves a constant as it is.
///
/// Differs from them: a round starts beyond the end of the last one, in the same direction
/// (Nesterov 1983; Biggs and Andrews 1997 for this iteration). This takes a fraction of the rounds.
/// The result is the end of a round, so the power is still exact.
///
/// `forth` and `back` average their first argument into their second. They may borrow its memory.
template<typename Forth, typename Back>
void correct(const Pixels& image, const Forth& forth, const Back& back, int num_rounds,
             Pixels& grown) {
    Pixels ratio, factor;
    fill_zeros(grown, [&]() -> const Pixels& {
        ratio = image;
        forth(ratio, factor);
        return factor;
    });
    // Where the round starts: the first one at `grown`.
    Pixels later_start;
    double last_difference = std::numeric_limits<double>::infinity(),
           earlier_difference = last_difference;
    // Rounds since the last restart.
    int run = 0;
    for (int round = 0; round < num_rounds; ++round) {
        Pixels& start = round == 0 ? grown : later_start;
        back(start, ratio);
        const auto [difference, sum] = take_ratio(ratio, image);
        forth(ratio, factor);
        // The difference rose, so the step was too long: restart.
        run = difference > last_difference ? 0 : run + 1;
        last_difference = difference;
        // Wedges narrower than the target's pixels cannot be told apart. The difference then stops
        // falling: it must fall by a fiftieth in Patience rounds. Restarts make it wave for some
        // ten rounds.
        constexpr int Patience = 20;
        // Enough is a tenth of the error that irradiance may have. More rounds would turn pixels
        // around poles and rims into specks.
        constexpr double Enough = 1e-4, Falling = 0.98;
        bool is_last = difference <= Enough * sum;
        if (round % Patience == 0) {
            is_last = is_last || difference > Falling * earlier_difference;
            earlier_difference = difference;
        }
        is_last = is_last || round + 1 == num_rounds;
        if (!is_last)
            later_start.resize(grown.size());
        const float further =
            run > 0 ? static_cast<float>(run - 1) / static_cast<float>(run + 2) : 0.0f;
        // Least value relative to the pixel. The next round multiplies, so a value must not come
        // near zero.
        constexpr float Least = 0.25f;
        for_each_chunk(grown.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const glm::vec3 after = start[i] * factor[i];
                if (!is_last)
                    later_start[i] = glm::max(after + further * (after - grown[i]), Least * after);
                grown[i] = after;
            }
        });
        if (is_last)
            return;
    }
}

EnvironmentImage grown(const EnvironmentImage& image, const ImageShape& target,
                       const glm::dmat3& target_from_source) {
    const ImageShape source = shape_of(image);
    EnvironmentImage result = interpolated(image, target, target_from_source);
    constexpr int MostRounds = 200; // a sun in a disc's rim needs most of them
    if (is_direct(source, target, target_from_source)) {
        LatLongResize forth(source, target, target_from_source);
        LatLongResize back(target, source, glm::transpose(target_from_source));
        correct(
            image.pixels, [&](const Pixels& from, Pixels& to) { forth.average(from, to); },
            [&](const Pixels& from, Pixels& to) { back.average(from, to); }, MostRounds,
            result.pixels);
        return result;
    }
    // In pictures this large a sun is never smaller than a pixel, and the links would take
    // gigabytes. The interpolation is nearly right: its irradiance is off by 2e-4 at most, and by
    // less than 1e-5 after one round. So the cube map need not be finer than the pictures.
    constexpr std::size_t Large = std::size_t{1} << 22;
    if (std::max(image.pixels.size(), result.pixels.size()) > Large) {
        const Path path(source, target, target_from_source, 1);
        const auto average = [&](const ImageShape& shape, Pixels& from, auto along) {
            EnvironmentImage borrowed = image_of(shape, std::move(from));
            Pixels means = (path.*along)(borrowed).pixels;
            from = std::move(borrowed.pixels);
            return means;
        };
        correct(
            image.pixels,
            [&](Pixels& from, Pixels& to) {
                to = Pixels(); // its memory would only be a second picture's
                to = average(source, from, &Path::forth);
            },
            [&](Pixels& from, Pixels& to) { to = average(target, from, &Path::back); }, 1,
            result.pixels);
        return result;
    }
    const PixelLinks links(source, target, target_from_source, resolution_between(source, target),
                           has_faces(source.layout) ? PixelLinks::Axes::Source
                                                    : PixelLinks::Axes::Target);
    correct(
        image.pixels, [&](const Pixels& from, Pixels& to) { to = links.to_target(from); },
        [&](const Pixels& from, Pixels& to) { to = links.to_source(from); }, MostRounds,
        result.pixels);
    return result;
}

} // namespace

EnvironmentImage convert(const EnvironmentImage& image, const ImageShape& target,
                         const glm::dmat3& target_from_source) {
    if (!fits(target.layout, target.width, target.height))
        throw std::invalid_argument(fmt::format("convert: a {} cannot be {}x{}",
                                                name(target.layout), target.width, target.height));
    if (auto copy = copied(image, target, target_from_source))
        return std::move(*copy);
    // At about the same size there is nothing to smooth and hardly any room for corrections.
    const bool grows = 5 * natural_resolution(target) > 6 * natural_resolution(image);
    EnvironmentImage result = grows ? grown(image, target, target_from_source)
                                    : averaged(image, target, target_from_source);
    result.assumptions = "converted";
    return result;
}

ImageSize conversion_size(const EnvironmentImage& image, Layout target) {
    const std::uint32_t natural = natural_resolution(image);
    if (target == image.layout)
        return {image.width, image.height};
    if (has_faces(target) && has_faces(image.layout))
        return natural_size(target, natural);
    // The rim pixels of a disc are long wedges that meet in a point. Only finer pixels tell them
    // apart.
    const bool is_disc = image.layout == Layout::AngularMap || image.layout == Layout::MirrorBall;
    // An octahedral map has elongated pixels where the rim of an angular map points.
    const std::uint32_t roomy = !is_disc ? 256 : target == Layout::Octahedral ? 640 : 512;
    return natural_size(target, std::max(natural, roomy));
}

} // namespace relumine::cubemap
