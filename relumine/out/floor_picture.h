// How pictures show the floor that was added to a mesh.
#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "relight/pictures/backdrop.h"
#include "relight/pictures/ground.h"
#include "relight/pictures/picture_view.h"
#include "relumine/in/scene.h"
#include "relumine/light/lighting.h"
#include "relumine/out/output_options.h"

namespace relumine {

/// Albedo of a floor that no option gives one.
inline constexpr float FloorAlbedo = 0.3f;

/// Returns how pictures fade the added floor out.
[[nodiscard]] relight::FadingFloor picture_floor(const Scene& scene);

/// Returns the ground that the environment is projected to, under an added floor.
///
/// Throws:  std::invalid_argument for a scene without a floor.
[[nodiscard]] relight::Ground picture_ground(const Scene& scene, const OutputOptions& options = {});

/// Returns how pictures show the added floor in a light; never FloorLook::Automatic. A floor with a
/// surface of its own is Grey, and so is one whose light is unknown.
[[nodiscard]] FloorLook floor_look(const Scene& scene, const Lighting& lighting,
                                   const OutputOptions& options = {});

/// Returns relight::MeshLight::open_floor for an eye: empty for a Grey floor, black below the
/// floor, which is not to be seen from there.
[[nodiscard]] std::optional<glm::vec3> open_floor(const Scene& scene, const Lighting& lighting,
                                                  FloorLook look, const glm::vec3& eye);

/// Returns a backdrop as an eye sees it on and around an added floor.
[[nodiscard]] relight::Backdrop on_floor(relight::Backdrop backdrop, const Scene& scene,
                                         const Lighting& lighting, FloorLook look,
                                         const glm::vec3& eye, const OutputOptions& options = {});

/// Returns the colour of a Studio floor.
[[nodiscard]] glm::vec3 studio_color(const Lighting& lighting, const OutputOptions& options = {});

} // namespace relumine
