// Light layers: what an artist puts over an environment.
//
// A layer is a region of directions with a soft edge, and an effect in this region: it adds light,
// it dims or tints the light below, or it places a picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/image_pyramid.h"
#include "cubemap/layers/region.h"

namespace relumine::cubemap {

/// Adds radiance times the coverage.
struct Emit {
    static constexpr std::string_view Name = "emit";
    /// Linear RGB, finite and not negative.
    glm::vec3 radiance{1.0f};
    bool operator==(const Emit&) const = default;
};

/// Multiplies the light below. The multiplier goes linearly from factor x tint at full coverage to
/// 1 at none.
struct Gain {
    static constexpr std::string_view Name = "gain";
    /// Finite and not negative, as is the tint.
    float factor = 1.0f;
    glm::vec3 tint{1.0f};
    bool operator==(const Gain&) const = default;
};

/// Places a picture on a Rectangle; other regions are refused. The picture is upright as seen from
/// the centre of the sphere.
struct ImagePatch {
    static constexpr std::string_view Name = "image";
    enum class Blend : std::uint8_t { Replace, Add };
    /// The picture's path as a layer file names it. Only `picture` is drawn.
    std::filesystem::path path;
    std::shared_ptr<const ImagePyramid> picture = nullptr;
    Blend blend = Blend::Replace;
    /// Compares pictures by their pixels.
    bool operator==(const ImagePatch& other) const;
};

/// What a layer does in its region.
using Effect = std::variant<Emit, Gain, ImagePatch>;

/// One layer: a region, an effect, and the strength of the effect.
struct LightLayer {
    std::string name;
    bool on = true;
    /// Where a layer that is on has it, only such layers shine, over black.
    bool solo = false;
    /// False: gives light, also to mirrors, and is not seen behind the scene.
    bool camera = true;
    /// Stops, in [-100, 100]. 2^gain_ev multiplies the radiance of Emit and ImagePatch, and the
    /// factor of Gain.
    double gain_ev = 0.0;
    /// Multiplies the same as gain_ev by kelvin_color(); 0 leaves the colour as it is.
    double kelvin = 0.0;
    Region region = Disc{};
    Effect effect = Emit{};
    bool operator==(const LightLayer&) const = default;
};

/// Checks a layer.
/// Throws:  std::invalid_argument `light layer "NAME": expected X, got Y` for anything the comments
///          above exclude.
void validate(const LightLayer& layer);

/// Returns the fields of a layer, in the order in which they are written: its own, those of its
/// region, then those of its effect. The pointers are valid until the region or the effect is
/// replaced.
[[nodiscard]] std::vector<LayerField> fields(LightLayer& layer);
[[nodiscard]] std::vector<LayerField> own_fields(LightLayer& layer);
[[nodiscard]] std::vector<LayerField> fields(Effect& effect);

/// Returns what multiplies a layer's radiance or factor: 2^gain_ev times the colour of its kelvin.
[[nodiscard]] glm::vec3 strength(const LightLayer& layer);

/// Returns true if a layer that is on has `solo`.
[[nodiscard]] bool has_solo(std::span<const LightLayer> layers);

/// Returns true if a layer gives light; `is_solo`: has_solo() of all layers.
[[nodiscard]] bool shines(const LightLayer& layer, bool is_solo);

/// Returns true if a layer that shines is not seen by the camera.
[[nodiscard]] bool hides_from_camera(std::span<const LightLayer> layers);

/// Returns what the camera sees of layers, without `solo`: as without_solo(), and layers that are
/// hidden from the camera are off.
[[nodiscard]] std::vector<LightLayer> seen_layers(std::span<const LightLayer> layers);

/// Returns layers that give the same light without `solo`. Under has_solo() the layers that do not
/// shine are off, and two more layers below all others make the environment black.
[[nodiscard]] std::vector<LightLayer> without_solo(std::span<const LightLayer> layers);

/// Returns "emit", "gain" or "image".
[[nodiscard]] std::string_view effect_name(const Effect& effect);

} // namespace relumine::cubemap
