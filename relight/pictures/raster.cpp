#include "relight/pictures/raster.h"

#include <array>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "files/parallel.h"

namespace relumine::relight {

/// A triangle as linear functions of the place in the picture. With e_k the edge opposite corner k
/// as a plane through the eye, and d the direction of a sample, at distance 1,
///
///     w_k = e_k . d / det,   e_0 = v_1 x v_2 (and so on),   det = v_0 . e_0,
///
/// all three are positive where the sample's ray meets the triangle; their sum is then 1 over its
/// depth, and w_k over the sum the weight of corner k.
struct Raster::Planes {
    /// The values of w_k at the first sample of the picture, and their change per sample to the
    /// right and down.
    std::array<double, 3> first{}, right{}, down{};
    bool is_front = false;
    /// Whether any ray may meet the triangle.
    bool is_seen = false;

    [[nodiscard]] double at(std::size_t k, double x, double y) const {
        return first[k] + x * right[k] + y * down[k];
    }
};

/// The samples that a triangle may be seen in, in samples of the picture; none where least is more
/// than most.
struct Raster::Box {
    glm::dvec2 least{std::numeric_limits<double>::infinity()}, most = -least;
    /// Some corners lie before the eye and some behind.
    bool crosses_eye = false;
};

namespace {

/// Samples of a rectangle of pixels: places from its first sample on.
struct SampleSpan {
    std::int32_t begin = 0, end = 0;
};

/// Returns the whole numbers of [0, size) that are at least `value`: the first of them.
std::int32_t first_from(float value, std::int32_t size) {
    if (!(value > 0.0f))
        return 0;
    if (!(value < static_cast<float>(size)))
        return size;
    const auto whole = static_cast<std::int32_t>(value);
    return whole + static_cast<std::int32_t>(static_cast<float>(whole) < value);
}

/// The place where three planes of a triangle are not negative, row by row.
struct RowCutter {
    std::array<float, 3> first{}, right{}, down{}, over_right{};

    [[nodiscard]] SampleSpan row(float y, std::int32_t width) const {
        SampleSpan span{0, width};
        for (std::size_t k = 0; k < 3; ++k) {
            const float start = first[k] + y * down[k];
            if (right[k] > 0.0f)
                span.begin = std::max(span.begin, first_from(-start * over_right[k], width));
            else if (right[k] < 0.0f)
                span.end = std::min(span.end, width - first_from(static_cast<float>(width - 1) +
                                                                     start * over_right[k],
                                                                 width));
            else if (start < 0.0f)
                return {};
        }
        return span;
    }
};

} // namespace

/// The nearest triangle of each sample of a rectangle.
class Raster::Depths {
public:
    Depths(std::int32_t width, std::int32_t height, const prt::CoplanarFaces& coplanar)
        : width_(width), height_(height), coplanar_(coplanar),
          nearest_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
          triangles_(nearest_.size(), EyeSample::NoTriangle) {}

