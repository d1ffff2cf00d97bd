// What is seen behind a mesh.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"
#include "cubemap/image/environment_file.h"

namespace relumine::relight {

/// Where a direction falls in the image of a chart.
struct ChartSpot {
    /// In pixels from the top left one's centre.
    glm::dvec2 place{0.0};
    /// The part of the image that a plain colour hides.
    float hidden = 0.0f;
};

/// A backdrop as an image whose places follow the directions smoothly, but for a seam: what many
/// directions side by side see is found faster than one by one.
struct Chart {
    /// Columns go on at the other side where it is closed.
    std::shared_ptr<const cubemap::EnvironmentImage> image;
    bool is_closed = false;
    std::function<ChartSpot(const glm::vec3& direction)> spot;
    glm::vec3 hiding{0.0f};

    /// Returns what a spot shows.
    [[nodiscard]] glm::vec3 seen(const ChartSpot& at) const;
};

/// Returns the radiance that a ray of a unit direction finds. May be called from any number of
/// threads at once.
class Backdrop {
public:
    using Seen = std::function<glm::vec3(const glm::vec3& direction)>;

    /// Empty: nothing is known to be behind.
    Backdrop() = default;
    Backdrop(std::nullptr_t) {}
    template<typename Callable>
        requires(!std::is_same_v<Callable, Backdrop> && std::is_constructible_v<Seen, Callable>)
    Backdrop(Callable seen) : seen_(std::move(seen)) {}
    explicit Backdrop(Chart chart);

    [[nodiscard]] glm::vec3 operator()(const glm::vec3& direction) const {
        return seen_(direction);
    }
    [[nodiscard]] explicit operator bool() const { return static_cast<bool>(seen_); }
    /// Null: there is none.
    [[nodiscard]] const Chart* chart() const { return chart_.get(); }

private:
    Seen seen_;
    std::shared_ptr<const Chart> chart_;
};

[[nodiscard]] Backdrop plain_backdrop(const glm::vec3& color);

/// Shows a cube map, bilinear. The map must outlive the backdrop.
///
/// Throws:  std::invalid_argument for a map without texels.
[[nodiscard]] Backdrop map_backdrop(const cubemap::CubeMap& map);

/// Shows an image's own pixels, bilinear: as sharp as the file is. `turn` carries the image's axes
/// to the world's, as in cubemap::turned().
[[nodiscard]] Backdrop image_backdrop(std::shared_ptr<const cubemap::EnvironmentImage> image,
                                      const glm::dmat3& turn = glm::dmat3(1.0));

/// Shows the pixels of an environment's file, bilinear; empty where it has no image.
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

} // namespace relumine::relight
