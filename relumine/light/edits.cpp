#include "relumine/light/edits.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace relumine {

UpdateReport update(LitScene& lit, Environment environment) {
    LightState next = lit.state();
    next.base = base_of(std::move(environment));
    return lit.edit(std::move(next));
}

UpdateReport set_layers(LitScene& lit, std::vector<cubemap::LightLayer> layers) {
    LightState next = lit.state();
    next.layers = std::move(layers);
    return lit.edit(std::move(next));
}

UpdateReport set_layer(LitScene& lit, std::size_t index, const cubemap::LightLayer& layer) {
    LightState next = lit.state();
    if (index >= next.layers.size())
        throw std::out_of_range(
            fmt::format("expected one of {} layers, got number {}", next.layers.size(), index));
    next.layers[index] = layer;
    return lit.edit(std::move(next));
}

UpdateReport set_rotation(LitScene& lit, double degrees, Ending ending) {
    LightState next = lit.state();
    next.rotation_degrees = degrees;
    return lit.edit(std::move(next), ending);
}

void mark(LitScene& lit) {
    lit.edit(lit.state(), Ending::Exact);
    lit.history().mark(lit.state());
}

void forget_history(LitScene& lit) {
    lit.edit(lit.state(), Ending::Exact);
    lit.history().restart(lit.state());
}

UpdateReport undo(LitScene& lit) {
    const LightState* before = lit.history().undo(lit.state());
    return before == nullptr ? UpdateReport() : lit.edit(*before, Ending::Exact);
}

UpdateReport redo(LitScene& lit) {
    const LightState* after = lit.history().redo();
    return after == nullptr ? UpdateReport() : lit.edit(*after, Ending::Exact);
}

} // namespace relumine
