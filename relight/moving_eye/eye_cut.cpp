#include "relight/moving_eye/eye_cut.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "cubemap/luminance.h"
#include "prt/glossy/lobe_list.h"

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/moving_eye/eye_cut.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The children of two cells are looked at together, or as many as a vector holds.
constexpr std::size_t NumSisters = 8;
using Sisters = hn::CappedTag<float, NumSisters>;

/// A light spread by the lobe's own width is off by so much of itself where the lobe is widened in
/// place of being summed finely.
constexpr float ErrorOfSpread = 0.5f;
/// The cosine and the masks change over half a radian, however rough the surface.
constexpr float LargestWidth2 = 0.25f;
/// How much the visible part of a cell may go with its light.
constexpr float ShareOfContrast = 0.3f;

/// Bits of the children of two cells, one for each child.
struct SisterBits {
    /// Those with light above the horizons.
    std::uint32_t lit = 0;
    /// Those that may stay whole, if receivers see all of the cell alike and if they do not.
    std::uint32_t fine_alike = 0, fine = 0;
};

/// The alpha of a lobe from which on the error of a cell holds as it is: roughness 0.3.
constexpr float WideAlpha = 0.09f;

/// A narrower lobe is a sum over more cells, and their errors go up and down: of 0.0225
/// (roughness 0.15) 2.8 times the error a cell leaves the error of the sum as it was.
float error_of_cell(float error, float alpha2) {
    return error * std::max(std::pow(WideAlpha * WideAlpha / alpha2, 0.375f), 1.0f);
}

/// What a lobe and an error ask of cells.
class Judge {
public:
    Judge(const BlockLobe& lobe, float error)
        : lobe_(lobe), error_(error_of_cell(error, lobe.alpha2)),
          factor_(0.25f * lobe.weight /
                  (std::numbers::pi_v<float> * std::max(lobe.n_v, std::sqrt(lobe.alpha2)))) {}

    [[nodiscard]] SisterBits operator()(const SisterCells& a, const SisterCells& b) const {
        SisterBits bits;
        for (std::size_t i = 0; i < NumSisters; i += hn::Lanes(Sisters()))
            add({a, b, i}, i, bits);
        return bits;
    }

private:
    using Vector = hn::Vec<Sisters>;

    /// Some of the children of two cells.
    struct Some {
        const SisterCells &a, &b;
        std::size_t first;

        template<typename T, std::size_t N, typename D>
        [[nodiscard]] auto load(D d, const std::array<T, N> SisterCells::* member,
                                std::size_t row) const {
            constexpr std::size_t Half = SisterCells::Stride;
#if HWY_TARGET != HWY_SCALAR
            if constexpr (hn::MaxLanes(D()) == NumSisters) {
                const hn::Half<D> half;
                return hn::Combine(d, hn::Load(half, (b.*member).data() + row * Half),
                                   hn::Load(half, (a.*member).data() + row * Half));
            } else
#endif
            {
                const SisterCells& of = first < Half ? a : b;
                return hn::Load(d, (of.*member).data() + row * Half + first % Half);
            }
        }
        [[nodiscard]] Vector row(SisterCells::Row row) const {
            return load(Sisters(), &SisterCells::rows, row);
        }
    };

    static Vector all(float value) { return hn::Set(Sisters(), value); }
    static Vector dot(const glm::vec3& a, Vector x, Vector y, Vector z) {
        return hn::MulAdd(all(a.x), x, hn::MulAdd(all(a.y), y, hn::Mul(all(a.z), z)));
    }

    static Vector luminance(const Some& cells) {
        constexpr cubemap::LuminanceWeights of = cubemap::Rec709Weights;
        const glm::vec3 weights(of.red, of.green, of.blue);
        return dot(weights, cells.row(SisterCells::Red), cells.row(SisterCells::Green),
                   cells.row(SisterCells::Blue));
    }

