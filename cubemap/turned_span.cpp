#include "cubemap/turned_span.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cubemap/turned_span.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::cubemap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, TurnedSpan::MaxSize>;
using Vec = hn::Vec<Lanes>;
using IntLanes = hn::RebindToSigned<Lanes>;
using IntVec = hn::Vec<IntLanes>;

Vec number(float value) {
    return hn::Set(Lanes(), value);
}

/// Solid angle in a texel, in parts of the density at its middle. x and y are in [-1/2, 1/2]; the
/// integral over a region is that of left_of(x, y) dy along its boundary, by Green.
class Density {
public:
    /// (u, v): the texel's middle in [-1, 1]^2; scale: texels to those.
    Density(Vec u, Vec v, float scale) {
        const Vec inverse = hn::Div(number(1.0f), hn::MulAdd(u, u, hn::MulAdd(v, v, number(1.0f))));
        const Vec slope = hn::Mul(number(-3.0f), inverse);
        const Vec bend = hn::Mul(number(15.0f), hn::Mul(inverse, inverse));
        at_middle_ = hn::Mul(inverse, hn::Sqrt(inverse));
        x_ = hn::Mul(hn::Mul(number(scale), slope), u);
        y_ = hn::Mul(hn::Mul(number(scale), slope), v);
        const Vec half_square = number(0.5f * scale * scale);
        xx_ = hn::Mul(half_square, hn::MulAdd(bend, hn::Mul(u, u), slope));
        yy_ = hn::Mul(half_square, hn::MulAdd(bend, hn::Mul(v, v), slope));
        xy_ = hn::Mul(number(scale * scale), hn::Mul(bend, hn::Mul(u, v)));
    }

    [[nodiscard]] Vec at_middle() const { return at_middle_; }

    /// The integral from -1/2 to x at height y.
    [[nodiscard]] Vec left_of(Vec x, Vec y) const {
        const Vec of_y = hn::MulAdd(hn::MulAdd(yy_, y, y_), y, number(1.0f));
        const Vec of_x =
            hn::Mul(hn::MulSub(x, number(0.5f), number(0.25f)), hn::MulAdd(xy_, y, x_));
        const Vec square = hn::MulAdd(hn::Sub(x, number(0.5f)), x, number(0.25f));
        const Vec mean = hn::MulAdd(hn::Mul(xx_, number(1.0f / 3.0f)), square, hn::Add(of_y, of_x));
        return hn::Mul(hn::Add(x, number(0.5f)), mean);
    }

    /// The mean of left_of() on the line from (x, y) - half to (x, y) + half. It is cubic there,
    /// whose mean is the middle's value and a sixth of the second derivative there.
    [[nodiscard]] Vec mean_left_of(Vec x, Vec y, Vec half_x, Vec half_y) const {
        const Vec half_xx = hn::MulAdd(xx_, x, hn::Mul(number(0.5f), hn::MulAdd(xy_, y, x_)));
        const Vec xy = hn::MulAdd(hn::Add(yy_, yy_), y, hn::MulAdd(xy_, x, y_));
        const Vec half_yy = hn::Mul(yy_, hn::Add(x, number(0.5f)));
        const Vec bend = hn::MulAdd(half_x, hn::MulAdd(half_xx, half_x, hn::Mul(xy, half_y)),
                                    hn::Mul(half_yy, hn::Mul(half_y, half_y)));
        return hn::MulAdd(bend, number(1.0f / 3.0f), left_of(x, y));
    }

    /// The integral over whole rows from the height y - half to y + half.
    [[nodiscard]] Vec of_rows(Vec y, Vec half) const {
        const Vec square = hn::MulAdd(y, y, hn::Mul(number(1.0f / 3.0f), hn::Mul(half, half)));
        const Vec mean = hn::MulAdd(
            yy_, square, hn::MulAdd(y_, y, hn::MulAdd(xx_, number(1.0f / 12.0f), number(1.0f))));
        return hn::Mul(hn::Add(half, half), mean);
    }

private:
    Vec at_middle_, x_, y_, xx_, yy_, xy_;
};

/// An edge of the quadrilaterals; then its part in a row of texels, which goes from column to
/// column.
class Edge {
public:
    Edge() = default;
    Edge(const TurnedSpan& span, std::size_t corner, std::size_t first) {
        const Lanes d;
        const std::size_t next = (corner + 1) % 4;
        x_ = hn::LoadU(d, span.x[corner].data() + first);
        y_ = hn::LoadU(d, span.y[corner].data() + first);
        end_x_ = hn::LoadU(d, span.x[next].data() + first);
        end_y_ = hn::LoadU(d, span.y[next].data() + first);
        const Vec width = not_zero(hn::Sub(end_x_, x_)), height = not_zero(hn::Sub(end_y_, y_));
        x_per_y_ = hn::Div(width, height);
        y_per_x_ = hn::Div(height, width);
        goes_right_ = hn::Gt(width, hn::Zero(d));
    }

