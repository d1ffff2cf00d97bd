// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN],
// Sections 3.1 and 4.
#include "prt/glossy/glossy_precompute.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/packed_parts.h"
#include "files/parallel.h"
#include "prt/free_memory.h"
#include "prt/glossy/brdf.h"
#include "prt/glossy/lobe_refinement.h"
#include "prt/precompute_options.h"
#include "prt/transfer/cell_index.h"

namespace relumine::prt {

namespace {

/// Name of this part in a checkpoint.
constexpr const char* GlossyPart = "highlights";

/// Work between two looks at the checkpoint: about a second. A block takes some milliseconds.
constexpr std::size_t BlocksPerThreadAndStep = 256;

/// Blocks of an estimate. The entries of blocks differ by a factor of about two, so the mean is
/// good to some percent.
constexpr std::size_t TrialBlocks = 256;

/// One block's entries of one lobe.
struct BlockEntries {
    std::vector<std::uint32_t> cells;
    std::vector<float> scales;
    std::vector<std::uint8_t> values;
};

/// Quantises a lobe. Bytes hold the square root: so a highlight's foot, shared by many directions,
/// keeps its digits beside the peak.
BlockEntries quantised(const LobeCut& cut) {
    BlockEntries entries;
    entries.cells.reserve(cut.cells.size());
    entries.scales.reserve(cut.cells.size());
    entries.values.reserve(cut.cells.size() * BlockSize);
    for (const CutCell& cell : cut.cells) {
        const float largest = *std::max_element(cell.mean.begin(), cell.mean.end());
        entries.cells.push_back(cell_index(cell.cell));
        entries.scales.push_back(largest / (255.0f * 255.0f));
        for (const float mean : cell.mean)
            entries.values.push_back(
                static_cast<std::uint8_t>(std::lround(255.0f * std::sqrt(mean / largest))));
    }
    return entries;
}

/// Writes one block for a checkpoint.
void add(files::ByteWriter& writer, const BlockEntries& block) {
    writer.add<std::uint64_t>(block.cells.size());
    writer.add_all(std::span(block.cells));
    writer.add_all(std::span(block.scales));
    writer.add_all(std::span(block.values));
}

BlockEntries next_entries(files::ByteReader& reader) {
    const auto count = static_cast<std::size_t>(reader.next<std::uint64_t>());
    BlockEntries block;
    block.cells = reader.next_all<std::uint32_t>(count);
    block.scales = reader.next_all<float>(count);
    block.values = reader.next_all<std::uint8_t>(count * BlockSize);
    return block;
}

/// Joins the blocks. Frees each block's arrays on the way.
LobeCuts joined(std::vector<BlockEntries>&& blocks) {
    LobeCuts cuts;
    cuts.begin.push_back(0);
    for (const BlockEntries& block : blocks)
        cuts.begin.push_back(cuts.begin.back() + block.cells.size());
    cuts.cells.reserve(cuts.begin.back());
    cuts.scales.reserve(cuts.begin.back());
    cuts.values.reserve(cuts.begin.back() * BlockSize);
    for (BlockEntries& block : blocks) {
        const BlockEntries moved = std::move(block);
        cuts.cells.insert(cuts.cells.end(), moved.cells.begin(), moved.cells.end());
        cuts.scales.insert(cuts.scales.end(), moved.scales.begin(), moved.scales.end());
        cuts.values.insert(cuts.values.end(), moved.values.begin(), moved.values.end());
    }
    return cuts;
}

/// The tolerance holds for highlights of at least this width (roughness 0.3) and falls for narrower
/// ones. A broad highlight takes in many lights, whose errors cancel; a narrow one sees one light
/// at a time. Narrow ones still have few cells.
constexpr float FullToleranceWidth = 0.18f;

float tightened(float tolerance, const BlockToRefine& block) {
    float narrowest = FullToleranceWidth;
    for (const float width : block.narrowness)
        if (width > 0.0f)
            narrowest = std::min(narrowest, width);
    return tolerance * std::pow(narrowest / FullToleranceWidth, 0.75f);
}

std::uint32_t deepest_level(std::uint32_t face_resolution) {
    return std::min(texel_level(face_resolution), MaxGlossyLevel);
}

class GlossyPrecompute {
public:
    GlossyPrecompute(const Receivers& receivers, const Blockers& blockers, const Transfer& transfer,
                     const GlossyOptions& options)
        : receivers_(receivers), blockers_(blockers), transfer_(transfer), options_(options),
          reduction_(options.reduction != nullptr ? *options.reduction : alone_) {}

