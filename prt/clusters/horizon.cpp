// Compiled with -ffp-contract=off: the compiler must not fuse the products and sums below.
#include "prt/clusters/horizon.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/clusters/horizon.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void directions_above_horizon(const NormalArrays& normals, std::size_t first,
                              const DirectionPatch& patch, std::span<std::uint64_t> rays) {
    const hn::CappedTag<float, PacketSize> d;
    const std::size_t num_lanes = hn::Lanes(d);
    const std::uint64_t used =
        patch.full() ? ~std::uint64_t{0} : (std::uint64_t{1} << patch.num_directions) - 1;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto nx = hn::Set(d, normals.x[first + i]);
        const auto ny = hn::Set(d, normals.y[first + i]);
        const auto nz = hn::Set(d, normals.z[first + i]);
        const auto nw = hn::Set(d, normals.w[first + i]);
        std::uint64_t above = 0;
        for (std::size_t j = 0; j < patch.num_directions; j += num_lanes) {
            const DirectionPacket& packet = patch.packets[j / PacketSize];
            const std::size_t lane = j % PacketSize;
            const auto xy = hn::Add(hn::Mul(nx, hn::Load(d, packet.x.data() + lane)),
                                    hn::Mul(ny, hn::Load(d, packet.y.data() + lane)));
            const auto xyz = hn::Add(xy, hn::Mul(nz, hn::Load(d, packet.z.data() + lane)));
            const auto cosine = hn::Add(xyz, nw);
            above |= std::uint64_t{bits_of(d, hn::Gt(cosine, hn::Zero(d)))} << j;
        }
        rays[i] = above & used;
    }
}

void samples_above_horizon(const NormalArrays& normals, std::size_t first,
                           const glm::vec3* directions, std::uint16_t* above) {
    const hn::CappedTag<float, BlockSize> d;
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        above[l] = 0;
    for (std::size_t i = 0; i < BlockSize; i += hn::Lanes(d)) {
        const auto nx = hn::LoadU(d, normals.x.data() + first + i);
        const auto ny = hn::LoadU(d, normals.y.data() + first + i);
        const auto nz = hn::LoadU(d, normals.z.data() + first + i);
        const auto nw = hn::LoadU(d, normals.w.data() + first + i);
        for (std::size_t l = 0; l < SamplesPerCell; ++l) {
            const glm::vec3& w = directions[l];
            const auto xy = hn::Add(hn::Mul(nx, hn::Set(d, w.x)), hn::Mul(ny, hn::Set(d, w.y)));
            const auto xyz = hn::Add(xy, hn::Mul(nz, hn::Set(d, w.z)));
            const auto cosine = hn::Add(xyz, nw);
            above[l] =
                static_cast<std::uint16_t>(above[l] | bits_of(d, hn::Gt(cosine, hn::Zero(d))) << i);
        }
    }
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

namespace {
HWY_EXPORT(directions_above_horizon);
HWY_EXPORT(samples_above_horizon);
} // namespace

void directions_above_horizon(const NormalArrays& normals, std::size_t first,
                              const DirectionPatch& patch, std::span<std::uint64_t> rays) {
    HWY_DYNAMIC_DISPATCH(directions_above_horizon)(normals, first, patch, rays);
}

std::array<std::uint16_t, SamplesPerCell>
samples_above_horizon(const NormalArrays& normals, std::size_t first,
                      std::span<const glm::vec3, SamplesPerCell> directions) {
    std::array<std::uint16_t, SamplesPerCell> above;
    HWY_DYNAMIC_DISPATCH(samples_above_horizon)(normals, first, directions.data(), above.data());
    return above;
}

} // namespace relumine::prt
#endif // HWY_ONCE
