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
#include "relight/pictures/picture.h"
#include "relumine/scene.h"

namespace relumine {

class LitScene;

using relight::Picture;

/// The mesh's own vertex colours as albedo.
struct MeshColors {};

/// Colours are no part of the transfer: one reflectance for all, or the mesh's colours. Scenes with
/// materials have theirs in the radiance already; the factor comes on top.
using Albedo = std::variant<glm::vec3, MeshColors>;

struct OutputOptions {
    Albedo albedo = glm::vec3(1.0f);
    /// Exposure in stops. save() applies it, draw() does not.
    double exposure_ev = 0.0;

    /// Size of the picture. Only for scenes of vertices, as are the camera and the rays below.
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    /// n x n rays a pixel
    std::uint32_t samples_per_axis = 3;
    /// Empty: camera_of() the scene.
    std::optional<Camera> camera = {};
    /// Vertical field of view of the automatic camera.
    float fov_degrees = 35.0f;

    /// Writes alpha in place of the background. Only for scenes of pixels.
    bool transparent = false;
    /// How many texels are filled around the charts. Only for scenes of texels.
    std::uint32_t gutter = 16;
};

/// Returns radiance times albedo, [num_receivers].
///
/// Throws:  std::invalid_argument for another number of radiances, for MeshColors of a mesh without
///          colours.
[[nodiscard]] std::vector<glm::vec3>
colors_of(const Scene& scene, std::span<const glm::vec3> radiance, const Albedo& albedo = {});

/// Draws and writes many pictures of one scene from one camera. What the camera sees is found once.
/// LitScene::draw() and save() are the short forms for one picture.
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

    /// What vertices look like from the camera, with the textures of the mesh where there are no
    /// highlights; the pixels' own picture; or the texels' lightmap.
    /// `radiance` as LitScene::radiance() has it; the environment is the background.
    [[nodiscard]] Picture draw(std::span<const glm::vec3> radiance,
                               const cubemap::CubeMap& environment);

    /// Radiance times albedo and exposure, [num_receivers]: what a .npy file holds.
    [[nodiscard]] std::vector<glm::vec3> values(std::span<const glm::vec3> radiance) const;

    /// Writes by extension: .png and .exr pictures, .ply and .glb meshes with vertex colours (only
    /// scenes of vertices), .npy numbers. Whole or not at all.
    void save(const std::filesystem::path& path, std::span<const glm::vec3> radiance,
              const cubemap::CubeMap& environment);

private:
    const Scene& scene_;
    const prt::RayScene& rays_;
    OutputOptions options_;
    /// Made when a second picture is drawn
    std::unique_ptr<relight::PictureView> view_;
    /// Of vertices without highlights.
    relight::SurfaceColors surface_colors_;
    bool drew_one_ = false;
};

/// Returns true if save() can write the path's extension for this scene: ".png", ".exr" and ".npy"
/// for all scenes, ".ply" and ".glb" for scenes of vertices. Capital letters are allowed.
[[nodiscard]] bool is_output_of(const std::filesystem::path& path, const Scene& scene);

/// Writes an environment as a lat-long picture: .exr (linear), or .png with the brightest
/// thousandth white, then exposed.
void save_map(const std::filesystem::path& path, const cubemap::CubeMap& map,
              double exposure_ev = 0.0);

} // namespace relumine
