// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN],
// Sections 3.1 and 4.
#include "prt/glossy/glossy_precompute.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/packed_parts.h"
#include "files/parallel.h"
#include "files/seconds.h"
#include "prt/clusters/dealt_tiles.h"
#include "prt/free_memory.h"
#include "prt/glossy/brdf.h"
#include "prt/glossy/lobe_refinement.h"
#include "prt/steps.h"
#include "prt/transfer/cell_index.h"

namespace relumine::prt {

namespace {

/// Work between two looks at the checkpoint: about a second. A block takes some milliseconds.
constexpr std::size_t BlocksPerThreadAndStep = 256;

/// Blocks of an estimate. The entries of blocks differ by a factor of about two, so the mean is
/// good to some percent.
constexpr std::size_t TrialBlocks = 256;

/// The integral of (n.w / pi)^2 over the hemisphere.
constexpr double WholeDiffusePower = 2.0 / (3.0 * std::numbers::pi);

/// The lobes that measured surfaces take, one for each colour.
constexpr std::size_t NumColors = 3;

/// Quantises a lobe. Bytes hold the square root: so a highlight's foot, shared by many directions,
/// keeps its digits beside the peak.
LobeCuts quantised(const LobeCut& cut) {
    LobeCuts entries;
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
    entries.begin.push_back(entries.cells.size());
    return entries;
}

/// Writes one block for a checkpoint.
void add(files::ByteWriter& writer, const LobeCuts& block) {
    writer.add<std::uint64_t>(block.cells.size());
    writer.add_all(std::span(block.cells));
    writer.add_all(std::span(block.scales));
    writer.add_all(std::span(block.values));
}

LobeCuts next_entries(files::ByteReader& reader) {
    const auto count = static_cast<std::size_t>(reader.next<std::uint64_t>());
    LobeCuts block{.begin = {0, count}};
    block.cells = reader.next_all<std::uint32_t>(count);
    block.scales = reader.next_all<float>(count);
    block.values = reader.next_all<std::uint8_t>(count * BlockSize);
    return block;
}

/// A block's entries of all lobes, and what they took.
struct FinishedBlock {
    std::array<LobeCuts, NumGlossyLobes> lobes;
    std::uint64_t num_rays = 0;

    [[nodiscard]] std::uint64_t num_entries() const {
        std::uint64_t count = 0;
        for (const LobeCuts& of_lobe : lobes)
            count += of_lobe.num_entries();
        return count;
    }
};

/// Joins the blocks' entries of a lobe. Frees each block's arrays on the way.
LobeCuts joined(std::span<FinishedBlock> blocks, std::size_t lobe) {
    std::size_t num_entries = 0;
    for (const FinishedBlock& block : blocks)
        num_entries += block.lobes[lobe].num_entries();
    LobeCuts cuts;
    cuts.begin.reserve(blocks.size() + 1);
    cuts.cells.reserve(num_entries);
    cuts.scales.reserve(num_entries);
    cuts.values.reserve(num_entries * BlockSize);
    for (FinishedBlock& block : blocks)
        cuts.append(std::exchange(block.lobes[lobe], {}), 0, 1);
    return cuts;
}

/// The tolerance holds for highlights of at least this width (roughness 0.3) and falls for narrower
/// ones. A broad highlight takes in many lights, whose errors cancel; a narrow one sees one light
/// at a time. Narrow ones still have few cells.
constexpr float FullToleranceWidth = 0.18f;

float tightened(float tolerance, const Mirrors& mirrors) {
    float narrowest = FullToleranceWidth;
    for (const float width : mirrors.narrowness)
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
                     const GlossyOptions& options, const Work& work)
        : receivers_(receivers), blockers_(blockers), transfer_(transfer), options_(options),
          work_(work), places_(places_of(work.team.part(), transfer.num_receivers())),
          blocks_(transfer.counts.num_blocks()) {}

