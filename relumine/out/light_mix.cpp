#include "relumine/out/light_mix.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "relumine/light/edits.h"

namespace relumine {

namespace {

/// A scene's light, taken apart. Puts it back together at its end.
class Mixer {
public:
    Mixer(LitScene& lit, Painter& painter)
        : lit_(lit), painter_(painter), state_(lit.environment().state()),
          gains_(lit.lamps().gains()), lamps_(lit.scene().lamps.names()) {}
    Mixer(const Mixer&) = delete;
    Mixer& operator=(const Mixer&) = delete;

    relight::LayeredPicture run() {
        const std::vector<cubemap::LightLayer> all = cubemap::without_solo(state_.layers);
        if (Lighting light = lit_.lighting(); !light.sent.empty()) {
            painter_.keep_guide(true);
            static_cast<void>(painter_.draw(light));
        }
        // Those that solo puts below make the environment black.
        const std::size_t first = all.size() - state_.layers.size();
        const auto below = [&](std::size_t count) {
            return std::vector(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
        };
        shine(0);
        add("environment", below(first));
        for (std::size_t i = first; i < all.size(); ++i)
            if (all[i].on)
                add(all[i].name, below(i + 1));
        for (std::size_t i = 0; i < lamps_.size(); ++i) {
            shine(i + 1);
            add(lamps_[i], all);
        }
        lit_.dim(gains_);
        painter_.dim(gains_);
        lit_.environment().edit(state_);
        bounce();
        painter_.keep_guide(false);
        return std::move(mix_);
    }

private:
    /// Only the first lamps shine. All have names, so that none is traced twice.
    void shine(std::size_t num_lamps) {
        if (lamps_.empty())
            return;
        std::vector<EmissionGain> gains = gains_;
        for (std::size_t i = 0; i < lamps_.size(); ++i)
            gains.push_back({.name = lamps_[i], .gain = glm::vec3(i < num_lamps ? 1.0f : 0.0f)});
        lit_.dim(gains);
        painter_.dim(std::move(gains));
    }

    void bounce() {
        if (lit_.bounces().is_set())
            lit_.bounce();
    }

    /// Adds what is more than in the picture before.
    void add(const std::string& name, std::vector<cubemap::LightLayer> layers) {
        set_layers(lit_, std::move(layers));
        bounce();
        Picture picture = painter_.draw(lit_.lighting());
        std::vector<glm::vec3> part = picture.pixels;
        for (std::size_t i = 0; i < mix_.whole.pixels.size(); ++i)
            part[i] -= mix_.whole.pixels[i];
        mix_.layers.push_back({name, std::move(part)});
        mix_.whole = std::move(picture);
    }

    LitScene& lit_;
    Painter& painter_;
    const LightState state_;
    const std::vector<EmissionGain> gains_;
    const std::vector<std::string> lamps_;
    relight::LayeredPicture mix_;
};

} // namespace

relight::LayeredPicture light_mix(LitScene& lit, Painter& painter) {
    if (!has_environment(lit))
        throw std::logic_error("expected a scene lit by an environment");
    return Mixer(lit, painter).run();
}

} // namespace relumine
