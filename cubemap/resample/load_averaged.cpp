#include "cubemap/resample/load_averaged.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "cubemap/image/environment_checks.h"
#include "cubemap/image/image_file.h"
#include "cubemap/image/image_layout.h"
#include "cubemap/image/image_size.h"
#include "cubemap/resample/axis_means.h"
#include "files/joined.h"
#include "files/large_vector.h"
#include "files/output_file.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

using detail::AxisMeans;

/// Rows of the smaller picture that are made together. The rows of the file under them are whole
/// blocks of every compression where two become one.
constexpr std::uint32_t BandHeight = 128;
/// Bands that are in memory at once, whatever the number of threads.
constexpr std::uint32_t BandsAtOnce = 8;

/// What was seen of the file's pixels.
struct Seen {
    BadPixels bad;
    ImageRows::Counts counts;
    float largest = 0.0f;
    double below = 0.0, above = 0.0;

    void add(const Seen& next) {
        if (bad.count() == 0) {
            bad.first_x = next.bad.first_x;
            bad.first_y = next.bad.first_y;
        }
        bad.num_nan += next.bad.num_nan;
        bad.num_infinite += next.bad.num_infinite;
        bad.num_negative += next.bad.num_negative;
        counts.num_transparent += next.counts.num_transparent;
        counts.num_outside += next.counts.num_outside;
        largest = std::max(largest, next.largest);
        below += next.below;
        above += next.above;
    }
};

AxisMeans column_means(const ImageShape& source, std::uint32_t width) {
    return {cell_borders(source.width, source.sampling),
            cell_borders(width, Sampling::TexelCentres), [](double u) { return u; },
            [](double a, double b) {
                return b - a;
            }};
}

AxisMeans row_means(const ImageShape& source, std::uint32_t height) {
    constexpr double Pi = std::numbers::pi;
    return {cell_borders(source.height, source.sampling),
            cell_borders(height, Sampling::TexelCentres), [](double v) { return v; },
            [](double a, double b) {
                return std::cos(Pi * a) - std::cos(Pi * b);
            }};
}

class AveragedReading {
public:
    /// `image` has the file's layout, sampling and size.
    AveragedReading(const ImageRows& rows, const EnvironmentImage& image, std::uint32_t parts)
        : rows_(rows), source_(shape_of(image)), width_((image.width + parts - 1) / parts),
          height_((image.height + parts - 1) / parts), columns_(column_means(source_, width_)),
          row_means_(row_means(source_, height_)), heights_(detail::lat_long_rows(source_)) {}

    [[nodiscard]] std::uint32_t width() const { return width_; }
    [[nodiscard]] std::uint32_t height() const { return height_; }

