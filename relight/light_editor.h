// Lighting design: a base environment, light layers over it, and a scene that follows every change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/layers/layer_composite.h"
#include "cubemap/layers/light_layer.h"
#include "prt/transfer/transfer.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// Keeps a scene lit by base + layers. A change of layers is composited and relit only where it
/// falls: dirty rectangles per face, the quadtree's clusters under them, B += (L' - L) T_C [JN,
/// Section 5.2].
///
/// Memory:  an edit of a layer allocates kilobytes at most (the layers' geometry), nothing per
///          texel, cluster or receiver.
/// Threads: one writer at a time may call functions that are not const. Any thread may call
///          snapshot() at any moment, also while the writer works; a snapshot never shows half an
///          update.
class LightEditor {
public:
    /// Takes the arguments of Relighter. The transfer must outlive the editor.
    explicit LightEditor(const prt::Transfer& transfer, const ShadowRays& rays = {});
    /// Refuses a temporary transfer.
    explicit LightEditor(const prt::Transfer&& transfer, const ShadowRays& rays = {}) = delete;

    /// Replaces the base environment and relights everything. Layers stay. Marks made before any
    /// base was set take the first base.
    ///
    /// Throws:  std::invalid_argument for a map without texels, or a radiance that
    ///          require_radiance() refuses; nothing has changed then.
    RelightTimes set_base(std::shared_ptr<const cubemap::CubeMap> base);
    RelightTimes set_base(cubemap::CubeMap base) {
        return set_base(std::make_shared<const cubemap::CubeMap>(std::move(base)));
    }
    /// The base as given, unturned; null before the first. Every change of the base makes another
    /// object, so pointers tell bases apart.
    [[nodiscard]] const std::shared_ptr<const cubemap::CubeMap>& base() const { return base_; }

    /// Replaces the base by another of the same resolution and updates only the difference, found
    /// by comparing tiles of 16 x 16 texels. Under a rotation, or with another resolution,
    /// everything is relit. For files that another program saves again and again.
    ///
    /// Throws:  std::invalid_argument as set_base(); nothing has changed then.
    UpdateReport update_base(cubemap::CubeMap base);

    /// Turns base and layers together about +Y, from their unturned state, and relights everything.
    /// Layers keep the directions they were given, before the turn.
    ///
    /// Throws:  std::invalid_argument for an angle that is not finite.
    RelightTimes set_rotation(double degrees_about_y);
    [[nodiscard]] double rotation() const { return rotation_degrees_; }

    /// The layers, bottom first.
    [[nodiscard]] std::span<const cubemap::LightLayer> layers() const { return layers_; }

    /// Replaces the list in one update: added, removed, reordered or changed layers, any number.
    ///
    /// Throws:  std::invalid_argument for an invalid layer, or radiance above MaxRadiance; nothing
    ///          has changed then.
    UpdateReport set_layers(std::vector<cubemap::LightLayer> layers);

    /// Replaces one layer, for example while it is dragged.
    ///
    /// Throws:  std::invalid_argument as set_layers(); std::out_of_range for an index.
    UpdateReport set_layer(std::size_t index, const cubemap::LightLayer& layer);

    /// Marks the present layers, rotation and base as a state for undo() to return to. An edit
    /// without a mark is not in the history.
    ///
    /// Memory:  marks share the bases and pictures they have in common. A mark after a change of
    ///          layers takes about a kilobyte for each layer; a mark after a change of base takes a
    ///          whole map (6 R^2 x 12 bytes). When the history's bases, without the present one,
    ///          exceed the limit of limit_history(), the oldest marks are forgotten. The last mark
    ///          before the present one stays.
    void mark();
    /// Sets the limit in bytes; 1 GiB by default. It takes effect at the next mark.
    void limit_history(std::size_t bytes) { max_history_bytes_ = bytes; }
    /// Forgets all marks. The present state becomes the only mark.
    void forget_history();
    /// Goes back to the mark before, or forward again. The radiance is that at the mark, bit by
    /// bit. Returns an empty report where there is no such mark.
    UpdateReport undo();
    UpdateReport redo();
    [[nodiscard]] bool can_undo() const { return at_ > 0; }
    [[nodiscard]] bool can_redo() const { return at_ + 1 < history_.size(); }

