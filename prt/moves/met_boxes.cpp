#include "prt/moves/met_boxes.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/moves/met_boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// As MetBoxes::meets(): `all` holds the boxes.
std::uint64_t meeting(const InverseDirections::Word& word, std::uint64_t asked,
                      const mesh::Bounds& all, std::span<const mesh::Bounds> boxes) {
    const hn::CappedTag<float, 16> d;
    std::uint64_t result = 0;
    for (std::size_t lane = 0; lane < InverseDirections::WordSize; lane += hn::Lanes(d)) {
        const auto wanted = static_cast<std::uint32_t>(asked >> lane) &
                            static_cast<std::uint32_t>((std::uint64_t{1} << hn::Lanes(d)) - 1);
        if (wanted == 0)
            continue;
        const auto x = hn::LoadU(d, word[0].data() + lane);
        const auto y = hn::LoadU(d, word[1].data() + lane);
        const auto z = hn::LoadU(d, word[2].data() + lane);
        const auto meets = [&](const mesh::Bounds& box) {
            const auto ax = hn::Mul(hn::Set(d, box.min.x), x),
                       bx = hn::Mul(hn::Set(d, box.max.x), x);
            const auto ay = hn::Mul(hn::Set(d, box.min.y), y),
                       by = hn::Mul(hn::Set(d, box.max.y), y);
            const auto az = hn::Mul(hn::Set(d, box.min.z), z),
                       bz = hn::Mul(hn::Set(d, box.max.z), z);
            const auto enters = hn::Max(hn::Max(hn::Min(ax, bx), hn::Min(ay, by)),
                                        hn::Max(hn::Min(az, bz), hn::Zero(d)));
            const auto leaves = hn::Min(hn::Min(hn::Max(ax, bx), hn::Max(ay, by)), hn::Max(az, bz));
            return bits_of(d, hn::Le(enters, leaves));
        };
        std::uint32_t left = meets(all) & wanted, met = 0;
        for (std::size_t box = 0; box < boxes.size() && left != 0; ++box) {
            const std::uint32_t own = meets(boxes[box]) & left;
            met |= own;
            left &= ~own;
        }
        result |= std::uint64_t{met} << lane;
    }
    return result;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {
HWY_EXPORT(meeting);
} // namespace

std::uint64_t MetBoxes::meeting(const InverseDirections::Word& word, std::uint64_t asked) const {
    return boxes_.empty() ? 0 : HWY_DYNAMIC_DISPATCH(meeting)(word, asked, all_, boxes_);
}

} // namespace relumine::prt
#endif
