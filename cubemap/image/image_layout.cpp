#include "cubemap/image/image_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/image/footprint.h"
#include "cubemap/image/projection.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

constexpr double Pi = std::numbers::pi;

using Squares = std::array<detail::FaceSquare, NumFaces>;
constexpr Squares InAColumn = {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}};
constexpr Squares InARow = {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}};
// The cross unfolds the cube around -Z, as HDR Shop and Debevec's probes do; +Z hangs at the
// bottom, upside down:
//
//          +Y
//      -X  -Z  +X
//          -Y
//          +Z (turned)
constexpr Squares Upright = {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 3, true}, {1, 1}}};
//          +Y
//      -X  -Z  +X  +Z
//          -Y
constexpr Squares Lying = {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {3, 1}, {1, 1}}};

/// What distinguishes the layouts, in their order.
struct LayoutFacts {
    Layout layout;
    std::string_view name, option_name;
    /// How many squares lie side by side and one below the other, and those of the faces, where the
    /// layout is made of faces.
    std::uint32_t columns = 0, rows = 0;
    Squares squares = {};
};
constexpr std::array<LayoutFacts, AllLayouts.size()> Layouts = {{
    {Layout::LatLong, "lat-long", "latlong"},
    {Layout::Cube, "cube", "cube", 1, 6, InAColumn},
    {Layout::VerticalCross, "vertical cross", "cross", 3, 4, Upright},
    {Layout::HorizontalStrip, "horizontal strip", "strip", 6, 1, InARow},
    {Layout::HorizontalCross, "horizontal cross", "hcross", 4, 3, Lying},
    {Layout::AngularMap, "angular map", "angular"},
    {Layout::MirrorBall, "mirror ball", "mirrorball"},
    {Layout::Octahedral, "octahedral map", "octahedral"},
}};

constexpr const LayoutFacts& facts(Layout layout) {
    return Layouts[static_cast<std::size_t>(layout)];
}
static_assert(std::all_of(AllLayouts.begin(), AllLayouts.end(),
                          [](Layout layout) { return facts(layout).layout == layout; }));

} // namespace

std::string_view name(Layout layout) {
    return facts(layout).name;
}

std::string_view option_name(Layout layout) {
    return facts(layout).option_name;
}

ImageSize squares_of(Layout layout) {
    return {facts(layout).columns, facts(layout).rows};
}

bool has_faces(Layout layout) {
    return facts(layout).columns != 0;
}

std::vector<double> cell_borders(std::uint32_t num_cells, Sampling sampling) {
    std::vector<double> borders(std::size_t{num_cells} + 1);
    const double n = num_cells;
    for (std::size_t i = 0; i <= num_cells; ++i) {
        const auto position = static_cast<double>(i);
        borders[i] =
            sampling == Sampling::TexelCentres ? position / n : (position - 0.5) / (n - 1.0);
    }
    borders.front() = 0.0;
    borders.back() = 1.0;
    return borders;
}

double sample_position(std::uint32_t index, std::uint32_t num_samples, Sampling sampling) {
    if (sampling == Sampling::TexelCentres || num_samples == 1)
        return (index + 0.5) / num_samples;
    return static_cast<double>(index) / (num_samples - 1);
}

bool fits(Layout layout, std::uint32_t width, std::uint32_t height) {
    if (width == 0 || height == 0)
        return false;
    const auto [columns, rows] = squares_of(layout);
    if (columns != 0)
        return width % columns == 0 && height % rows == 0 && width / columns == height / rows;
    return layout == Layout::LatLong || width == height;
}

std::optional<std::size_t> pixel_at(const ImageShape& shape, const glm::dvec3& direction) {
    // Returns the sample of n that lies at a position of [0, 1], if there is one.
    const auto sample = [&](double position, std::uint32_t n) -> std::optional<std::size_t> {
        const double index =
            shape.sampling == Sampling::Borders && n > 1 ? position * (n - 1) : position * n - 0.5;
        const double nearest = std::round(index);
        constexpr double Tolerance = 1e-6;
        if (std::abs(index - nearest) > Tolerance || nearest < 0.0 || nearest > n - 1.0)
            return std::nullopt;
        return static_cast<std::size_t>(nearest);
    };
    if (has_faces(shape.layout)) {
        const FaceSquares squares(shape.layout, shape.width, shape.height);
        const FacePoint point = face_point(direction);
        const auto x = sample(point.s, squares.resolution()),
                   y = sample(point.t, squares.resolution());
        if (!x || !y)
            return std::nullopt;
        return squares.pixel(point.face, static_cast<std::uint32_t>(*x),
                             static_cast<std::uint32_t>(*y));
    }
    glm::dvec2 point(0.0);
    if (const Projection* picture = projection(shape.layout))
        point = picture->point(direction);
    else
        point = {0.5 - std::atan2(direction.x, direction.z) / (2.0 * Pi),
                 std::atan2(std::hypot(direction.x, direction.z), direction.y) / Pi};
    const auto x = sample(point.x, shape.width), y = sample(point.y, shape.height);
    if (!x || !y)
        return std::nullopt;
    return *y * shape.width + *x;
}

