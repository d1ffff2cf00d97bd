#include "relight/surfaces/ray_fan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include <glm/geometric.hpp>

#include "cubemap/frame.h"
#include "prt/receivers/surface.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/surfaces/ray_fan.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FanTag = hn::CappedTag<float, prt::PacketSize>;
using FanVector = hn::Vec<FanTag>;

/// Coordinates of some rays.
struct FanDirections {
    FanVector x, y, z;
};

FanVector constant(float value) {
    return hn::Set(FanTag(), value);
}

FanVector dot(const FanDirections& a, const FanDirections& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

FanDirections normalised(const FanDirections& v) {
    const FanVector scale = hn::Div(constant(1.0f), hn::Sqrt(dot(v, v)));
    return {hn::Mul(v.x, scale), hn::Mul(v.y, scale), hn::Mul(v.z, scale)};
}

/// x a + y b + z c.
FanDirections combined(const FanDirections& of, const glm::vec3& a, const glm::vec3& b,
                       const glm::vec3& c) {
    const auto axis = [&](int i) {
        return hn::MulAdd(of.x, constant(a[i]),
                          hn::MulAdd(of.y, constant(b[i]), hn::Mul(of.z, constant(c[i]))));
    };
    return {axis(0), axis(1), axis(2)};
}

/// Square root of what may be below 0 by a rounding.
FanVector root(FanVector value) {
    return hn::Sqrt(hn::Max(value, hn::Zero(FanTag())));
}

using FanIndices = hn::Vec<hn::RebindToUnsigned<FanTag>>;

/// Points of the unit square.
struct FanPoints {
    FanVector x, y;
};

FanVector fraction(FanVector v) {
    return hn::Sub(v, hn::Floor(v));
}

/// Returns points i of the fan, without its shift.
FanPoints hammersley_points(const RayFan& fan, FanIndices i) {
    const FanTag d;
    const hn::RebindToUnsigned<FanTag> du;
    const hn::RebindToSigned<FanTag> di;
    const auto to_float = [&](auto v) {
        return hn::ConvertTo(d, hn::BitCast(di, v));
    };
    // Numbers below 2^24 in reverse: single bits, pairs, fours and eights change places.
    const auto swapped = [&](auto v, auto shift, std::uint32_t mask) {
        return hn::Or(hn::And(hn::ShiftRight<decltype(shift)::value>(v), hn::Set(du, mask)),
                      hn::ShiftLeft<decltype(shift)::value>(hn::And(v, hn::Set(du, mask))));
    };
    auto bits = swapped(i, std::integral_constant<int, 1>(), 0x55555555u);
    bits = swapped(bits, std::integral_constant<int, 2>(), 0x33333333u);
    bits = swapped(bits, std::integral_constant<int, 4>(), 0x0f0f0f0fu);
    bits = swapped(bits, std::integral_constant<int, 8>(), 0x00ff00ffu);
    bits = hn::Or(hn::ShiftRight<16>(bits), hn::ShiftLeft<16>(bits));
    const FanVector inverse = hn::Mul(to_float(hn::ShiftRight<8>(bits)), constant(0x1p-24f));
    const FanVector along =
        hn::Div(hn::Add(to_float(i), constant(0.5f)), constant(static_cast<float>(fan.num_rays)));
    return {along, inverse};
}

/// Returns points of a grid over the part of the square that has point i of a fan of 2^n rays
/// alone: an elementary interval of the sequence.
FanPoints part_points(const RayFan& fan, std::uint32_t i, FanIndices of_grid) {
    constexpr std::uint32_t Side = 4;
    static_assert(Side * Side == prt::PacketSize);
    const FanTag d;
    const hn::RebindToUnsigned<FanTag> du;
    const hn::RebindToSigned<FanTag> di;
    const std::uint32_t num_columns = fan_columns(fan.num_rays);
    const FanVector columns = constant(static_cast<float>(num_columns));
    const FanVector rows = constant(static_cast<float>(fan.num_rays / num_columns));
    const FanPoints own = hammersley_points(fan, hn::Set(du, i));
    const auto within = [&](FanIndices place) {
        return hn::Mul(hn::Add(hn::ConvertTo(d, hn::BitCast(di, place)), constant(0.5f)),
                       constant(1.0f / Side));
    };
    const FanVector x = within(hn::And(of_grid, hn::Set(du, Side - 1)));
    const FanVector y = within(hn::ShiftRight<2>(of_grid));
    return {hn::Div(hn::Add(hn::Floor(hn::Mul(own.x, columns)), x), columns),
            hn::Div(hn::Add(hn::Floor(hn::Mul(own.y, rows)), y), rows)};
}

/// Returns directions in the frame of the normal, mirrored at half vectors of visible_half().
FanDirections mirrored(const FanFrame& frame, FanVector u_x, FanVector cosine, FanVector sine,
                       FanVector& density) {
    const FanVector one = constant(1.0f);
    const FanVector r = hn::Sqrt(u_x);
    const FanVector x = hn::Mul(r, cosine);
    const FanVector x2 = hn::Mul(x, x);
    const float s = 0.5f * (1.0f + frame.stretched_eye.z);
    const FanVector y = hn::MulAdd(constant(1.0f - s), root(hn::Sub(one, x2)),
                                   hn::Mul(constant(s), hn::Mul(r, sine)));
    const FanVector z = root(hn::NegMulAdd(y, y, hn::Sub(one, x2)));
    const FanDirections h = combined({x, y, z}, frame.t1, frame.t2, frame.stretched_eye);
    const FanDirections half =
        normalised({hn::Mul(constant(frame.alphas.x), h.x), hn::Mul(constant(frame.alphas.y), h.y),
                    hn::Max(h.z, constant(1e-6f))});

    const float a2 = frame.alphas.x * frame.alphas.y;
    // Both are 1 of a round lobe.
    const FanVector along = constant(frame.alphas.y / frame.alphas.x),
                    across = constant(frame.alphas.x / frame.alphas.y);
    const FanVector facing = hn::MulAdd(hn::Mul(along, half.x), half.x,
                                        hn::MulAdd(hn::Mul(across, half.y), half.y,
                                                   hn::Mul(constant(a2), hn::Mul(half.z, half.z))));
    const float n_v = frame.to_eye.z;
    const float mask = n_v + (frame.alphas.x == frame.alphas.y
                                  ? std::sqrt(n_v * n_v * (1.0f - a2) + a2)
                                  : glm::length(glm::vec3(frame.alphas, 1.0f) * frame.to_eye));
    density =
        hn::Div(constant(a2 * 0.5f / (std::numbers::pi_v<float> * mask)), hn::Mul(facing, facing));

    const FanDirections eye{constant(frame.to_eye.x), constant(frame.to_eye.y),
                            constant(frame.to_eye.z)};
    const FanVector twice = hn::Mul(constant(2.0f), dot(eye, half));
    return {hn::MulSub(twice, half.x, eye.x), hn::MulSub(twice, half.y, eye.y),
            hn::MulSub(twice, half.z, eye.z)};
}

/// Sends rays at points(lanes) of the square, which the fan shifts along its height.
template<typename Points>
void send(const RayFan& fan, const FanFrame& frame, FanRays& rays, const Points& points) {
    constexpr float Turn = 2.0f * std::numbers::pi_v<float>;
    const FanTag d;
    const hn::RebindToUnsigned<FanTag> du;
    for (std::size_t lane = 0; lane < prt::PacketSize; lane += hn::Lanes(d)) {
        const FanPoints point = points(hn::Iota(du, static_cast<std::uint32_t>(lane)));
        const FanVector u_x = point.x, u_y = fraction(hn::Add(point.y, constant(fan.shift.y)));
        const FanVector angle = hn::Mul(constant(Turn), u_y);
        const FanVector cosine = hn::Cos(d, angle), sine = hn::Sin(d, angle);
        FanVector density = constant(1.0f / Turn);
        FanDirections local{u_x, u_x, u_x};
        if (fan.alpha > 0.0f) {
            local = mirrored(frame, u_x, cosine, sine, density);
        } else {
            const FanVector across = root(hn::NegMulAdd(u_x, u_x, constant(1.0f)));
            local = {hn::Mul(across, cosine), hn::Mul(across, sine), u_x};
        }
        const FanDirections world =
            normalised(combined(local, frame.axes[0], frame.axes[1], frame.axes[2]));
        hn::Store(world.x, d, rays.directions.x.data() + lane);
        hn::Store(world.y, d, rays.directions.y.data() + lane);
        hn::Store(world.z, d, rays.directions.z.data() + lane);
        hn::Store(density, d, rays.densities.data() + lane);
        rays.above |= prt::HWY_NAMESPACE::bits_of(d, hn::Gt(local.z, hn::Zero(d))) << lane;
    }
}

void fan_rays(const RayFan& fan, const FanFrame& frame, std::uint32_t first, FanRays& rays) {
    const hn::RebindToUnsigned<FanTag> du;
    const FanVector columns = constant(static_cast<float>(fan_columns(fan.num_rays)));
    send(fan, frame, rays, [&](FanIndices lanes) {
        FanPoints points = hammersley_points(
            fan, hn::Min(hn::Add(lanes, hn::Set(du, first)), hn::Set(du, fan.num_rays - 1)));
        const FanVector x = hn::Mul(points.x, columns);
        points.x =
            hn::Div(hn::Add(hn::Floor(x), fraction(hn::Add(x, constant(fan.shift.x)))), columns);
        return points;
    });
    const std::uint32_t most = fan.only ? 1 : fan.num_rays - first;
    const std::uint32_t count = std::min<std::uint32_t>(most, prt::PacketSize);
    rays.above &= (1u << count) - 1;
    rays.directions.num_directions = count;
}

void fan_part(const RayFan& fan, const FanFrame& frame, std::uint32_t ray, FanRays& rays) {
    send(fan, frame, rays, [&](FanIndices lanes) { return part_points(fan, ray, lanes); });
    rays.directions.num_directions = prt::PacketSize;
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(fan_rays);
HWY_EXPORT(fan_part);
} // namespace

FanFrame::FanFrame(const RayFan& fan)
    : axes(fan.alpha_along > 0.0f ? prt::tangent_frame(fan.tangent, fan.normal)
                                  : cubemap::frame_of(fan.normal)),
      alphas(fan.alpha_along > 0.0f ? fan.alpha_along : fan.alpha, fan.alpha),
      to_eye(fan.to_eye * axes),
      stretched_eye(glm::normalize(glm::vec3(alphas.x * to_eye.x, alphas.y * to_eye.y, to_eye.z))) {
    const glm::vec3 across(-stretched_eye.y, stretched_eye.x, 0.0f);
    if (const float length2 = glm::dot(across, across); length2 > 0.0f)
        t1 = across / std::sqrt(length2);
    t2 = glm::cross(stretched_eye, t1);
}

FanRays fan_rays(const RayFan& fan, const FanFrame& frame, std::uint32_t first) {
    FanRays rays;
    HWY_DYNAMIC_DISPATCH(fan_rays)(fan, frame, first, rays);
    return rays;
}

FanRays fan_part(const RayFan& fan, const FanFrame& frame, std::uint32_t ray) {
    FanRays rays;
    HWY_DYNAMIC_DISPATCH(fan_part)(fan, frame, ray, rays);
    return rays;
}

} // namespace relumine::relight
#endif // HWY_ONCE
