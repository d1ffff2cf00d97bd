#include "prt/visibility/blockers.h"

#include <algorithm>

namespace relumine::prt {

void DirectionPatch::add(const glm::vec3& direction) {
    const std::size_t first = num_directions++;
    // The first direction fills all lanes, so that no lane holds a wild number.
    const std::size_t end = first == 0 ? Size : first + 1;
    for (std::size_t j = first; j < end; ++j)
        packets[j / PacketSize].set(j % PacketSize, direction);
    for (std::size_t p = 0; p < NumPackets; ++p) {
        const std::size_t begin = p * PacketSize;
        packets[p].num_directions = static_cast<std::uint32_t>(
            num_directions <= begin ? 0 : std::min(num_directions - begin, PacketSize));
    }
}

void Blockers::clear_blocked(const ReceiverGroup& group, const DirectionPatch& patch,
                             std::span<std::uint64_t> rays) const {
    for (std::size_t p = 0; p < DirectionPatch::NumPackets; ++p)
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto active = static_cast<std::uint32_t>(rays[i] >> (p * PacketSize) & 0xffffu);
            if (active == 0)
                continue;
            const std::uint64_t blocked = occluded(group.origins[i], patch.packets[p], active);
            rays[i] &= ~(blocked << (p * PacketSize));
        }
}

} // namespace relumine::prt
