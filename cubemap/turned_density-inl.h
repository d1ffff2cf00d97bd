// The density of solid angle over the texels that a tile of a turned map meets. Compiled once per
// instruction set, inside a Highway block.
#if defined(RELUMINE_CUBEMAP_TURNED_DENSITY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_CUBEMAP_TURNED_DENSITY_INL_H
#undef RELUMINE_CUBEMAP_TURNED_DENSITY_INL_H
#else
#define RELUMINE_CUBEMAP_TURNED_DENSITY_INL_H
#endif

#include <cstddef>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::cubemap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t MaxLanes = 16;
using Lanes = hn::CappedTag<float, MaxLanes>;
using Vec = hn::Vec<Lanes>;

inline Vec number(float value) {
    return hn::Set(Lanes(), value);
}

/// A texel's middle in [-1, 1].
inline Vec middle(Vec texel, float scale) {
    return hn::MulAdd(texel, number(scale), number(0.5f * scale - 1.0f));
}

/// Solid angle in texels of R x R near (u, v), in parts of the density at a texel's middle: 1 + a x
/// + b y + (x, y) C (x, y), x and y in [-1/2, 1/2]. a and b are a texel's own, C that at (u, v).
class Density {
public:
    Density(float u, float v, float scale) : scale_(scale) {
        const float inverse = 1.0f / (1.0f + u * u + v * v);
        const float slope = -1.5f * scale * scale * inverse;
        const float bend = 7.5f * scale * scale * inverse * inverse;
        xx_ = slope + bend * u * u;
        yy_ = slope + bend * v * v;
        xy_ = 2.0f * bend * u * v;
        y_ = -3.0f * scale * inverse * v;
    }

    /// The integral from side to side at the middle's height.
    [[nodiscard]] float across_middle() const { return 1.0f + xx_ / 12.0f; }
    /// b less that at (u, v).
    [[nodiscard]] Vec change(Vec y_slope) const { return hn::Sub(y_slope, number(y_)); }

    /// a and b of a texel, whose middle is given.
    struct Slopes {
        Vec x, y;
    };
    [[nodiscard]] Slopes slopes(Vec u, Vec v) const {
        const Vec inverse =
            hn::ApproximateReciprocal(hn::MulAdd(u, u, hn::MulAdd(v, v, number(1.0f))));
        const Vec slope = hn::Mul(number(-3.0f * scale_), inverse);
        return {hn::Mul(slope, u), hn::Mul(slope, v)};
    }

    /// The mean, on the line from (x, y) - half to (x, y) + half, of the integral from the left
    /// side to the line. That is cubic there, whose mean is the middle's value and a sixth of the
    /// second derivative there.
    [[nodiscard]] Vec mean_left_of(const Slopes& slopes, Vec x, Vec y, Vec half_x,
                                   Vec half_y) const {
        const Vec half = number(0.5f), xx = number(xx_), yy = number(yy_), xy = number(xy_);
        const Vec from_left = hn::Add(x, half);
        const Vec of_y = hn::MulAdd(hn::MulAdd(yy, y, slopes.y), y, number(1.0f));
        const Vec half_slope = hn::Mul(half, hn::MulAdd(xy, y, slopes.x));
        const Vec square = hn::MulAdd(hn::Sub(x, half), x, number(0.25f));
        const Vec mean =
            hn::MulAdd(number(xx_ / 3.0f), square, hn::MulAdd(half_slope, hn::Sub(x, half), of_y));
        const Vec half_xx = hn::MulAdd(xx, x, half_slope);
        const Vec mixed = hn::MulAdd(number(2.0f * yy_), y, hn::MulAdd(xy, x, slopes.y));
        const Vec bend = hn::MulAdd(half_x, hn::MulAdd(half_xx, half_x, hn::Mul(mixed, half_y)),
                                    hn::Mul(hn::Mul(yy, from_left), hn::Mul(half_y, half_y)));
        return hn::MulAdd(from_left, mean, hn::Mul(bend, number(1.0f / 3.0f)));
    }

    /// What whole texels of a row have up to height y: the integral of their density less y, and
    /// for each unit of change(). Multiples of powers of two, so that differences are exact: where
    /// they cancel, nothing is left of a sun in the row.
    struct Heights {
        Vec density, change;
    };
    [[nodiscard]] Heights up_to(Vec y) const {
        const Vec square = hn::Mul(y, y), coarse = number(1.5f), fine = number(0.75f);
        const Vec density = hn::Mul(square, hn::MulAdd(number(yy_ / 3.0f), y, number(0.5f * y_)));
        return {hn::Sub(hn::Add(density, coarse), coarse),
                hn::Sub(hn::MulAdd(number(0.5f), square, fine), fine)};
    }

private:
    float scale_, y_, xx_, yy_, xy_;
};

} // namespace relumine::cubemap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif // toggle
