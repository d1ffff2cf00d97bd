#include "prt/transfer/glossy_transfer.h"

#include <algorithm>

#include "prt/transfer/cell_index.h"

namespace relumine::prt {

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
