#include "prt/glossy/lobe_kernel.h"

#include <algorithm>
#include <numbers>

#include <glm/geometric.hpp>

#include "prt/glossy/lobe_list.h"
#include "prt/glossy/sheen_lobe.h"

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

/// Normals of some receivers, and a lobe's parameters.
struct LobeNormals {
    explicit LobeNormals(const BlockSurfaces& of)
        : normal(of.normal), dot_eye(of.normal_dot_eye), parameters(of.parameters) {}
    LobeNormals(const std::array<BlockSurfaces::Floats, 3>& own,
                const BlockSurfaces::Floats& own_dot_eye,
                const std::array<BlockSurfaces::Floats, 2>& own_parameters)
        : normal(own), dot_eye(own_dot_eye), parameters(own_parameters) {}

    const std::array<BlockSurfaces::Floats, 3>& normal;
    const BlockSurfaces::Floats& dot_eye;
    const std::array<BlockSurfaces::Floats, 2>& parameters;
};

/// The terms of one direction for some of a block's receivers, as LobeGeometry has them.
struct LobeTerms {
    LobeTerms(const BlockSurfaces& of, const glm::vec3& w, std::size_t first_lane)
        : LobeTerms(of, LobeNormals(of), w, first_lane) {}
    LobeTerms(const BlockSurfaces& of, const LobeNormals& of_lobe, const glm::vec3& w,
              std::size_t first_lane)
        : surfaces(of), normals(of_lobe), lane(first_lane), n_w(hn::Zero(Tag())),
          sin2(hn::Zero(Tag())), v_h(hn::Zero(Tag())), fresnel(hn::Zero(Tag())) {
        const Tag d;
        const Vector3 n(normals.normal, lane);
        const Vector3 v(of.to_eye, lane);
        const Vector3 light(hn::Set(d, w.x), hn::Set(d, w.y), hn::Set(d, w.z));
        n_w = hn::Max(dot(n, light), hn::Zero(d));
        const Vector3 h(hn::Add(v.x, light.x), hn::Add(v.y, light.y), hn::Add(v.z, light.z));
        const auto h_h = hn::Max(dot(h, h), hn::Set(d, 1e-12f));
        sin2 = hn::Div(squared_cross(n, h), h_h);
        const auto length = hn::Sqrt(h_h);
        v_h = hn::Mul(hn::Set(d, 0.5f), length);
        const auto one_less =
            hn::Max(hn::NegMulAdd(hn::Set(d, 0.5f), length, hn::Set(d, 1.0f)), hn::Zero(d));
        const auto squared = hn::Mul(one_less, one_less);
        fresnel = hn::Mul(hn::Mul(squared, squared), one_less);
    }

    [[nodiscard]] Vector n_v() const { return hn::Load(Tag(), normals.dot_eye.data() + lane); }
    /// Returns number i of the lobe's parameters().
    [[nodiscard]] Vector parameter(std::size_t i) const {
        return hn::Load(Tag(), normals.parameters[i].data() + lane);
    }
    [[nodiscard]] hn::Mask<Tag> lanes(std::uint32_t bits) const {
        const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits >> lane),
                                       static_cast<std::uint8_t>(bits >> lane >> 8u)};
        return hn::LoadMaskBits(Tag(), bytes);
    }

    const BlockSurfaces& surfaces;
    LobeNormals normals;
    std::size_t lane;
    /// n.w, sin^2 between n and the half vector, v.h, which is |v + w| / 2, and Schlick's
    /// (1 - v.h)^5
    Vector n_w, sin2, v_h, fresnel;
};

// The lobes, 16 receivers at a time: functions `specular(LOBE, LobeTerms)`.
#include "prt/glossy/blinn_phong_lobe-inl.h"
#include "prt/glossy/ggx_lobe-inl.h"
#include "prt/glossy/measured_lobe-inl.h"
#include "prt/glossy/sheen_lobe-inl.h"

/// Returns the highlights of all lobes that the block has.
template<std::size_t I = 1>
Vector all_specular(const LobeTerms& terms) {
    if constexpr (I == NumHighlights) {
        return hn::Zero(Tag());
    } else if constexpr (std::tuple_element_t<I, LobeList>::Facts.is_table) {
        return all_specular<I + 1>(terms);
    } else {
        const auto others = all_specular<I + 1>(terms);
        const std::uint32_t lanes = terms.surfaces.lanes[I];
        if (lanes == 0)
            return others;
        return hn::IfThenElse(terms.lanes(lanes),
                              specular(std::tuple_element_t<I, LobeList>(), terms), others);
    }
}

