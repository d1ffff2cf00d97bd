#include "relumine/in/material.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/joined.h"
#include "prt/glossy/lobe_list.h"

namespace relumine {

prt::Surface SurfaceMaterial::applied_to(const prt::Surface& surface) const {
    if (table)
        return prt::measured_surface(table);
    glm::vec3 specular_color(0.0f);
    if (specular)
        specular_color = *specular;
    else if (prt::facts_of(highlight).has_fresnel)
        specular_color = prt::facts_of(surface.highlight).has_fresnel
                             ? surface.specular
                             : glm::vec3(prt::DielectricF0);
    return {.albedo = albedo.value_or(surface.albedo),
            .specular = specular_color,
            .highlight = highlight,
            .roughness_or_exponent = roughness_or_exponent,
            .metallic = highlight == prt::Highlight::GgxWhole && !albedo && !specular
                            ? surface.metallic
                            : 0.0f};
}

prt::SurfaceOverride surface_override(std::span<const SurfaceMaterial> materials,
                                      const mesh::TriangleMesh& mesh) {
    // A mesh without groups has one without a name.
    std::vector<std::optional<SurfaceMaterial>> by_group(
        std::max<std::size_t>(mesh.groups.size(), 1));
    for (const SurfaceMaterial& material : materials) {
        if (material.group.empty()) {
            std::fill(by_group.begin(), by_group.end(), material);
            continue;
        }
        const auto found = std::find(mesh.groups.begin(), mesh.groups.end(), material.group);
        if (found == mesh.groups.end())
            throw std::invalid_argument(
                mesh.groups.empty()
                    ? fmt::format("expected no group, since the mesh has none, got '{}'",
                                  material.group)
                    : fmt::format(
                          "expected a group of the mesh ({}{}), got '{}'",
                          files::joined(std::span(mesh.groups)
                                            .first(std::min<std::size_t>(mesh.groups.size(), 8)),
                                        ", "),
                          mesh.groups.size() > 8 ? ", ..." : "", material.group));
        by_group[static_cast<std::size_t>(found - mesh.groups.begin())] = material;
    }
    return [by_group = std::move(by_group)](const mesh::TriangleMesh& of, std::uint32_t triangle,
                                            const prt::Surface& surface) {
        const std::size_t group = of.triangle_groups.empty() ? 0 : of.triangle_groups[triangle];
        return group < by_group.size() && by_group[group] ? by_group[group]->applied_to(surface)
                                                          : surface;
    };
}

} // namespace relumine
