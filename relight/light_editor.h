// Lighting design: a base environment, light layers over it, and a scene that follows every change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/layers/layer_composite.h"
#include "cubemap/layers/light_layer.h"
#include "prt/transfer.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// Keeps a scene lit by base + layers. A change of layers is composited and relit only where it
/// falls: dirty rectangles per face, the quadtree's clusters under them, B += (L' - L) T_C [JN,
/// Section 5.2]. An edit of a layer allocates kilobytes at most (the layers' geometry), nothing per
/// texel, cluster or receiver.
///
/// Threads: one writer at a time may call what is not const. snapshot() may be called from any
/// thread at any moment, while the writer works too; it never sees half an update.
class LightEditor {
public:
    /// Arguments as for Relighter; the transfer must outlive the editor.
    explicit LightEditor(const prt::Transfer& transfer, const ShadowRays& rays = {});
    /// Refuses a temporary transfer.
    explicit LightEditor(const prt::Transfer&& transfer, const ShadowRays& rays = {}) = delete;

    /// Replaces the base environment and relights everything. Layers stay. The first base becomes
    /// that of all marks before it. Throws std::invalid_argument for a map without texels or a
    /// radiance that require_radiance() refuses; nothing has changed then.
    RelightTimes set_base(cubemap::CubeMap base);
    /// The base as given, unturned; null before the first. Another object after every change of it,
    /// so that pointers tell bases apart.
    [[nodiscard]] const std::shared_ptr<const cubemap::CubeMap>& base() const { return base_; }

    /// Replaces the base by another of the same resolution and updates only what differs, as found
    /// by comparing tiles of 16 x 16 texels (where a rotation or another resolution stands in the
    /// way: everything). For files that another program saves again and again.
    UpdateReport update_base(cubemap::CubeMap base);

    /// Turns base and layers together about +Y, from their unturned state, and relights everything.
    /// Layers keep the directions they were given; those are before the turn.
    RelightTimes set_rotation(double degrees_about_y);
    [[nodiscard]] double rotation() const { return rotation_degrees_; }

    /// The layers, bottom first.
    [[nodiscard]] std::span<const cubemap::LightLayer> layers() const { return layers_; }

    /// Replaces the list: added, removed, reordered or changed layers, any number, in one update.
    /// Throws std::invalid_argument for a layer that is not valid or radiance above MaxRadiance;
    /// nothing has changed then.
    UpdateReport set_layers(std::vector<cubemap::LightLayer> layers);

    /// Replaces one layer, as while it is dragged. Throws std::invalid_argument as above,
    /// std::out_of_range for an index.
    UpdateReport set_layer(std::size_t index, const cubemap::LightLayer& layer);

    /// Marks the present layers, rotation and base as a state that undo() comes back to. An edit
    /// without a mark is not in the history.
    ///
    /// Memory: marks share the bases and pictures they have in common, so a mark after a change of
    /// layers takes a kilobyte or so for each layer and one after a change of base a whole map (6
    /// R^2 x 12 bytes). When the history's bases, without the present one, come to more than
    /// limit_history() allows, the oldest marks are forgotten; the last before the present stays.
    void mark();
    /// Bytes; 1 GiB unless told. Counts from the next mark on.
    void limit_history(std::size_t bytes) { max_history_bytes_ = bytes; }
    /// Forgets all marks but the present state, which becomes the only one.
    void forget_history();
    /// Back to the mark before, or forward again; the radiance is bitwise what it was at the mark.
    /// An empty report when there is none.
    UpdateReport undo();
    UpdateReport redo();
    [[nodiscard]] bool can_undo() const { return at_ > 0; }
    [[nodiscard]] bool can_redo() const { return at_ + 1 < history_.size(); }

    /// Radiance (albedo 1) of all receivers after the last complete update, [num_receivers] in the
    /// receivers' order. For the writer's thread.
    [[nodiscard]] std::span<const glm::vec3> radiance() const { return relighter_.radiance(); }
    /// Copies it, from any thread. `radiance` is resized to [num_receivers].
    void snapshot(std::vector<glm::vec3>& radiance) const;

    /// Base and layers together, as they light the scene (turned).
    [[nodiscard]] const cubemap::CubeMap& environment() const { return relighter_.environment(); }
    [[nodiscard]] const Relighter& relighter() const { return relighter_; }
    /// Rectangles that hold every texel of environment() that the last call which edits has
    /// changed; mark() changes none.
    [[nodiscard]] std::span<const cubemap::TexelRectangle> changed_texels() const { return dirty_; }

private:
    /// What a mark holds.
    struct State {
        std::vector<cubemap::LightLayer> layers = {};
        double rotation_degrees = 0.0;
        std::shared_ptr<const cubemap::CubeMap> base = nullptr;
        /// Bases by their address
        bool operator==(const State&) const = default;
    };
    void forget_oldest();
    UpdateReport apply(std::span<const cubemap::LightLayer> layers);
    RelightTimes relight_all();
    UpdateReport update_dirty(const cubemap::CubeMap& base,
                              std::span<const cubemap::LightLayer> layers);
    UpdateReport go_to(std::size_t mark);
    [[nodiscard]] const cubemap::CubeMap& turned_base() const {
        return rotation_degrees_ == 0.0 ? *base_ : turned_base_;
    }
    void turn_base();
    void turn(std::span<const cubemap::LightLayer> layers,
              std::vector<cubemap::LightLayer>& turned) const;
    void publish();

    Relighter relighter_;
    /// As given
    std::shared_ptr<const cubemap::CubeMap> base_;
    /// Empty while there is no rotation
    cubemap::CubeMap turned_base_;
    double rotation_degrees_ = 0.0;
    /// As given
    std::vector<cubemap::LightLayer> layers_;
    /// As they are composited
    std::vector<cubemap::LightLayer> turned_layers_;
    /// Scratch of set_layer()
    cubemap::LightLayer next_layer_;
    /// Scratch: the same after an edit
    std::vector<cubemap::LightLayer> next_layers_;
    /// Without overlaps
    std::vector<cubemap::TexelRectangle> dirty_;
    /// Scratch of apply(): what the changed layers cover
    std::vector<cubemap::TexelRectangle> touched_;
    std::vector<State> history_;
    /// The history's present
    std::size_t at_ = 0;
    std::size_t max_history_bytes_ = std::size_t{1} << 30;

    mutable std::shared_mutex published_mutex_;
    /// What snapshot() copies
    std::vector<glm::vec3> published_;
    /// Filled outside of the lock, then swapped in
    std::vector<glm::vec3> back_;
};

} // namespace relumine::relight
