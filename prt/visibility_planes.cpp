#include "prt/visibility_planes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

namespace relumine::prt {

namespace {

/// Receivers of one task: eight words of 64, so that tasks write whole cache lines of each plane. Their rays through one patch
/// start close together and meet the same blockers.
constexpr std::size_t WordsPerTask = 8;

/// Patches of one task: with 512 receivers a million rays, about a twentieth of a second. Splitting the directions, too, keeps all
/// threads busy when the receivers are few.
constexpr std::size_t PatchesPerTask = 128;

} // namespace

struct VisibilityPlanes::Patch {
    DirectionPacket packet;
    std::array<std::uint64_t*, PacketSize> planes{};
};

VisibilityPlanes::VisibilityPlanes(std::span<const glm::vec3> origins, const NormalArrays& normals,
                                   const Blockers& blockers)
    : origins_(origins), normals_(normals), blockers_(blockers) {}

void VisibilityPlanes::trace(std::span<const LatticePoint> points,
                             const std::function<void(double)>& on_progress) {
    const std::size_t num_words = normals_.num_words();
    std::vector<Patch> patches;
    for (const LatticePoint point : points) {
        const auto [entry, is_new] = planes_.try_emplace(point);
        if (!is_new)
            continue;
        entry->second.resize(num_words);
        if (patches.empty() || patches.back().packet.num_directions == PacketSize)
            patches.emplace_back();
        Patch& patch = patches.back();
        const std::uint32_t lane = patch.packet.num_directions++;
        const glm::vec3 w = direction(point);
        // Unused lanes repeat the packet's first direction, so that they never are wild numbers.
        for (std::size_t i = lane == 0 ? 0 : lane; i < (lane == 0 ? PacketSize : lane + 1); ++i)
            patch.packet.set(i, w);
        patch.planes[lane] = entry->second.data();
        ++num_directions_;
    }

    const std::size_t num_rows = (num_words + WordsPerTask - 1) / WordsPerTask;
    const std::size_t num_columns = (patches.size() + PatchesPerTask - 1) / PatchesPerTask;
    std::atomic<std::size_t> num_done = 0;
    const auto trace_task = [&](std::size_t row, std::size_t column) {
        const std::size_t begin = row * WordsPerTask;
        const std::size_t end = std::min(begin + WordsPerTask, num_words);
        const std::size_t last_patch = std::min((column + 1) * PatchesPerTask, patches.size());
        std::uint64_t num_rays = 0;
        for (std::size_t patch = column * PatchesPerTask; patch < last_patch; ++patch)
            for (std::size_t word = begin; word < end; ++word)
                trace_word(word, patches[patch], num_rays);
        num_rays_ += num_rays;
        on_progress(static_cast<double>(++num_done) / static_cast<double>(num_rows * num_columns));
    };
    tbb::parallel_for(tbb::blocked_range2d<std::size_t>(0, num_rows, 1, 0, num_columns, 1),
                      [&](const tbb::blocked_range2d<std::size_t>& tasks) {
                          for (std::size_t row = tasks.rows().begin(); row < tasks.rows().end(); ++row)
                              for (std::size_t column = tasks.cols().begin(); column < tasks.cols().end();
                                   ++column)
                                  trace_task(row, column);
                      });
}

void VisibilityPlanes::trace_word(std::size_t word, const Patch& patch, std::uint64_t& num_rays) const {
    std::array<std::uint64_t, PacketSize> words{};
    const std::size_t begin = word * WordSize;
    const std::size_t end = std::min(begin + WordSize, origins_.size());
    const std::uint32_t used = (1u << patch.packet.num_directions) - 1;
    for (std::size_t i = begin; i < end; ++i) {
        std::uint32_t above = 0;
        for (std::uint32_t lane = 0; lane < PacketSize; ++lane) {
            const float cosine = normals_.x[i] * patch.packet.x[lane] + normals_.y[i] * patch.packet.y[lane] +
                                 normals_.z[i] * patch.packet.z[lane];
            above |= static_cast<std::uint32_t>(cosine > 0.0f) << lane;
        }
        above &= used;
        if (above == 0)
            continue;
        num_rays += static_cast<std::uint64_t>(std::popcount(above));
        const std::uint32_t lit = above & ~blockers_.occluded(origins_[i], patch.packet, above);
        for (std::uint32_t bits = lit; bits != 0; bits &= bits - 1)
            words[static_cast<std::size_t>(std::countr_zero(bits))] |= std::uint64_t{1} << (i - begin);
    }
    for (std::size_t lane = 0; lane < patch.packet.num_directions; ++lane)
        patch.planes[lane][word] = words[lane];
}

void VisibilityPlanes::keep_only(std::span<const LatticePoint> points) {
    std::unordered_map<LatticePoint, std::vector<std::uint64_t>> kept;
    for (const LatticePoint point : points)
        if (const auto entry = planes_.find(point); entry != planes_.end())
            kept.insert(planes_.extract(entry));
    planes_ = std::move(kept);
}

} // namespace relumine::prt
