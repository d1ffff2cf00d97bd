// A vector comparison's result as bits. Compiled once per instruction set, inside a Highway block.
#if defined(RELUMINE_PRT_MASK_BITS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_PRT_MASK_BITS_INL_H
#undef RELUMINE_PRT_MASK_BITS_INL_H
#else
#define RELUMINE_PRT_MASK_BITS_INL_H
#endif

#include <cstdint>
#include <cstring>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

/// Returns the lanes of a mask as bits: bit i is lane i, of up to 32.
template<class D>
std::uint32_t bits_of(D d, hwy::HWY_NAMESPACE::Mask<D> mask) {
    std::uint8_t bytes[8] = {};
    hwy::HWY_NAMESPACE::StoreMaskBits(d, mask, bytes);
    std::uint32_t bits = 0;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif // toggle
