#include "relight/kernels/glossy_kernels.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/kernels/glossy_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void light_block(const prt::LobeCuts& cuts, std::size_t block, std::span<const float> light,
                 BlockRadiance& radiance) {
    const hn::CappedTag<float, prt::BlockSize> d;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        auto red = hn::Zero(d);
        auto green = hn::Zero(d);
        auto blue = hn::Zero(d);
        for (std::size_t entry = cuts.begin[block]; entry < cuts.begin[block + 1]; ++entry) {
            const std::uint8_t* value = cuts.values.data() + entry * prt::BlockSize + lane;
            const auto root = hn::ConvertTo(d, hn::PromoteTo(integers, hn::LoadU(bytes, value)));
            const auto transfer = hn::Mul(root, root);
            const float* rgb = light.data() + std::size_t{3} * cuts.cells[entry];
            const float scale = cuts.scales[entry];
            red = hn::MulAdd(transfer, hn::Set(d, rgb[0] * scale), red);
            green = hn::MulAdd(transfer, hn::Set(d, rgb[1] * scale), green);
            blue = hn::MulAdd(transfer, hn::Set(d, rgb[2] * scale), blue);
        }
        hn::StoreU(red, d, radiance.channels[0].data() + lane);
        hn::StoreU(green, d, radiance.channels[1].data() + lane);
        hn::StoreU(blue, d, radiance.channels[2].data() + lane);
    }
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

HWY_EXPORT(light_block);

void light_block(const prt::LobeCuts& cuts, std::size_t block, std::span<const float> light,
                 BlockRadiance& radiance) {
    HWY_DYNAMIC_DISPATCH(light_block)(cuts, block, light, radiance);
}

} // namespace relumine::relight
#endif
