#include "relight/moving_eye/moving_eye.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/luminance.h"
#include "files/parallel.h"
#include "files/seconds.h"
#include "prt/glossy/brdf.h"
#include "relight/moving_eye/eye_cut.h"
#include "relight/moving_eye/eye_kernel.h"
#include "relight/moving_eye/seen_blocks.h"
#include "relight/moving_eye/sky_cells.h"
#include "relight/moving_eye/visibility_pyramid.h"
#include "relight/sharp/traced_light.h"

namespace relumine::relight {

namespace {

/// The error that a cell may make, over the tolerance and what a white matt surface sends: the
/// errors of a hundred cells add up like so many random numbers.
constexpr float ShareOfCell = 0.1f;

/// Its cells are half as wide as the lobe of NarrowestLiveRoughness.
constexpr std::uint32_t DeepestLevel = 8;

/// Returns the level whose cells are no wider than half of the lobe of the smallest alpha.
std::uint32_t level_for(float alpha) {
    const float cells = std::numbers::pi_v<float> / alpha;
    const auto level = static_cast<std::uint32_t>(std::ceil(std::log2(cells)));
    return std::clamp(level, 5u, DeepestLevel);
}

bool is_ggx(const prt::Surface& surface) {
    return prt::facts_of(surface.highlight).is_roughness;
}

float smallest_alpha(std::span<const prt::Surface> surfaces) {
    float alpha = 2.0f;
    for (const prt::Surface& surface : surfaces)
        if (is_ggx(surface))
            alpha = std::min(alpha, prt::ggx_alpha(surface.roughness_or_exponent));
    return alpha;
}

void check(const prt::Transfer& transfer, std::span<const prt::Surface> surfaces) {
    if (surfaces.size() != transfer.num_receivers())
        throw std::invalid_argument("expected one surface per receiver");
    if (std::none_of(surfaces.begin(), surfaces.end(), is_ggx))
        throw std::invalid_argument("expected surfaces with highlights, got none");
}

/// Sums of a block take so many changes before they are summed anew: rounding adds up.
constexpr std::uint32_t MostUpdates = 64;

void add(EyeLight& to, const EyeLight& light) {
    for (std::size_t channel = 0; channel < to.all.channels.size(); ++channel)
        for (std::size_t i = 0; i < prt::BlockSize; ++i) {
            to.all.channels[channel][i] += light.all.channels[channel][i];
            to.grazing.channels[channel][i] += light.grazing.channels[channel][i];
        }
}

/// What one thread works with, and counts.
struct Worker {
    EyeCut cut;
    LitCells cells = {}, traced = {};
    EyeReport counts = {};
};

/// The light of a block's cut, for an eye that stands still.
struct Kept {
    EyeLight light;
    std::vector<EyeCut::Item> divided;
    /// Version of the sky and generation of the eye that the light is for.
    std::uint64_t version = 0, generation = 0;
    std::size_t num_cells = 0;
    std::uint32_t num_updates = 0;
};

} // namespace

struct MovingEye::Impl {
    Impl(const prt::Transfer& of, std::span<const glm::vec3> at,
         std::span<const prt::Surface> shiny, std::span<const SeenBlocks::Triangle> triangles)
        : transfer(of), visibility(of), sky(level_for(smallest_alpha(shiny))),
          result(of.num_receivers()) {
        for (const std::uint32_t receiver : of.order)
            positions.push_back(at[receiver]);
        set_surfaces(shiny);
        if (!triangles.empty())
            seen.emplace(transfer, visibility, positions, triangles);
    }

    void set_surfaces(std::span<const prt::Surface> shiny) {
        surfaces.clear();
        is_matt.clear();
        for (const std::uint32_t receiver : transfer.order)
            surfaces.push_back(is_ggx(shiny[receiver]) ? shiny[receiver] : prt::Surface());
        for (std::size_t block = 0; block < transfer.counts.num_blocks(); ++block) {
            const auto own = std::span(surfaces).subspan(block * prt::BlockSize, size_of(block));
            is_matt.push_back(std::none_of(own.begin(), own.end(), is_ggx));
        }
        last_error = -1.0f;
    }

