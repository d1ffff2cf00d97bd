// Means over the cells of one axis for those of another.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace relumine::cubemap::detail {

/// The cells of one axis that each cell of another one overlaps, with their parts of it.
class AxisMeans {
public:
    struct Part {
        std::uint32_t source;
        double weight;
    };

    /// Borders ascend from 0 to 1. `place` carries places on the source's axis to the target's,
    /// linearly; ranges that leave 0..1 come in again at the other end. `measure(a, b)` is the
    /// weight of a range.
    template<typename Place, typename Measure>
    AxisMeans(const std::vector<double>& source, const std::vector<double>& target,
              const Place& place, const Measure& measure)
        : starts_(target.size(), 0) {
        std::vector<std::pair<std::uint32_t, Part>> parts;
        const auto add = [&](std::uint32_t cell, double begin, double end) {
            const auto after = std::upper_bound(target.begin(), target.end(), begin);
            auto i =
                static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(after - target.begin(), 1)) - 1;
            for (; i + 1 < target.size() && target[i] < end; ++i)
                if (const double weight =
                        measure(std::max(begin, target[i]), std::min(end, target[i + 1]));
                    weight > 0.0)
                    parts.push_back({i, {cell, weight}});
        };
        for (std::uint32_t cell = 0; cell + 1 < source.size(); ++cell) {
            auto [begin, end] = std::minmax({place(source[cell]), place(source[cell + 1])});
            const double turns = std::floor(begin);
            begin -= turns;
            end -= turns;
            add(cell, begin, std::min(end, 1.0));
            if (end > 1.0)
                add(cell, 0.0, end - 1.0);
        }
        std::stable_sort(parts.begin(), parts.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        std::vector<double> sums(target.size() - 1, 0.0);
        for (const auto& [cell, part] : parts) {
            ++starts_[cell + 1];
            sums[cell] += part.weight;
        }
        for (std::size_t i = 1; i < starts_.size(); ++i)
            starts_[i] += starts_[i - 1];
        for (const auto& [cell, part] : parts)
            parts_.push_back({part.source, part.weight / sums[cell]});
    }

    /// The parts of a target cell; their weights add up to 1.
    [[nodiscard]] std::span<const Part> of(std::size_t cell) const {
        return std::span(parts_).subspan(starts_[cell], starts_[cell + 1] - starts_[cell]);
    }

private:
    std::vector<std::size_t> starts_;
    std::vector<Part> parts_;
};

} // namespace relumine::cubemap::detail
