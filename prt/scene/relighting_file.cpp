#include "prt/scene/relighting_file.h"

#include <array>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

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

} // namespace

std::uint64_t save_relighting_scene(const std::filesystem::path& path, RelightingScene given) {
    Scene& scene = given.scene;
    if (!given.albedo.empty() && given.albedo.size() != scene.receivers.size())
        throw std::invalid_argument(fmt::format("expected the albedo of {} receivers, got {}",
                                                scene.receivers.size(), given.albedo.size()));
    scene.mesh.colors.clear();
    scene.mesh.uvs.clear();
    scene.mesh.second_uvs.clear();
    scene.blockers.reset();
    scene.receivers.to_eye.clear();
    scene.receivers.surfaces.clear();
    scene.receivers.veils.clear();
    scene.settings.glossy_tolerance.reset();
    scene.settings.view.reset();
    scene.settings.left_out.clear();
    check_relighting(path, given);
    NewSections sections;
    for (const SectionGroup* group : RelightingSections)
        group->add(sections, scene);
    if (!given.albedo.empty())
        sections[Albedo] = SectionContent::view(given.albedo);
    return write_sections(path, sections);
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
