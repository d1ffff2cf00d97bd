// What lights a scene, as values: what is given, what edits make of it, and the states that undo
// goes back to.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <utility>
#include <variant>
#include <vector>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment_file.h"
#include "cubemap/layers/light_layer.h"
#include "lights/light_list.h"
#include "relight/binned_environment.h"
#include "relight/pictures/backdrop.h"
#include "relumine/in/environment.h"

namespace relumine {

using relight::BinnedEnvironment;

/// An environment, a list of distant lights, or both, whose light is added. Without either it is
/// dark.
struct Light {
    Light() = default;
    Light(cubemap::CubeMap map) : environment(std::move(map)) {}
    /// A map that others hold, too, is not copied.
    Light(std::shared_ptr<const cubemap::CubeMap> map, cubemap::EnvironmentFile of = {},
          std::filesystem::path from = {})
        : environment(std::move(map)), file(std::move(of)), path(std::move(from)) {}
    Light(Environment of)
        : environment(std::move(of.map)), file(std::move(of.file)), path(std::move(of.path)) {}
    /// An environment that bin() of the scene has summed. Clusters whose light stays are not summed
    /// again, so the last bits may differ from light of the map. `file` is what the map was made
    /// from.
    Light(BinnedEnvironment binned, cubemap::EnvironmentFile of = {})
        : environment(std::move(binned)), file(std::move(of)) {}
    Light(std::vector<lights::DistantLight> list) : lights(std::move(list)) {}

    std::variant<std::monostate, cubemap::CubeMap, std::shared_ptr<const cubemap::CubeMap>,
                 BinnedEnvironment>
        environment = {};
    /// The pixels that pictures show behind the mesh; without an image: those of the map.
    cubemap::EnvironmentFile file = {};
    std::filesystem::path path = {};
    /// Each has shadow rays of its own or, with LightOptions::clusters_only, its cluster's.
    std::vector<lights::DistantLight> lights = {};
};

/// The environment below layers. States share it.
class LightBase {
public:
    explicit LightBase(std::shared_ptr<const cubemap::CubeMap> map,
                       cubemap::EnvironmentFile file = {}, std::filesystem::path path = {})
        : map_(std::move(map)), file_(std::move(file)), path_(std::move(path)) {}

    /// Unturned. Null as long as nothing was edited: the scene's environment is the base then.
    [[nodiscard]] const std::shared_ptr<const cubemap::CubeMap>& map() const { return map_; }
    /// What it was made from; without an image where that is unknown.
    [[nodiscard]] const cubemap::EnvironmentFile& file() const { return file_; }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    /// The file's pixels; empty without a file. Made by the first call: to resample pictures of
    /// faces takes as long as to light a scene.
    [[nodiscard]] const relight::Backdrop& backdrop() const {
        std::call_once(once_, [&] { backdrop_ = relight::backdrop_of(file_); });
        return backdrop_;
    }

private:
    std::shared_ptr<const cubemap::CubeMap> map_;
    cubemap::EnvironmentFile file_;
    std::filesystem::path path_;
    mutable std::once_flag once_;
    mutable relight::Backdrop backdrop_;
};

/// Returns the base that an environment is.
[[nodiscard]] inline std::shared_ptr<const LightBase> base_of(Environment environment) {
    return std::make_shared<const LightBase>(
        std::make_shared<const cubemap::CubeMap>(std::move(environment.map)),
        std::move(environment.file), std::move(environment.path));
}

/// An environment with light layers over it, all of it turned.
struct LightState {
    /// Null under a list of lights.
    std::shared_ptr<const LightBase> base = nullptr;
    /// Bottom first, as they are before the turn.
    std::vector<cubemap::LightLayer> layers = {};
    /// About +Y.
    double rotation_degrees = 0.0;
    /// Whether the base's own pixels show behind the scene, changed by layers at most.
    [[nodiscard]] bool shows_base() const {
        return rotation_degrees == 0.0 && !cubemap::has_solo(layers);
    }
    /// Compares bases by their address.
    bool operator==(const LightState&) const = default;
};

/// States that undo and redo go to.
///
/// Memory:  states share the bases and pictures they have in common. A mark after a change of
///          layers takes about a kilobyte for each layer; a mark after a change of base takes a
///          whole map (6 R^2 x 12 bytes). When the bases, without the present one, exceed the
///          limit, the oldest marks are forgotten. The last mark before the present one stays.
class LightHistory {
public:
    /// Forgets all marks but this one.
    void restart(const LightState& first);
    /// Forgets the marks after the present one, and adds one of another state.
    void mark(const LightState& state);
    /// Returns the state to go back to: the present mark where `now` is another state, as after an
    /// edit without a mark; otherwise the mark before, which becomes the present one. Null where
    /// there is none.
    const LightState* undo(const LightState& now);
    /// Makes the mark after the present one that, and returns it; null where there is none.
    const LightState* redo() { return can_redo() ? &marks_[++at_] : nullptr; }
    /// Whether undo() would return a mark.
    [[nodiscard]] bool can_undo(const LightState& now) const { return at_ > 0 || is_unmarked(now); }
    [[nodiscard]] bool can_redo() const { return at_ + 1 < marks_.size(); }
    /// Sets the limit in bytes; 1 GiB by default. It takes effect at the next mark.
    void limit(std::size_t bytes) { max_bytes_ = bytes; }

private:
    [[nodiscard]] bool is_unmarked(const LightState& now) const;

    std::vector<LightState> marks_;
    /// Index of the present mark.
    std::size_t at_ = 0;
    std::size_t max_bytes_ = std::size_t{1} << 30;
};

} // namespace relumine