    /// The lobes of a block's receivers for an eye.
    [[nodiscard]] prt::BlockSurfaces surfaces_of(std::size_t block, const glm::vec3& eye) const {
        prt::BlockSurfaces block_surfaces;
        const std::size_t first = block * prt::BlockSize;
        for (std::size_t i = 0; i < size_of(block); ++i) {
            const glm::vec3 ray = eye - positions[first + i];
            const float length = glm::length(ray);
            block_surfaces.set(i, surfaces[first + i], transfer.normals[first + i],
                               length > 0.0f ? ray / length : glm::vec3(0.0f, 1.0f, 0.0f));
        }
        return block_surfaces;
    }
    [[nodiscard]] std::size_t size_of(std::size_t block) const {
        return std::min(prt::BlockSize, transfer.num_receivers() - block * prt::BlockSize);
    }

    /// Finds and traces the small bright lights.
    void trace(const Relighter& relighter) {
        const ShadowRays& rays = relighter.shadow_rays();
        lights.clear();
        if (rays.blockers == nullptr)
            return;
        if (!traced)
            traced.emplace(transfer, rays);
        const cubemap::CubeMap& map = relighter.environment();
        if (map.resolution != 0) {
            std::vector<double> powers;
            for (const VectorIrradiance& sum :
                 relighter.binning()->sums(map, transfer.quadtree.leaves()))
                powers.push_back(sum.power());
            lights = find_sharp_lights(map, *relighter.binning(), transfer.quadtree.leaves(),
                                       powers, rays.tolerance, true);
        } else {
            const std::span<const SharpLight> of_list = relighter.sharp_lights();
            lights.assign(of_list.begin(), of_list.end());
        }
        static_cast<void>(traced->trace(lights));
        traced_lights.assign(lights.size() / SisterCells::Stride + 1, {});
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const VectorIrradiance& light = lights[i].irradiance;
            SisterCells& sisters = traced_lights[i / SisterCells::Stride];
            sisters.set_direction(i % SisterCells::Stride, lights[i].direction);
            sisters.set_light(
                i % SisterCells::Stride,
                {glm::length(light.red), glm::length(light.green), glm::length(light.blue)});
        }
    }

