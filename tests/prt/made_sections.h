// The bytes of sections that were to be written.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "prt/scene/section_file.h"

namespace relumine::scenes {

[[nodiscard]] inline prt::Sections made(const prt::NewSections& sections) {
    prt::Sections result;
    for (const auto& [name, content] : sections) {
        std::vector<std::byte> own;
        const std::span<const std::byte> bytes =
            content.bytes(0, static_cast<std::size_t>(content.size()), own);
        result[name].assign(bytes.begin(), bytes.end());
    }
    return result;
}

} // namespace relumine::scenes
