// Which texels an edit of light layers changes, and what becomes of them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cubemap/cube_map.h"
#include "cubemap/layers/layer_composite.h"
#include "cubemap/layers/light_layer.h"
#include "relumine/light/light.h"

namespace relumine {

/// Puts the layers of a LightState over its base. A change of layers is composited only where it
/// falls: dirty rectangles per face.
///
/// Memory:  an edit of a layer allocates kilobytes at most (the layers' geometry), nothing per
///          texel.
class LayerCompositor {
public:
    LayerCompositor() = default;
    /// The state must have a base with a map. One that turns may be written over `memory`, as
    /// take_turned() returns it.
    explicit LayerCompositor(const LightState& state, cubemap::CubeMap memory = {});
    /// With a base that was turned already.
    LayerCompositor(const LightState& state, std::shared_ptr<const cubemap::CubeMap> turned_base);

    [[nodiscard]] bool is_set() const { return now_.base != nullptr; }

    /// Gives away the turned base, if it made one that nobody else holds; nothing else may be asked
    /// of it then.
    [[nodiscard]] cubemap::CubeMap take_turned();

    /// Returns the base, turned, where no layer lies over it; otherwise null.
    [[nodiscard]] std::shared_ptr<const cubemap::CubeMap> base_alone();

    /// Returns base and layers together, turned. `memory` may be written over, as
    /// cubemap::written_over() says.
    [[nodiscard]] cubemap::CubeMap whole(cubemap::CubeMap memory = {});

    /// Finds what differs in another state of the same turn, and without one the base may be
    /// another of the same resolution; its changes are found by comparing tiles of 16 x 16 texels.
    /// Rectangles do not overlap; changed() has them until the next call.
    ///
    /// Throws:  std::invalid_argument for a new base that require_radiance() refuses.
    void find_changes(const LightState& next);
    [[nodiscard]] std::span<const cubemap::TexelRectangle> changed() const { return changed_; }
    /// Makes the changed texels those of the other state.
    ///
    /// Throws:  std::invalid_argument where layers are too bright together; the environment is as
    ///          it was then.
    void composite(cubemap::CubeMap& environment) const;
    /// The other state becomes the present one.
    void accept();

private:
    /// Texels that a region touches.
    struct TouchedTexels {
        cubemap::Region region;
        std::uint32_t resolution;
        std::vector<cubemap::TexelRectangle> rectangles;
    };
    /// What is composited.
    struct Turned {
        std::shared_ptr<const cubemap::CubeMap> base = nullptr;
        std::vector<cubemap::LightLayer> layers = {};
    };
    [[nodiscard]] std::span<const cubemap::TexelRectangle>
    texels_of(const cubemap::LightLayer& layer);
    void turn_layers(const LightState& state, std::vector<cubemap::LightLayer>& turned) const;

    double rotation_degrees_ = 0.0;
    /// Null where the base does not turn or was turned before.
    std::shared_ptr<cubemap::CubeMap> turned_base_;
    Turned now_;
    Turned next_;
    std::vector<cubemap::TexelRectangle> changed_;
    /// Scratch: the rectangles that changed layers cover.
    std::vector<cubemap::TexelRectangle> touched_;
    /// The texels of the regions that were asked for last, oldest first: an edit often has the
    /// region of the edit before.
    std::vector<TouchedTexels> known_;
};

/// Returns what the camera sees of a state's environment. Null where it sees all that gives light.
///
/// Cost:    O(texels) where layers are hidden, nothing elsewhere.
[[nodiscard]] std::shared_ptr<const cubemap::CubeMap> seen_environment(const LightState& state);

} // namespace relumine
