#include "prt/transfer/glossy_transfer.h"

#include <algorithm>

#include "prt/transfer/cell_index.h"

namespace relumine::prt {

void LobeCuts::append(const LobeCuts& from, std::size_t first_block, std::size_t num_blocks) {
    const std::uint64_t first = from.begin[first_block];
    const std::uint64_t last = from.begin[first_block + num_blocks];
    const std::uint64_t before = num_entries();
    for (std::size_t block = first_block; block < first_block + num_blocks; ++block)
        begin.push_back(before + from.begin[block + 1] - first);
    const auto add = [&](auto& to, const auto& elements, std::size_t width) {
        to.insert(to.end(), elements.begin() + static_cast<std::ptrdiff_t>(first * width),
                  elements.begin() + static_cast<std::ptrdiff_t>(last * width));
    };
    add(cells, from.cells, 1);
    add(scales, from.scales, 1);
    add(values, from.values, BlockSize);
}

bool GlossyTransfer::is_stored() const {
    return whole_depth != 0 || std::any_of(lobes.begin(), lobes.end(), [](const LobeCuts& lobe) {
               return lobe.num_entries() != 0;
           });
}

std::uint32_t GlossyTransfer::deepest_level() const {
    std::uint32_t largest = 0;
    for (const LobeCuts& lobe : lobes)
        for (const std::uint32_t cell : lobe.cells)
            largest = std::max(largest, cell);
    return std::max(whole_depth, level_of_index(largest));
}

std::size_t GlossyTransfer::num_bytes() const {
    std::size_t bytes = to_eye.size() * sizeof(glm::vec3);
    for (const LobeCuts& lobe : lobes)
        bytes += lobe.begin.size() * sizeof(std::uint64_t) + lobe.values.size() +
                 lobe.num_entries() * (sizeof(std::uint32_t) + sizeof(float));
    return bytes;
}

} // namespace relumine::prt
