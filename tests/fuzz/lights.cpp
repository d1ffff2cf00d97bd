#include "lights/light_export.h"
#include "lights/light_file.h"
#include "tests/fuzz/fuzz.h"

RELUMINE_FUZZ_TARGET(lights) {
    using namespace relumine;
    const std::filesystem::path path = fuzz::file("lights.json", fuzz::bytes(data, size));
    const auto list = fuzz::accepted([&] { return lights::load_lights(path); });
    if (!list)
        return 0;
    const std::string text = lights::json_text(*list);
    const lights::LightList copy =
        lights::load_lights(fuzz::file("copy.json", std::as_bytes(std::span(text))));
    fuzz::require(lights::json_text(copy) == text, "a list reads back as it was written");
    for (const lights::LightFormat format : lights::AllLightFormats)
        fuzz::require(!lights::light_text(*list, format, {.soft = true}).empty(),
                      "a list has a text in each format");
    return 0;
}
