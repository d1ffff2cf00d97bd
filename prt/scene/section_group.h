// A group of sections of the .prt file: what is written, read and checked together.
#pragma once

#include <array>

#include "prt/scene/scene_check.h"
#include "prt/scene/scene_file.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

struct SectionGroup {
    /// Adds the sections that the scene needs. They refer to the scene.
    /// Throws: std::invalid_argument for parts of a scene that do not fit each other.
    void (*add)(NewSections& sections, const Scene& scene);
    /// Reads them into a scene that has the groups before, and checks shapes and indices.
    /// Throws: as SectionReader.
    void (*read)(const SectionReader& reader, Scene& scene);
    /// Checks that the values can be lit and drawn, before a write and after a read.
    void (*check)(const SceneCheck& check, const Scene& scene) = [](const SceneCheck&,
                                                                    const Scene&) {
    };
    /// Light that plans do not have yet.
    bool is_light = false;
};

extern const SectionGroup SettingsSections, MeshSections, BrdfSections, MaterialSections,
    ReceiverSections, LampSections, ClusterSections, CountSections, GlossySections, BounceSections;

/// The list, in the order in which groups are read and checked.
inline const std::array AllSections = {
    &SettingsSections, &MeshSections,    &BrdfSections,  &MaterialSections, &ReceiverSections,
    &LampSections,     &ClusterSections, &CountSections, &GlossySections,   &BounceSections};

/// Whether rays can start at a place of the scene, lifted by its bias.
[[nodiscard]] bool can_start_rays(const Scene& scene, const glm::vec3& place);
/// Returns what a place should be, for messages.
[[nodiscard]] std::string expected_place(const Scene& scene);
void check_camera(const SceneCheck& check, const Scene& scene, const Camera& camera);

/// Does what load_scene() does.
[[nodiscard]] Scene scene_of(const SectionReader& reader);

/// Does the same for a scene without its light, as sections_without_light() makes it.
[[nodiscard]] Scene plan_of(const SectionReader& reader);

/// Returns the sections of a scene without counts, highlights and bounces. They refer to the scene,
/// which must last until they are written.
/// Throws: as save_scene() does.
[[nodiscard]] NewSections sections_without_light(const std::filesystem::path& path,
                                                 const Scene& scene);

} // namespace relumine::prt
