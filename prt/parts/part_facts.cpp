#include "prt/parts/part_facts.h"

#include <cstdint>
#include <stdexcept>

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

PartCheck check_parts(std::span<const std::filesystem::path> paths) {
    PartCheck check;
    PartList list;
    for (const std::filesystem::path& path : paths)
        try {
            const SectionReader reader(path);
            require_part(reader);
            const std::string whole_name = reader.has("lit") ? "light" : "plan";
            list.add(path, read_head(reader, "part", whole_name), whole_name);
        } catch (const std::runtime_error& error) {
            check.faults.emplace_back(error.what());
        }
    check.num_parts = list.count();
    check.missing = list.missing();
    return check;
}

} // namespace relumine::prt
