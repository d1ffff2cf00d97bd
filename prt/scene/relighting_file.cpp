#include "prt/scene/relighting_file.h"

#include <array>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "prt/scene/packed_mesh.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

namespace {

const std::string Albedo = "albedo";

const std::array RelightingSections = {&SettingsSections, &MeshSections,  &ReceiverSections,
                                       &ClusterSections,  &CountSections, &BounceSections};

void check_relighting(const std::filesystem::path& path, const RelightingScene& given) {
    const SceneCheck check(path);
    for (const SectionGroup* group : RelightingSections)
        group->check(check, given.scene);
    check.all("an albedo of 0 to 1", given.albedo,
              [](const glm::vec3& color) { return is_within(color, 0.0f, 1.0f + RangeSlack); });
}

/// Returns the scene without what relighting does not need.
RelightingScene leaned(RelightingScene given) {
    Scene& scene = given.scene;
    if (!given.albedo.empty() && given.albedo.size() != scene.receivers.size())
        throw std::invalid_argument(fmt::format("expected the albedo of {} receivers, got {}",
                                                scene.receivers.size(), given.albedo.size()));
    scene.mesh.colors.clear();
    scene.mesh.uvs.clear();
    scene.mesh.second_uvs.clear();
    scene.blockers.reset();
    scene.free_lifts.clear();
    scene.receivers.to_eye.clear();
    scene.receivers.surfaces.clear();
    scene.receivers.veils.clear();
    scene.settings.glossy_tolerance.reset();
    scene.settings.view.reset();
    scene.settings.left_out.clear();
    return given;
}

/// The scene must last until the sections are written.
NewSections sections_of(const RelightingScene& given) {
    NewSections sections;
    for (const SectionGroup* group : RelightingSections)
        group->add(sections, given.scene);
    if (!given.albedo.empty())
        sections[Albedo] = SectionContent::view(given.albedo);
    return sections;
}

} // namespace

std::uint64_t save_relighting_scene(const std::filesystem::path& path, RelightingScene scene) {
    const RelightingScene lean = leaned(std::move(scene));
    check_relighting(path, lean);
    return write_sections(path, sections_of(lean));
}

std::vector<std::byte> packed_relighting_scene(RelightingScene scene) {
    const RelightingScene lean = leaned(std::move(scene));
    check_relighting("scene", lean);
    NewSections sections = sections_of(lean);
    for (const char* const name : {"positions", "normals", "triangles", "lifts"})
        sections.erase(name);
    add_packed_mesh(sections, lean.scene.mesh);
    return packed_sections(sections, Packing::Best);
}

RelightingScene relighting_scene_of(const SectionReader& reader) {
    if (reader.has("plan"))
        throw std::runtime_error(fmt::format("{}: expected a scene, got a plan or a part of one",
                                             reader.path().string()));
    RelightingScene result;
    for (const SectionGroup* group : RelightingSections)
        group->read(reader, result.scene);
    const Receivers& receivers = result.scene.receivers;
    result.albedo = reader.elements<glm::vec3>(Albedo, receivers.size(), true);
    if (result.albedo.empty())
        for (const Surface& surface : receivers.surfaces)
            result.albedo.push_back(surface.albedo);
    check_relighting(reader.path(), result);
    return result;
}

} // namespace relumine::prt
