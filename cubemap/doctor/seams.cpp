#include "cubemap/doctor/seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "cubemap/doctor/bright_spot.h"
#include "cubemap/image/image_layout.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

// Thresholds in stops, and factors of a usual step. They come from some twenty measured
// environments: none has a fault that the eye cannot see, while a lost row or a turned face is a
// fault.
/// Relative to the most uneven hundredth of the columns.
constexpr double WrapFactor = 2.0, WrapLeastEv = 0.15;
/// Relative to the most uneven of the next rows.
constexpr double PoleFactor = 3.0, PoleLeastEv = 0.2;
/// Around the pole, relative to one row's step.
constexpr double AroundFactor = 4.0, AroundLeastEv = 0.4;
/// Relative to one texel's step beside the edge.
constexpr double EdgeFactor = 2.5, EdgeLeastEv = 0.15;
constexpr std::size_t NumPoleRows = 8;
constexpr std::uint32_t LeastHeight = 16, LeastFace = 8;
/// Luminance below this part of the mean counts as dark: its variation in stops does not matter.
constexpr double DarkPart = 1e-2;

double quantile(std::vector<double> values, double part) {
    const auto at = values.begin() + std::lround(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

/// The luminance of an image's pixels in stops. Pixels are computed when asked for: a large map
/// would not fit into memory twice.
class Stops {
public:
    explicit Stops(const EnvironmentImage& image) : image_(image) {
        double sum = 0.0;
        for (const glm::vec3& pixel : image.pixels)
            sum += luminance(glm::dvec3(pixel));
        mean_ = sum / static_cast<double>(image.pixels.size());
    }
    [[nodiscard]] double operator[](std::size_t pixel) const {
        return mean_ > 0.0
                   ? std::log2(luminance(glm::dvec3(image_.pixels[pixel])) / mean_ + DarkPart)
                   : 0.0;
    }

private:
    const EnvironmentImage& image_;
    double mean_ = 0.0;
};

class LatLongCheck {
public:
    LatLongCheck(const EnvironmentImage& image, std::vector<SeamFault>& faults)
        : width_(image.width), height_(image.height), stops_(image),
          rows_(detail::lat_long_rows(shape_of(image))), faults_(faults) {}

    void wrap() const {
        std::vector<double> steps = mean_steps();
        const double seam = steps.back();
        steps.pop_back();
        const double usual = quantile(steps, 0.99);
        if (seam > WrapFactor * usual && seam > WrapLeastEv)
            faults_.push_back({"left and right edge", seam, median(steps)});
    }

    void pole(bool is_top) const {
        const auto row = [&](std::size_t i) {
            const std::size_t y = is_top ? i : height_ - 1 - i;
            std::vector<double> values(width_);
            for (std::size_t x = 0; x < width_; ++x)
                values[x] = stops_[y * width_ + x];
            return values;
        };
        std::vector<double> levels;
        for (std::size_t i = 0; i <= NumPoleRows; ++i)
            levels.push_back(median(row(i)));
        // Rows differ from one to the next. Grain also makes the pole differ from the mean, since
        // all its pixels may be one sample.
        double usual = 0.0;
        for (std::size_t i = 1; i < NumPoleRows; ++i) {
            std::vector<double> grain;
            for (const double value : row(i))
                grain.push_back(std::abs(value - levels[i]));
            usual = std::max({usual, std::abs(levels[i + 1] - levels[i]), median(grain)});
        }
        const double seam = std::abs(levels[1] - levels[0]);
        const std::string name = is_top ? "top row" : "bottom row";
        if (seam > PoleFactor * usual && seam > PoleLeastEv) {
            faults_.push_back({name, seam, usual});
            return;
        }
        // All pixels of the row lie within one row's height of each other.
        const std::vector<double> first = row(0), second = row(1);
        std::vector<double> around, down;
        for (std::size_t x = 0; x < width_; ++x) {
            around.push_back(std::abs(first[x] - levels[0]));
            down.push_back(std::abs(first[x] - second[x]));
        }
        const double spread = median(around), beside = median(down);
        if (spread > AroundFactor * beside && spread > AroundLeastEv)
            faults_.push_back({name + " around the pole", spread, beside});
    }

private:
    /// Returns the mean step from each column to the next one, and from the last to the first. Rows
    /// are weighted with their solid angles.
    [[nodiscard]] std::vector<double> mean_steps() const {
        // Bands of rows are summed in parallel, and the bands in order.
        constexpr std::size_t BandHeight = 64;
        std::vector<std::vector<double>> bands((height_ + BandHeight - 1) / BandHeight);
        files::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t band) {
            std::vector<double>& sums = bands[band];
            sums.assign(width_, 0.0);
            const std::size_t end = std::min((band + 1) * BandHeight, height_);
            for (std::size_t y = band * BandHeight; y < end; ++y) {
                const double first = stops_[y * width_];
                double here = first;
                for (std::size_t x = 0; x < width_; ++x) {
                    const double next = x + 1 < width_ ? stops_[y * width_ + x + 1] : first;
                    sums[x] += rows_[y].height * std::abs(next - here);
                    here = next;
                }
            }
        });
        double weights = 0.0;
        for (const detail::LatLongRow& row : rows_)
            weights += row.height;
        std::vector<double> steps(width_, 0.0);
        for (std::size_t x = 0; x < width_; ++x) {
            for (const std::vector<double>& sums : bands)
                steps[x] += sums[x];
            steps[x] /= weights;
        }
        return steps;
    }

    std::size_t width_, height_;
    Stops stops_;
    std::vector<detail::LatLongRow> rows_;
    std::vector<SeamFault>& faults_;
};

