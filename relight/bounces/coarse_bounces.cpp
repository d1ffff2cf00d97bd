#include "relight/bounces/coarse_bounces.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "files/packed_parts.h"

namespace relumine::relight {

namespace {

/// Neighbouring rows among which groups are made.
constexpr std::size_t RowsPerRun = 256;
static_assert(RowsPerTask % RowsPerRun == 0);

/// Bounces of random light that tell which rows belong together: of receivers, and of groups,
/// whose products cost little.
constexpr std::size_t NumBounces = 6, NumBouncesOfGroups = 8;

/// Rows belong together where their light differs by less than this part of it, on the first level
/// and on the second; each further level allows more, so there are ever fewer groups.
constexpr float Tolerance = 0.04f, ToleranceOfGroups = 0.08f, Growth = 1.3f;

/// Light below this is nothing, where random light begins with up to 1.
constexpr float Nothing = 0.01f;

/// The last level has so few groups that its equations are solved at once.
constexpr std::size_t FewGroups = 256;

/// What a group gets from another: A rho, for each colour.
struct Entry {
    std::uint32_t group = 0;
    PaddedRgb weight;
};
using Rows = std::vector<std::vector<Entry>>;

/// Sums weights by group, and lists the groups in the order in which they came.
class RowSums {
public:
    explicit RowSums(std::size_t num_groups) : sums_(num_groups), has_(num_groups) {}

    /// The weight is a copy, which no sum overlaps.
    void add(std::size_t group, float factor, const PaddedRgb weight) {
        if (has_[group] == 0) {
            groups_.push_back(static_cast<std::uint32_t>(group));
            has_[group] = 1;
        }
        for (std::size_t c = 0; c < 4; ++c)
            sums_[group].rgb[c] += factor * weight.rgb[c];
    }

    /// Returns the sums times a factor, and forgets them.
    [[nodiscard]] std::vector<Entry> take(float factor) {
        std::vector<Entry> entries;
        for (const std::uint32_t group : groups_) {
            Entry& entry = entries.emplace_back(Entry{.group = group, .weight = sums_[group]});
            for (float& channel : entry.weight.rgb)
                channel *= factor;
            sums_[group] = {};
            has_[group] = 0;
        }
        groups_.clear();
        return entries;
    }

private:
    std::vector<PaddedRgb> sums_;
    std::vector<std::uint8_t> has_;
    std::vector<std::uint32_t> groups_;
};

/// The groups of some rows.
struct Groups {
    /// [rows] ascending within a run, as groups are numbered by their first rows.
    std::vector<std::uint32_t> of;
    /// [groups] first row
    std::vector<std::uint32_t> first;
    /// [groups] one over the number of rows
    std::vector<float> shares;
};

/// Four draws of random light between -1 and 1, the same on all machines.
std::vector<PaddedRgb> random_light(std::size_t num_rows) {
    std::vector<PaddedRgb> light(num_rows);
    std::uint64_t state = 1;
    for (PaddedRgb& value : light)
        for (float& channel : value.rgb) {
            state = state * 6364136223846793005u + 1442695040888963407u; // Knuth's MMIX
            channel = static_cast<float>(state >> 40) * 0x1p-23f - 1.0f;
        }
    return light;
}

float largest(const PaddedRgb& value) {
    float result = 0.0f;
    for (const float channel : value.rgb)
        result = std::max(result, std::abs(channel));
    return result;
}

/// Makes the groups of rows that have about the same light.
Groups groups_of(std::span<const PaddedRgb> light, float tolerance) {
    Groups groups;
    groups.of.resize(light.size());
    std::vector<std::uint32_t> sizes;
    for (std::size_t run = 0; run < light.size(); run += RowsPerRun) {
        const std::size_t first_of_run = groups.first.size();
        const std::size_t end = std::min(run + RowsPerRun, light.size());
        for (std::size_t row = run; row < end; ++row) {
            std::size_t group = first_of_run;
            for (; group < groups.first.size(); ++group) {
                const PaddedRgb& other = light[groups.first[group]];
                PaddedRgb difference;
                for (std::size_t c = 0; c < 4; ++c)
                    difference.rgb[c] = light[row].rgb[c] - other.rgb[c];
                if (largest(difference) <= tolerance * std::max(largest(other), Nothing))
                    break;
            }
            if (group == groups.first.size()) {
                groups.first.push_back(static_cast<std::uint32_t>(row));
                sizes.push_back(0);
            }
            groups.of[row] = static_cast<std::uint32_t>(group);
            ++sizes[group];
        }
    }
    for (const std::uint32_t size : sizes)
        groups.shares.push_back(1.0f / static_cast<float>(size));
    return groups;
}

} // namespace

struct CoarseBounces::Level {
    /// Rows are receivers, or the groups of the level before.
    Groups groups;
    std::vector<std::uint64_t> row_begin = {0};
    std::vector<Entry> entries = {};
    // All [groups].
    std::vector<PaddedRgb> next = {};
    /// For each colour, 1 - A rho; of the last level.
    std::array<Eigen::PartialPivLU<Eigen::MatrixXf>, 3> equations = {};

