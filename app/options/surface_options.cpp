#include "app/options/surface_options.h"

#include "app/options/material_option.h"

namespace relumine::app {

void SurfaceOptions::add_to(Command& command) {
    command.add_option(
        "--material", materials_,
        "surface in place of the file's: ggx:roughness=0.3,albedo=0.5,f0=0.04, "
        "blinn:exponent=50,kd=0.3,ks=0.2 or lambert:albedo=0.8; GROUP=... for one object; "
        "the floor of --floor is `floor`, and Lambert unless named; highlights need --view");
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

prt::SurfaceOverride SurfaceOptions::surface(const mesh::TriangleMesh& mesh) const {
    if (materials_.empty())
        return {};
    std::vector<SurfaceMaterial> options;
    for (const std::string& material : materials_)
        options.push_back(parse_material(material));
    return surface_override(options, mesh);
}

prt::Surface SurfaceOptions::floor_surface() const {
    prt::Surface surface;
    for (const std::string& text : materials_)
        if (const SurfaceMaterial material = parse_material(text); material.group == "floor")
            surface = material.applied_to({});
    return surface;
}

} // namespace relumine::app
