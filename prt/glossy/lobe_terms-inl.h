// What lobes are made of, 16 receivers at a time. For lobe_kernel.cpp, once per instruction set.
#if defined(RELUMINE_LOBE_TERMS) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_LOBE_TERMS
#undef RELUMINE_LOBE_TERMS
#else
#define RELUMINE_LOBE_TERMS
#endif

#include <numbers>

#include <glm/vec3.hpp>
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "prt/glossy/lobe_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::prt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, BlockSize>;
using Vector = hn::Vec<Tag>;

/// Three coordinates of some of a block's receivers.
struct Vector3 {
    Vector x, y, z;
    Vector3(Vector x_, Vector y_, Vector z_) : x(x_), y(y_), z(z_) {}
    Vector3(const std::array<BlockSurfaces::Floats, 3>& axes, std::size_t lane)
        : x(hn::Load(Tag(), axes[0].data() + lane)), y(hn::Load(Tag(), axes[1].data() + lane)),
          z(hn::Load(Tag(), axes[2].data() + lane)) {}
};

inline Vector dot(const Vector3& a, const Vector3& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

/// Returns |a x b|^2. 1 - cos^2 would lose it to cancellation where a highlight is sharp.
inline Vector squared_cross(const Vector3& a, const Vector3& b) {
    const auto x = hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y));
    const auto y = hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z));
    const auto z = hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x));
    return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
}

/// The terms of one direction for some of a block's receivers, as LobeGeometry has them.
struct LobeTerms {
    LobeTerms(const BlockSurfaces& of, const glm::vec3& w, std::size_t first_lane)
        : surfaces(of), lane(first_lane), n_w(hn::Zero(Tag())), sin2(hn::Zero(Tag())),
          fresnel(hn::Zero(Tag())) {
        const Tag d;
        const Vector3 n(of.normal, lane);
        const Vector3 v(of.to_eye, lane);
        const Vector3 light(hn::Set(d, w.x), hn::Set(d, w.y), hn::Set(d, w.z));
        n_w = hn::Max(dot(n, light), hn::Zero(d));
        const Vector3 h(hn::Add(v.x, light.x), hn::Add(v.y, light.y), hn::Add(v.z, light.z));
        const auto h_h = hn::Max(dot(h, h), hn::Set(d, 1e-12f));
        sin2 = hn::Div(squared_cross(n, h), h_h);
        // v.h = |v + w| / 2 for unit vectors.
        const auto one_less =
            hn::Max(hn::NegMulAdd(hn::Set(d, 0.5f), hn::Sqrt(h_h), hn::Set(d, 1.0f)), hn::Zero(d));
        const auto squared = hn::Mul(one_less, one_less);
        fresnel = hn::Mul(hn::Mul(squared, squared), one_less);
    }

    [[nodiscard]] Vector n_v() const {
        return hn::Load(Tag(), surfaces.normal_dot_eye.data() + lane);
    }
    /// Of a lobe's parameters().
    [[nodiscard]] Vector parameter(std::size_t i) const {
        return hn::Load(Tag(), surfaces.parameters[i].data() + lane);
    }
    [[nodiscard]] hn::Mask<Tag> lanes(std::uint32_t bits) const {
        const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits >> lane),
                                       static_cast<std::uint8_t>(bits >> lane >> 8u)};
        return hn::LoadMaskBits(Tag(), bytes);
    }

    const BlockSurfaces& surfaces;
    std::size_t lane;
    /// n.w, sin^2 between n and the half vector, and Schlick's (1 - v.h)^5
    Vector n_w, sin2, fresnel;
};

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