/// Returns the highlights S of all receivers.
Vector highlights(const LobeTerms& terms, const glm::vec3& direction) {
    const auto others = all_specular(terms);
    const BlockSurfaces& surfaces = terms.surfaces;
    if (surfaces.stretched_lanes == 0)
        return others;
    const Tag d;
    alignas(64) std::array<float, BlockSize> n_w, values;
    hn::Store(terms.n_w, d, n_w.data());
    hn::Store(others, d, values.data());
    for (std::size_t i = 0; i < hn::Lanes(d); ++i)
        if (const std::size_t lane = terms.lane + i;
            (surfaces.stretched_lanes >> lane & 1u) != 0 && n_w[i] > 0.0f)
            values[i] = surfaces.stretched[lane]->value(
                {surfaces.to_eye[0][lane], surfaces.to_eye[1][lane], surfaces.to_eye[2][lane]},
                direction);
    return hn::Load(d, values.data());
}

/// Returns the part of a value that Fresnel makes white, or takes away.
Vector grazing(const LobeTerms& terms, std::uint32_t lanes, Vector value) {
    return hn::Mul(terms.fresnel, hn::IfThenElseZero(terms.lanes(lanes), value));
}

Vector diffuse(const LobeTerms& terms) {
    return hn::Mul(terms.n_w, hn::Set(Tag(), std::numbers::inv_pi_v<float>));
}

/// Returns a colour of what thin films mirror, of lobes S; others are as they are.
Vector filmed(const LobeTerms& terms, std::size_t color, Vector highlight, Vector others) {
    const Tag d;
    alignas(64) std::array<float, BlockSize> lobe, v_h, values;
    hn::Store(highlight, d, lobe.data());
    hn::Store(terms.v_h, d, v_h.data());
    hn::Store(others, d, values.data());
    for (std::size_t i = 0; i < hn::Lanes(d); ++i)
        if ((terms.surfaces.film_lanes >> (terms.lane + i) & 1u) != 0 && lobe[i] > 0.0f)
            values[i] = lobe[i] * terms.surfaces.films[terms.lane + i]->at(
                                      std::min(v_h[i], 1.0f))[static_cast<int>(color)];
    return hn::Load(d, values.data());
}

/// Puts a colour of surfaces that have a lobe for each in the place of a lobe. `highlight` is S.
Vector with_colors(const LobeTerms& terms, std::size_t color, Vector highlight, Vector others) {
    if (terms.surfaces.film_lanes != 0)
        others = filmed(terms, color, highlight, others);
    const std::uint32_t lanes = terms.surfaces.lanes[static_cast<std::size_t>(Highlight::Measured)];
    if (lanes == 0)
        return others;
    return hn::IfThenElse(terms.lanes(lanes), measured(terms, color), others);
}

/// What clear coats mirror.
Vector coat(const BlockSurfaces& surfaces, const glm::vec3& direction, std::size_t lane) {
    const Tag d;
    const LobeTerms terms(surfaces,
                          {surfaces.coat_normal, surfaces.coat_dot_eye, surfaces.coat_parameters},
                          direction, lane);
    const auto fresnel =
        hn::MulAdd(hn::Set(d, 1.0f - DielectricF0), terms.fresnel, hn::Set(d, DielectricF0));
    return hn::IfThenElseZero(
        hn::And(terms.lanes(surfaces.coat_lanes), hn::Gt(terms.n_w, hn::Zero(d))),
        hn::Mul(fresnel, specular(GgxLobe(), terms)));
}

Vector sheen(const LobeTerms& terms) {
    return hn::IfThenElseZero(
        hn::And(terms.lanes(terms.surfaces.sheen_lanes), hn::Gt(terms.n_w, hn::Zero(Tag()))),
        value(SheenLobe(), terms));
}

void evaluate_lobe(const BlockSurfaces& surfaces, GlossyLobe lobe,
                   std::span<const glm::vec3> directions, std::span<BlockSurfaces::Floats> values) {
    const std::uint32_t lanes = surfaces.lanes_with(lobe);
    const auto evaluated = [&](const LobeTerms& terms, const glm::vec3& direction) {
        switch (lobe) {
        case GlossyLobe::Specular: {
            const auto highlight = highlights(terms, direction);
            return with_colors(terms, 0, highlight, highlight);
        }
        case GlossyLobe::SpecularGrazing: {
            const auto highlight = highlights(terms, direction);
            return with_colors(terms, 1, highlight, grazing(terms, lanes, highlight));
        }
        case GlossyLobe::DiffuseGrazing: {
            const auto highlight =
                surfaces.film_lanes == 0 ? hn::Zero(Tag()) : highlights(terms, direction);
            return with_colors(terms, 2, highlight, grazing(terms, lanes, diffuse(terms)));
        }
        case GlossyLobe::Coat:
            return coat(surfaces, direction, terms.lane);
        case GlossyLobe::Sheen:
            break;
        }
        return sheen(terms);
    };
    for (std::size_t i = 0; i < directions.size(); ++i)
        for (std::size_t lane = 0; lane < BlockSize; lane += hn::Lanes(Tag()))
            hn::StoreU(evaluated(LobeTerms(surfaces, directions[i], lane), directions[i]), Tag(),
                       values[i].data() + lane);
}

