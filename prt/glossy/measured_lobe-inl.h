// The tables of measured_lobe.h, 16 receivers at a time. A part of lobe_kernel.cpp.

/// Two places of a table along one of its sides: the first, and the share of the second.
struct Between {
    Between(Vector index, std::size_t count) : first(hn::Zero(Tag())), share(first) {
        const Tag d;
        const auto x = hn::Min(hn::Max(hn::Sub(index, hn::Set(d, 0.5f)), hn::Zero(d)),
                               hn::Set(d, static_cast<float>(count - 1)));
        first = hn::Min(hn::Floor(x), hn::Set(d, static_cast<float>(count - 2)));
        share = hn::Sub(x, first);
    }
    Vector first, share;
};

/// Where a table is read for some receivers, as BrdfTable::rest() reads it.
struct TablePlace {
    using Table = mesh::BrdfTable;
    explicit TablePlace(const LobeTerms& terms)
        : half(hn::Zero(Tag()), Table::NumHalf), difference(half), azimuth(half) {
        const Tag d;
        const auto one = hn::Set(d, 1.0f);
        const auto zero = hn::Zero(d), middle = hn::Set(d, 0.5f);
        const auto sin2 = hn::Min(hn::Max(terms.sin2, zero), one);
        const auto sin_h = hn::Sqrt(sin2);
        const auto cos_h = hn::Sqrt(hn::Max(hn::Sub(one, sin2), hn::Set(d, 1e-12f)));
        const auto n_v = hn::Max(terms.n_v(), zero);
        const auto cos_d =
            hn::Min(hn::Max(hn::Div(hn::Mul(middle, hn::Add(terms.n_w, n_v)), cos_h), zero), one);
        const auto sin_d = hn::Sqrt(hn::NegMulAdd(cos_d, cos_d, one));
        const auto cos_phi = hn::Min(hn::Div(hn::Mul(middle, hn::Abs(hn::Sub(terms.n_w, n_v))),
                                             hn::Max(hn::Mul(sin_h, sin_d), hn::Set(d, 1e-9f))),
                                     one);
        const auto per_radian = hn::Set(d, 2.0f * std::numbers::inv_pi_v<float>);
        const auto index = [&](Vector angle, std::size_t count) {
            return hn::Mul(hn::Set(d, static_cast<float>(count)), hn::Mul(angle, per_radian));
        };
        half = Between(hn::Mul(hn::Set(d, static_cast<float>(Table::NumHalf)),
                               hn::Sqrt(hn::Mul(hn::Asin(d, sin_h), per_radian))),
                       Table::NumHalf);
        difference = Between(index(hn::Acos(d, cos_d), Table::NumDifference), Table::NumDifference);
        azimuth = Between(index(hn::Acos(d, cos_phi), Table::NumAzimuth), Table::NumAzimuth);
    }

    /// Returns one of the colours of a table.
    [[nodiscard]] Vector read(const Table& table, std::size_t color) const {
        const Tag d;
        const hn::RebindToSigned<Tag> integers;
        const auto first = hn::ConvertTo(
            integers,
            hn::MulAdd(hn::MulAdd(half.first, hn::Set(d, static_cast<float>(Table::NumDifference)),
                                  difference.first),
                       hn::Set(d, static_cast<float>(Table::NumAzimuth)), azimuth.first));
        const float* const values = table.rests().data() + color * Table::NumPlaces;
        const auto between = [](Vector a, Vector b, Vector share) {
            return hn::MulAdd(share, hn::Sub(b, a), a);
        };
        const auto row = [&](std::size_t offset) {
            return between(hn::GatherIndex(d, values + offset, first),
                           hn::GatherIndex(d, values + offset + 1, first), azimuth.share);
        };
        const auto sheet = [&](std::size_t offset) {
            return between(row(offset), row(offset + Table::NumAzimuth), difference.share);
        };
        return between(sheet(0), sheet(Table::NumAzimuth * Table::NumDifference), half.share);
    }

    Between half, difference, azimuth;
};

/// Returns red, green or blue of the measured surfaces, and zero for others.
inline Vector measured(const LobeTerms& terms, std::size_t color) {
    const BlockSurfaces& surfaces = terms.surfaces;
    auto result = hn::Zero(Tag());
    std::uint32_t left = surfaces.lanes[static_cast<std::size_t>(Highlight::Measured)] &
                         (((1u << hn::Lanes(Tag())) - 1u) << terms.lane);
    if (left == 0)
        return result;
    const TablePlace place(terms);
    while (left != 0) {
        const mesh::BrdfTable* const table =
            surfaces.tables[static_cast<std::size_t>(std::countr_zero(left))];
        std::uint32_t same = 0;
        for (std::uint32_t bits = left; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
            same |= (surfaces.tables[lane] == table ? 1u : 0u) << lane;
        }
        result = hn::IfThenElse(terms.lanes(same), place.read(*table, color), result);
        left &= ~same;
    }
    return hn::Mul(terms.n_w, result);
}
