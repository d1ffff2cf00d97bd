#include "cubemap/layers/layer_composite.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <variant>

#include <fmt/format.h>
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "cubemap/layers/texel_range.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

/// Tiles are cut from the whole face, not from the rectangles. So a texel gets the same tests
/// wherever rectangles begin. With 32 x 32, a disc of 100 texels' radius has about as many tiles at
/// its rim as inside.
constexpr std::uint32_t TileSize = 32;

/// A layer's effect with its gain multiplied in.
struct Light {
    glm::vec3 radiance;
    void operator()(glm::vec3& texel, float coverage) const { texel += coverage * radiance; }
};
struct Filter {
    glm::vec3 factor;
    void operator()(glm::vec3& texel, float coverage) const {
        texel *= 1.0f + coverage * (factor - 1.0f);
    }
};
struct Image {
    const ImagePyramid* picture;
    bool replace;
    glm::vec3 gain;
};
using PreparedEffect = std::variant<Light, Filter, Image>;

struct PreparedLayer {
    RegionShape region;
    PreparedEffect effect;
};

PreparedLayer prepared(const LightLayer& layer) {
    validate(layer);
    struct Prepare {
        glm::vec3 gain;
        PreparedEffect operator()(const Emit& emit) const { return Light{gain * emit.radiance}; }
        PreparedEffect operator()(const Gain& effect) const {
            return Filter{gain * effect.factor * effect.tint};
        }
        PreparedEffect operator()(const ImagePatch& patch) const {
            return Image{patch.picture.get(), patch.blend == ImagePatch::Blend::Replace, gain};
        }
    };
    return {shape(layer.region), std::visit(Prepare{strength(layer)}, layer.effect)};
}

/// Calls texel(x, y, coverage) for the covered texels of a range that lie in the rectangle.
template<typename Shape, typename Texel>
void for_covered(const Shape& shape, const FaceGrid& grid, const TexelRange& range,
                 const TexelRectangle& rectangle, const Texel& texel) {
    const TexelRange part = range.within(rectangle);
    if (part.empty())
        return;
    const Overlap overlap = bound(shape, grid, range);
    if (overlap == Overlap::None)
        return;
    if (overlap == Overlap::All) {
        for (std::uint32_t y = part.y0; y < part.y1; ++y) {
            for (std::uint32_t x = part.x0; x < part.x1; ++x)
                texel(x, y, 1.0);
        }
    } else if (range.is_texel()) {
        const double mean = mean_coverage(shape, grid.plane, grid.square(range.x0, range.y0));
        if (mean > 0.0)
            texel(range.x0, range.y0, mean);
    } else {
        const auto& part_of_shape = narrowed(shape, grid, range);
        for (int i = 0; i < 4; ++i)
            for_covered(part_of_shape, grid, range.quarter(i), rectangle, texel);
    }
}

/// A picture on its rectangle, averaged over texels.
class PlacedPicture {
public:
    PlacedPicture(const RectangleShape& rectangle, const ImagePyramid& picture,
                  const FaceGrid& grid)
        : rectangle_(rectangle), picture_(picture), plane_(grid.plane) {
        // One level serves the whole picture. With two, a bright spot at their border would be
        // counted twice or not at all. At the middle of the picture and of the face, a pixel of
        // this level has at least half the width of a texel; the level has at least eight pixels.
        const glm::dvec2& half = rectangle.half_sides();
        const double texel = std::min(0.25, grid.half_texel / std::sqrt(half.x * half.y));
        const Picture& full = picture.levels().front();
        const double pixels = std::max(1.0, 0.5 * texel * std::max(full.width, full.height));
        level_ = std::min(static_cast<std::size_t>(std::ceil(std::log2(pixels))),
                          picture.levels().size() - 1);
        const Picture& chosen = picture.levels()[level_];
        largest_part_ = LargestPart / std::max({chosen.width, chosen.height, 8u});
    }

