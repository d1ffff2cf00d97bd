#include "prt/glossy/lobe_kernel.h"

#include <numbers>

#include <glm/geometric.hpp>

#include "prt/glossy/brdf.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prt/glossy/lobe_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

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

Vector dot(const Vector3& a, const Vector3& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

/// Returns |a x b|^2. 1 - cos^2 would lose it to cancellation where a highlight is sharp.
Vector squared_cross(const Vector3& a, const Vector3& b) {
    const auto x = hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y));
    const auto y = hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z));
    const auto z = hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x));
    return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
}

/// The terms of one direction for some of a block's receivers.
class DirectionTerms {
public:
    DirectionTerms(const BlockSurfaces& surfaces, const glm::vec3& w, std::size_t lane)
        : surfaces_(surfaces), lane_(lane), n_w_(hn::Zero(Tag())), h_h_(hn::Zero(Tag())),
          nxh_(hn::Zero(Tag())), c_(hn::Zero(Tag())) {
        const Tag d;
        const Vector3 n(surfaces.normal, lane);
        const Vector3 v(surfaces.to_eye, lane);
        const Vector3 light(hn::Set(d, w.x), hn::Set(d, w.y), hn::Set(d, w.z));
        n_w_ = hn::Max(dot(n, light), hn::Zero(d));
        const Vector3 h(hn::Add(v.x, light.x), hn::Add(v.y, light.y), hn::Add(v.z, light.z));
        h_h_ = hn::Max(dot(h, h), hn::Set(d, 1e-12f));
        nxh_ = hn::Div(squared_cross(n, h), h_h_); // sin^2 between n and the half vector
        // v.h = |v + w| / 2 for unit vectors.
        const auto one_less =
            hn::Max(hn::NegMulAdd(hn::Set(d, 0.5f), hn::Sqrt(h_h_), hn::Set(d, 1.0f)), hn::Zero(d));
        const auto squared = hn::Mul(one_less, one_less);
        c_ = hn::Mul(hn::Mul(squared, squared), one_less);
    }

    [[nodiscard]] Vector specular() const {
        const Tag d;
        auto result = hn::Zero(d);
        if (surfaces_.ggx != 0)
            result = hn::IfThenElseZero(lanes(surfaces_.ggx), ggx());
        if (surfaces_.blinn_phong != 0)
            result = hn::IfThenElse(lanes(surfaces_.blinn_phong), blinn_phong(), result);
        return result;
    }
    [[nodiscard]] Vector specular_grazing() const {
        return hn::Mul(c_, hn::IfThenElseZero(lanes(surfaces_.ggx), ggx()));
    }
    [[nodiscard]] Vector diffuse_grazing() const {
        const auto diffuse = hn::Mul(n_w_, hn::Set(Tag(), std::numbers::inv_pi_v<float>));
        return hn::Mul(c_, hn::IfThenElseZero(lanes(surfaces_.ggx), diffuse));
    }

private:
    [[nodiscard]] hn::Mask<Tag> lanes(std::uint32_t bits) const {
        const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits >> lane_),
                                       static_cast<std::uint8_t>(bits >> lane_ >> 8u)};
        return hn::LoadMaskBits(Tag(), bytes);
    }
    [[nodiscard]] Vector load(const BlockSurfaces::Floats& values) const {
        return hn::Load(Tag(), values.data() + lane_);
    }

    /// Returns D V n.w of glTF 2.0, Appendix B.
    [[nodiscard]] Vector ggx() const {
        const Tag d;
        const auto one = hn::Set(d, 1.0f);
        const auto a2 = load(surfaces_.alpha_squared);
        const auto n_v = load(surfaces_.normal_dot_eye);
        // cos^2 (a2 - 1) + 1 = sin^2 + cos^2 a2
        const auto cos2 = hn::Max(hn::Sub(one, nxh_), hn::Zero(d));
        const auto t = hn::MulAdd(cos2, a2, nxh_);
        const auto distribution =
            hn::Div(a2, hn::Mul(hn::Set(d, std::numbers::pi_v<float>), hn::Mul(t, t)));
        const auto rest = hn::Sub(one, a2);
        const auto mask_v = hn::Mul(n_w_, hn::Sqrt(hn::MulAdd(hn::Mul(n_v, n_v), rest, a2)));
        const auto mask_w = hn::Mul(n_v, hn::Sqrt(hn::MulAdd(hn::Mul(n_w_, n_w_), rest, a2)));
        const auto visibility = hn::Div(hn::Mul(hn::Set(d, 0.5f), n_w_), hn::Add(mask_v, mask_w));
        return hn::Mul(distribution, visibility);
    }

    [[nodiscard]] Vector blinn_phong() const {
        const Tag d;
        // log1p keeps digits that 1 - sin^2 would round away.
        const auto sin2 = hn::Min(nxh_, hn::Set(d, 1.0f - 6e-8f));
        const auto log_cos = hn::Mul(hn::Set(d, 0.5f), hn::Log1p(d, hn::Neg(sin2)));
        const auto power = hn::Exp(d, hn::Mul(load(surfaces_.exponent), log_cos));
        return hn::Mul(hn::Mul(load(surfaces_.factor), power), n_w_);
    }

    const BlockSurfaces& surfaces_;
    std::size_t lane_;
    Vector n_w_, h_h_, nxh_, c_;
};

