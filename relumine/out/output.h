// Lit scenes as pictures, coloured meshes and numbers.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/pictures/backdrop.h"
#include "relight/pictures/picture.h"
#include "relight/pictures/picture_view.h"
#include "relumine/in/scene.h"
#include "relumine/light/lighting.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/floor_picture.h"
#include "relumine/out/output_options.h"
#include "relumine/out/receiver_colors.h"

namespace relumine {

using relight::Picture;

/// Draws and writes many pictures of one scene from one camera. What the camera sees is found once,
/// and one exposure is chosen for all. draw() and save() of a LitScene are the short forms for one
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

    /// Tells from now on how much of a picture of vertices is drawn; one call at a time, from any
    /// thread.
    void on_progress(std::function<void(double)> told);

    /// What vertices look like from the camera, with the textures of the mesh under the highlights;
    /// the pixels' own picture; or the texels' lightmap.
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

    /// Looks from another camera from now on. Only for scenes of vertices.
    void look_from(const Camera& camera);
    /// Dims and colours what the scene's lamps show of their own light, as LitScene::dim() does
    /// with what they give.
    void dim(std::vector<EmissionGain> gains);

    /// Lets rays that gather the light of rooms look where the next picture's light is, also in all
    /// pictures after it: those of its parts add up to it. Or ends that.
    void keep_guide(bool is_kept);

    /// Keeps to an exposure that was chosen before.
    void set_exposure_ev(double ev);

    /// Returns the exposure of files with this extension; 0 before it is chosen.
    [[nodiscard]] double exposure_ev(const std::filesystem::path& path) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The scene in its light. For many pictures of one view see Painter.
///
/// Throws:  as Painter; std::logic_error before the first light().
[[nodiscard]] Picture draw(const LitScene& lit, const OutputOptions& options = {});
/// Writes the lit scene by extension, as Painter::save().
void save(const LitScene& lit, const std::filesystem::path& path,
          const OutputOptions& options = {});

/// Returns true if save() can write the path's extension for this scene: ".png", ".exr" and ".npy"
/// for all scenes, ".ply" and ".glb" for scenes of vertices. Capital letters are allowed.
[[nodiscard]] bool is_output_of(const std::filesystem::path& path, const Scene& scene);

/// Writes an environment as a lat-long picture: .exr (linear), or .png with the brightest
/// thousandth white, then exposed.
void save_map(const std::filesystem::path& path, const cubemap::CubeMap& map,
              double exposure_ev = 0.0);

} // namespace relumine
