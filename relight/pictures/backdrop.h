// What is seen behind a mesh.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"
#include "cubemap/image/environment_file.h"
#include "prt/receivers/camera.h"

namespace relumine::relight {

/// Returns the radiance that a ray of a unit direction finds. May be called from any number of
/// threads at once.
using Backdrop = std::function<glm::vec3(const glm::vec3& direction)>;

[[nodiscard]] Backdrop plain_backdrop(const glm::vec3& color);

/// Shows a cube map, bilinear. The map must outlive the backdrop.
///
/// Throws:  std::invalid_argument for a map without texels.
[[nodiscard]] Backdrop map_backdrop(const cubemap::CubeMap& map);

/// Shows an image's own pixels, bilinear: as sharp as the file is. `turn` carries the image's axes
/// to the world's, as in cubemap::turned().
[[nodiscard]] Backdrop image_backdrop(std::shared_ptr<const cubemap::EnvironmentImage> image,
                                      const glm::dmat3& turn = glm::dmat3(1.0));

/// The same for an environment's file; empty where there is none.
[[nodiscard]] Backdrop backdrop_of(const cubemap::EnvironmentFile& file);

/// Shows what an edit made of a sharp backdrop: darker in proportion where the edited map is darker
/// than the base, brighter by the difference where it is brighter. So what was not edited stays as
/// sharp as it was. The maps must outlive the backdrop.
[[nodiscard]] Backdrop edited_backdrop(Backdrop sharp, const cubemap::CubeMap& base,
                                       const cubemap::CubeMap& edited);

/// Shows a cube map out of focus: under a Gaussian whose width at half height is `degrees`, in
/// (0, 180].
///
/// Cost:    O(1 / degrees^2): a tenth of a second at 5 degrees.
[[nodiscard]] Backdrop blurred_backdrop(const cubemap::CubeMap& map, double degrees);

/// Returns what a pixel shows of a backdrop: the mean over its samples, of which each lets through
/// what `passed` says, [samples per pixel].
///
/// Where the corners of an open pixel see nearly the same, nothing else is asked: most pixels are
/// narrower than the photograph's, which has nothing in between then.
[[nodiscard]] glm::vec3 seen_behind(const prt::PictureRays& rays, std::uint32_t x, std::uint32_t y,
                                    std::span<const glm::vec3> passed, const Backdrop& backdrop);

} // namespace relumine::relight