    void add(const Some& cells, std::size_t first, SisterBits& bits) const {
        const Sisters d;
        const hn::RebindToUnsigned<Sisters> bits_d;
        const auto zero = hn::Zero(d), one = all(1.0f);
        const auto x = cells.row(SisterCells::X), y = cells.row(SisterCells::Y),
                   z = cells.row(SisterCells::Z), power = luminance(cells);
        const auto packed = cells.load(bits_d, &SisterCells::size_and_contrast, 0);
        const auto size = hn::BitCast(d, hn::And(packed, hn::Set(bits_d, 0xffff0000u)));
        const auto contrast = hn::BitCast(d, hn::ShiftLeft<16>(packed));
        const auto n_w = dot(lobe_.normal, x, y, z), v_w = dot(lobe_.to_eye, x, y, z);
        const auto spread = all(lobe_.spread), alpha2 = all(lobe_.alpha2);
        const auto lit =
            hn::And(hn::Gt(power, zero), hn::Ge(hn::Add(n_w, hn::Add(spread, size)), zero));
        const auto sum = hn::Add(all(lobe_.n_v), n_w);
        const auto over_h_h =
            hn::Div(one, hn::Max(hn::MulAdd(all(2.0f), v_w, all(2.0f)), all(1e-6f)));
        const auto sine = hn::Sqrt(hn::Max(hn::NegMulAdd(hn::Mul(sum, sum), over_h_h, one), zero));
        // The half vector of v and w turns half as far as w towards v, and 1 / |v + w| as far to
        // the side: much further near the horizon. The square of what it turns in the mean:
        const auto turn2 = hn::MulAdd(all(0.5f), over_h_h, all(0.125f));
        const auto size2 = hn::Mul(hn::Mul(size, size), turn2);
        const auto nearest =
            hn::Max(hn::Sub(sine, hn::MulAdd(all(0.5f), hn::Sqrt(size2), spread)), zero);
        const auto nearest2 = hn::Mul(nearest, nearest);
        const auto width2 = hn::Min(hn::Add(nearest2, alpha2), all(LargestWidth2));
        // S as if at the nearest point, of the lobe that is as wide as the cell: above / below.
        const auto wide2 = hn::MulAdd(size2, all(1.0f / 6.0f), alpha2);
        const auto t = hn::Add(nearest2, wide2);
        const auto risen =
            hn::Min(hn::Max(hn::MulAdd(all(0.5f), size, hn::Add(n_w, spread)), zero), one);
        const auto above = hn::Mul(hn::Mul(all(factor_), power), hn::Mul(wide2, risen));
        const auto below =
            hn::Mul(all(error_), hn::Mul(hn::Mul(t, t), hn::Max(risen, all(lobe_.n_v))));
        // How far off the cell is as one light, times width2.
        const auto off = hn::Min(
            hn::Mul(hn::Mul(all(ErrorOfSpread), turn2), cells.row(SisterCells::Variance)), width2);
        const auto edge =
            hn::Min(hn::Sqrt(hn::Mul(hn::Mul(size2, all(4.0f / 3.0f)), width2)), width2);
        const auto differs = hn::MulAdd(
            all(0.5f), edge, hn::Mul(hn::Mul(all(0.5f * ShareOfContrast), contrast), width2));
        const auto allowed = hn::Mul(below, width2);
        const auto weak = hn::Le(above, below);
        const auto bits_of = [&](auto mask) {
            return prt::HWY_NAMESPACE::bits_of(d, mask) << first;
        };
        bits.lit |= bits_of(lit);
        bits.fine_alike |= bits_of(hn::Or(weak, hn::Le(hn::Mul(above, off), allowed)));
        bits.fine |= bits_of(hn::Or(weak, hn::Le(hn::Mul(above, hn::Add(off, differs)), allowed)));
    }

    const BlockLobe& lobe_;
    float error_, factor_;
};

/// Which children of a divided cell are part of a cut, and which are divided: a bit each.
struct Choice {
    std::uint32_t whole = 0, divided = 0;
};

/// Finds the cells of a cut. `search` has the faces.
class CellSearch {
public:
    CellSearch(const VisibilityPyramid& visibility, const SkyCells& sky, std::size_t block,
               EyeCut::Search& search)
        : visibility_(visibility), sky_(sky), block_(block), search_(search) {}

    void run(const Judge& judge) {
        // Level by level, so that what is fetched ahead has time to come.
        for (std::size_t next = 0; next < search_.num_divided; next += 2) {
            make_room();
            const EyeCut::Item a = search_.divided[next];
            const bool has_two = next + 1 < search_.num_divided;
            const EyeCut::Item b = has_two ? search_.divided[next + 1] : a;
            const SisterCells &below_a = sky_.children(a.cell), &below_b = sky_.children(b.cell);
            const SisterBits bits = judge(below_a, below_b);
            divide(next, below_a, bits);
            if (has_two)
                divide(next + 1, below_b,
                       {.lit = bits.lit >> 4u,
                        .fine_alike = bits.fine_alike >> 4u,
                        .fine = bits.fine >> 4u});
        }
    }