    /// Appends the traced lights that reach a block.
    void add_traced(std::size_t block, LitCells& cells) const {
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const std::uint16_t reached = traced->reached(i, block);
            if (reached == 0)
                continue;
            PartlyCell& cell = cells.partly.emplace_back();
            cell.light =
                traced_lights[i / SisterCells::Stride].rows.data() + i % SisterCells::Stride;
            cell.unit = 1.0f;
            for (std::size_t lane = 0; lane < prt::BlockSize; ++lane)
                cell.parts[lane] = static_cast<std::uint8_t>(reached >> lane & 1u);
        }
    }

    /// What light of the cut sends through a block's lobes.
    [[nodiscard]] EyeLight cut_light(std::size_t block, const prt::BlockSurfaces& lanes,
                                     const BlockLobe& lobe, Worker& worker) {
        auto& [cut, cells, traced_cells, counts] = worker;
        EyeLight light;
        Kept* own = stands ? &kept[block] : nullptr;
        if (own != nullptr && own->generation == generation && own->num_updates < MostUpdates &&
            own->version + 1 >= sky.version()) {
            if (own->version == sky.version() || cut.update(block, lobe, own->divided, cells)) {
                ++counts.num_updated;
                counts.num_cells += own->num_cells;
                if (cells.size() != 0) {
                    sum_cells(lanes, cells, light);
                    add(light, own->light);
                    own->light = light;
                    ++own->num_updates;
                }
                own->version = sky.version();
                return own->light;
            }
            cells.clear();
        }
        cut.find(block, lobe, cells);
        sum_cells(lanes, cells, light);
        counts.num_cells += cells.size();
        if (own != nullptr) {
            own->light = light;
            own->divided.assign(cut.divided().begin(), cut.divided().end());
            own->version = sky.version();
            own->generation = generation;
            own->num_cells = cells.size();
            own->num_updates = 0;
        }
        return light;
    }

    void light_block(std::size_t block, const glm::vec3& eye, std::span<const glm::vec3> radiance,
                     bool is_needed, Worker& worker) {
        const std::size_t first = block * prt::BlockSize, size = size_of(block);
        worker.cells.clear();
        worker.traced.clear();
        if (is_matt[block] || !is_needed) {
            for (std::size_t i = first; i < first + size; ++i)
                result[transfer.order[i]] = radiance[transfer.order[i]];
            return;
        }
        const prt::BlockSurfaces lanes = surfaces_of(block, eye);
        const std::span<const prt::Surface> own = std::span(surfaces).subspan(first, size);
        const std::optional<BlockLobe> lobe = lobe_of(lanes, own);
        EyeLight light;
        if (lobe) {
            ++worker.counts.num_blocks;
            light = cut_light(block, lanes, *lobe, worker);
            add_traced(block, worker.traced);
            if (worker.traced.size() != 0) {
                EyeLight of_traced;
                sum_cells(lanes, worker.traced, of_traced);
                add(light, of_traced);
                worker.counts.num_cells += worker.traced.size();
            }
        }
        for (std::size_t i = 0; i < size; ++i) {
            const std::uint32_t receiver = transfer.order[first + i];
            const glm::vec3& matt = radiance[receiver];
            if (own[i].highlight == prt::Highlight::None || !(lanes.normal_dot_eye[i] > 0.0f)) {
                result[receiver] = matt;
                continue;
            }
            prt::Lobes<glm::vec3> lobes{.specular = light.all.of(i),
                                        .specular_grazing = light.grazing.of(i)};
            const glm::vec3 albedo =
                transfer.surfaces.empty() ? glm::vec3(1.0f) : transfer.surfaces[first + i].albedo;
            for (int channel = 0; channel < 3; ++channel)
                if (albedo[channel] > 0.0f)
                    lobes.diffuse[channel] = matt[channel] / albedo[channel];
            const prt::EyeCosines n_v(own[i], transfer.normals[first + i],
                                      {lanes.to_eye[0][i], lanes.to_eye[1][i], lanes.to_eye[2][i]});
            result[receiver] = prt::reflect(own[i], lobes, n_v);
        }
    }

    /// Says where the next look is from, and what errors its cells may make.
    void stand_at(const glm::vec3& eye, float error) {
        stands = generation != 0 && eye == last_eye && error == last_error;
        if (!stands)
            ++generation;
        else if (kept.empty())
            kept.resize(transfer.counts.num_blocks());
        last_eye = eye;
        last_error = error;
    }

    const prt::Transfer& transfer;
    /// [num_receivers] by place.
    std::vector<glm::vec3> positions;
    std::vector<prt::Surface> surfaces;
    /// [num_blocks] where no receiver has a highlight.
    std::vector<bool> is_matt;
    VisibilityPyramid visibility;
    SkyCells sky;
    /// Where pictures are known.
    std::optional<SeenBlocks> seen;
    std::optional<TracedLight> traced;
    std::vector<SharpLight> lights;
    /// `lights` as the kernel takes them.
    std::vector<SisterCells> traced_lights;
    bool is_lit = false;
    /// [num_blocks] once an eye has stood still.
    std::vector<Kept> kept;
    /// Counts eyes, which differ in where they are or in the error of their cuts.
    std::uint64_t generation = 0;
    glm::vec3 last_eye{0.0f};
    float last_error = -1.0f;
    /// Whether the present look is from where the last one was.
    bool stands = false;
    /// About what a white matt surface sends: root of the mean square.
    float white = 0.0f;
    EyeReport report;
    std::vector<glm::vec3> result;
};

MovingEye::MovingEye(const prt::Transfer& transfer, std::span<const glm::vec3> positions,
                     std::span<const prt::Surface> surfaces,
                     std::span<const SeenBlocks::Triangle> triangles) {
    if (positions.size() != transfer.num_receivers())
        throw std::invalid_argument("expected one position per receiver");
    check(transfer, surfaces);
    impl_ = std::make_unique<Impl>(transfer, positions, surfaces, triangles);
}
MovingEye::~MovingEye() = default;
MovingEye::MovingEye(MovingEye&&) noexcept = default;

