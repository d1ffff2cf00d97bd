// What pictures, coloured meshes and numbers of a lit scene are made with. An option is a field
// here and its row in options_of().
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include <glm/vec3.hpp>

#include "relight/pictures/display_transform.h"
#include "relight/pictures/framing.h"
#include "relight/pictures/tone_curve.h"
#include "relumine/in/emission.h"
#include "relumine/in/scene.h"
#include "relumine/light/mirrors.h"
#include "relumine/options/option_words.h"

namespace relumine {

using relight::ToneCurve;

/// What the mesh says: its materials, or its vertex colours. Where it says nothing, and so that
/// pictures have no white plaster, 0.5 in pictures and colours; 1 in data (.npy, lightmaps).
struct AutomaticAlbedo {};

/// The mesh's own vertex colours as albedo.
struct MeshColors {};

/// Colours are no part of the transfer: one reflectance for all, or the mesh's colours. Scenes with
/// materials have theirs in the radiance already; the factor comes on top. A floor that was added
/// to the mesh has an albedo of its own.
using Albedo = std::variant<AutomaticAlbedo, glm::vec3, MeshColors>;

/// Where the shadows of lights smaller than their cluster, the sun above all, are traced.
enum class SunShadows {
    /// At every point that a picture of vertices shows.
    Pixels,
    /// At the receivers, as in meshes and numbers.
    Receivers,
};
inline constexpr std::array<std::string_view, 2> SunShadowsNames = {"pixel", "vertex"};
template<>
inline constexpr std::span<const std::string_view> WordsOf<SunShadows> = SunShadowsNames;
template<>
inline constexpr std::span<const std::string_view> WordsOf<ToneCurve> = relight::ToneCurveNames;

/// What a picture shows behind the mesh.
struct EnvironmentBehind {
    /// Width at half height of the blur; 0: sharp.
    double blur_degrees = 0.0;
};
/// Nothing: the picture has alpha.
struct NothingBehind {};
using Background = std::variant<EnvironmentBehind, NothingBehind, glm::vec3>;

/// How a picture shows the floor that was added to the mesh.
enum class FloorLook {
    /// Photo where the environment shows a ground (relight::has_ground()) or the background is
    /// plain, Studio where it does not, Grey without an environment.
    Automatic,
    /// What is behind, on the ground: the environment as if the mesh stood in it, darkened and
    /// tinted by what the mesh takes and sends.
    Photo,
    /// A plain floor that ends far away.
    Studio,
    /// A plain disc that fades out at the floor's edge.
    Grey,
};
inline constexpr std::array<std::string_view, 4> FloorLookNames = {"auto", "photo", "studio",
                                                                   "grey"};
template<>
inline constexpr std::span<const std::string_view> WordsOf<FloorLook> = FloorLookNames;

/// Where a camera stands that looks at a mesh, and its field of view.
struct CameraPlace {
    relight::CameraAngles angles = {};
    /// Vertical
    std::optional<float> fov_degrees = {};
};

struct OutputOptions {
    Albedo albedo = AutomaticAlbedo{};
    FloorLook floor = FloorLook::Automatic;
    /// Height of the camera that photographed the environment, above the floor, in the mesh's unit.
    /// Empty: the longest side of what stands on the floor.
    std::optional<float> photo_height = {};
    /// Albedo of an added floor that has no surface of its own. Empty: 0.3 in pictures and colours,
    /// 1 in data.
    std::optional<glm::vec3> floor_albedo = {};
    /// Factors on the light that the scene gives of its own. Pictures show them on what glows;
    /// LitScene::dim() lets the light follow.
    std::vector<EmissionGain> emission = {};
    /// Exposure in stops. Empty: what suits the lit surfaces that are seen, for .png, .ply and
    /// .glb; 0 for .exr and .npy. save() applies it, draw() does not.
    std::optional<double> exposure_ev = {};
    /// The tone curve of .png; all else stays linear.
    ToneCurve tone = ToneCurve::Neutral;
    /// The display transform of .png, in place of the tone curve, where it has a config.
    relight::DisplayView display = {};

    /// Size of the picture. Only for scenes of vertices, as are the camera and the rays below.
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    /// n x n rays a pixel
    std::uint32_t samples_per_axis = 3;
    /// In place of all that is said of the camera below
    std::optional<Camera> camera = {};
    /// Empty: camera_of() the scene, moved as `eye` and `target` say.
    std::optional<CameraPlace> camera_place = {};
    /// Among the coordinates of the mesh's file
    std::optional<glm::dvec3> eye = {};
    std::optional<glm::dvec3> target = {};
    std::optional<float> fov_degrees = {};
    SunShadows sun = SunShadows::Pixels;
    /// Rays that find what a pixel mirrors, where the scene has no highlights of its own; 0:
    /// surfaces are matte. Receivers on pixels take LightOptions::highlight_rays.
    std::uint32_t highlight_rays = DefaultHighlightRays;

    /// Not for scenes of texels.
    Background background = EnvironmentBehind{};
};

/// Throws OptionError for options that contradict each other.
void check(const OutputOptions& options);

/// Returns the camera of a picture. Throws as check() does.
[[nodiscard]] Camera camera_of(const Scene& scene, const OutputOptions& options);

/// Whether a picture looks from elsewhere than the eye that the highlights of a scene of vertices
/// are for. Highlights then stay where that eye sees them.
[[nodiscard]] bool is_other_eye(const Scene& scene, const OutputOptions& options);

// How the values are written

struct AlbedoText {
    static constexpr const char* Type = "TEXT";
    static Albedo read(const std::string& text);
    static std::string show(const Albedo& albedo);
};
struct BackgroundText {
    static constexpr const char* Type = "TEXT";
    static Background read(const std::string& text);
    static std::string show(const Background& background);
};
struct ExposureText {
    static constexpr const char* Type = "TEXT";
    static std::optional<double> read(const std::string& text);
    static std::string show(const std::optional<double>& stops);
};
struct CameraText {
    static constexpr const char* Type = "TEXT";
    static CameraPlace read(const std::string& text);
    static std::string show(const CameraPlace& place);
};
/// --size WIDTHxHEIGHT, each side from `min` (1) to prt::MaxPictureSize.
[[nodiscard]] OptionRow size_row(std::uint32_t& width, std::uint32_t& height, std::string help,
                                 OptionFacts facts);

/// All options of a picture.
[[nodiscard]] OptionTable options_of(OutputOptions& o);

} // namespace relumine