    /// Takes the sky's last change to a cut, as EyeCut::update() says.
    bool update(const Judge& judge, std::span<EyeCut::Item> items, LitCells& cells) const {
        for (EyeCut::Item& at : items) {
            const std::uint32_t changed = sky_.changed_children(at.cell);
            if (changed == 0)
                continue;
            const SisterCells& below = sky_.children(at.cell);
            const VisibilityPyramid::Sights seen = visibility_.sights(at.place);
            const Choice choice = chosen(SkyCells::first_child(at.cell), seen, judge(below, below));
            if (choice.divided != at.divided)
                return false;
            const std::uint32_t before =
                std::exchange(at.whole, static_cast<std::uint16_t>(choice.whole));
            for (std::uint32_t left = changed & (before | choice.whole); left != 0;
                 left &= left - 1) {
                const std::uint32_t i = lowest_bit(left);
                PartlyCell cell;
                cell.unit = visibility_.copy_parts(visibility_.child(block_, at.place, seen, i),
                                                   cell.parts);
                if ((choice.whole >> i & 1u) != 0) {
                    cell.light = below.rows.data() + i;
                    cells.partly.push_back(cell);
                }
                if ((before >> i & 1u) != 0) {
                    cell.light = sky_.children_before(at.cell).rows.data() + i;
                    cell.unit = -cell.unit;
                    cells.partly.push_back(cell);
                }
            }
        }
        return true;
    }

private:
    /// Chooses among children, the first of which has this number.
    [[nodiscard]] Choice chosen(std::uint32_t first, const VisibilityPyramid::Sights& seen,
                                const SisterBits& bits) const {
        const std::uint32_t fine =
            sky_.is_split(first) ? (bits.fine & seen.divided) | (bits.fine_alike & ~seen.divided)
                                 : 0xf;
        const std::uint32_t lit = bits.lit & (seen.visible | seen.mixed);
        return {.whole = lit & fine & 0xfu, .divided = lit & ~fine & 0xfu};
    }

    template<typename T>
    static void make_room(std::vector<T>& list, std::size_t used) {
        if (used + NumSisters > list.size())
            list.resize(2 * (used + NumSisters));
    }
    void make_room() {
        make_room(search_.divided, search_.num_divided);
        make_room(search_.open, search_.num_open);
        make_room(search_.partly, search_.num_partly);
    }

    void divide(std::size_t index, const SisterCells& below, const SisterBits& bits) {
        EyeCut::Item& at = search_.divided[index];
        const VisibilityPyramid::Sights seen = visibility_.sights(at.place);
        const std::uint32_t first = SkyCells::first_child(at.cell);
        const Choice choice = chosen(first, seen, bits);
        at.whole = static_cast<std::uint16_t>(choice.whole);
        at.divided = static_cast<std::uint16_t>(choice.divided);
        const std::uint32_t open = choice.whole & seen.visible;
        for (std::uint32_t i = 0; i < 4; ++i) {
            search_.open[search_.num_open] = below.rows.data() + i;
            search_.num_open += open >> i & 1u;
        }
        const VisibilityPyramid::Place place = at.place;
        for (std::uint32_t left = choice.divided & seen.visible; left != 0; left &= left - 1)
            divide_later(first + lowest_bit(left),
                         VisibilityPyramid::Place(VisibilityPyramid::Kind::Visible));
        for (std::uint32_t left = bits.lit & seen.mixed; left != 0; left &= left - 1) {
            const std::uint32_t i = lowest_bit(left);
            const VisibilityPyramid::Place child = visibility_.child(block_, place, seen, i);
            if ((choice.divided >> i & 1u) != 0) {
                divide_later(first + i, child);
                continue;
            }
            hwy::Prefetch(visibility_.first_part(child));
            EyeCut::Partly& partly = search_.partly[search_.num_partly++];
            partly.light = below.rows.data() + i;
            partly.place = child;
        }
    }

    static std::uint32_t lowest_bit(std::uint32_t bits) {
        return static_cast<std::uint32_t>(std::countr_zero(bits));
    }

    void divide_later(std::uint32_t cell, const VisibilityPyramid::Place& place) {
        const SisterCells& below = sky_.children(cell);
        hwy::Prefetch(below.rows.data());
        hwy::Prefetch(below.rows.data() + SisterCells::Red * SisterCells::Stride);
        EyeCut::Item& item = search_.divided[search_.num_divided++];
        item.cell = cell;
        item.place = place;
    }