    /// Sums the rows of the groups for which has_group(group) is true; `add_row` adds the weights
    /// of a row of the finer level to RowSums.
    template<typename HasGroup, typename AddRow>
    [[nodiscard]] Rows rows_of(const HasGroup& has_group, const AddRow& add_row) const {
        std::vector<std::vector<std::uint32_t>> members(num_groups());
        for (std::uint32_t row = 0; row < groups.of.size(); ++row)
            members[groups.of[row]].push_back(row);
        Rows rows(num_groups());
        const files::IndexRange<std::size_t> all(0, num_groups(), 64);
        files::parallel_for(all, [&](const auto& some) {
            RowSums sums(num_groups());
            for (std::size_t group = some.begin(); group != some.end(); ++group) {
                if (!has_group(group))
                    continue;
                for (const std::uint32_t row : members[group])
                    add_row(row, sums);
                rows[group] = sums.take(groups.shares[group]);
            }
        });
        return rows;
    }

    void take(const Rows& rows) {
        for (const std::vector<Entry>& row : rows) {
            entries.insert(entries.end(), row.begin(), row.end());
            row_begin.push_back(entries.size());
        }
        next.resize(rows.size());
    }

    [[nodiscard]] std::size_t num_groups() const { return groups.first.size(); }

    void average(std::span<const PaddedRgb> values, std::span<PaddedRgb> means) const {
        std::fill(means.begin(), means.end(), PaddedRgb{});
        for (std::size_t row = 0; row < values.size(); ++row)
            for (std::size_t c = 0; c < 4; ++c)
                means[groups.of[row]].rgb[c] += values[row].rgb[c];
        for (std::size_t group = 0; group < means.size(); ++group)
            for (std::size_t c = 0; c < 4; ++c)
                means[group].rgb[c] *= groups.shares[group];
    }

    /// result = A rho light
    void multiply(std::span<const PaddedRgb> light, std::span<PaddedRgb> result) const {
        constexpr std::size_t GroupsPerTask = 64;
        files::parallel_for(std::size_t{0}, (num_groups() + GroupsPerTask - 1) / GroupsPerTask,
                            [&](std::size_t task) {
                                const std::size_t end =
                                    std::min(num_groups(), (task + 1) * GroupsPerTask);
                                for (std::size_t i = task * GroupsPerTask; i < end; ++i)
                                    result[i] = gathered(i, light);
                            });
    }

    /// Several sums at a time, as in sum_lists().
    [[nodiscard]] PaddedRgb gathered(std::size_t group, std::span<const PaddedRgb> light) const {
        constexpr std::size_t NumSums = 4;
        std::array<PaddedRgb, NumSums> sums{};
        std::uint64_t i = row_begin[group];
        const std::uint64_t end = row_begin[group + 1];
        for (; i + NumSums <= end; i += NumSums)
            for (std::size_t k = 0; k < NumSums; ++k)
                for (std::size_t c = 0; c < 4; ++c)
                    sums[k].rgb[c] +=
                        entries[i + k].weight.rgb[c] * light[entries[i + k].group].rgb[c];
        for (; i < end; ++i)
            for (std::size_t c = 0; c < 4; ++c)
                sums[0].rgb[c] += entries[i].weight.rgb[c] * light[entries[i].group].rgb[c];
        PaddedRgb sum;
        for (std::size_t c = 0; c < 4; ++c)
            sum.rgb[c] = (sums[0].rgb[c] + sums[1].rgb[c]) + (sums[2].rgb[c] + sums[3].rgb[c]);
        return sum;
    }

    void set_equations() {
        const auto size = static_cast<Eigen::Index>(num_groups());
        for (std::size_t c = 0; c < equations.size(); ++c) {
            Eigen::MatrixXf matrix = Eigen::MatrixXf::Identity(size, size);
            for (std::size_t row = 0; row < num_groups(); ++row)
                for (std::uint64_t i = row_begin[row]; i < row_begin[row + 1]; ++i)
                    matrix(static_cast<Eigen::Index>(row), entries[i].group) -=
                        entries[i].weight.rgb[c];
            equations[c].compute(matrix);
        }
    }

