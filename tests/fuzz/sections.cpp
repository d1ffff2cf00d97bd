// The sections of a .prt file without its container, so that mutations reach what is in them: for
// each section the letter of its name (below), its size (two bytes, low first) and its bytes.
#include <array>
#include <vector>

#include "prt/scene/section_group.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/scene_target.h"
#include "tests/fuzz/section_names.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace relumine;
    std::span<const std::byte> rest = fuzz::bytes(data, size);
    prt::Sections sections;
    while (rest.size() >= 3) {
        const std::size_t letter = std::to_integer<std::size_t>(rest[0]) - 'A';
        const std::size_t length =
            std::to_integer<std::size_t>(rest[1]) | std::to_integer<std::size_t>(rest[2]) << 8u;
        rest = rest.subspan(3);
        const std::span<const std::byte> content = rest.first(std::min(length, rest.size()));
        rest = rest.subspan(content.size());
        if (letter < fuzz::SectionNames.size())
            sections[std::string(fuzz::SectionNames[letter])].assign(content.begin(),
                                                                     content.end());
    }
    if (const auto scene =
            fuzz::accepted([&] { return prt::scene_of("input.prt", std::move(sections)); }))
        fuzz::require_sound(*scene);
    return 0;
}
