#include "relight/bounces/coarse_bounces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "files/packed_parts.h"
#include "files/parallel.h"

namespace relumine::relight {

namespace {

/// Receivers of a group on the first level: neighbours that see much the same.
constexpr std::size_t SmallestGroup = 16, LargestGroup = 1024;

/// Groups that make one of the next level.
constexpr std::size_t GroupsPerGroup = 4;

/// The first level has fewer entries than the matrix by this factor at least.
constexpr std::int64_t LeastSaving = 3;

/// Groups that tell how many entries there would be.
constexpr std::size_t NumTriedGroups = 32;

/// The last level has so few groups that its products cost nothing.
constexpr std::size_t FewGroups = 100;

constexpr std::uint32_t MaxBouncesOfLastLevel = 100;

/// The relative error at which the sum of the last level ends.
constexpr double LastLevelTolerance = 0.02;

/// No channel is assumed to keep more of its light per bounce.
constexpr double LargestRatio = 0.97;

/// Sums weights by group, and lists the groups in the order in which they came.
class RowSums {
public:
    explicit RowSums(std::size_t num_groups) : sums_(num_groups) {}

    void add(std::size_t group, float weight) {
        if (sums_[group] == 0.0f)
            groups_.push_back(static_cast<std::uint32_t>(group));
        sums_[group] += weight;
    }
    [[nodiscard]] std::span<const std::uint32_t> groups() const { return groups_; }
    [[nodiscard]] float of(std::uint32_t group) const { return sums_[group]; }
    void clear() {
        for (const std::uint32_t group : groups_)
            sums_[group] = 0.0f;
        groups_.clear();
    }

private:
    std::vector<float> sums_;
    std::vector<std::uint32_t> groups_;
};

/// Whether this process has the group that begins with a row.
bool has_group(const SharedRows& shared, std::size_t first_row) {
    return shared.team == nullptr || prt::has_row(shared.team->part(), first_row, 0);
}

} // namespace

/// Sums the rows of the groups for which has_group(group) is true; `add_row` adds the weights of a
/// row of the finer level to RowSums.
template<typename HasGroup, typename AddRow>
CoarseBounces::Rows CoarseBounces::rows_of_groups(std::size_t num_rows, std::size_t group_size,
                                                  const HasGroup& has_group,
                                                  const AddRow& add_row) {
    const std::size_t num_groups = (num_rows + group_size - 1) / group_size;
    Rows rows(num_groups);
    const files::IndexRange<std::size_t> groups(0, num_groups, 64);
    files::parallel_for(groups, [&](const auto& some) {
        RowSums sums(num_groups);
        for (std::size_t group = some.begin(); group != some.end(); ++group) {
            if (!has_group(group))
                continue;
            const std::size_t begin = group * group_size;
            const std::size_t end = std::min(begin + group_size, num_rows);
            for (std::size_t row = begin; row < end; ++row)
                add_row(row, sums);
            for (const std::uint32_t emitter : sums.groups())
                rows[group].push_back(
                    {.group = emitter,
                     .weight = sums.of(emitter) / static_cast<float>(end - begin)});
            sums.clear();
        }
    });
    return rows;
}

/// Gives all processes the groups of each. Groups lie within runs of rows, so each is in one
/// process.
void CoarseBounces::share(Rows& rows, std::size_t group_size, prt::Team& team) {
    const prt::Part part = team.part();
    const auto has_group = [&](std::uint32_t process, std::size_t group) {
        return prt::has_row({process, part.count}, group * group_size, 0);
    };
    files::ByteWriter writer;
    for (std::size_t group = 0; group < rows.size(); ++group)
        if (has_group(part.index, group)) {
            writer.add<std::uint64_t>(rows[group].size());
            writer.add_all(std::span<const Entry>(rows[group]));
        }
    const auto of_all = team.all_gather(writer.take());
    for (std::uint32_t process = 0; process < of_all.size(); ++process) {
        files::ByteReader reader(of_all[process]);
        for (std::size_t group = 0; group < rows.size(); ++group)
            if (has_group(process, group)) {
                const auto size = reader.next<std::uint64_t>();
                rows[group] = reader.next_all<Entry>(static_cast<std::size_t>(size));
            }
    }
}

CoarseBounces::Level CoarseBounces::level_of(const Rows& rows, std::size_t group_size) {
    Level level{.group_size = group_size};
    for (const std::vector<Entry>& row : rows) {
        level.entries.insert(level.entries.end(), row.begin(), row.end());
        level.row_begin.push_back(level.entries.size());
    }
    for (std::vector<PaddedRgb>* values :
         {&level.albedo, &level.sent, &level.sum, &level.next, &level.given})
        values->resize(rows.size());
    return level;
}

/// Returns the smallest size of groups that leaves a matrix small enough.
std::size_t CoarseBounces::size_of_groups(const prt::BounceMatrix& matrix, std::size_t first,
                                          const SharedRows& shared) {
    static_assert(prt::RowsPerRun % LargestGroup == 0);
    const std::size_t num_rows = matrix.num_rows() - first;
    std::size_t group_size = SmallestGroup;
    for (; group_size < LargestGroup; group_size *= GroupsPerGroup) {
        const std::size_t num_groups = (num_rows + group_size - 1) / group_size;
        const std::size_t step = std::max<std::size_t>(num_groups / NumTriedGroups, 1);
        RowSums sums(num_groups);
        std::array<std::int64_t, 2> entries_and_emitters{};
        for (std::size_t group = 0; group < num_groups; group += step) {
            if (!has_group(shared, group * group_size))
                continue;
            const std::size_t end = std::min((group + 1) * group_size, num_rows);
            for (std::size_t row = group * group_size; row < end; ++row)
                for (const std::uint32_t emitter : matrix.emitters[first + row]) {
                    sums.add((emitter - first) / group_size, 1.0f);
                    ++entries_and_emitters[1];
                }
            entries_and_emitters[0] += static_cast<std::int64_t>(sums.groups().size());
            sums.clear();
        }
        if (shared.team != nullptr)
            shared.team->sum(entries_and_emitters);
        if (LeastSaving * entries_and_emitters[0] <= entries_and_emitters[1])
            break;
    }
    return group_size;
}

CoarseBounces::CoarseBounces(const prt::BounceMatrix& matrix, std::size_t first,
                             const SharedRows& shared) {
    const std::size_t num_rows = matrix.num_rows() - first;
    const auto emitters_of = [&](std::size_t place) {
        return static_cast<double>(shared.team != nullptr ? shared.num_emitters[place]
                                                          : matrix.emitters[place].size());
    };
    // Each receiver's own emitters stand for those of all that it is averaged with.
    const auto own_weight = [&](std::size_t place) {
        double num_emitters = 0.0;
        for (const std::uint32_t other : matrix.averaged[place])
            num_emitters += emitters_of(other);
        const double num_own = emitters_of(place);
        return num_own > 0.0 ? static_cast<float>(static_cast<double>(matrix.weights[place]) *
                                                  num_emitters / num_own)
                             : 0.0f;
    };
    const std::size_t group_size = size_of_groups(matrix, first, shared);
    const auto has_own = [&](std::size_t group) {
        return has_group(shared, group * group_size);
    };
    Rows rows = rows_of_groups(num_rows, group_size, has_own, [&](std::size_t row, RowSums& sums) {
        const float weight = own_weight(first + row);
        if (weight > 0.0f)
            for (const std::uint32_t emitter : matrix.emitters[first + row])
                sums.add((emitter - first) / group_size, weight);
    });
    if (shared.team != nullptr)
        share(rows, group_size, *shared.team);
    levels_.push_back(level_of(rows, group_size));
    while (levels_.back().num_groups() > FewGroups) {
        const Level& fine = levels_.back();
        const auto all = [](std::size_t) {
            return true;
        };
        const auto add_row = [&](std::size_t row, RowSums& sums) {
            for (std::uint64_t i = fine.row_begin[row]; i < fine.row_begin[row + 1]; ++i)
                sums.add(fine.entries[i].group / GroupsPerGroup, fine.entries[i].weight);
        };
        levels_.push_back(level_of(rows_of_groups(fine.num_groups(), GroupsPerGroup, all, add_row),
                                   GroupsPerGroup));
    }
}

void CoarseBounces::set_albedo(std::span<const PaddedRgb> albedo) {
    for (Level& level : levels_) {
        means_of_groups(albedo, level.group_size, level.albedo);
        albedo = level.albedo;
    }
}

void CoarseBounces::Level::multiply() {
    for (std::size_t i = 0; i < num_groups(); ++i)
        for (std::size_t c = 0; c < 4; ++c)
            sent[i].rgb[c] = given[i].rgb[c] + albedo[i].rgb[c] * sum[i].rgb[c];
    constexpr std::size_t GroupsPerTask = 64;
    files::parallel_for(
        std::size_t{0}, (num_groups() + GroupsPerTask - 1) / GroupsPerTask, [&](std::size_t task) {
            const std::size_t end = std::min(num_groups(), (task + 1) * GroupsPerTask);
            for (std::size_t group = task * GroupsPerTask; group < end; ++group) {
                // Several sums at a time, as in sum_lists().
                constexpr std::size_t NumSums = 4;
                std::array<PaddedRgb, NumSums> sums{};
                std::uint64_t i = row_begin[group];
                const std::uint64_t end_of_row = row_begin[group + 1];
                for (; i + NumSums <= end_of_row; i += NumSums)
                    for (std::size_t k = 0; k < NumSums; ++k)
                        for (std::size_t c = 0; c < 4; ++c)
                            sums[k].rgb[c] +=
                                entries[i + k].weight * sent[entries[i + k].group].rgb[c];
                for (; i < end_of_row; ++i)
                    for (std::size_t c = 0; c < 4; ++c)
                        sums[0].rgb[c] += entries[i].weight * sent[entries[i].group].rgb[c];
                for (std::size_t c = 0; c < 4; ++c)
                    next[group].rgb[c] =
                        (sums[0].rgb[c] + sums[1].rgb[c]) + (sums[2].rgb[c] + sums[3].rgb[c]);
            }
        });
}

std::span<const PaddedRgb> CoarseBounces::sum_of_bounces(std::size_t level_index,
                                                         std::span<const PaddedRgb> sent) {
    if (level_index + 1 == levels_.size())
        return sum_of_last_level(sent);
    Level& level = levels_[level_index];
    Level& coarse = levels_[level_index + 1];
    level.given.assign(sent.begin(), sent.end());
    std::fill(level.sum.begin(), level.sum.end(), PaddedRgb{});
    level.multiply();
    // What comes back goes on bouncing, as far as it is even within groups of the next level.
    for (std::size_t i = 0; i < level.num_groups(); ++i)
        for (std::size_t c = 0; c < 4; ++c)
            level.sent[i].rgb[c] = level.albedo[i].rgb[c] * level.next[i].rgb[c];
    std::vector<PaddedRgb> coarse_sent(coarse.num_groups());
    means_of_groups(level.sent, coarse.group_size, coarse_sent);
    const std::span<const PaddedRgb> more = sum_of_bounces(level_index + 1, coarse_sent);
    for (std::size_t i = 0; i < level.num_groups(); ++i)
        for (std::size_t c = 0; c < 4; ++c)
            level.next[i].rgb[c] += more[i / coarse.group_size].rgb[c];
    return level.next;
}

std::span<const PaddedRgb> CoarseBounces::sum_of_last_level(std::span<const PaddedRgb> sent) {
    Level& level = levels_.back();
    level.given.assign(sent.begin(), sent.end());
    std::fill(level.sum.begin(), level.sum.end(), PaddedRgb{});
    std::array<double, 3> last{};
    for (std::uint32_t bounce = 0;; ++bounce) {
        level.multiply();
        std::array<double, 3> steps{}, sizes{};
        for (std::size_t i = 0; i < level.num_groups(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const auto after = static_cast<double>(level.next[i].rgb[c]);
                const double step = after - static_cast<double>(level.sum[i].rgb[c]);
                steps[c] += step * step;
                sizes[c] += after * after;
            }
        // What further bounces add: the last one again and again, each time by a ratio smaller.
        std::array<double, 3> tails{};
        bool is_done = bounce > 0;
        for (std::size_t c = 0; c < 3; ++c) {
            if (steps[c] == 0.0 || last[c] == 0.0)
                continue;
            const double ratio = std::min(std::sqrt(steps[c] / last[c]), LargestRatio);
            tails[c] = ratio / (1.0 - ratio);
            // A tail is right for light that is even; let a fifth of it be wrong.
            is_done =
                is_done && 0.2 * tails[c] * std::sqrt(steps[c] / sizes[c]) < LastLevelTolerance;
        }
        if (is_done || bounce + 1 == MaxBouncesOfLastLevel) {
            for (std::size_t i = 0; i < level.num_groups(); ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    level.sum[i].rgb[c] =
                        level.next[i].rgb[c] +
                        static_cast<float>(tails[c]) * (level.next[i].rgb[c] - level.sum[i].rgb[c]);
            return level.sum;
        }
        level.sum.swap(level.next);
        last = steps;
    }
}

} // namespace relumine::relight