    /// Draws a triangle. Its box, in samples of the rectangle, must lie within.
    void draw(std::uint32_t triangle, const Planes& planes, double left, double top,
              const std::array<std::int32_t, 4>& box) {
        const auto [x0, y0, x1, y1] = box;
        const std::int32_t width = x1 - x0, height = y1 - y0;
        if (width <= 0 || height <= 0)
            return;
        // Edges are moved out by a hundredfold of what rounding may move them, so that no sample
        // falls between neighbours.
        constexpr double Roundings = 0x1p-19;
        RowCutter cutter;
        double depth = 0.0, depth_right = 0.0, depth_down = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double first = planes.at(k, left + x0, top + y0);
            depth += first;
            depth_right += planes.right[k];
            depth_down += planes.down[k];
            const double slack = Roundings * (std::abs(first) + width * std::abs(planes.right[k]) +
                                              height * std::abs(planes.down[k]));
            cutter.first[k] = static_cast<float>(first + slack);
            cutter.right[k] = static_cast<float>(planes.right[k]);
            cutter.down[k] = static_cast<float>(planes.down[k]);
            cutter.over_right[k] = cutter.right[k] != 0.0f ? 1.0f / cutter.right[k] : 0.0f;
        }
        const auto change = static_cast<float>(depth_right);
        for (std::int32_t y = 0; y < height; ++y) {
            const SampleSpan span = cutter.row(static_cast<float>(y), width);
            const auto start = static_cast<float>(depth + y * depth_down);
            const std::size_t row =
                static_cast<std::size_t>(y0 + y) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(x0);
            for (std::int32_t x = span.begin; x < span.end; ++x) {
                const float near = start + static_cast<float>(x) * change;
                float& nearest = nearest_[row + static_cast<std::size_t>(x)];
                // Hundredfold what roundings make of equal depths.
                constexpr float AboutAsNear = 1.0f - 0x1p-17f;
                if (near <= AboutAsNear * nearest)
                    continue;
                std::uint32_t& seen = triangles_[row + static_cast<std::size_t>(x)];
                const bool is_nearer = near > nearest;
                if (AboutAsNear * near <= nearest ? is_nearer != covers(is_nearer ? seen : triangle,
                                                                        is_nearer ? triangle : seen)
                                                  : is_nearer) {
                    nearest = near;
                    seen = triangle;
                }
            }
        }
    }

    [[nodiscard]] std::uint32_t triangle(std::size_t x, std::size_t y) const {
        return triangles_[y * static_cast<std::size_t>(width_) + x];
    }
    [[nodiscard]] std::int32_t width() const { return width_; }
    [[nodiscard]] std::int32_t height() const { return height_; }

private:
    /// CoplanarFaces::covers(), whose last answer is kept: neighbouring samples ask the same.
    [[nodiscard]] bool covers(std::uint32_t triangle, std::uint32_t other) {
        if (triangle != asked_[0] || other != asked_[1]) {
            asked_ = {triangle, other};
            is_covered_ = coplanar_.covers(triangle, other);
        }
        return is_covered_;
    }

    std::int32_t width_, height_;
    const prt::CoplanarFaces& coplanar_;
    std::array<std::uint32_t, 2> asked_{EyeSample::NoTriangle, EyeSample::NoTriangle};
    bool is_covered_ = false;
    /// 1 over the depth; 0: nothing.
    std::vector<float> nearest_;
    std::vector<std::uint32_t> triangles_;
};

Raster::Raster(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
               const prt::TwinTriangles& twins, const glm::vec3& eye, const prt::PictureRays& grid,
               const PictureTiles& tiles)
    : mesh_(mesh), rays_(rays), twins_(twins), tiles_(tiles), per_axis_(grid.samples_per_axis()),
      eye_(eye), forward_(grid.forward()), right_(grid.right()), down_(grid.down()),
      coplanar_(mesh.positions, mesh.triangles) {
    first_ = glm::dvec3(grid.corner()) + 0.5 * (right_ + down_);
    over_right_ = 1.0 / glm::dot(right_, right_);
    over_down_ = 1.0 / glm::dot(down_, down_);
    deal();
}

Raster::Planes Raster::planes_of(std::uint32_t triangle) const {
    std::array<glm::dvec3, 3> v;
    for (std::size_t k = 0; k < 3; ++k)
        v[k] = glm::dvec3(mesh_.positions[mesh_.triangles[triangle][k]]) - eye_;
    const std::array<glm::dvec3, 3> edges = {glm::cross(v[1], v[2]), glm::cross(v[2], v[0]),
                                             glm::cross(v[0], v[1])};
    const double det = glm::dot(v[0], glm::cross(v[1] - v[0], v[2] - v[0]));
    Planes planes;
    // The normal looks away from the eye where det is positive.
    planes.is_front = det < 0.0;
    const double scale = 1.0 / det;
    if (!std::isfinite(scale))
        return planes;
    planes.is_seen = planes.is_front || rays_.stops(triangle) != prt::RayScene::Stops::Front;
    for (std::size_t k = 0; k < 3; ++k) {
        planes.first[k] = scale * glm::dot(edges[k], first_);
        planes.right[k] = scale * glm::dot(edges[k], right_);
        planes.down[k] = scale * glm::dot(edges[k], down_);
    }
    return planes;
}

