// A .prt file, as it is and with checksums that fit.
#include <vector>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/prt_file.h"
#include "tests/fuzz/scene_target.h"

RELUMINE_FUZZ_TARGET(prt) {
    using namespace relumine;
    const std::span<const std::byte> input = fuzz::bytes(data, size);
    for (const std::vector<std::byte>& content :
         {std::vector<std::byte>(input.begin(), input.end()), fuzz::with_checksums(input)}) {
        const std::filesystem::path path = fuzz::file("input.prt", content);
        if (const auto scene = fuzz::accepted([&] { return prt::load_scene(path); }))
            fuzz::require_sound(*scene);
    }
    return 0;
}
