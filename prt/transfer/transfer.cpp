#include "prt/transfer/transfer.h"

namespace relumine::prt {

void set_surfaces(Transfer& transfer, const Receivers& receivers) {
    transfer.surfaces.clear();
    if (!receivers.surfaces.empty())
        for (const std::uint32_t receiver : transfer.order)
            transfer.surfaces.push_back(receivers.surfaces[receiver]);
    if (!transfer.glossy)
        return;
    transfer.glossy->to_eye.clear();
    for (const std::uint32_t receiver : transfer.order)
        transfer.glossy->to_eye.push_back(receivers.to_eye[receiver]);
}

} // namespace relumine::prt
