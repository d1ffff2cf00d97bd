// The sections of a .prt file without its container, so that mutations reach what is in them: for
// each section the letter of its name (below), its size (two bytes, low first) and its bytes. With
// a section `plan` they are those of a plan, whose light is computed.

#include "prt/parts/part_file.h"
#include "prt/scene/section_group.h"
#include "relumine/in/precompute.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/scene_target.h"
#include "tests/fuzz/section_names.h"

namespace {

using namespace relumine;

void try_plan(prt::Sections&& sections) {
    const PartOptions options{
        .plan = fuzz::file("input.plan", prt::packed_sections(prt::to_write(std::move(sections)))),
        .output = fuzz::folder() / "part.prt"};
    const auto plan = fuzz::accepted([&] { return prt::load_plan(options.plan); });
    constexpr std::size_t MostPairs = 10'000;
    if (plan && plan->scene.receivers.size() * plan->scene.transfer.num_clusters() <= MostPairs &&
        plan->scene.settings.face_resolution <= 8)
        static_cast<void>(fuzz::accepted([&] {
            precompute_part(options);
            return true;
        }));
}

} // namespace

RELUMINE_FUZZ_TARGET(sections) {
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
    if (sections.contains("plan"))
        try_plan(std::move(sections));
    else if (const auto scene = fuzz::accepted([&] {
                 return prt::scene_of(
                     {"input.prt", prt::packed_sections(prt::to_write(std::move(sections)))});
             }))
        fuzz::require_sound(*scene);
    return 0;
}