    const VisibilityPyramid& visibility_;
    const SkyCells& sky_;
    std::size_t block_;
    EyeCut::Search& search_;
};

void find_cells(const VisibilityPyramid& visibility, const SkyCells& sky, std::size_t block,
                const BlockLobe& lobe, float error, EyeCut::Search& search) {
    CellSearch(visibility, sky, block, search).run(Judge(lobe, error));
}

bool update_cells(const VisibilityPyramid& visibility, const SkyCells& sky, std::size_t block,
                  const BlockLobe& lobe, float error, std::span<EyeCut::Item> items,
                  LitCells& cells) {
    EyeCut::Search none;
    return CellSearch(visibility, sky, block, none).update(Judge(lobe, error), items, cells);
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

HWY_EXPORT(find_cells);
HWY_EXPORT(update_cells);

namespace {

glm::vec3 lane_of(const std::array<prt::BlockSurfaces::Floats, 3>& axes, std::size_t lane) {
    return {axes[0][lane], axes[1][lane], axes[2][lane]};
}

/// The factor on a highlight in radiance: about what it reflects of a white sky.
float reflectance(const prt::Surface& surface, float n_v) {
    const float f0 = std::max({surface.specular.r, surface.specular.g, surface.specular.b});
    const float less = 1.0f - n_v;
    return f0 + (1.0f - f0) * (less * less) * (less * less) * less;
}

} // namespace

std::optional<BlockLobe> lobe_of(const prt::BlockSurfaces& block,
                                 std::span<const prt::Surface> surfaces) {
    BlockLobe lobe{.normal = glm::vec3(0.0f), .to_eye = glm::vec3(0.0f)};
    const std::uint32_t lanes = block.lanes_with(prt::GlossyLobe::Specular);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if ((lanes >> i & 1u) == 0)
            continue;
        lobe.normal += lane_of(block.normal, i);
        lobe.to_eye += lane_of(block.to_eye, i);
        lobe.alpha2 = std::min(lobe.alpha2, block.parameters[0][i]);
        lobe.weight = std::max(lobe.weight, reflectance(surfaces[i], block.normal_dot_eye[i]));
    }
    if (!(glm::length(lobe.normal) > 0.0f && glm::length(lobe.to_eye) > 0.0f))
        return std::nullopt;
    lobe.normal = glm::normalize(lobe.normal);
    lobe.to_eye = glm::normalize(lobe.to_eye);
    lobe.n_v = std::max(glm::dot(lobe.normal, lobe.to_eye), 1e-3f);
    for (std::size_t i = 0; i < surfaces.size(); ++i)
        if ((lanes >> i & 1u) != 0)
            lobe.spread = std::max(lobe.spread,
                                   glm::distance(lobe.normal, lane_of(block.normal, i)) +
                                       0.5f * glm::distance(lobe.to_eye, lane_of(block.to_eye, i)));
    return lobe;
}

bool EyeCut::update(std::size_t block, const BlockLobe& lobe, std::span<Item> divided,
                    LitCells& cells) const {
    return HWY_DYNAMIC_DISPATCH(update_cells)(visibility_, sky_, block, lobe, error_, divided,
                                              cells);
}

void EyeCut::find(std::size_t block, const BlockLobe& lobe, LitCells& cells) {
    search_.num_divided = search_.num_open = search_.num_partly = 0;
    search_.divided.resize(std::max(search_.divided.size(), std::size_t{cubemap::NumFaces}));
    for (std::uint32_t face = 0; face < cubemap::NumFaces; ++face)
        if (const VisibilityPyramid::Place place = visibility_.face(block, face);
            place.kind() != VisibilityPyramid::Kind::Hidden)
            search_.divided[search_.num_divided++] = {
                .cell = face, .whole = 0, .divided = 0, .place = place};
    HWY_DYNAMIC_DISPATCH(find_cells)(visibility_, sky_, block, lobe, error_, search_);
    cells.open.insert(cells.open.end(), search_.open.begin(),
                      search_.open.begin() + static_cast<std::ptrdiff_t>(search_.num_open));
    const std::size_t first = cells.partly.size();
    cells.partly.resize(first + search_.num_partly);
    for (std::size_t i = 0; i < search_.num_partly; ++i) {
        PartlyCell& cell = cells.partly[first + i];
        cell.light = search_.partly[i].light;
        cell.unit = visibility_.copy_parts(search_.partly[i].place, cell.parts);
    }
}

} // namespace relumine::relight
#endif