void evaluate_lobes(const BlockSurfaces& surfaces, const glm::vec3& direction,
                    std::array<BlockSurfaces::Floats, NumGlossyLobes>& values) {
    const std::uint32_t lanes = surfaces.lanes_with(GlossyLobe::SpecularGrazing);
    const std::uint32_t diffuse_lanes = surfaces.lanes_with(GlossyLobe::DiffuseGrazing);
    for (std::size_t lane = 0; lane < BlockSize; lane += hn::Lanes(Tag())) {
        const LobeTerms terms(surfaces, direction, lane);
        const auto highlight = highlights(terms, direction);
        hn::StoreU(with_colors(terms, 0, highlight, highlight), Tag(), values[0].data() + lane);
        hn::StoreU(with_colors(terms, 1, highlight, grazing(terms, lanes, highlight)), Tag(),
                   values[1].data() + lane);
        hn::StoreU(with_colors(terms, 2, highlight, grazing(terms, diffuse_lanes, diffuse(terms))),
                   Tag(), values[2].data() + lane);
        hn::StoreU(surfaces.coat_lanes == 0 ? hn::Zero(Tag()) : coat(surfaces, direction, lane),
                   Tag(), values[3].data() + lane);
        hn::StoreU(surfaces.sheen_lanes == 0 ? hn::Zero(Tag()) : sheen(terms), Tag(),
                   values[4].data() + lane);
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
    if (has_coat(surface))
        set_coat(lane, surface, normal_of_lane, eye_of_lane);
    if (!(normal_dot_eye[lane] > 0.0f) || surface.highlight == Highlight::None)
        return;
    lanes[static_cast<std::size_t>(surface.highlight)] |= 1u << lane;
    tables[lane] = surface.table.get();
    const std::array<float, 2> own = with_lobe(surface.highlight, [&](auto lobe) {
        return lobe.parameters(surface.roughness_or_exponent);
    });
    for (std::size_t i = 0; i < own.size(); ++i)
        parameters[i][lane] = own[i];
    if (has_film(surface)) {
        film_lanes |= 1u << lane;
        films.resize(BlockSize);
        films[lane].emplace(surface, EyeCosines(surface, normal_of_lane, eye_of_lane));
    }
    if (is_stretched(surface)) {
        stretched_lanes |= 1u << lane;
        stretched.resize(BlockSize);
        stretched[lane].emplace(surface, normal_of_lane);
    }
    if (!has_sheen(surface))
        return;
    sheen_lanes |= 1u << lane;
    const float n_v = normal_dot_eye[lane], alpha = SheenLobe::alpha(surface.sheen_roughness);
    sheen_parameters[0][lane] = alpha;
    sheen_parameters[1][lane] = 1.0f + SheenLobe::lambda(SheenLobe::fit(alpha), n_v);
    sheen_parameters[2][lane] = sheen_limit(surface.sheen_roughness, n_v) * (2.0f + 1.0f / alpha) *
                                0.5f * std::numbers::inv_pi_v<float> / (4.0f * n_v);
}

void BlockSurfaces::set_coat(std::size_t lane, const Surface& surface,
                             const glm::vec3& normal_of_lane, const glm::vec3& eye_of_lane) {
    const glm::vec3 own =
        surface.coat_normal == glm::vec3(0.0f) ? normal_of_lane : surface.coat_normal;
    for (int axis = 0; axis < 3; ++axis)
        coat_normal[static_cast<std::size_t>(axis)][lane] = own[axis];
    coat_dot_eye[lane] = glm::dot(own, eye_of_lane);
    if (coat_dot_eye[lane] > 0.0f)
        coat_lanes |= 1u << lane;
    const std::array<float, 2> of_lobe = GgxLobe::parameters(surface.coat_roughness);
    for (std::size_t i = 0; i < of_lobe.size(); ++i)
        coat_parameters[i][lane] = of_lobe[i];
}

std::uint32_t BlockSurfaces::lanes_with(GlossyLobe lobe) const {
    if (lobe == GlossyLobe::Coat)
        return coat_lanes;
    if (lobe == GlossyLobe::Sheen)
        return sheen_lanes;
    std::uint32_t bits = film_lanes;
    for (std::size_t i = 1; i < NumHighlights; ++i) {
        const LobeFacts& facts = facts_of(static_cast<Highlight>(i));
        if (lobe == GlossyLobe::Specular || facts.is_table ||
            (lobe == GlossyLobe::SpecularGrazing ? facts.has_fresnel : facts.has_diffuse_grazing))
            bits |= lanes[i];
    }
    return bits;
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