    /// Fills the smaller picture. Bad pixels count as they are, or, with `infinity`, as what they
    /// are replaced by.
    Seen read(std::vector<glm::vec3>& pixels, const float* infinity) const {
        const std::uint32_t num_bands = (height_ + BandHeight - 1) / BandHeight;
        std::vector<Seen> seen(num_bands);
        for (std::uint32_t first = 0; first < num_bands; first += BandsAtOnce)
            files::parallel_for(
                files::IndexRange<std::uint32_t>(first, std::min(first + BandsAtOnce, num_bands)),
                [&](const auto& bands) {
                    for (std::uint32_t band = bands.begin(); band != bands.end(); ++band)
                        seen[band] = read_band(band, pixels, infinity);
                });
        Seen all;
        for (const Seen& each : seen)
            all.add(each);
        return all;
    }

private:
    Seen read_band(std::uint32_t band, std::vector<glm::vec3>& pixels,
                   const float* infinity) const {
        const std::uint32_t top = band * BandHeight;
        const std::uint32_t bottom = std::min(top + BandHeight, height_);
        // A row across the border of two bands is read twice and looked at in the upper one.
        const std::uint32_t begin = row_means_.of(top).front().source;
        const std::uint32_t end = row_means_.of(bottom - 1).back().source + 1;
        const std::uint32_t first_new = top == 0 ? 0 : row_means_.of(top - 1).back().source + 1;
        std::vector<glm::vec3> of_file(std::size_t{end - begin} * source_.width);
        Seen seen;
        if (first_new > begin) // counted apart
            rows_.read(begin,
                       std::span(of_file).first(std::size_t{first_new - begin} * source_.width));
        seen.counts = rows_.read(
            first_new, std::span(of_file).subspan(std::size_t{first_new - begin} * source_.width));
        const auto row = [&](std::uint32_t y) {
            return std::span(of_file).subspan(std::size_t{y - begin} * source_.width,
                                              source_.width);
        };
        for (std::uint32_t y = first_new; y < end; ++y)
            look_at(row(y), y, seen);
        if (infinity != nullptr)
            for (glm::vec3& pixel : of_file)
                pixel = detail::fixed(pixel, *infinity);
        std::vector<glm::dvec3> sums(width_);
        for (std::uint32_t y = top; y < bottom; ++y) {
            std::fill(sums.begin(), sums.end(), glm::dvec3(0.0));
            for (const auto& [from, weight] : row_means_.of(y))
                add_row(row(from), weight, sums);
            std::transform(sums.begin(), sums.end(),
                           pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * width_),
                           [](const glm::dvec3& sum) { return glm::vec3(sum); });
        }
        return seen;
    }

    void add_row(std::span<const glm::vec3> row, double weight,
                 std::vector<glm::dvec3>& sums) const {
        for (std::size_t x = 0; x < sums.size(); ++x)
            for (const auto& [column, part] : columns_.of(x))
                sums[x] += weight * part * glm::dvec3(row[column]);
    }

    void look_at(std::span<const glm::vec3> row, std::uint32_t y, Seen& seen) const {
        for (std::uint32_t x = 0; x < source_.width; ++x) {
            const glm::vec3& pixel = row[x];
            detail::count_if_bad(pixel, x, y, seen.bad);
            seen.largest = detail::largest_finite(pixel, seen.largest);
        }
        double below = 0.0, above = 0.0;
        for (const glm::vec3& pixel : row)
            for (int channel = 0; channel < 3; ++channel)
                if (std::isfinite(pixel[channel]))
                    (pixel[channel] < 0.0f ? below : above) += std::abs(pixel[channel]);
        seen.below += below * heights_[y].height;
        seen.above += above * heights_[y].height;
    }

    const ImageRows& rows_;
    ImageShape source_;
    std::uint32_t width_, height_;
    AxisMeans columns_, row_means_;
    std::vector<detail::LatLongRow> heights_;
};

/// Returns the rows of a lat-long in one file that is too wide.
std::unique_ptr<ImageRows> rows_of_wide(const std::filesystem::path& path,
                                        const LoadOptions& options, std::uint32_t most_width) {
    if (options.layout.value_or(Layout::LatLong) != Layout::LatLong ||
        environment_files(path).size() > 1 || read_image_size(path).width <= most_width)
        return nullptr;
    const std::vector<std::byte> head =
        files::read(path, 0, std::min(files::size(path), MaxHeadBytes));
    return format_of(head, path).rows(path);
}

} // namespace

EnvironmentImage load_averaged(const std::filesystem::path& path, const LoadOptions& options,
                               std::uint32_t most_width) {
    const std::unique_ptr<ImageRows> rows = rows_of_wide(path, options, most_width);
    EnvironmentImage image;
    if (rows != nullptr) {
        image.width = rows->head().width;
        image.height = rows->head().height;
        detail::interpret(rows->head(), options, path.string(), image);
    }
    if (rows == nullptr || image.layout != Layout::LatLong)
        return load_environment(path, options);

    const AveragedReading reading(*rows, image, (image.width + most_width - 1) / most_width);
    image.pixels = files::large_vector<glm::vec3>(std::size_t{reading.width()} * reading.height());
    const Seen seen = reading.read(image.pixels, nullptr);
    image.bad_pixels = seen.bad;
    if (seen.bad.num_negative > 0)
        image.bad_pixels.negative_share = seen.below / seen.above; // infinite without any light
    if (detail::are_fixed(image.bad_pixels, options, path.string())) {
        image.infinity_became = std::max(detail::least_infinity(rows->head()), seen.largest);
        reading.read(image.pixels, &image.infinity_became);
        image.fixed = true;
    }
    image.num_transparent = seen.counts.num_transparent;
    image.num_file_pixels = std::size_t{image.width} * image.height;
    if (rows->colors() != nullptr)
        image.assumptions += ", " + rows->colors()->remark(seen.counts.num_outside);
    image.assumptions += fmt::format(", {}x{} pixels averaged to {}x{}", image.width, image.height,
                                     reading.width(), reading.height());
    image.width = reading.width();
    image.height = reading.height();
    image.sampling = Sampling::TexelCentres;
    return image;
}

} // namespace relumine::cubemap