bool MovingEye::set_surfaces(std::span<const prt::Surface> surfaces) {
    check(impl_->transfer, surfaces);
    impl_->set_surfaces(surfaces);
    const std::uint32_t level = level_for(smallest_alpha(surfaces));
    if (level == impl_->sky.deepest_level())
        return false;
    impl_->sky = SkyCells(level);
    impl_->kept.clear();
    impl_->is_lit = false;
    return true;
}

void MovingEye::set_light(const Relighter& relighter) {
    impl_->trace(relighter);
    impl_->sky.set(relighter, impl_->lights);
    impl_->is_lit = true;
    double sum = 0.0;
    for (const glm::vec3& b : relighter.diffuse_radiance()) {
        const double luminance = cubemap::luminance(glm::dvec3(b));
        sum += luminance * luminance;
    }
    // In steps of a fifth: cuts stay where the light changes a little.
    constexpr double Steps = 4.0;
    const double white = std::sqrt(sum / static_cast<double>(impl_->result.size()));
    impl_->white = white > 0.0
                       ? static_cast<float>(std::exp2(std::round(Steps * std::log2(white)) / Steps))
                       : 0.0f;
}

std::span<const glm::vec3> MovingEye::look(const glm::vec3& eye,
                                           std::span<const glm::vec3> radiance,
                                           const EyeOptions& options,
                                           std::span<const glm::vec4> sides) {
    if (!impl_->is_lit)
        throw std::logic_error("expected light before a look");
    if (radiance.size() != impl_->result.size())
        throw std::invalid_argument(fmt::format("expected the radiance of {} receivers, got {}",
                                                impl_->result.size(), radiance.size()));
    const auto start = std::chrono::steady_clock::now();
    EyeReport& report = impl_->report;
    const float before = report.tolerance;
    const double seconds_before = report.seconds;
    // A look that only took changes says little of the next one's time.
    const bool may_refine = report.num_updated == 0 || seconds_before * 1e3 > options.budget_ms;
    report = {.tolerance = options.tolerance};
    if (options.budget_ms > 0.0 && seconds_before > 0.0 && !may_refine)
        report.tolerance = before;
    else if (options.budget_ms > 0.0 && seconds_before > 0.0)
        report.tolerance =
            std::clamp(before * static_cast<float>(
                                    std::clamp(1e3 * seconds_before / options.budget_ms, 0.5, 2.0)),
                       0.002f, 0.5f);
    const float error = report.tolerance * impl_->white * ShareOfCell;
    impl_->stand_at(eye, error);
    std::span<const std::uint8_t> needed;
    if (options.seen_only && impl_->seen)
        needed = impl_->seen->find(eye, sides);
    std::atomic<std::size_t> num_cells = 0, num_blocks = 0, num_updated = 0;
    constexpr std::size_t Grain = 16;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, impl_->transfer.counts.num_blocks(), Grain),
        [&](const auto& some) {
            Worker worker{EyeCut(impl_->visibility, impl_->sky, error)};
            for (std::size_t block = some.begin(); block < some.end(); ++block)
                impl_->light_block(block, eye, radiance, needed.empty() || needed[block] != 0,
                                   worker);
            num_cells += worker.counts.num_cells;
            num_blocks += worker.counts.num_blocks;
            num_updated += worker.counts.num_updated;
        });
    report.num_cells = num_cells;
    report.num_blocks = num_blocks;
    report.num_updated = num_updated;
    report.seconds = files::seconds_since(start);
    return impl_->result;
}

const EyeReport& MovingEye::report() const {
    return impl_->report;
}

std::size_t MovingEye::num_traced() const {
    return impl_->lights.size();
}

std::size_t MovingEye::num_bytes() const {
    return impl_->visibility.num_bytes();
}

} // namespace relumine::relight
