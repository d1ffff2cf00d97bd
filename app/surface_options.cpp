#include "app/surface_options.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/material_option.h"
#include "app/memory_option.h"
#include "prt/glossy/surface_sampling.h"

namespace relumine::app {

void SurfaceOptions::add_to(Command& command) {
    command.add_option(
        "--material", materials_,
        "surface in place of the file's: ggx:roughness=0.3,albedo=0.5,f0=0.04, "
        "blinn:exponent=50,kd=0.3,ks=0.2 or lambert:albedo=0.8; GROUP=... for one object; "
        "highlights need --view");
    command
        .add_option("--glossy-tolerance", glossy_tolerance_,
                    "relative error of a highlight under a small light anywhere")
        .between(1e-4, 1.0)
        .show_default();
}

void SurfaceOptions::check() const {
    for (const std::string& material : materials_)
        static_cast<void>(parse_material(material));
}

void SurfaceOptions::apply(prt::Scene& scene, Session& session) const {
    const mesh::TriangleMesh& mesh = scene.mesh;
    if (mesh.materials.empty() && materials_.empty())
        return;
    std::vector<MaterialOption> options;
    for (const std::string& material : materials_)
        options.push_back(parse_material(material));
    const prt::SurfaceOverride override_surface = surface_override(options, mesh);

    prt::Receivers& receivers = scene.receivers;
    if (receivers.points.empty()) {
        receivers.surfaces = prt::vertex_surfaces(mesh, override_surface);
    } else {
        receivers.surfaces.clear();
        for (const prt::MeshPoint& point : receivers.points)
            receivers.surfaces.push_back(override_surface(
                mesh, point.triangle, prt::surface_at(mesh, point.triangle, point.barycentric)));
    }
    if (!receivers.to_eye.empty())
        return;
    std::size_t num_highlights = 0;
    for (prt::Surface& surface : receivers.surfaces) {
        num_highlights += surface.highlight != prt::Highlight::None ? 1 : 0;
        surface.highlight = prt::Highlight::None;
    }
    if (num_highlights != 0)
        session.warn(fmt::format("{} receivers have highlights, which need --view: left "
                                 "out, the scene is diffuse",
                                 num_highlights));
}

void SurfaceOptions::precompute_highlights(prt::Scene& scene, const prt::RayScene& rays,
                                           const prt::PrecomputeOptions& precompute,
                                           std::optional<std::uint64_t> max_bytes,
                                           const std::string& mesh, Session& session,
                                           Report& report) const {
    if (!prt::has_highlights(scene.receivers)) {
        prt::set_surfaces(scene.transfer, scene.receivers);
        return;
    }
    const float narrowest = prt::narrowest_roughness(precompute.face_resolution);
    const auto is_too_sharp = [&](const prt::Surface& surface) {
        return surface.highlight == prt::Highlight::Ggx && surface.shape < narrowest;
    };
    const std::vector<prt::Surface>& surfaces = scene.receivers.surfaces;
    if (const auto count = std::count_if(surfaces.begin(), surfaces.end(), is_too_sharp);
        count != 0)
        session.warn(fmt::format("{} receivers are smoother than roughness {:.3f}: cells of the "
                                 "quadtree cannot hold so sharp a highlight, it comes out wider",
                                 count, narrowest));
    prt::GlossyOptions glossy{.tolerance = glossy_tolerance_,
                              .face_resolution = precompute.face_resolution,
                              .bias = precompute.bias,
                              .checkpoint = precompute.checkpoint,
                              .stop = session.stop(),
                              .on_progress = session.progress("highlights")};
    const auto refused = [&](std::string_view kind, std::uint64_t num_entries) {
        return std::runtime_error(fmt::format("{}: expected highlights within {} of memory, got {} "
                                              "{}; a larger --glossy-tolerance takes less",
                                              mesh, megabytes(*max_bytes), kind,
                                              megabytes(num_entries * prt::BytesPerEntry)));
    };
    if (max_bytes) {
        const std::uint64_t estimate =
            prt::estimate_glossy_entries(scene.receivers, rays, scene.transfer, glossy);
        if (estimate * prt::BytesPerEntry > *max_bytes)
            throw refused("an estimate of", estimate);
        report.set("highlights_estimate", estimate);
        glossy.max_bytes = *max_bytes;
    }
    prt::GlossyStatistics statistics;
    try {
        scene.transfer.glossy =
            prt::precompute_glossy(scene.receivers, rays, scene.transfer, glossy, &statistics);
    } catch (const prt::TooManyEntries& error) {
        throw refused("at least", error.num_entries);
    }
    session.end_progress();
    prt::set_surfaces(scene.transfer, scene.receivers);
    scene.settings.glossy_tolerance = glossy_tolerance_;
    const double cells_per_block = static_cast<double>(statistics.num_entries) /
                                   static_cast<double>(scene.transfer.counts.num_blocks());
    session.say(
        fmt::format("highlights: {:.0f} cells per block of {} receivers in {:.1f} s, {:.1f} MB",
                    cells_per_block, prt::BlockSize, statistics.seconds,
                    static_cast<double>(scene.transfer.glossy->num_bytes()) * 1e-6));
    report.set("glossy", {{"tolerance", glossy_tolerance_},
                          {"cells", statistics.num_entries},
                          {"cells_per_block", cells_per_block},
                          {"rays", statistics.num_rays},
                          {"seconds", statistics.seconds},
                          {"bytes", scene.transfer.glossy->num_bytes()},
                          {"narrowest_roughness", narrowest}});
}

} // namespace relumine::app