    /// Returns the mean of coverage times the picture over a texel.
    [[nodiscard]] glm::dvec3 mean(const FaceSquare& texel, bool covered) const {
        return light(texel, covered) / texel.solid_angle();
    }

private:
    /// Part of a pixel's side. Smaller parts meet every pixel evenly.
    static constexpr double LargestPart = 0.5;

    /// Returns the integral of coverage times the picture over the solid angle of a texel or a part
    /// of it.
    [[nodiscard]] glm::dvec3 light(const FaceSquare& part, bool covered) const {
        const glm::dvec3 middle = plane_.direction(part.u, part.v);
        if (!covered && rectangle_.bound(middle, part.chord()) == Overlap::None)
            return glm::dvec3(0.0);
        // The part is small enough if its side, in units of the picture's, is below the limit.
        const double angle = part.solid_angle();
        if (angle > largest_part_ * largest_part_ * rectangle_.solid_angle_of_picture(middle)) {
            glm::dvec3 sum(0.0);
            for (int i = 0; i < 4; ++i)
                sum += light(part.quarter(i), covered);
            return sum;
        }
        const double covered_angle =
            covered ? angle : detail::covered_solid_angle(rectangle_, plane_, part);
        return covered_angle * picture_.sample(level_, rectangle_.picture_position(middle));
    }

    const RectangleShape& rectangle_;
    const ImagePyramid& picture_;
    const FaceAxes& plane_;
    std::size_t level_;
    double largest_part_;
};

void apply(const PreparedLayer& layer, const FaceGrid& grid, const TexelRange& tile,
           const TexelRectangle& rectangle, CubeMap& target) {
    if (const auto* image = std::get_if<Image>(&layer.effect)) {
        const auto& region = std::get<RectangleShape>(layer.region);
        const PlacedPicture picture(region, *image->picture, grid);
        for_covered(region, grid, tile, rectangle,
                    [&](std::uint32_t x, std::uint32_t y, double coverage) {
                        const glm::dvec3 light = picture.mean(grid.square(x, y), coverage == 1.0);
                        glm::vec3& texel = target.at(grid.face, x, y);
                        texel = texel * static_cast<float>(image->replace ? 1.0 - coverage : 1.0) +
                                image->gain * glm::vec3(light);
                    });
        return;
    }
    const auto change = [&](const auto& effect) {
        const auto texel = [&](std::uint32_t x, std::uint32_t y, double coverage) {
            effect(target.at(grid.face, x, y), static_cast<float>(coverage));
        };
        std::visit([&](const auto& region) { for_covered(region, grid, tile, rectangle, texel); },
                   layer.region);
    };
    if (const auto* light = std::get_if<Light>(&layer.effect))
        change(*light);
    else
        change(std::get<Filter>(layer.effect));
}

/// Copies past the caches: what is larger than they would fetch each line before it is written.
void stream(const float* from, std::size_t count, float* to) {
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    const std::size_t past = reinterpret_cast<std::uintptr_t>(to) / sizeof(float) % lanes;
    std::size_t i = std::min(count, past == 0 ? 0 : lanes - past);
    std::copy_n(from, i, to);
    for (; i + lanes <= count; i += lanes)
        hn::Stream(hn::LoadU(d, from + i), d, to + i);
    std::copy_n(from + i, count - i, to + i);
}

void stream_rectangle(const CubeMap& base, const TexelRectangle& rectangle, CubeMap& target) {
    const std::size_t width = rectangle.x1 - rectangle.x0;
    files::parallel_for(files::IndexRange<std::uint32_t>(rectangle.y0, rectangle.y1, 16),
                        [&](const auto& rows) {
                            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y)
                                stream(&base.at(rectangle.face, rectangle.x0, y).x, 3 * width,
                                       &target.at(rectangle.face, rectangle.x0, y).x);
                            hwy::FlushStream();
                        });
}