/// A texel of a face.
struct Texel {
    Face face;
    std::uint32_t x, y;
};

/// Returns the texel one step further into the face from its border.
Texel inwards(Texel texel, bool across, std::uint32_t resolution) {
    std::uint32_t& position = across ? texel.x : texel.y;
    position = position < resolution / 2 ? position + 1 : position - 1;
    return texel;
}

/// A border of a face.
struct Border {
    Face face;
    /// True: left or right border. False: top or bottom.
    bool across;
    /// True: right or bottom border.
    bool far;
};

/// Returns the texel beyond a border, and whether it lies on a left or right border of its face.
std::pair<Texel, bool> beyond(const Border& border, double along, std::uint32_t resolution) {
    constexpr double Outside = 1e-7;
    const double out = border.far ? 1.0 + Outside : -Outside;
    const FacePoint point = face_point(border.across ? cube_point(border.face, out, along)
                                                     : cube_point(border.face, along, out));
    const auto index = [&](double position) {
        return static_cast<std::uint32_t>(std::clamp(position * resolution, 0.0, resolution - 1.0));
    };
    const double from_side = std::min(point.s, 1.0 - point.s),
                 from_top = std::min(point.t, 1.0 - point.t);
    return {{point.face, index(point.s), index(point.t)}, from_side < from_top};
}

std::string_view axis_name(Face face) {
    static constexpr std::array<std::string_view, NumFaces> Names = {"+X", "-X", "+Y",
                                                                     "-Y", "+Z", "-Z"};
    return Names[static_cast<std::size_t>(face)];
}

void check_edges(const EnvironmentImage& image, const FaceSquares& squares,
                 std::vector<SeamFault>& faults) {
    const std::uint32_t resolution = squares.resolution();
    const Stops values(image);
    const auto at = [&](const Texel& texel) {
        return values[squares.pixel(texel.face, texel.x, texel.y)];
    };
    for (const Face face : AllFaces) {
        for (int side = 0; side < 4; ++side) {
            const Border border{face, side < 2, side % 2 == 1};
            std::vector<double> over, beside;
            Face other = face;
            for (std::uint32_t i = 0; i < resolution; ++i) {
                const std::uint32_t end = border.far ? resolution - 1 : 0;
                const Texel here = border.across ? Texel{face, end, i} : Texel{face, i, end};
                // With either sampling, texel i has the same number on the other face, or the same
                // number counted from the other end.
                const auto [there, there_across] =
                    beyond(border, (i + 0.5) / resolution, resolution);
                other = there.face;
                over.push_back(std::abs(at(here) - at(there)));
                beside.push_back(std::abs(at(here) - at(inwards(here, border.across, resolution))));
                beside.push_back(
                    std::abs(at(there) - at(inwards(there, there_across, resolution))));
            }
            const double step = median(over), usual = median(beside);
            if (face < other && step > EdgeFactor * usual && step > EdgeLeastEv)
                faults.push_back(
                    {fmt::format("edge of {} and {}", axis_name(face), axis_name(other)), step,
                     usual});
        }
    }
}

} // namespace

std::vector<SeamFault> seam_faults(const EnvironmentImage& image) {
    std::vector<SeamFault> faults;
    if (image.layout == Layout::LatLong) {
        if (image.height < LeastHeight || image.width < 2 * LeastHeight)
            return faults;
        const LatLongCheck check(image, faults);
        check.wrap();
        check.pole(true);
        check.pole(false);
    } else if (has_faces(image.layout)) {
        const FaceSquares squares(image.layout, image.width, image.height);
        if (squares.resolution() >= LeastFace)
            check_edges(image, squares, faults);
    }
    return faults;
}

} // namespace relumine::cubemap
