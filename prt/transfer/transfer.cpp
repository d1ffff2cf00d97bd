#include "prt/transfer/transfer.h"

#include <algorithm>

namespace relumine::prt {

void set_surfaces(Transfer& transfer, const Receivers& receivers) {
    transfer.surfaces.clear();
    if (!receivers.surfaces.empty())
        for (const std::uint32_t receiver : transfer.order)
            transfer.surfaces.push_back(receivers.surfaces[receiver]);
    // Highlights that are not stored: those of sharp lights are found all the same.
    const auto shines = [](const Surface& surface) {
        return surface.highlight != Highlight::None;
    };
    if (!transfer.glossy && !receivers.to_eye.empty() &&
        std::any_of(transfer.surfaces.begin(), transfer.surfaces.end(), shines))
        for (LobeCuts& lobe : transfer.glossy.emplace().lobes)
            lobe.begin.assign(transfer.counts.num_blocks() + 1, 0);
    if (!transfer.glossy)
        return;
    transfer.glossy->to_eye.clear();
    for (const std::uint32_t receiver : transfer.order)
        transfer.glossy->to_eye.push_back(receivers.to_eye[receiver]);
}

} // namespace relumine::prt
