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

} // namespace

struct MovingEye::Impl {
    Impl(const prt::Transfer& of, std::span<const glm::vec3> at,
         std::span<const prt::Surface> shiny, std::span<const SeenBlocks::Triangle> triangles)
        : transfer(of), visibility(of), sky(level_for(smallest_alpha(shiny))),
          result(of.num_receivers()) {
        for (const std::uint32_t receiver : of.order) {
            positions.push_back(at[receiver]);
            surfaces.push_back(is_ggx(shiny[receiver]) ? shiny[receiver] : prt::Surface());
        }
        for (std::size_t block = 0; block < of.counts.num_blocks(); ++block) {
            const auto own = std::span(surfaces).subspan(block * prt::BlockSize, size_of(block));
            is_matt.push_back(std::none_of(own.begin(), own.end(), is_ggx));
        }
        if (!triangles.empty())
            seen.emplace(transfer, visibility, positions, triangles);
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

    void light_block(std::size_t block, const glm::vec3& eye, std::span<const glm::vec3> radiance,
                     bool is_needed, EyeCut& cut, LitCells& cells) {
        const std::size_t first = block * prt::BlockSize, size = size_of(block);
        cells.clear();
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
            cut.find(block, *lobe, cells);
            add_traced(block, cells);
            sum_cells(lanes, cells, light);
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
    /// The same, as the kernel takes them.
    std::vector<SisterCells> traced_lights;
    bool is_lit = false;
    /// What a white matt surface sends: root of the mean square.
    double white = 0.0;
    EyeReport report;
    std::vector<glm::vec3> result;
};

MovingEye::MovingEye(const prt::Transfer& transfer, std::span<const glm::vec3> positions,
                     std::span<const prt::Surface> surfaces,
                     std::span<const SeenBlocks::Triangle> triangles) {
    if (positions.size() != transfer.num_receivers() || surfaces.size() != positions.size())
        throw std::invalid_argument("expected one position and one surface per receiver");
    if (std::none_of(surfaces.begin(), surfaces.end(), is_ggx))
        throw std::invalid_argument("expected surfaces with highlights, got none");
    impl_ = std::make_unique<Impl>(transfer, positions, surfaces, triangles);
}
MovingEye::~MovingEye() = default;
MovingEye::MovingEye(MovingEye&&) noexcept = default;

void MovingEye::set_light(const Relighter& relighter) {
    impl_->trace(relighter);
    impl_->sky.set(relighter, impl_->lights);
    impl_->is_lit = true;
    double sum = 0.0;
    for (const glm::vec3& b : relighter.diffuse_radiance()) {
        const double luminance = cubemap::luminance(glm::dvec3(b));
        sum += luminance * luminance;
    }
    impl_->white = std::sqrt(sum / static_cast<double>(impl_->result.size()));
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
    report = {.tolerance = options.tolerance};
    if (options.budget_ms > 0.0 && seconds_before > 0.0)
        report.tolerance =
            std::clamp(before * static_cast<float>(
                                    std::clamp(1e3 * seconds_before / options.budget_ms, 0.5, 2.0)),
                       0.002f, 0.5f);
    const float error = report.tolerance * static_cast<float>(impl_->white) * ShareOfCell;
    std::atomic<std::size_t> num_cells = 0, num_blocks = 0;
    std::span<const std::uint8_t> needed;
    if (options.seen_only && impl_->seen)
        needed = impl_->seen->find(eye, sides);
    constexpr std::size_t Grain = 16;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, impl_->transfer.counts.num_blocks(), Grain),
        [&](const auto& some) {
            EyeCut cut(impl_->visibility, impl_->sky, error);
            LitCells cells;
            for (std::size_t block = some.begin(); block < some.end(); ++block) {
                impl_->light_block(block, eye, radiance, needed.empty() || needed[block] != 0, cut,
                                   cells);
                num_cells += cells.size();
                num_blocks += cells.size() == 0 ? 0 : 1;
            }
        });
    report.num_cells = num_cells;
    report.num_blocks = num_blocks;
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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