    /// Lets light go on from surface to surface, as Relighter::set_bounces(). Edits show their
    /// direct light at once, with the bounces of the light before; settle() and step() bring the
    /// new ones. mark(), undo() and redo() settle.
    ///
    /// Throws:  as Relighter::set_bounces().
    void set_bounces(SurfaceBounces bounces);
    /// Finds all bounces, as Relighter::bounce(). Without set_bounces() or a base nothing happens.
    BounceReport settle(std::span<const glm::vec3> more = {});
    /// Goes one bounce on, as Relighter::step(), where light bounces and is_settled() is false.
    BounceReport step();
    [[nodiscard]] bool is_settled() const { return relighter_.is_settled(); }

    /// Radiance of all receivers after the last complete update, as Relighter::radiance(). For the
    /// writer's thread.
    ///
    /// Shape:   [num_receivers] in the receivers' order.
    [[nodiscard]] std::span<const glm::vec3> radiance() const { return relighter_.radiance(); }
    /// Copies the radiance, from any thread. `radiance` is resized to [num_receivers].
    void snapshot(std::vector<glm::vec3>& radiance) const;

    /// Base and layers together, turned as they light the scene.
    [[nodiscard]] const cubemap::CubeMap& environment() const { return relighter_.environment(); }
    [[nodiscard]] const Relighter& relighter() const { return relighter_; }
    /// Rectangles that hold every texel of environment() changed by the last editing call. mark()
    /// changes none.
    [[nodiscard]] std::span<const cubemap::TexelRectangle> changed_texels() const { return dirty_; }

private:
    /// The content of a mark.
    struct State {
        std::vector<cubemap::LightLayer> layers = {};
        double rotation_degrees = 0.0;
        std::shared_ptr<const cubemap::CubeMap> base = nullptr;
        /// Compares bases by their address.
        bool operator==(const State&) const = default;
    };
    /// Texels that a region touches.
    struct TouchedTexels {
        cubemap::Region region;
        std::uint32_t resolution;
        std::vector<cubemap::TexelRectangle> rectangles;
    };
    void forget_oldest();
    std::span<const cubemap::TexelRectangle> texels_of(const cubemap::LightLayer& layer);
    UpdateReport apply(std::span<const cubemap::LightLayer> layers);
    RelightTimes relight_all();
    UpdateReport update_dirty(const cubemap::CubeMap& base,
                              std::span<const cubemap::LightLayer> layers);
    UpdateReport go_to(std::size_t mark);
    void renew();
    [[nodiscard]] const cubemap::CubeMap& turned_base() const {
        return rotation_degrees_ == 0.0 ? *base_ : turned_base_;
    }
    void turn_base();
    void turn(std::span<const cubemap::LightLayer> layers,
              std::vector<cubemap::LightLayer>& turned) const;
    void publish();

    Relighter relighter_;
    /// As given, unturned.
    std::shared_ptr<const cubemap::CubeMap> base_;
    /// Empty without a rotation.
    cubemap::CubeMap turned_base_;
    double rotation_degrees_ = 0.0;
    /// As given, unturned.
    std::vector<cubemap::LightLayer> layers_;
    /// Turned, as they are composited.
    std::vector<cubemap::LightLayer> turned_layers_;
    /// Scratch of set_layer().
    cubemap::LightLayer next_layer_;
    /// Scratch: turned_layers_ after an edit.
    std::vector<cubemap::LightLayer> next_layers_;
    /// Rectangles without overlaps.
    std::vector<cubemap::TexelRectangle> dirty_;
    /// Scratch of apply(): the rectangles that changed layers cover.
    std::vector<cubemap::TexelRectangle> touched_;
    /// Of regions asked for last, oldest first: an edit often has the region of the edit before.
    std::vector<TouchedTexels> known_;
    std::vector<State> history_;
    /// Index of the present mark.
    std::size_t at_ = 0;
    std::size_t max_history_bytes_ = std::size_t{1} << 30;

    mutable std::shared_mutex published_mutex_;
    /// The radiance that snapshot() copies.
    std::vector<glm::vec3> published_;
    /// Filled without the lock, then swapped in.
    std::vector<glm::vec3> back_;
};

} // namespace relumine::relight
