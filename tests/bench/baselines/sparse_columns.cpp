#include "tests/bench/baselines/sparse_columns.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::bench {

namespace {

constexpr std::size_t Lanes = 16;
/// A multiple of Lanes that 16 bits count.
constexpr std::size_t ChunkReceivers = 4096;

/// Magnitudes in bins of a 32nd of an octave: a float's exponent and the first bits after it.
constexpr std::size_t NumBins = 1 << 13;
std::size_t bin_of(float magnitude) {
    return std::bit_cast<std::uint32_t>(magnitude) >> 18;
}

/// Calls work(block, values) for all blocks, in parallel.
template<typename Work>
void for_blocks(const BlockedRows& rows, std::size_t first, std::size_t last, const Work& work) {
    files::parallel_for(files::IndexRange<std::size_t>(first, last, 8), [&](const auto& blocks) {
        std::vector<float> values(rows.num_columns * Lanes);
        for (std::size_t block = blocks.begin(); block < blocks.end(); ++block) {
            rows.read(block, values);
            work(block, values);
        }
    });
}

/// The magnitude from which on at most `num_entries` are as large.
float threshold(const BlockedRows& rows, std::size_t num_entries) {
    std::vector<std::atomic<std::uint64_t>> bins(NumBins);
    for_blocks(rows, 0, rows.num_blocks(), [&](std::size_t, const std::vector<float>& values) {
        std::vector<std::uint32_t> own(NumBins, 0);
        for (const float value : values)
            ++own[bin_of(std::abs(value))];
        for (std::size_t i = 0; i < NumBins; ++i)
            bins[i] += own[i];
    });
    std::uint64_t count = 0;
    std::size_t bin = NumBins - 1;
    while (bin > 1 && count + bins[bin] <= num_entries)
        count += bins[bin--];
    return std::bit_cast<float>(static_cast<std::uint32_t>(bin + 1) << 18);
}

} // namespace

SparseColumns::SparseColumns(const BlockedRows& rows, std::size_t num_entries)
    : num_receivers_(rows.num_receivers), scales_(rows.num_columns, 0.0f),
      norms_(rows.num_columns, 0.0f) {
    const float least = threshold(rows, num_entries);
    struct Entry {
        std::uint32_t column;
        std::uint32_t receiver;
        float value;
    };
    const std::size_t num_chunks = (num_receivers_ + ChunkReceivers - 1) / ChunkReceivers;
    std::vector<std::vector<Entry>> entries(num_chunks);
    std::mutex mutex;
    for_blocks(rows, 0, rows.num_blocks(),
               [&](std::size_t block, const std::vector<float>& values) {
                   std::vector<Entry> own;
                   for (std::size_t i = 0; i < values.size(); ++i)
                       if (std::abs(values[i]) >= least)
                           own.push_back({static_cast<std::uint32_t>(i / Lanes),
                                          static_cast<std::uint32_t>(block * Lanes + i % Lanes),
                                          values[i]});
                   const std::scoped_lock lock(mutex);
                   auto& of_chunk = entries[block * Lanes / ChunkReceivers];
                   of_chunk.insert(of_chunk.end(), own.begin(), own.end());
               });
    for (const std::vector<Entry>& of_chunk : entries)
        for (const Entry& entry : of_chunk) {
            scales_[entry.column] = std::max(scales_[entry.column], std::abs(entry.value));
            norms_[entry.column] += entry.value * entry.value;
        }
    for (std::size_t i = 0; i < scales_.size(); ++i) {
        scales_[i] = scales_[i] > 0.0f ? scales_[i] / 127.0f : 1.0f;
        norms_[i] = std::sqrt(norms_[i]);
    }
    chunks_.resize(num_chunks);
    for (std::size_t i = 0; i < num_chunks; ++i) {
        std::ranges::sort(entries[i], [](const Entry& a, const Entry& b) {
            return std::pair(a.column, a.receiver) < std::pair(b.column, b.receiver);
        });
        Chunk& chunk = chunks_[i];
        chunk.begin.resize(rows.num_columns + 1, 0);
        for (const Entry& entry : entries[i]) {
            const auto value =
                static_cast<std::int8_t>(std::lround(entry.value / scales_[entry.column]));
            if (value == 0)
                continue;
            ++chunk.begin[entry.column + 1];
            chunk.receivers.push_back(
                static_cast<std::uint16_t>(entry.receiver - i * ChunkReceivers));
            chunk.values.push_back(value);
        }
        std::partial_sum(chunk.begin.begin(), chunk.begin.end(), chunk.begin.begin());
        entries[i] = {};
    }
}

std::size_t SparseColumns::bytes() const {
    std::size_t sum = 2 * sizeof(float) * scales_.size();
    for (const Chunk& chunk : chunks_)
        sum += chunk.begin.size() * sizeof(std::uint32_t) + 3 * chunk.values.size();
    return sum;
}

std::vector<std::byte> SparseColumns::content() const {
    std::vector<std::byte> bytes;
    const auto add = [&](const auto& values) {
        const auto more = std::as_bytes(std::span(values));
        bytes.insert(bytes.end(), more.begin(), more.end());
    };
    add(scales_);
    for (const Chunk& chunk : chunks_) {
        // Differences pack better than what they are differences of.
        std::vector<std::uint32_t> counts(chunk.begin.size());
        std::adjacent_difference(chunk.begin.begin(), chunk.begin.end(), counts.begin());
        std::vector<std::uint16_t> steps(chunk.receivers.size());
        std::adjacent_difference(chunk.receivers.begin(), chunk.receivers.end(), steps.begin());
        add(counts);
        add(steps);
        add(chunk.values);
    }
    return bytes;
}

std::vector<std::uint32_t> SparseColumns::chosen(std::span<const glm::vec3> light,
                                                 std::size_t num_columns) const {
    std::vector<std::uint32_t> columns(light.size());
    std::iota(columns.begin(), columns.end(), 0u);
    if (num_columns != 0 && num_columns < columns.size()) {
        const auto weight = [&](std::uint32_t i) {
            return glm::dot(light[i], light[i]) * norms_[i] * norms_[i];
        };
        std::ranges::nth_element(
            columns, columns.begin() + static_cast<std::ptrdiff_t>(num_columns),
            [&](std::uint32_t a, std::uint32_t b) { return weight(a) > weight(b); });
        columns.resize(num_columns);
        std::ranges::sort(columns);
    }
    return columns;
}

void SparseColumns::multiply(std::span<const glm::vec3> light, std::size_t num_columns,
                             std::vector<glm::vec3>& radiance) const {
    const std::vector<std::uint32_t> columns = chosen(light, num_columns);
    radiance.assign(num_receivers_, glm::vec3(0.0f));
    files::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
        const Chunk& chunk = chunks_[i];
        glm::vec3* const sums = radiance.data() + i * ChunkReceivers;
        for (const std::uint32_t column : columns) {
            const glm::vec3 scaled = scales_[column] * light[column];
            for (std::uint32_t k = chunk.begin[column]; k < chunk.begin[column + 1]; ++k)
                sums[chunk.receivers[k]] += static_cast<float>(chunk.values[k]) * scaled;
        }
    });
}

} // namespace relumine::bench
