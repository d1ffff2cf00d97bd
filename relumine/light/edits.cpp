#include "relumine/light/edits.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace relumine {

UpdateReport update(LitScene& lit, Environment environment) {
    LightState next = lit.environment().state();
    next.base = base_of(std::move(environment));
    return lit.environment().edit(std::move(next));
}

UpdateReport set_layers(LitScene& lit, std::vector<cubemap::LightLayer> layers) {
    LightState next = lit.environment().state();
    next.layers = std::move(layers);
    return lit.environment().edit(std::move(next));
}

UpdateReport set_layer(LitScene& lit, std::size_t index, const cubemap::LightLayer& layer) {
    LightState next = lit.environment().state();
    if (index >= next.layers.size())
        throw std::out_of_range(
            fmt::format("expected one of {} layers, got number {}", next.layers.size(), index));
    next.layers[index] = layer;
    return lit.environment().edit(std::move(next));
}

UpdateReport set_rotation(LitScene& lit, double degrees, Ending ending) {
    LightState next = lit.environment().state();
    next.rotation_degrees = degrees;
    return lit.environment().edit(std::move(next), ending);
}

void mark(LitScene& lit) {
    lit.environment().edit(lit.environment().state(), Ending::Exact);
    lit.environment().history().mark(lit.environment().state());
}

void forget_history(LitScene& lit) {
    lit.environment().edit(lit.environment().state(), Ending::Exact);
    lit.environment().history().restart(lit.environment().state());
}

UpdateReport undo(LitScene& lit) {
    const LightState* before = lit.environment().history().undo(lit.environment().state());
    return before == nullptr ? UpdateReport() : lit.environment().edit(*before, Ending::Exact);
}

UpdateReport redo(LitScene& lit) {
    const LightState* after = lit.environment().history().redo();
    return after == nullptr ? UpdateReport() : lit.environment().edit(*after, Ending::Exact);
}

} // namespace relumine