void evaluate_lobe(const BlockSurfaces& surfaces, GlossyLobe lobe,
                   std::span<const glm::vec3> directions, std::span<BlockSurfaces::Floats> values) {
    for (std::size_t i = 0; i < directions.size(); ++i)
        for (std::size_t lane = 0; lane < BlockSize; lane += hn::Lanes(Tag())) {
            const DirectionTerms terms(surfaces, directions[i], lane);
            const auto value = lobe == GlossyLobe::Specular          ? terms.specular()
                               : lobe == GlossyLobe::SpecularGrazing ? terms.specular_grazing()
                                                                     : terms.diffuse_grazing();
            hn::StoreU(value, Tag(), values[i].data() + lane);
        }
}

void evaluate_lobes(const BlockSurfaces& surfaces, const glm::vec3& direction,
                    std::array<BlockSurfaces::Floats, NumGlossyLobes>& values) {
    for (std::size_t lane = 0; lane < BlockSize; lane += hn::Lanes(Tag())) {
        const DirectionTerms terms(surfaces, direction, lane);
        hn::StoreU(terms.specular(), Tag(), values[0].data() + lane);
        hn::StoreU(terms.specular_grazing(), Tag(), values[1].data() + lane);
        hn::StoreU(terms.diffuse_grazing(), Tag(), values[2].data() + lane);
    }
}

} // namespace relumine::prt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::prt {

HWY_EXPORT(evaluate_lobe);
HWY_EXPORT(evaluate_lobes);

void BlockSurfaces::set(std::size_t lane, const Surface& surface, const glm::vec3& normal_of_lane,
                        const glm::vec3& eye_of_lane) {
    for (int axis = 0; axis < 3; ++axis) {
        normal[static_cast<std::size_t>(axis)][lane] = normal_of_lane[axis];
        to_eye[static_cast<std::size_t>(axis)][lane] = eye_of_lane[axis];
    }
    normal_dot_eye[lane] = glm::dot(normal_of_lane, eye_of_lane);
    alpha_squared[lane] = 1.0f;
    if (!(normal_dot_eye[lane] > 0.0f))
        return;
    const std::uint32_t bit = 1u << lane;
    if (surface.highlight == Highlight::Ggx) {
        ggx |= bit;
        const float alpha = ggx_alpha(surface.roughness_or_exponent);
        alpha_squared[lane] = alpha * alpha;
    } else if (surface.highlight == Highlight::BlinnPhong) {
        blinn_phong |= bit;
        exponent[lane] = blinn_phong_exponent(surface.roughness_or_exponent);
        factor[lane] = blinn_phong_norm(surface.roughness_or_exponent);
    }
}

void evaluate_lobe(const BlockSurfaces& surfaces, GlossyLobe lobe,
                   std::span<const glm::vec3> directions, std::span<BlockSurfaces::Floats> values) {
    HWY_DYNAMIC_DISPATCH(evaluate_lobe)(surfaces, lobe, directions, values);
}

void evaluate_lobes(const BlockSurfaces& surfaces, const glm::vec3& direction,
                    std::array<BlockSurfaces::Floats, NumGlossyLobes>& values) {
    HWY_DYNAMIC_DISPATCH(evaluate_lobes)(surfaces, direction, values);
}

} // namespace relumine::prt
#endif
