#include "relight/moving_eye/eye_kernel.h"

#include <numbers>

#include "prt/receivers/surface.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/moving_eye/eye_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, prt::BlockSize>;
using Vector = hn::Vec<Tag>;

/// Some of a block's receivers.
struct Lanes {
    Lanes(const prt::BlockSurfaces& of, std::size_t lane)
        : n_x(load(of.normal[0], lane)), n_y(load(of.normal[1], lane)),
          n_z(load(of.normal[2], lane)), v_x(load(of.to_eye[0], lane)),
          v_y(load(of.to_eye[1], lane)), v_z(load(of.to_eye[2], lane)),
          n_v(load(of.normal_dot_eye, lane)), a2(load(of.parameters[0], lane)),
          rest(hn::Sub(hn::Set(Tag(), 1.0f), a2)),
          mask_v(hn::Sqrt(hn::MulAdd(hn::Mul(n_v, n_v), rest, a2))) {}

    static Vector load(const prt::BlockSurfaces::Floats& values, std::size_t lane) {
        return hn::Load(Tag(), values.data() + lane);
    }

    Vector n_x, n_y, n_z, v_x, v_y, v_z, n_v, a2, rest, mask_v;
};

template<SisterCells::Row Row>
Vector value_of(CellLight light) {
    return hn::Set(Tag(), light[Row * SisterCells::Stride]);
}

/// Returns S of GgxLobe for one direction, its distribution widened, and Schlick's (1 - v.h)^5.
/// With q = |v + w|^2 (1 - cos^2 (1 - a^2)) there is one quotient:
///     S = a^2 |v + w|^4 n.w / (2 pi q^2 (n.w m_v + n.v m_w))
Vector lobe(const Lanes& at, CellLight cell, Vector& fresnel) {
    const Tag d;
    const auto one = hn::Set(d, 1.0f);
    const auto x = value_of<SisterCells::X>(cell), y = value_of<SisterCells::Y>(cell),
               z = value_of<SisterCells::Z>(cell);
    const auto dot_n = hn::MulAdd(at.n_x, x, hn::MulAdd(at.n_y, y, hn::Mul(at.n_z, z)));
    const auto dot_v = hn::MulAdd(at.v_x, x, hn::MulAdd(at.v_y, y, hn::Mul(at.v_z, z)));
    const auto n_w = hn::Max(dot_n, hn::Zero(d));
    // |v + w|^2 of unit vectors, and n.(v + w)
    const auto h_h =
        hn::Max(hn::MulAdd(hn::Set(d, 2.0f), dot_v, hn::Set(d, 2.0f)), hn::Set(d, 1e-6f));
    const auto n_h = hn::Add(at.n_v, dot_n);
    // As much wider as the light is spread.
    const auto a2 = hn::MulAdd(hn::Set(d, 0.5f), value_of<SisterCells::Variance>(cell), at.a2);
    // Rounding must not take q below what the lobe's peak has.
    const auto q =
        hn::Max(hn::NegMulAdd(hn::Mul(n_h, n_h), hn::Sub(one, a2), h_h), hn::Mul(h_h, a2));
    const auto mask_w = hn::Sqrt(hn::MulAdd(hn::Mul(n_w, n_w), at.rest, at.a2));
    const auto over = hn::Mul(hn::Mul(hn::Set(d, 2.0f * std::numbers::pi_v<float>), hn::Mul(q, q)),
                              hn::MulAdd(n_w, at.mask_v, hn::Mul(at.n_v, mask_w)));
    const auto one_less = hn::Max(hn::NegMulAdd(hn::Set(d, 0.5f), hn::Sqrt(h_h), one), hn::Zero(d));
    const auto squared = hn::Mul(one_less, one_less);
    fresnel = hn::Mul(hn::Mul(squared, squared), one_less);
    return hn::Div(hn::Mul(hn::Mul(a2, hn::Mul(h_h, h_h)), n_w), over);
}

/// The light of some receivers.
struct Sums {
    Sums()
        : red(hn::Zero(Tag())), green(red), blue(red), red_grazing(red), green_grazing(red),
          blue_grazing(red) {}

    void add(CellLight light, Vector value, Vector fresnel) {
        const auto grazing = hn::Mul(value, fresnel);
        const auto r = value_of<SisterCells::Red>(light), g = value_of<SisterCells::Green>(light),
                   b = value_of<SisterCells::Blue>(light);
        red = hn::MulAdd(value, r, red);
        green = hn::MulAdd(value, g, green);
        blue = hn::MulAdd(value, b, blue);
        red_grazing = hn::MulAdd(grazing, r, red_grazing);
        green_grazing = hn::MulAdd(grazing, g, green_grazing);
        blue_grazing = hn::MulAdd(grazing, b, blue_grazing);
    }

    Vector red, green, blue, red_grazing, green_grazing, blue_grazing;
};

void sum_cells(const prt::BlockSurfaces& surfaces, const LitCells& cells, EyeLight& light) {
    const Tag d;
    const hn::Rebind<std::uint8_t, Tag> bytes;
    const hn::Rebind<std::int32_t, Tag> integers;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const Lanes at(surfaces, lane);
        Sums sums;
        auto fresnel = hn::Zero(d);
        for (const CellLight cell : cells.open) {
            const auto value = lobe(at, cell, fresnel);
            sums.add(cell, value, fresnel);
        }
        for (const PartlyCell& cell : cells.partly) {
            const auto seen = hn::ConvertTo(
                d, hn::PromoteTo(integers, hn::LoadU(bytes, cell.parts.data() + lane)));
            const auto part = hn::Mul(seen, hn::Set(d, cell.unit));
            const auto value = hn::Mul(lobe(at, cell.light, fresnel), part);
            sums.add(cell.light, value, fresnel);
        }
        // Receivers that do not face the eye have no lobe.
        const auto faces = hn::Gt(at.n_v, hn::Zero(d));
        const auto store = [&](Vector value, std::array<float, prt::BlockSize>& to) {
            hn::StoreU(hn::IfThenElseZero(faces, value), d, to.data() + lane);
        };
        store(sums.red, light.all.channels[0]);
        store(sums.green, light.all.channels[1]);
        store(sums.blue, light.all.channels[2]);
        store(sums.red_grazing, light.grazing.channels[0]);
        store(sums.green_grazing, light.grazing.channels[1]);
        store(sums.blue_grazing, light.grazing.channels[2]);
    }
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

HWY_EXPORT(sum_cells);

void sum_cells(const prt::BlockSurfaces& surfaces, const LitCells& cells, EyeLight& light) {
    HWY_DYNAMIC_DISPATCH(sum_cells)(surfaces, cells, light);
}

} // namespace relumine::relight
#endif