FaceSquares::FaceSquares(Layout layout, std::uint32_t width, std::uint32_t height)
    : width_(width), squares_(facts(layout).squares) {
    if (!has_faces(layout) || !fits(layout, width, height))
        throw std::invalid_argument(fmt::format(
            "expected an image of six cube faces, got a {} of {}x{}", name(layout), width, height));
    resolution_ = width / facts(layout).columns;
}

namespace detail {

std::vector<LatLongRow> lat_long_rows(const ImageShape& shape) {
    const std::vector<double> borders = cell_borders(shape.height, shape.sampling);
    std::vector<LatLongRow> rows(shape.height);
    for (std::uint32_t y = 0; y < shape.height; ++y) {
        const double polar = Pi * sample_position(y, shape.height, shape.sampling);
        const double top = Pi * borders[y], bottom = Pi * borders[y + 1];
        // cos(top) - cos(bottom) without cancellation
        const double height = 2.0 * std::sin(0.5 * (top + bottom)) * std::sin(0.5 * (bottom - top));
        rows[y] = {std::cos(polar), std::sin(polar), height};
    }
    return rows;
}

std::vector<LatLongColumn> lat_long_columns(const ImageShape& shape) {
    const std::vector<double> borders = cell_borders(shape.width, shape.sampling);
    std::vector<LatLongColumn> columns(shape.width);
    for (std::uint32_t x = 0; x < shape.width; ++x) {
        const double longitude = 2.0 * Pi * (0.5 - sample_position(x, shape.width, shape.sampling));
        columns[x] = {std::sin(longitude), std::cos(longitude),
                      2.0 * Pi * (borders[x + 1] - borders[x])};
    }
    return columns;
}

namespace {

/// Finds rows of a Projection's pixels.
class ProjectedRow {
public:
    explicit ProjectedRow(const ImageShape& shape)
        : picture_(*projection(shape.layout)), width_(shape.width), height_(shape.height),
          pieces_(picture_, shape.width, shape.height) {}

    /// Puts the places of a row's pixels into `row`. `angles` are the solid angles of whole pixels;
    /// empty: of no pixel.
    void find(std::uint32_t y, std::span<const double> angles, std::vector<PixelPlace>& row) {
        row.resize(width_);
        for (std::uint32_t x = 0; x < width_; ++x) {
            PixelPlace& place = row[x];
            const bool is_whole = pieces_.is_whole(x, y);
            if (is_whole)
                place.direction = picture_.direction(point(x, y));
            if (is_whole && !angles.empty()) {
                place.solid_angle = angles[std::min(x, width_ - 1 - x)];
                continue;
            }
            glm::dvec3 mean(0.0);
            pieces_.visit(x, y, [&](std::span<const glm::dvec3> corners) {
                const double angle = solid_angle(corners);
                glm::dvec3 sum(0.0);
                for (const glm::dvec3& corner : corners)
                    sum += corner;
                place.solid_angle += angle;
                mean += angle * sum / static_cast<double>(corners.size());
            });
            if (!is_whole && glm::length(mean) > 0.0)
                place.direction = glm::normalize(mean);
        }
    }

    /// Returns the solid angles of whole pixels in the left half of a row.
    [[nodiscard]] std::vector<double> whole_angles(std::uint32_t y) const {
        // Gauss-Legendre with three points in each direction is exact to 1e-9 of a small pixel.
        constexpr std::uint32_t SmallPixels = 32;
        constexpr std::array<double, 3> Nodes = {-0.387298334620741689, 0.0, 0.387298334620741689};
        constexpr std::array<double, 3> Weights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
        if (width_ < SmallPixels)
            return {};
        const double area = 1.0 / (static_cast<double>(width_) * height_);
        std::vector<double> angles((width_ + 1) / 2);
        for (std::size_t x = 0; x < angles.size(); ++x)
            for (std::size_t i = 0; i < 9; ++i)
                angles[x] += Weights[i % 3] * Weights[i / 3] * area *
                             picture_.density(
                                 point(static_cast<double>(x) + Nodes[i % 3], y + Nodes[i / 3]));
        return angles;
    }

private:
    [[nodiscard]] glm::dvec2 point(double x, double y) const {
        return {(x + 0.5) / width_, (y + 0.5) / height_};
    }

    const Projection& picture_;
    std::uint32_t width_, height_;
    ProjectionFootprints pieces_;
};

} // namespace

ProjectedRows::ProjectedRows(const ImageShape& shape, std::uint32_t y) {
    ProjectedRow row(shape);
    // Both axes through the middle mirror the density of every projection.
    const std::vector<double> angles = row.whole_angles(y);
    row.find(y, angles, upper);
    row.find(shape.height - 1 - y, angles, lower);
}

void for_each_projected_rows(
    const ImageShape& shape,
    const std::function<void(std::uint32_t, const ProjectedRows&)>& visit) {
    constexpr std::uint32_t NumTogether = 64;
    const std::uint32_t half = (shape.height + 1) / 2;
    for (std::uint32_t first = 0; first < half; first += NumTogether) {
        const std::uint32_t end = std::min(first + NumTogether, half);
        std::vector<std::optional<ProjectedRows>> rows(end - first);
        files::parallel_for(first, end,
                            [&](std::uint32_t y) { rows[y - first].emplace(shape, y); });
        for (std::uint32_t y = first; y < end; ++y)
            visit(y, *rows[y - first]);
    }
}

} // namespace detail

} // namespace relumine::cubemap