Raster::Box Raster::box_of(std::uint32_t triangle) const {
    Box box;
    std::size_t num_behind = 0;
    for (const std::uint32_t corner : mesh_.triangles[triangle]) {
        const glm::dvec3 v = glm::dvec3(mesh_.positions[corner]) - eye_;
        const double depth = glm::dot(v, forward_);
        if (!(depth > 0.0)) {
            ++num_behind;
            continue;
        }
        const glm::dvec3 at = v / depth - first_;
        const glm::dvec2 place(glm::dot(at, right_) * over_right_,
                               glm::dot(at, down_) * over_down_);
        box.least = glm::min(box.least, place);
        box.most = glm::max(box.most, place);
    }
    if (num_behind != 0 && num_behind != 3) {
        box.crosses_eye = true;
        box.least = glm::dvec2(-std::numeric_limits<double>::infinity());
        box.most = -box.least;
    }
    return box;
}

Raster::TileRange Raster::tiles_of(const Box& box) const {
    if (!(box.least.x <= box.most.x))
        return {};
    // A tile's ring is the tile's, and so is a rounding of the box.
    constexpr double Reach = PictureTiles::LargestRing + 1.0;
    const auto clamped = [&](double place, double reach, std::uint32_t count) {
        const double tile = std::floor((place / per_axis_ + reach) / PictureTiles::Size);
        return static_cast<std::uint16_t>(std::clamp(tile, 0.0, static_cast<double>(count)));
    };
    return {clamped(box.least.x, -Reach, tiles_.columns()),
            clamped(box.least.y, -Reach, tiles_.rows()),
            clamped(box.most.x, Reach + PictureTiles::Size, tiles_.columns()),
            clamped(box.most.y, Reach + PictureTiles::Size, tiles_.rows())};
}

/// Whether a triangle may be seen in a tile: no plane is negative at all of its corners.
bool Raster::meets(const Planes& planes, std::size_t tile) const {
    const PixelRectangle pixels =
        tiles_.pixels(static_cast<std::uint32_t>(tile), PictureTiles::LargestRing + 1);
    const double left = static_cast<double>(pixels.left) * per_axis_,
                 right = static_cast<double>(pixels.right) * per_axis_,
                 top = static_cast<double>(pixels.top) * per_axis_,
                 bottom = static_cast<double>(pixels.bottom) * per_axis_;
    for (std::size_t k = 0; k < 3; ++k)
        if (planes.at(k, planes.right[k] > 0.0 ? right : left,
                      planes.down[k] > 0.0 ? bottom : top) < 0.0)
            return false;
    return true;
}

void Raster::deal() {
    const auto num_triangles = static_cast<std::uint32_t>(mesh_.num_triangles());
    std::vector<TileRange> ranges(num_triangles);
    std::vector<std::uint8_t> crosses_eye(num_triangles);
    files::parallel_for(files::IndexRange<std::uint32_t>(0, num_triangles, 1024),
                        [&](const auto& some) {
                            for (std::uint32_t i = some.begin(); i < some.end(); ++i) {
                                const Box box = box_of(i);
                                ranges[i] = tiles_of(box);
                                crosses_eye[i] = box.crosses_eye ? 1 : 0;
                            }
                        });
    const auto for_tiles = [&](std::uint32_t triangle, const auto& visit) {
        const TileRange& range = ranges[triangle];
        // Beside the eye, the box is the whole picture.
        const bool is_to_be_cut = crosses_eye[triangle] != 0;
        const Planes planes = is_to_be_cut ? planes_of(triangle) : Planes();
        for (std::size_t y = range.top; y < range.bottom; ++y)
            for (std::size_t x = range.left; x < range.right; ++x)
                if (const std::size_t tile = y * tiles_.columns() + x;
                    !is_to_be_cut || meets(planes, tile))
                    visit(tile);
    };
    begins_.assign(std::size_t{tiles_.count()} + 1, 0);
    for (std::uint32_t i = 0; i < num_triangles; ++i)
        for_tiles(i, [&](std::size_t tile) { ++begins_[tile + 1]; });
    for (std::size_t tile = 0; tile < tiles_.count(); ++tile)
        begins_[tile + 1] += begins_[tile];
    triangles_.resize(begins_.back());
    std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
    for (std::uint32_t i = 0; i < num_triangles; ++i)
        for_tiles(i, [&](std::size_t tile) { triangles_[next[tile]++] = i; });
}