    GlossyTransfer run(GlossyStatistics& statistics);
    std::uint64_t estimate();

private:
    BlockToRefine block_at(std::size_t block, std::vector<glm::vec3>& origins) const;
    double lambert_power(std::size_t block, std::uint32_t lanes, int color) const;
    FinishedBlock refine(std::size_t block) const;
    void do_all_blocks();

    const Receivers& receivers_;
    const Blockers& blockers_;
    const Transfer& transfer_;
    const GlossyOptions& options_;
    const Work& work_;
    /// [receivers of the part]
    std::vector<std::uint32_t> places_;
    std::vector<FinishedBlock> blocks_;
};

BlockToRefine GlossyPrecompute::block_at(std::size_t block, std::vector<glm::vec3>& origins) const {
    BlockToRefine result{.block = block};
    const std::size_t begin = block * BlockSize;
    const std::size_t end = std::min(begin + BlockSize, places_.size());
    for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t receiver = transfer_.order[places_[i]];
        const glm::vec3& normal = receivers_.normals[receiver];
        const glm::vec3& to_eye = receivers_.to_eye[receiver];
        const Surface& surface = receivers_.surfaces[receiver];
        const std::size_t lane = i - begin;
        result.surfaces.set(lane, surface, normal, to_eye);
        result.of_base.mirror[lane] = 2.0f * result.surfaces.normal_dot_eye[lane] * normal - to_eye;
        result.of_base.narrowness[lane] =
            result.surfaces.normal_dot_eye[lane] > 0.0f ? narrowness_of(surface) : 0.0f;
        if ((result.surfaces.coat_lanes >> lane & 1u) != 0) {
            const glm::vec3 coat =
                surface.coat_normal == glm::vec3(0.0f) ? normal : surface.coat_normal;
            result.of_coat.mirror[lane] = 2.0f * glm::dot(coat, to_eye) * coat - to_eye;
            result.of_coat.narrowness[lane] = GgxLobe::narrowness(surface.coat_roughness);
        }
        origins.push_back(ray_origin(receivers_.positions[receiver], normal, options_.bias));
    }
    result.origins = origins;
    return result;
}

/// Returns the power of the Lambertian parts of a block's measured surfaces in the colour of a
/// lobe.
double GlossyPrecompute::lambert_power(std::size_t block, std::uint32_t lanes, int color) const {
    double power = 0.0;
    for (; lanes != 0; lanes &= lanes - 1) {
        const std::size_t place =
            block * BlockSize + static_cast<std::size_t>(std::countr_zero(lanes));
        const double albedo =
            double{receivers_.surfaces[transfer_.order[places_[place]]].albedo[color]};
        power += albedo * albedo * WholeDiffusePower;
    }
    return power;
}

FinishedBlock GlossyPrecompute::refine(std::size_t block) const {
    std::vector<glm::vec3> origins;
    const BlockToRefine to_refine = block_at(block, origins);
    FinishedBlock finished;
    RefinementLimits limits{.tolerance = tightened(options_.tolerance, to_refine.of_base),
                            .max_level = deepest_level(options_.face_resolution)};
    for (std::size_t i = 0; i < NumGlossyLobes; ++i) {
        const auto lobe = static_cast<GlossyLobe>(i);
        LobeCuts& entries = finished.lobes[static_cast<std::size_t>(lobe)];
        if (!to_refine.surfaces.has(lobe)) {
            entries.begin.push_back(0);
            continue;
        }
        if (lobe == GlossyLobe::DiffuseGrazing)
            limits.reference_power =
                std::popcount(to_refine.surfaces.lanes_with(GlossyLobe::DiffuseGrazing)) *
                WholeDiffusePower;
        // Each colour of a measured BRDF, or of a film, has its own power.
        if (to_refine.has_colors() && i < NumColors) {
            limits.reference_power = 0.0;
            limits.added_power = lambert_power(
                block, to_refine.surfaces.lanes[static_cast<std::size_t>(Highlight::Measured)],
                static_cast<int>(i));
        }
        // Layers have their own power.
        if (lobe == GlossyLobe::Coat || lobe == GlossyLobe::Sheen)
            limits = {.tolerance = tightened(options_.tolerance, to_refine.mirrors(lobe)),
                      .max_level = limits.max_level};
        const LobeCut cut = refine_lobe(to_refine, lobe, transfer_, blockers_, limits);
        if (lobe == GlossyLobe::Specular)
            limits.reference_power = cut.power;
        entries = quantised(cut);
        finished.num_rays += cut.num_rays;
    }
    return finished;
}

