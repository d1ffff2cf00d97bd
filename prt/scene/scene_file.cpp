#include "prt/scene/scene_file.h"

#include <stdexcept>

#include <fmt/format.h>

#include "files/hash.h"
#include "files/output_file.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/scene/absent_groups.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

namespace {

void check_scene(const Scene& scene, const std::filesystem::path& path) {
    const SceneCheck check(path);
    for (const SectionGroup* group : AllSections)
        group->check(check, scene);
}

Scene read_scene(const SectionReader& reader, bool is_plan) {
    Scene scene;
    for (const SectionGroup* group : AllSections)
        if (!(is_plan && (group->is_light || group == &BounceSections)))
            group->read(reader, scene);
    check_scene(scene, reader.path());
    for (AbsentGroup& own : scene.absent)
        take_away(scene, own);
    if (!is_plan)
        set_surfaces(scene.transfer, scene.receivers);
    return scene;
}

void add_sections(NewSections& sections, const Scene& scene, bool are_light) {
    for (const SectionGroup* group : AllSections)
        if (group->is_light == are_light)
            group->add(sections, scene);
}

} // namespace

NewSections sections_without_light(const std::filesystem::path& path, const Scene& scene) {
    const bool are_vertices = on_vertices(scene.layout);
    if (are_vertices && scene.receivers.size() != 0 &&
        scene.receivers.size() != scene.mesh.num_vertices())
        throw std::invalid_argument(
            fmt::format("{}: expected one receiver per vertex, got {} for {}", path.string(),
                        scene.receivers.size(), scene.mesh.num_vertices()));
    const std::size_t num_receivers =
        are_vertices ? scene.mesh.num_vertices() : scene.receivers.size();
    if (scene.transfer.num_receivers() != num_receivers ||
        scene.mesh.normals.size() != scene.mesh.num_vertices())
        throw std::invalid_argument(
            fmt::format("{}: expected the transfer of {} receivers and a normal for each of {} "
                        "vertices, got {} and {}",
                        path.string(), num_receivers, scene.mesh.num_vertices(),
                        scene.transfer.num_receivers(), scene.mesh.normals.size()));
    check_scene(scene, path);
    NewSections sections;
    add_sections(sections, scene, false);
    return sections;
}

std::uint64_t save_scene(const std::filesystem::path& path, const Scene& scene) {
    NewSections sections = sections_without_light(path, scene);
    add_sections(sections, scene, true);
    return write_sections(path, sections);
}

bool has_traced_highlights(const Scene& scene) {
    return !scene.settings.glossy_tolerance && has_highlights(scene.receivers);
}

std::uint64_t hash_without_light(const Scene& scene) {
    NewSections sections;
    add_sections(sections, scene, false);
    std::uint64_t hash = 0;
    for (const auto& [name, content] : sections) {
        std::vector<std::byte> made;
        hash = files::hash_of(std::as_bytes(std::span(name)), hash + content.size());
        hash = files::hash_of(content.bytes(0, content.size(), made), hash);
    }
    return hash;
}

Scene load_scene(const std::filesystem::path& path) {
    return scene_of(SectionReader(path));
}

Scene scene_of(const SectionReader& reader) {
    if (reader.has("plan"))
        throw std::runtime_error(fmt::format(
            "{}: expected a scene, got {}", reader.path().string(),
            reader.has("part") ? "a part of one" : "a plan of one, which has no light yet"));
    return read_scene(reader, false);
}

Scene plan_of(const SectionReader& reader) {
    return read_scene(reader, true);
}

} // namespace relumine::prt
