#include "app/options/receiver_options.h"

#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "relumine/in/place_report.h"

namespace relumine::app {

namespace {

/// Puts the members of a layout into a report.
struct MembersIn {
    Report& report;

    template<class Value>
    void operator()(std::string_view name, const Value& value) const {
        report.set(name == "fov_degrees" ? "fov" : name, value);
    }
    template<class Value>
    void unusual(std::string_view name, const Value& value, const Value& usual) const {
        if (value != usual)
            (*this)(name, value);
    }
};

} // namespace

Report layout_json(const prt::Scene& scene) {
    if (prt::on_vertices(scene.layout))
        return {};
    Report report;
    report.set("kind", prt::kind_of(scene.layout).name);
    prt::ReceiverLayout layout = scene.layout;
    std::visit(
        [&](auto& own) {
            MembersIn member{report};
            own.members(member);
        },
        layout);
    for (const char* const place : {"eye", "target", "low", "high"})
        if (const Report* const found = report.find(place); found != nullptr) {
            const Report::Array& p = found->values();
            const glm::dvec3 at(p.at(0).number(), p.at(1).number(), p.at(2).number());
            report.set(place, place_json(scene.mesh, glm::vec3(at)));
        }
    report.set("coverage", coverage_of(scene));
    return report;
}

double coverage_of(const prt::Scene& scene) {
    return static_cast<double>(prt::num_places_taken(scene.layout)) /
           static_cast<double>(prt::num_places(scene.layout));
}

Report atlas_json(const prt::AtlasReport& atlas, const prt::TexelLayout& texels) {
    Report report = {{"texels_overlapping", atlas.num_overlapping},
                     {"texels_on_borders", atlas.num_borders},
                     {"triangles_outside", atlas.num_outside},
                     {"triangles_flat_in_uv", atlas.num_flat}};
    if (atlas.num_overlapping > 0)
        report.set("first_overlap", std::vector<Report>{atlas.first_overlap % texels.width,
                                                        atlas.first_overlap / texels.width});
    return report;
}

void require_vertices(const prt::Scene& scene, const std::string& path) {
    if (!prt::on_vertices(scene.layout))
        throw std::runtime_error(
            fmt::format("{}: expected a scene whose receivers are vertices, got {}", path,
                        prt::description(scene.layout)));
}

} // namespace relumine::app
