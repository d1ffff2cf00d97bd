// Lit scenes as pictures, coloured meshes and numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/pictures/backdrop.h"
#include "relight/pictures/picture.h"
#include "relight/pictures/picture_view.h"
#include "relight/pictures/tone_curve.h"
#include "relight/relighter.h"
#include "relight/sharp/sharp_lights.h"
#include "relumine/scene.h"

namespace relumine {

class LitScene;

using relight::Picture;
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

/// What a picture shows behind the mesh.
struct EnvironmentBehind {
    /// Width at half height of the blur; 0: sharp.
    double blur_degrees = 0.0;
};
/// Nothing: the picture has alpha.
struct NothingBehind {};
using Background = std::variant<EnvironmentBehind, NothingBehind, glm::vec3>;

/// What a picture is drawn of: the light of a scene's receivers.
struct Lighting {
    /// [num_receivers], as LitScene::radiance().
    std::span<const glm::vec3> radiance;
    /// Must outlive this object. Null: there is nothing behind the mesh but black.
    const cubemap::CubeMap* environment = nullptr;
    /// The environment from its own pixels. Empty: from the cube map.
    relight::Backdrop sharp = {};
    /// The lights that are traced one by one, and [num_receivers] radiance without them. Empty:
    /// radiance has all light.
    std::vector<relight::SharpLight> lights = {};
    std::vector<glm::vec3> soft = {};
};

/// Returns the light of a Relighter, which must outlive it.
[[nodiscard]] Lighting lighting_of(const relight::Relighter& relighter);

struct OutputOptions {
    Albedo albedo = AutomaticAlbedo{};
    /// Of an added floor, where it has no surface of its own. Empty: 0.3 in pictures and colours, 1
    /// in data.
    std::optional<glm::vec3> floor_albedo = {};
    /// The outer part of an added floor's radius over which it fades into the background; 0: none.
    float floor_fade = 0.6f;
    /// Exposure in stops. Empty: what suits the lit surfaces that are seen, for .png, .ply and
    /// .glb; 0 for .exr and .npy. save() applies it, draw() does not.
    std::optional<double> exposure_ev = {};
    /// Of .png; all else stays linear.
    ToneCurve tone = ToneCurve::Neutral;

    /// Size of the picture. Only for scenes of vertices, as are the camera and the rays below.
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    /// n x n rays a pixel
    std::uint32_t samples_per_axis = 3;
    /// Empty: camera_of() the scene.
    std::optional<Camera> camera = {};
    SunShadows sun = SunShadows::Pixels;

    /// Not for scenes of texels.
    Background background = EnvironmentBehind{};
    /// How many texels are filled around the charts. Only for scenes of texels.
    std::uint32_t gutter = 16;
};

/// Returns radiance times albedo, [num_receivers]. The floor has the albedo of the mesh.
///
/// Throws:  std::invalid_argument for another number of radiances, for MeshColors of a mesh without
///          colours.
[[nodiscard]] std::vector<glm::vec3> colors_of(const Scene& scene,
                                               std::span<const glm::vec3> radiance,
                                               const Albedo& albedo = glm::vec3(1.0f));

/// Returns what pictures multiply each receiver's radiance with, [num_receivers].
///
/// Throws:  std::invalid_argument for MeshColors of a mesh without colours.
[[nodiscard]] std::vector<glm::vec3> picture_albedo(const Scene& scene,
                                                    const OutputOptions& options = {});

/// Returns the albedo with which light bounces, [num_receivers]: that of pictures, also for texels,
/// which themselves stay for albedo 1.
///
/// Throws:  as picture_albedo().
[[nodiscard]] std::vector<glm::vec3> bounce_albedo(const Scene& scene,
                                                   const OutputOptions& options = {});

/// Returns how pictures fade the added floor out.
[[nodiscard]] relight::FadingFloor picture_floor(const Scene& scene,
                                                 const OutputOptions& options = {});

/// Draws and writes many pictures of one scene from one camera. What the camera sees is found once,
/// and one exposure is chosen for all. LitScene::draw() and save() are the short forms for one
/// picture.
///
/// Throws:  std::invalid_argument where radiance does not fit the scene, an environment has no
///          texels, a camera has no direction, or the path's extension does not fit (save());
///          std::runtime_error naming a path that cannot be written.
/// Threads: one thread at a time.
class Painter {
public:
    /// The scene must outlive the Painter; it may be moved meanwhile.
    Painter(const LitScene& lit, const OutputOptions& options);
    Painter(LitScene&&, const OutputOptions&) = delete;
    ~Painter();
    Painter(Painter&&) noexcept;

    /// What vertices look like from the camera, with the textures of the mesh where there are no
    /// highlights; the pixels' own picture; or the texels' lightmap.
    [[nodiscard]] Picture draw(const Lighting& lighting);

    /// Radiance times albedo and exposure, [num_receivers]: what a .npy file holds.
    [[nodiscard]] std::vector<glm::vec3> values(std::span<const glm::vec3> radiance) const;

    /// Writes by extension: .png and .exr pictures, .ply and .glb meshes with vertex colours (only
    /// scenes of vertices), .npy numbers. Whole or not at all.
    void save(const std::filesystem::path& path, const Lighting& lighting);

    /// Returns true if the exposure of files with this extension is yet to be chosen.
    [[nodiscard]] bool needs_light_for(const std::filesystem::path& path) const;

    /// Takes light into account when the exposure is chosen, for sequences. Without any, the first
    /// file to be saved decides. Nothing once it is chosen.
    void meter(const Lighting& lighting);

    /// Returns the exposure that suits what was metered, or this light where nothing was, and keeps
    /// to it.
    [[nodiscard]] double choose_exposure_ev(const Lighting& lighting);

    /// Keeps to an exposure that was chosen before.
    void set_exposure_ev(double ev);

    /// Returns the exposure of files with this extension; 0 before it is chosen.
    [[nodiscard]] double exposure_ev(const std::filesystem::path& path) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Returns true if save() can write the path's extension for this scene: ".png", ".exr" and ".npy"
/// for all scenes, ".ply" and ".glb" for scenes of vertices. Capital letters are allowed.
[[nodiscard]] bool is_output_of(const std::filesystem::path& path, const Scene& scene);

/// Writes an environment as a lat-long picture: .exr (linear), or .png with the brightest
/// thousandth white, then exposed.
void save_map(const std::filesystem::path& path, const cubemap::CubeMap& map,
              double exposure_ev = 0.0);

} // namespace relumine