void composite_rectangle(const CubeMap& base, std::span<const PreparedLayer> layers,
                         const TexelRectangle& rectangle, CubeMap& target) {
    constexpr std::size_t CachedTexels = 1u << 19;
    bool is_copied = &base == &target;
    if (!is_copied && rectangle.num_texels() > CachedTexels) {
        is_copied = true;
        stream_rectangle(base, rectangle, target);
        if (layers.empty())
            return;
    }
    const FaceGrid grid(rectangle.face, base.resolution);
    const auto end_tile = [](std::uint32_t texel) {
        return (texel + TileSize - 1) / TileSize;
    };
    const std::uint32_t first_row = rectangle.y0 / TileSize, first_column = rectangle.x0 / TileSize;
    const std::uint32_t num_rows = end_tile(rectangle.y1) - first_row,
                        num_columns = end_tile(rectangle.x1) - first_column;
    files::parallel_for(std::uint32_t{0}, num_rows * num_columns, [&](std::uint32_t index) {
        const std::uint32_t row = first_row + index / num_columns,
                            column = first_column + index % num_columns;
        const TexelRange tile(column * TileSize, row * TileSize, TileSize, base.resolution);
        const TexelRange part = tile.within(rectangle);
        for (std::uint32_t y = part.y0; y < part.y1 && !is_copied; ++y)
            std::copy_n(&base.at(rectangle.face, part.x0, y), part.x1 - part.x0,
                        &target.at(rectangle.face, part.x0, y));
        for (const PreparedLayer& layer : layers)
            apply(layer, grid, tile, rectangle, target);
    });
}

} // namespace

std::vector<TexelRectangle> all_texels(std::uint32_t resolution) {
    std::vector<TexelRectangle> rectangles;
    rectangles.reserve(NumFaces);
    for (const Face face : AllFaces)
        rectangles.push_back({.face = face, .x0 = 0, .y0 = 0, .x1 = resolution, .y1 = resolution});
    return rectangles;
}

void composite(const CubeMap& base, std::span<const LightLayer> layers,
               std::span<const TexelRectangle> rectangles, CubeMap& target) {
    if (base.resolution != target.resolution || base.texels.size() != target.texels.size() ||
        base.texels.size() != NumFaces * std::size_t{base.resolution} * base.resolution)
        throw std::invalid_argument(
            fmt::format("composite: expected maps of one resolution, got {} and {}",
                        base.resolution, target.resolution));
    for (const TexelRectangle& r : rectangles) {
        if (r.x0 > r.x1 || r.y0 > r.y1 || r.x1 > base.resolution || r.y1 > base.resolution ||
            static_cast<std::size_t>(r.face) >= NumFaces)
            throw std::invalid_argument(fmt::format("composite: expected a rectangle within {0} x "
                                                    "{0} texels, got [{1}, {2}) x [{3}, {4})",
                                                    base.resolution, r.x0, r.x1, r.y0, r.y1));
    }
    std::vector<PreparedLayer> ready;
    ready.reserve(layers.size() + 2);
    for (const LightLayer& layer : without_solo(layers)) {
        if (layer.on)
            ready.push_back(prepared(layer));
        else
            validate(layer);
    }
    // Rectangles are done one after the other, so texels in two of them are never written at the
    // same time.
    for (const TexelRectangle& rectangle : rectangles) {
        if (rectangle.x0 < rectangle.x1 && rectangle.y0 < rectangle.y1)
            composite_rectangle(base, ready, rectangle, target);
    }
}

std::vector<float> coverage_map(const Region& region, std::uint32_t resolution) {
    const LightLayer layer{.name = "region", .region = region, .effect = Emit{}};
    const CubeMap map = composite(CubeMap(resolution, glm::vec3(0.0f)), {&layer, 1});
    std::vector<float> coverage;
    coverage.reserve(map.texels.size());
    for (const glm::vec3& texel : map.texels)
        coverage.push_back(texel.r);
    return coverage;
}

CubeMap composite(const CubeMap& base, std::span<const LightLayer> layers) {
    CubeMap target(base.resolution);
    composite(base, layers, all_texels(base.resolution), target);
    return target;
}

} // namespace relumine::cubemap