    /// next = all further bounces of light.
    void solve(std::span<const PaddedRgb> light) {
        multiply(light, next);
        Eigen::VectorXf values(static_cast<Eigen::Index>(num_groups()));
        for (std::size_t c = 0; c < equations.size(); ++c) {
            for (std::size_t i = 0; i < num_groups(); ++i)
                values[static_cast<Eigen::Index>(i)] = next[i].rgb[c];
            values = equations[c].solve(values);
            for (std::size_t i = 0; i < num_groups(); ++i)
                next[i].rgb[c] = values[static_cast<Eigen::Index>(i)];
        }
    }
};

namespace {

/// Gives all processes the rows of each. Groups lie within runs of rows, so each is in one process.
template<typename HasGroup>
void share(Rows& rows, prt::Team& team, const HasGroup& has_group) {
    const prt::Part part = team.part();
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

/// Random light of the receivers after some bounces.
std::vector<PaddedRgb> bounced_light(BounceProduct& product, std::span<const PaddedRgb> albedo) {
    const std::size_t first = product.first(), size = product.matrix().num_rows();
    std::vector<PaddedRgb> light(first), next(size);
    const std::vector<PaddedRgb> random = random_light(size - first);
    light.insert(light.end(), random.begin(), random.end());
    for (std::size_t bounce = 0; bounce < NumBounces; ++bounce) {
        for (std::size_t i = first; i < size; ++i)
            for (std::size_t c = 0; c < 4; ++c)
                light[i].rgb[c] *= albedo[i].rgb[c];
        product.multiply(light, first, size, next);
        light.swap(next);
    }
    light.erase(light.begin(), light.begin() + static_cast<std::ptrdiff_t>(first));
    return light;
}

} // namespace

CoarseBounces::CoarseBounces(BounceProduct& product, std::span<const PaddedRgb> albedo) {
    const prt::BounceMatrix& matrix = product.matrix();
    const std::size_t first = product.first();
    prt::Team* const team = product.shared().team;
    // Each receiver's own emitters stand for those of all that it is averaged with.
    const auto own_weight = [&](std::size_t place) {
        double num_emitters = 0.0;
        for (const std::uint32_t other : matrix.averaged[place])
            num_emitters += static_cast<double>(product.num_emitters(other));
        const auto num_own = static_cast<double>(product.num_emitters(place));
        return num_own > 0.0 ? static_cast<float>(static_cast<double>(matrix.weights[place]) *
                                                  num_emitters / num_own)
                             : 0.0f;
    };
    Level level{.groups = groups_of(bounced_light(product, albedo), Tolerance)};
    const auto has_group = [&](const prt::Part& part, std::size_t group) {
        return prt::has_row(part, level.groups.first[group], 0);
    };
    Rows rows = level.rows_of(
        [&](std::size_t group) { return team == nullptr || has_group(team->part(), group); },
        [&](std::size_t row, RowSums& sums) {
            const float weight = own_weight(first + row);
            if (weight > 0.0f)
                for (const std::uint32_t emitter : matrix.emitters[first + row])
                    sums.add(level.groups.of[emitter - first], weight, albedo[emitter]);
        });
    if (team != nullptr)
        share(rows, *team, [&](std::uint32_t process, std::size_t group) {
            return has_group({process, team->part().count}, group);
        });
    level.take(rows);
    levels_.push_back(std::move(level));
    for (float tolerance = ToleranceOfGroups; levels_.back().num_groups() > FewGroups;
         tolerance *= Growth) {
        const Level& fine = levels_.back();
        std::vector<PaddedRgb> light = random_light(fine.num_groups()), next(light.size());
        for (std::size_t bounce = 0; bounce < NumBouncesOfGroups; ++bounce) {
            fine.multiply(light, next);
            light.swap(next);
        }
        Level coarse{.groups = groups_of(light, tolerance)};
        coarse.take(coarse.rows_of(
            [](std::size_t) { return true; },
            [&](std::size_t row, RowSums& sums) {
                for (std::uint64_t i = fine.row_begin[row]; i < fine.row_begin[row + 1]; ++i)
                    sums.add(coarse.groups.of[fine.entries[i].group], 1.0f, fine.entries[i].weight);
            }));
        levels_.push_back(std::move(coarse));
    }
    levels_.back().set_equations();
}

CoarseBounces::~CoarseBounces() = default;
CoarseBounces::CoarseBounces(CoarseBounces&&) noexcept = default;
CoarseBounces& CoarseBounces::operator=(CoarseBounces&&) noexcept = default;

std::size_t CoarseBounces::num_groups() const {
    return levels_.front().num_groups();
}

std::span<const std::uint32_t> CoarseBounces::group_of() const {
    return levels_.front().groups.of;
}

std::span<const float> CoarseBounces::shares() const {
    return levels_.front().groups.shares;
}

std::span<const PaddedRgb> CoarseBounces::sum_of_bounces(std::span<const PaddedRgb> light) {
    return sum_of_bounces(0, light);
}

std::span<const PaddedRgb> CoarseBounces::sum_of_bounces(std::size_t level_index,
                                                         std::span<const PaddedRgb> light) {
    Level& level = levels_[level_index];
    if (level_index + 1 == levels_.size()) {
        level.solve(light);
        return level.next;
    }
    level.multiply(light, level.next);
    // What comes back goes on bouncing, as far as it is even within groups of the next level.
    const Level& coarse = levels_[level_index + 1];
    std::vector<PaddedRgb> of_groups(coarse.num_groups());
    coarse.average(level.next, of_groups);
    const std::span<const PaddedRgb> more = sum_of_bounces(level_index + 1, of_groups);
    for (std::size_t i = 0; i < level.num_groups(); ++i)
        for (std::size_t c = 0; c < 4; ++c)
            level.next[i].rgb[c] += more[coarse.groups.of[i]].rgb[c];
    return level.next;
}

} // namespace relumine::relight
