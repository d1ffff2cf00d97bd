// Sections that no file has.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "prt/scene/section_reader.h"

namespace relumine::scenes {

[[nodiscard]] inline prt::SectionReader reader_of(const std::filesystem::path& path,
                                                  prt::Sections sections) {
    return {path, prt::packed_sections(prt::to_write(std::move(sections)))};
}

[[nodiscard]] inline prt::Sections made(const prt::NewSections& sections) {
    const prt::PackedSections packed("made", prt::packed_sections(sections));
    prt::Sections result;
    for (const std::string& name : packed.names())
        result[name] = packed.bytes(name);
    return result;
}

} // namespace relumine::scenes
