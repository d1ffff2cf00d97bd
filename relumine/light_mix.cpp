#include "relumine/light_mix.h"

#include <stdexcept>
#include <utility>

namespace relumine {

relight::LayeredPicture light_mix(LitScene& lit, Painter& painter) {
    if (!has_environment(lit))
        throw std::logic_error("expected a scene lit by an environment");
    const LightState state = lit.state();
    const std::vector<cubemap::LightLayer> all = cubemap::without_solo(state.layers);
    // Those that solo puts below make the environment black.
    const std::size_t first = all.size() - state.layers.size();
    relight::LayeredPicture mix;
    const auto add = [&](const std::string& name, std::size_t num_layers) {
        set_layers(lit, {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(num_layers)});
        if (lit.bounces().is_set())
            lit.bounce();
        Picture picture = painter.draw(lit.lighting());
        std::vector<glm::vec3> part = picture.pixels;
        for (std::size_t i = 0; i < mix.whole.pixels.size(); ++i)
            part[i] -= mix.whole.pixels[i];
        mix.layers.push_back({name, std::move(part)});
        mix.whole = std::move(picture);
    };
    add("environment", first);
    for (std::size_t i = first; i < all.size(); ++i)
        if (all[i].on)
            add(all[i].name, i + 1);
    lit.edit(state);
    if (lit.bounces().is_set())
        lit.bounce();
    return mix;
}

} // namespace relumine