void GlossyPrecompute::do_all_blocks() {
    std::atomic<std::uint64_t> num_entries = 0;
    BlockWork blocks{.part = "highlights",
                     .num_blocks = blocks_.size(),
                     .blocks_per_tile = VisibleCounts::TileBlocks,
                     .blocks_per_step = BlocksPerThreadAndStep * files::num_threads()};
    blocks.work = [&](std::size_t block) {
        blocks_[block] = refine(block);
        num_entries += blocks_[block].num_entries();
    };
    blocks.write = [this](std::size_t block, files::ByteWriter& writer) {
        writer.add(blocks_[block].num_rays);
        for (const LobeCuts& of_lobe : blocks_[block].lobes)
            add(writer, of_lobe);
    };
    blocks.read = [&](std::size_t block, files::ByteReader& reader) {
        blocks_[block].num_rays = reader.next<std::uint64_t>();
        for (LobeCuts& of_lobe : blocks_[block].lobes)
            of_lobe = next_entries(reader);
        num_entries += blocks_[block].num_entries();
    };
    blocks.check = [&] {
        const std::uint64_t found = num_entries;
        const bool is_too_much = found * BytesPerEntry > options_.max_bytes;
        if (const auto most = largest_of_all(work_.team, is_too_much ? found : 0); most != 0)
            throw TooLarge("cells of highlights", most, most * BytesPerEntry);
    };
    Progress progress(work_);
    progress.start_stage(0.0, 1.0);
    do_blocks(work_, blocks, progress);
}

GlossyTransfer GlossyPrecompute::run(GlossyStatistics& statistics) {
    do_all_blocks();
    GlossyTransfer glossy;
    std::array<std::int64_t, 2> sums{};
    for (const FinishedBlock& block : blocks_)
        sums[0] += static_cast<std::int64_t>(block.num_rays);
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
        glossy.lobes[lobe] = joined(blocks_, lobe);
        sums[1] += static_cast<std::int64_t>(glossy.lobes[lobe].num_entries());
    }
    blocks_ = {};
    return_free_memory();
    work_.team.sum(sums);
    statistics.num_rays = static_cast<std::uint64_t>(sums[0]);
    statistics.num_entries = static_cast<std::uint64_t>(sums[1]);
    return glossy;
}

std::uint64_t GlossyPrecompute::estimate() {
    const std::size_t num_blocks = blocks_.size();
    const std::size_t num_trials = std::min(num_blocks, TrialBlocks);
    std::atomic<std::uint64_t> count = 0;
    files::parallel_for(std::size_t{0}, num_trials, [&](std::size_t i) {
        if (work_.stop.stop_requested())
            throw Cancelled();
        count += refine((2 * i + 1) * num_blocks / (2 * num_trials)).num_entries();
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

std::uint64_t estimate_glossy_entries(const Receivers& receivers, const Blockers& blockers,
                                      const Transfer& transfer, const GlossyOptions& options,
                                      const Work& work) {
    check(receivers, transfer, options);
    return GlossyPrecompute(receivers, blockers, transfer, options, work).estimate();
}

GlossyTransfer precompute_glossy(const Receivers& receivers, const Blockers& blockers,
                                 const Transfer& transfer, const GlossyOptions& options,
                                 const Work& work, GlossyStatistics* statistics) {
    check(receivers, transfer, options);
    const auto start = std::chrono::steady_clock::now();
    GlossyStatistics local;
    GlossyTransfer glossy =
        GlossyPrecompute(receivers, blockers, transfer, options, work).run(local);
    local.seconds = files::seconds_since(start);
    if (statistics != nullptr)
        *statistics = local;
    return glossy;
}

} // namespace relumine::prt
