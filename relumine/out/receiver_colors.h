// What receivers' radiance is multiplied with: albedo, for pictures, for numbers and for bounces.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relumine/in/scene.h"
#include "relumine/out/output_options.h"

namespace relumine {

/// Returns radiance times albedo and the emission, [num_receivers]. The floor has the albedo of the
/// mesh.
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

/// Returns what numbers (.npy) multiply each receiver's radiance with, [num_receivers]: 1 where the
/// options leave it open.
///
/// Throws:  as picture_albedo().
[[nodiscard]] std::vector<glm::vec3> computed_albedo(const Scene& scene,
                                                     const OutputOptions& options = {});

/// Throws:  std::invalid_argument unless there is a radiance for each receiver.
void require_fit(const Scene& scene, std::span<const glm::vec3> radiance);

/// Returns a times b, one by one; as many of each.
[[nodiscard]] std::vector<glm::vec3> product(std::span<const glm::vec3> a,
                                             std::span<const glm::vec3> b);

/// Adds to the first of the colours what there is of emission.
void add_emission(std::span<const glm::vec3> emission, std::vector<glm::vec3>& colors);

} // namespace relumine