    /// `blocks_per_step`: work between two looks at the checkpoint.
    GlossyTransfer run(std::size_t blocks_per_step, GlossyStatistics& statistics);
    std::uint64_t estimate();

private:
    using EntriesOfBlock = std::array<BlockEntries, NumGlossyLobes>;

    BlockToRefine block_at(std::size_t block, std::vector<glm::vec3>& origins) const;
    EntriesOfBlock refine(std::size_t block);
    void keep(EntriesOfBlock&& block);
    void take_up();
    void save_checkpoint();
    bool something_is_left();
    void work(std::size_t blocks_per_step);

    const Receivers& receivers_;
    const Blockers& blockers_;
    const Transfer& transfer_;
    const GlossyOptions& options_;
    Alone alone_;
    Team& reduction_;
    /// Finished blocks, from the first on.
    std::vector<EntriesOfBlock> blocks_;
    /// Entries of the finished blocks.
    std::uint64_t num_entries_ = 0;
    /// Finished blocks in the checkpoint.
    std::size_t num_saved_ = 0;
    std::uint64_t rays_saved_ = 0;
    std::atomic<std::uint64_t> num_rays_ = 0;
};

BlockToRefine GlossyPrecompute::block_at(std::size_t block, std::vector<glm::vec3>& origins) const {
    BlockToRefine result{.block = block};
    const std::size_t begin = block * BlockSize;
    const std::size_t end = std::min(begin + BlockSize, transfer_.num_receivers());
    for (std::size_t place = begin; place < end; ++place) {
        const std::uint32_t receiver = transfer_.order[place];
        const glm::vec3& normal = receivers_.normals[receiver];
        const glm::vec3& to_eye = receivers_.to_eye[receiver];
        const Surface& surface = receivers_.surfaces[receiver];
        const std::size_t lane = place - begin;
        result.surfaces.set(lane, surface, normal, to_eye);
        result.mirror[lane] = 2.0f * result.surfaces.normal_dot_eye[lane] * normal - to_eye;
        result.narrowness[lane] =
            result.surfaces.normal_dot_eye[lane] > 0.0f ? narrowness_of(surface) : 0.0f;
        origins.push_back(ray_origin(receivers_.positions[receiver], normal, options_.bias));
    }
    result.origins = origins;
    return result;
}

GlossyPrecompute::EntriesOfBlock GlossyPrecompute::refine(std::size_t block) {
    std::vector<glm::vec3> origins;
    const BlockToRefine to_refine = block_at(block, origins);
    EntriesOfBlock entries;
    RefinementLimits limits{.tolerance = tightened(options_.tolerance, to_refine),
                            .max_level = deepest_level(options_.face_resolution)};
    for (const GlossyLobe lobe :
         {GlossyLobe::Specular, GlossyLobe::SpecularGrazing, GlossyLobe::DiffuseGrazing}) {
        if (!to_refine.surfaces.has(lobe))
            continue;
        // The integral of (n.w / pi)^2 over the hemisphere is 2 / (3 pi).
        if (lobe == GlossyLobe::DiffuseGrazing)
            limits.reference_power =
                std::popcount(to_refine.surfaces.lanes_with(GlossyLobe::DiffuseGrazing)) * 2.0 /
                (3.0 * std::numbers::pi);
        const LobeCut cut = refine_lobe(to_refine, lobe, transfer_, blockers_, limits);
        if (lobe == GlossyLobe::Specular)
            limits.reference_power = cut.power;
        entries[static_cast<std::size_t>(lobe)] = quantised(cut);
        num_rays_ += cut.num_rays;
    }
    return entries;
}

std::uint64_t num_entries(const std::array<BlockEntries, NumGlossyLobes>& block) {
    std::uint64_t count = 0;
    for (const BlockEntries& of_lobe : block)
        count += of_lobe.cells.size();
    return count;
}

void GlossyPrecompute::keep(EntriesOfBlock&& block) {
    num_entries_ += num_entries(block);
    blocks_.push_back(std::move(block));
}

/// Takes up the blocks of an earlier run. A record has the number of its blocks' rays, then the
/// blocks.
void GlossyPrecompute::take_up() {
    for (const std::vector<std::byte>& record :
         options_.checkpoint->load(GlossyPart, false).records)
        files::unpack(record, [this](std::span<const std::byte> part) {
            files::ByteReader reader(part);
            num_rays_ += reader.next<std::uint64_t>();
            while (!reader.at_end()) {
                EntriesOfBlock block;
                for (BlockEntries& of_lobe : block)
                    of_lobe = next_entries(reader);
                keep(std::move(block));
            }
        });
    if (blocks_.size() > transfer_.counts.num_blocks())
        throw std::runtime_error("checkpoint: expected fewer blocks");
    num_saved_ = blocks_.size();
    rays_saved_ = num_rays_;
}

void GlossyPrecompute::save_checkpoint() {
    const std::vector<std::byte> record = files::pack(1, [this](std::size_t) {
        files::ByteWriter writer;
        writer.add<std::uint64_t>(num_rays_ - rays_saved_);
        for (std::size_t i = num_saved_; i < blocks_.size(); ++i)
            for (const BlockEntries& of_lobe : blocks_[i])
                add(writer, of_lobe);
        return writer.take();
    });
    if (!options_.checkpoint->save(GlossyPart, record, {}))
        return;
    num_saved_ = blocks_.size();
    rays_saved_ = num_rays_;
}

/// Whether a process has blocks left. Throws where a process must stop or has too many entries.
bool GlossyPrecompute::something_is_left() {
    const bool is_too_much = num_entries_ * BytesPerEntry > options_.max_bytes;
    std::array<std::int64_t, 3> largest = {
        static_cast<std::int64_t>(transfer_.counts.num_blocks() - blocks_.size()),
        static_cast<std::int64_t>(is_too_much ? num_entries_ : 0),
        options_.stop.stop_requested() ? 1 : 0};
    reduction_.max(largest);
    if (largest[1] != 0)
        throw TooManyEntries(static_cast<std::uint64_t>(largest[1]));
    if (largest[0] != 0 && largest[2] != 0)
        throw Cancelled();
    return largest[0] != 0;
}

void GlossyPrecompute::work(std::size_t blocks_per_step) {
    const std::size_t num_blocks = transfer_.counts.num_blocks();
    std::mutex mutex;
    std::size_t num_done = blocks_.size();
    while (something_is_left()) {
        const std::size_t begin = blocks_.size();
        std::vector<EntriesOfBlock> step(std::min(blocks_per_step, num_blocks - begin));
        const std::uint64_t rays_before = num_rays_;
        try {
            files::parallel_for(std::size_t{0}, step.size(), [&](std::size_t i) {
                // One process must not leave the others waiting.
                if (!reduction_.has_others() && options_.stop.stop_requested())
                    throw Cancelled();
                step[i] = refine(begin + i);
                const std::scoped_lock lock(mutex);
                ++num_done;
                if (options_.on_progress)
                    options_.on_progress(static_cast<double>(num_done) /
                                         static_cast<double>(num_blocks));
            });
        } catch (...) {
            num_rays_ = rays_before;
            throw;
        }
        for (EntriesOfBlock& block : step)
            keep(std::move(block));
        if (options_.checkpoint != nullptr && options_.checkpoint->is_due())
            save_checkpoint();
    }
}

GlossyTransfer GlossyPrecompute::run(std::size_t blocks_per_step, GlossyStatistics& statistics) {
    const std::size_t num_blocks = transfer_.counts.num_blocks();
    if (options_.checkpoint != nullptr)
        take_up();
    try {
        work(blocks_per_step);
    } catch (const TooManyEntries&) {
        if (options_.checkpoint != nullptr)
            save_checkpoint();
        throw;
    } catch (const Cancelled&) {
        if (options_.checkpoint != nullptr && options_.checkpoint->is_worthwhile() &&
            (reduction_.has_others() || num_saved_ != blocks_.size()))
            save_checkpoint();
        throw;
    }
    std::array<std::vector<BlockEntries>, NumGlossyLobes> entries;
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
        entries[lobe].resize(num_blocks);
        for (std::size_t block = 0; block < num_blocks; ++block)
            entries[lobe][block] = std::move(blocks_[block][lobe]);
    }
    blocks_ = {};