    /// Goes to a row of texels. Widens the bounds of the quadrilateral there.
    void begin_row(Vec top, Vec& least_x, Vec& most_x) {
        const Vec bottom = hn::Add(top, number(1.0f));
        const Vec start = hn::Min(hn::Max(y_, top), bottom);
        const Vec end = hn::Min(hn::Max(end_y_, top), bottom);
        low_ = hn::Min(start, end);
        high_ = hn::Max(start, end);
        right_end_ = hn::IfThenElse(goes_right_, end, start);
        sign_ = hn::IfThenElse(goes_right_, number(1.0f), number(-1.0f));
        const Vec left = hn::Min(x_, end_x_), right = hn::Max(x_, end_x_);
        const auto is_here = hn::Gt(high_, low_);
        is_in_row_ = !hn::AllFalse(Lanes(), is_here);
        if (!is_in_row_)
            return;
        for (const Vec y : {start, end}) {
            const Vec x = hn::Min(hn::Max(x_at(y), left), right);
            least_x = hn::IfThenElse(is_here, hn::Min(least_x, x), least_x);
            most_x = hn::IfThenElse(is_here, hn::Max(most_x, x), most_x);
        }
    }
    /// Whether any has a part in the row.
    [[nodiscard]] bool is_in_row() const { return is_in_row_; }
    /// Goes to the left side of a column of that row.
    void begin_column(Vec column) { crossing_ = crossing_at(column); }

    /// What lies to the left of the edge in the texel whose left side is the column and whose
    /// middle has this height; then goes to the next texel.
    Vec left_in_texel(Vec column, Vec middle_y, const Density& density) {
        const Vec next = crossing_at(hn::Add(column, number(1.0f)));
        const Vec half = hn::Mul(number(0.5f), hn::Sub(next, crossing_));
        const Vec middle = hn::Mul(number(0.5f), hn::Add(next, crossing_));
        // Rounding may make a flat edge's part wider than the texel.
        const Vec half_x = hn::Min(hn::Max(hn::Mul(half, x_per_y_), number(-0.5f)), number(0.5f));
        const Vec x = hn::Sub(x_at(middle), hn::Add(column, number(0.5f)));
        const Vec inside = hn::Min(hn::Max(x, number(-0.5f)), number(0.5f));
        const Vec through =
            hn::Mul(hn::Add(half, half),
                    density.mean_left_of(inside, hn::Sub(middle, middle_y), half_x, half));
        const Vec rest = hn::Mul(number(0.5f), hn::Sub(right_end_, next));
        const Vec rest_middle = hn::Sub(hn::Mul(number(0.5f), hn::Add(right_end_, next)), middle_y);
        crossing_ = next;
        return hn::Mul(sign_, hn::Add(through, density.of_rows(rest_middle, rest)));
    }

private:
    [[nodiscard]] static Vec not_zero(Vec length) {
        constexpr float Least = 1e-18f;
        return hn::CopySign(hn::Max(hn::Abs(length), number(Least)), length);
    }
    [[nodiscard]] Vec x_at(Vec y) const { return hn::MulAdd(hn::Sub(y, y_), x_per_y_, x_); }
    /// The height at which the edge crosses a line between columns, within the row.
    [[nodiscard]] Vec crossing_at(Vec column) const {
        return hn::Min(hn::Max(hn::MulAdd(hn::Sub(column, x_), y_per_x_, y_), low_), high_);
    }
    Vec x_, y_, end_x_, end_y_, x_per_y_, y_per_x_;
    hn::Mask<Lanes> goes_right_;
    Vec low_, high_, right_end_, sign_, crossing_;
    bool is_in_row_ = false;
};

/// Colours of texels, and their weights. Each quadrilateral has a vector of its own: gathers are
/// slower.
class Means {
public:
    Means(const glm::vec3* face, std::size_t num_texels)
        : values_(reinterpret_cast<const float*>(face)),
          last_(static_cast<std::int32_t>(num_texels - 1)), tail_{face[last_].x, face[last_].y,
                                                                  face[last_].z} {}

    void add(Vec weight, IntVec texel) {
        const Color d;
        HWY_ALIGN std::array<float, TurnedSpan::MaxSize> weights;
        HWY_ALIGN std::array<std::int32_t, TurnedSpan::MaxSize> texels;
        hn::Store(weight, Lanes(), weights.data());
        hn::Store(texel, IntLanes(), texels.data());
        for (std::size_t i = 0; i < hn::Lanes(Lanes()); ++i) {
            // A vector has four numbers, one more than a colour.
            const float* color =
                texels[i] == last_ ? tail_.data() : values_ + std::ptrdiff_t{3} * texels[i];
            float* sum = sums_.data() + 4 * i;
            for (std::size_t j = 0; j < 4; j += hn::Lanes(d))
                hn::Store(hn::MulAdd(hn::Set(d, weights[i]), hn::LoadU(d, color + j),
                                     hn::Load(d, sum + j)),
                          d, sum + j);
        }
        weights_ = hn::Add(weights_, weight);
    }
    void store(std::size_t count, glm::vec3* means) const {
        HWY_ALIGN std::array<float, TurnedSpan::MaxSize> weights{};
        hn::Store(weights_, Lanes(), weights.data());
        for (std::size_t i = 0; i < count; ++i)
            means[i] = glm::vec3(sums_[4 * i], sums_[4 * i + 1], sums_[4 * i + 2]) / weights[i];
    }

private:
    using Color = hn::CappedTag<float, 4>;
    const float* values_;
    std::int32_t last_;
    std::array<float, 4> tail_;
    HWY_ALIGN std::array<float, 4 * TurnedSpan::MaxSize> sums_ = {};
    Vec weights_ = number(0.0f);
};

