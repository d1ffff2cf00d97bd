#include "prt/parts/part_facts.h"

#include <cstdint>

#include "prt/parts/part_list.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

SceneFileKind scene_file_kind(const std::filesystem::path& path) {
    if (!begins_as_sections(path))
        return SceneFileKind::Other;
    const SectionReader reader(path);
    if (reader.has("lit"))
        return SceneFileKind::LightPart;
    if (reader.has("part"))
        return SceneFileKind::ScenePart;
    return reader.has("plan") ? SceneFileKind::Plan : SceneFileKind::Scene;
}

PartFacts part_facts(const std::filesystem::path& path) {
    const SectionReader reader(path);
    require_part(reader);
    const bool is_light = reader.has("lit");
    const PartHead head = read_head(reader, "part", is_light ? "light" : "plan");
    return {.part = head.part,
            .num_receivers = is_light ? reader.elements<std::uint32_t>("lit_receivers").size()
                                      : head.num_receivers,
            .whole = head.whole,
            .has_plan = reader.has("positions")};
}

} // namespace relumine::prt