    GlossyTransfer glossy;
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
        glossy.lobes[lobe] = joined(std::move(entries[lobe]));
        statistics.num_entries += glossy.lobes[lobe].num_entries();
    }
    entries = {};
    return_free_memory();
    std::array<std::int64_t, 2> sums = {static_cast<std::int64_t>(num_rays_.load()),
                                        static_cast<std::int64_t>(statistics.num_entries)};
    reduction_.sum(sums);
    statistics.num_rays = static_cast<std::uint64_t>(sums[0]);
    statistics.num_entries = static_cast<std::uint64_t>(sums[1]);
    return glossy;
}

std::uint64_t GlossyPrecompute::estimate() {
    const std::size_t num_blocks = transfer_.counts.num_blocks();
    const std::size_t num_trials = std::min(num_blocks, TrialBlocks);
    std::atomic<std::uint64_t> count = 0;
    files::parallel_for(std::size_t{0}, num_trials, [&](std::size_t i) {
        if (options_.stop.stop_requested())
            throw Cancelled();
        count += num_entries(refine((2 * i + 1) * num_blocks / (2 * num_trials)));
    });
    return static_cast<std::uint64_t>(static_cast<double>(count) * static_cast<double>(num_blocks) /
                                      static_cast<double>(num_trials));
}

