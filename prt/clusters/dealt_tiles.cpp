#include "prt/clusters/dealt_tiles.h"

#include <algorithm>

#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

namespace {

/// Receivers of a tile.
constexpr std::size_t Width = VisibleCounts::TileBlocks * BlockSize;

} // namespace

std::vector<std::uint32_t> places_of(const Part& part, std::size_t num_receivers) {
    std::vector<std::uint32_t> places;
    places.reserve(num_receivers / part.count + Width);
    for (std::size_t begin = part.index * Width; begin < num_receivers; begin += part.count * Width)
        for (std::size_t place = begin; place < std::min(begin + Width, num_receivers); ++place)
            places.push_back(static_cast<std::uint32_t>(place));
    return places;
}

OwnPlace own_place(std::size_t place, std::size_t num_parts) {
    const std::size_t tile = place / Width;
    return {.part = static_cast<std::uint32_t>(tile % num_parts),
            .index = tile / num_parts * Width + place % Width};
}

} // namespace relumine::prt