bool Raster::find(std::uint32_t tile, const PixelRectangle& pixels,
                  std::span<EyeSample> samples) const {
    const auto triangles =
        std::span(triangles_).subspan(begins_[tile], begins_[tile + 1] - begins_[tile]);
    for (const std::uint32_t triangle : triangles)
        if (rays_.stops(triangle) == prt::RayScene::Stops::Somewhere)
            return false;
    const auto per_axis = static_cast<std::int32_t>(per_axis_);
    Depths depths(static_cast<std::int32_t>(pixels.width()) * per_axis,
                  static_cast<std::int32_t>(pixels.bottom - pixels.top) * per_axis, coplanar_);
    const double left = static_cast<double>(pixels.left) * per_axis,
                 top = static_cast<double>(pixels.top) * per_axis;
    for (const std::uint32_t triangle : triangles) {
        const Planes planes = planes_of(triangle);
        if (!planes.is_seen)
            continue;
        const Box box = box_of(triangle);
        // A hundredth of a sample for rounding
        const auto place = [](double at, std::int32_t size) {
            return static_cast<std::int32_t>(std::clamp(at, 0.0, static_cast<double>(size)));
        };
        depths.draw(triangle, planes, left, top,
                    {place(std::ceil(box.least.x - left - 0.01), depths.width()),
                     place(std::ceil(box.least.y - top - 0.01), depths.height()),
                     place(std::floor(box.most.x - left + 1.01), depths.width()),
                     place(std::floor(box.most.y - top + 1.01), depths.height())});
    }
    std::uint32_t last = EyeSample::NoTriangle;
    Planes planes;
    for (std::size_t y = 0; y < static_cast<std::size_t>(depths.height()); ++y)
        for (std::size_t x = 0; x < static_cast<std::size_t>(depths.width()); ++x) {
            const std::size_t pixel = y / per_axis_ * pixels.width() + x / per_axis_;
            EyeSample& found =
                samples[(pixel * per_axis_ + y % per_axis_) * per_axis_ + x % per_axis_];
            const std::uint32_t triangle = depths.triangle(x, y);
            if (triangle != last && triangle != EyeSample::NoTriangle)
                planes = planes_of(last = triangle);
            found = triangle == EyeSample::NoTriangle
                        ? EyeSample()
                        : sample(triangle, planes, left + static_cast<double>(x),
                                 top + static_cast<double>(y));
        }
    return true;
}

EyeSample Raster::sample(std::uint32_t triangle, const Planes& planes, double x, double y) const {
    // Slack may have let a sample in that lies just outside.
    const double first = std::max(planes.at(0, x, y), 0.0),
                 second = std::max(planes.at(1, x, y), 0.0),
                 third = std::max(planes.at(2, x, y), 0.0);
    const double sum = first + second + third;
    const double scale = sum > 0.0 ? 1.0 / sum : 0.0;
    const glm::vec2 barycentric(static_cast<float>(scale * second),
                                static_cast<float>(scale * third));
    if (planes.is_front)
        return {triangle, barycentric.x, barycentric.y};
    const prt::Hit hit = twins_.facing({.triangle = triangle, .barycentric = barycentric},
                                       glm::vec3(first_ + x * right_ + y * down_));
    return {hit.triangle, hit.barycentric.x, hit.barycentric.y};
}

} // namespace relumine::relight
