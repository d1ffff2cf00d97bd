// Spherical harmonics of a lit scene as files: docs/harmonics.md.
#pragma once

#include <filesystem>

#include "relumine/light/lit_scene.h"

namespace relumine {

/// Writes LitScene::harmonics() by extension, whole or not at all.
///
/// - .npy: [num_receivers, order^2, 3] float32.
/// - .exr: a layer of RGB for each coefficient, by relight::HarmonicNames; the picture itself is
///   the radiance. Not for vertices. Lightmaps of texels also get the layers `direction` and
///   `direction_weight` of a directional lightmap.
/// - .json: three.js, a Group with a LightProbe at each point. Only for points and grids.
///
/// Throws:  std::invalid_argument for another extension, or one that does not fit the receivers;
///          as LitScene::harmonics(); std::runtime_error that names the path.
void save_harmonics(const LitScene& lit, const std::filesystem::path& path);

/// Throws as save_harmonics() for a path that does not fit the scene.
void require_harmonics_path(const std::filesystem::path& path, const Scene& scene);

} // namespace relumine
