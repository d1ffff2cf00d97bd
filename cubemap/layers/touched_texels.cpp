// Finds the texels that a layer can change, with the same quartering and the same bounds as the
// composite.
#include <bit>
#include <cstdint>
#include <stdexcept>
#include <variant>

#include "cubemap/layers/layer_composite.h"
#include "cubemap/layers/texel_range.h"

namespace relumine::cubemap {

namespace {

/// Halvings of a face's rectangle, which give at most 2^3 rectangles.
constexpr int MaxHalvings = 3;
/// Two halves together must keep at most this part of the area, or halving is not worth an
/// additional pass.
constexpr double LargestKeptPart = 0.7;
/// Texels along the sides of the smallest range examined. A box may be one texel wider than
/// necessary, but is found twice as fast.
constexpr std::uint32_t Finest = 2;
/// Texels of one tile of the composite.
constexpr std::uint64_t SmallestToHalve = 1024;

std::uint64_t area(const TexelRectangle& r) {
    return std::uint64_t{r.x1 - r.x0} * (r.y1 - r.y0);
}

bool contains(const TexelRectangle& outer, const TexelRange& inner) {
    return outer.x0 <= inner.x0 && outer.y0 <= inner.y0 && outer.x1 >= inner.x1 &&
           outer.y1 >= inner.y1;
}

void extend(TexelRectangle& box, const TexelRange& part) {
    if (area(box) == 0) {
        box = {.face = box.face, .x0 = part.x0, .y0 = part.y0, .x1 = part.x1, .y1 = part.y1};
        return;
    }
    box.x0 = std::min(box.x0, part.x0);
    box.y0 = std::min(box.y0, part.y0);
    box.x1 = std::max(box.x1, part.x1);
    box.y1 = std::max(box.y1, part.y1);
}

template<typename Shape>
class Touched {
public:
    Touched(const Shape& shape, Face face, std::uint32_t resolution)
        : shape_(shape), grid_(face, resolution), resolution_(resolution) {}

    /// Returns the box of the touched texels within a rectangle. Empty if there are none.
    [[nodiscard]] TexelRectangle box(const TexelRectangle& within) const {
        TexelRectangle result{.face = within.face};
        grow(shape_, TexelRange(0, 0, std::bit_ceil(resolution_), resolution_), within, result);
        return result;
    }

    /// Halves a box repeatedly as long as it is mostly untouched.
    void split(const TexelRectangle& box_of_all, int halvings,
               std::vector<TexelRectangle>& result) const {
        if (halvings > 0 && area(box_of_all) > SmallestToHalve) {
            TexelRectangle first = box_of_all, second = box_of_all;
            if (box_of_all.x1 - box_of_all.x0 >= box_of_all.y1 - box_of_all.y0)
                first.x1 = second.x0 = box_of_all.x0 + (box_of_all.x1 - box_of_all.x0) / 2;
            else
                first.y1 = second.y0 = box_of_all.y0 + (box_of_all.y1 - box_of_all.y0) / 2;
            first = box(first);
            second = box(second);
            const auto kept = static_cast<double>(area(first) + area(second));
            if (kept <= LargestKeptPart * static_cast<double>(area(box_of_all))) {
                split(first, halvings - 1, result);
                split(second, halvings - 1, result);
                return;
            }
        }
        if (area(box_of_all) > 0)
            result.push_back(box_of_all);
    }

private:
    template<typename Narrowed>
    void grow(const Narrowed& shape, const TexelRange& range, const TexelRectangle& within,
              TexelRectangle& result) const {
        const TexelRange part = range.within(within);
        if (part.empty() || (area(result) > 0 && contains(result, part)))
            return;
        const Overlap overlap = bound(shape, grid_, range);
        if (overlap == Overlap::None)
            return;
        if (overlap == Overlap::All || range.size <= Finest) {
            extend(result, part);
            return;
        }
        const auto& part_of_shape = narrowed(shape, grid_, range);
        for (int i = 0; i < 4; ++i)
            grow(part_of_shape, range.quarter(i), within, result);
    }

    const Shape& shape_;
    FaceGrid grid_;
    std::uint32_t resolution_;
};

} // namespace

std::vector<TexelRectangle> touched_texels(const LightLayer& layer, std::uint32_t resolution) {
    if (resolution == 0)
        throw std::invalid_argument("touched texels: expected a resolution of at least 1, got 0");
    validate(layer);
    std::vector<TexelRectangle> rectangles;
    if (!layer.on)
        return rectangles;
    std::visit(
        [&](const auto& region) {
            for (const Face face : AllFaces) {
                const Touched touched(region, face, resolution);
                const TexelRectangle whole{
                    .face = face, .x0 = 0, .y0 = 0, .x1 = resolution, .y1 = resolution};
                touched.split(touched.box(whole), MaxHalvings, rectangles);
            }
        },
        shape(layer.region));
    return rectangles;
}

} // namespace relumine::cubemap
