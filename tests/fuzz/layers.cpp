#include "cubemap/layers/layer_composite.h"
#include "cubemap/layers/layer_file.h"
#include "tests/fuzz/fuzz.h"

RELUMINE_FUZZ_TARGET(layers) {
    using namespace relumine;
    const std::filesystem::path path = fuzz::file("layers.json", fuzz::bytes(data, size));
    const auto layers = fuzz::accepted([&] { return cubemap::load_layers(path); });
    if (!layers)
        return 0;
    const std::filesystem::path copy = fuzz::folder() / "copy.json";
    cubemap::save_layers(copy, *layers);
    fuzz::require(cubemap::load_layers(copy) == *layers, "layers read back as they were written");
    const cubemap::CubeMap base(4);
    static_cast<void>(cubemap::composite(base, layers->layers));
    if (!layers->frames.empty()) {
        const double middle = 0.5 * (layers->frames.front().frame + layers->frames.back().frame);
        try {
            static_cast<void>(cubemap::composite(base, cubemap::layers_at(*layers, middle)));
        } catch (const std::invalid_argument&) { // what lies between two key frames may be no layer
        }
    }
    return 0;
}