void check(const Receivers& receivers, const Transfer& transfer, const GlossyOptions& options) {
    const std::size_t count = transfer.num_receivers();
    if (receivers.size() != count || receivers.to_eye.size() != count ||
        receivers.surfaces.size() != count)
        throw std::invalid_argument(fmt::format(
            "expected the transfer's {} receivers with eye directions and surfaces", count));
    if (!(options.tolerance > 0.0f && options.tolerance <= 1.0f))
        throw std::invalid_argument(fmt::format(
            "expected a glossy tolerance above 0, at most 1, got {}", options.tolerance));
    if (options.face_resolution < 1 || options.face_resolution > (1u << MaxLevel))
        throw std::invalid_argument(fmt::format("expected a face resolution from 1 to {}, got {}",
                                                1u << MaxLevel, options.face_resolution));
}

} // namespace

bool has_highlights(const Receivers& receivers) {
    return !receivers.to_eye.empty() &&
           std::any_of(receivers.surfaces.begin(), receivers.surfaces.end(),
                       [](const Surface& surface) { return surface.highlight != Highlight::None; });
}

float narrowest_roughness(std::uint32_t face_resolution) {
    // A cell in the middle of a face is widest: it spans 2 / 2^level in the tangent.
    const float cell = 2.0f / static_cast<float>(1u << deepest_level(face_resolution));
    return std::sqrt(std::max(cell, ggx_alpha(0.0f)));
}

TooManyEntries::TooManyEntries(std::uint64_t entries)
    : std::runtime_error(fmt::format("too many cells of highlights: {}", entries)),
      num_entries(entries) {}

std::uint64_t estimate_glossy_entries(const Receivers& receivers, const Blockers& blockers,
                                      const Transfer& transfer, const GlossyOptions& options) {
    check(receivers, transfer, options);
    return GlossyPrecompute(receivers, blockers, transfer, options).estimate();
}

GlossyTransfer precompute_glossy(const Receivers& receivers, const Blockers& blockers,
                                 const Transfer& transfer, const GlossyOptions& options,
                                 GlossyStatistics* statistics) {
    check(receivers, transfer, options);
    const auto start = std::chrono::steady_clock::now();
    GlossyStatistics local;
    const std::size_t blocks_per_step = BlocksPerThreadAndStep * files::num_threads();
    GlossyTransfer glossy =
        GlossyPrecompute(receivers, blockers, transfer, options).run(blocks_per_step, local);
    local.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (statistics != nullptr)
        *statistics = local;
    return glossy;
}

GlossyTransfer precompute_glossy_in_steps(const Receivers& receivers, const Blockers& blockers,
                                          const Transfer& transfer, const GlossyOptions& options,
                                          std::size_t blocks_per_step) {
    check(receivers, transfer, options);
    GlossyStatistics statistics;
    return GlossyPrecompute(receivers, blockers, transfer, options)
        .run(blocks_per_step, statistics);
}

} // namespace relumine::prt