/// The number of texels from 0 that the quadrilaterals reach.
int reach(const std::array<std::array<float, TurnedSpan::MaxSize>, 4>& corners, std::size_t first,
          std::size_t end) {
    float most = 0.0f;
    for (const auto& corner : corners)
        for (std::size_t i = first; i < end; ++i)
            most = std::max(most, corner[i]);
    return static_cast<int>(std::ceil(most));
}

/// As many quadrilaterals as there are lanes, from the first on.
void mean_under_lanes(const TurnedSpan& span, std::size_t first, const glm::vec3* face,
                      std::int32_t resolution, glm::vec3* means) {
    const Lanes d;
    const IntLanes di;
    const std::size_t end = std::min(span.size, first + hn::Lanes(d));
    const int num_rows = reach(span.y, first, end);
    Edge edges[4] = {{span, 0, first}, {span, 1, first}, {span, 2, first}, {span, 3, first}};
    const IntVec column = hn::LoadU(di, span.column.data() + first);
    const IntVec row = hn::LoadU(di, span.row.data() + first);
    const IntVec last = hn::Set(di, resolution - 1);
    const float scale = 2.0f / static_cast<float>(resolution);
    const auto middle = [&](IntVec texel) {
        return hn::MulAdd(hn::Add(hn::ConvertTo(d, texel), number(0.5f)), number(scale),
                          number(-1.0f));
    };
    Means sums(face, static_cast<std::size_t>(resolution) * static_cast<std::size_t>(resolution));
    for (int r = 0; r < num_rows; ++r) {
        const Vec top = number(static_cast<float>(r)), middle_y = hn::Add(top, number(0.5f));
        const IntVec texel_row = hn::Min(hn::Add(row, hn::Set(di, r)), last);
        Vec least_x = number(1e6f), most_x = number(0.0f);
        for (Edge& edge : edges)
            edge.begin_row(top, least_x, most_x);
        const int first_column = static_cast<int>(hn::GetLane(hn::MinOfLanes(d, least_x)));
        const auto end_column = static_cast<int>(std::ceil(hn::GetLane(hn::MaxOfLanes(d, most_x))));
        for (Edge& edge : edges)
            edge.begin_column(number(static_cast<float>(first_column)));
        for (int c = first_column; c < end_column; ++c) {
            const Vec left = number(static_cast<float>(c));
            const IntVec texel_column = hn::Min(hn::Add(column, hn::Set(di, c)), last);
            const Density density(middle(texel_column), middle(texel_row), scale);
            Vec sum = hn::Zero(d);
            for (Edge& edge : edges)
                if (edge.is_in_row())
                    sum = hn::Add(sum, edge.left_in_texel(left, middle_y, density));
            // What lies beside the quadrilateral gets nothing, not even rounding.
            const auto is_under =
                hn::And(hn::Lt(left, most_x), hn::Gt(hn::Add(left, number(1.0f)), least_x));
            const Vec weight = hn::IfThenElseZero(
                is_under, hn::Mul(density.at_middle(), hn::Max(sum, hn::Zero(d))));
            if (!hn::AllFalse(d, hn::Gt(weight, hn::Zero(d))))
                sums.add(weight,
                         hn::Add(hn::Mul(texel_row, hn::Set(di, resolution)), texel_column));
        }
    }
    sums.store(end - first, means + first);
}

void mean_under(const TurnedSpan& span, const glm::vec3* face, std::int32_t resolution,
                glm::vec3* means) {
    for (std::size_t first = 0; first < span.size; first += hn::Lanes(Lanes()))
        mean_under_lanes(span, first, face, resolution, means);
}

} // namespace relumine::cubemap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::cubemap {

namespace {
HWY_EXPORT(mean_under);
}

void TurnedSpan::add(const std::array<glm::dvec2, 4>& corners) {
    const glm::dvec2 least =
        glm::floor(glm::min(glm::min(corners[0], corners[1]), glm::min(corners[2], corners[3])));
    column[size] = static_cast<std::int32_t>(least.x);
    row[size] = static_cast<std::int32_t>(least.y);
    for (std::size_t i = 0; i < 4; ++i) {
        x[i][size] = static_cast<float>(corners[i].x - least.x);
        y[i][size] = static_cast<float>(corners[i].y - least.y);
    }
    ++size;
}

void mean_under(const TurnedSpan& span, const glm::vec3* face, std::uint32_t resolution,
                glm::vec3* means) {
    HWY_DYNAMIC_DISPATCH(mean_under)
    (span, face, static_cast<std::int32_t>(resolution), means);
}

} // namespace relumine::cubemap
#endif // HWY_ONCE
