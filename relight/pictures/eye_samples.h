// What the samples of a picture's pixels see.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/camera.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/ray_scene.h"
#include "prt/visibility/twin_triangles.h"
#include "relight/pictures/raster.h"
#include "relight/pictures/seen_mesh.h"

namespace relumine::relight {

/// The samples of a rectangle of pixels.
class SampleRectangle {
public:
    /// `samples` begin with those of the rectangle's first pixel; rows are `stride` samples apart.
    SampleRectangle(const PixelRectangle& pixels, std::size_t per_pixel,
                    std::span<const EyeSample> samples, std::size_t stride)
        : pixels_(pixels), per_pixel_(per_pixel), stride_(stride), samples_(samples) {}
    /// Keeps samples of its own, row by row.
    SampleRectangle(const PixelRectangle& pixels, std::size_t per_pixel,
                    std::vector<EyeSample> samples)
        : pixels_(pixels), per_pixel_(per_pixel), stride_(pixels.width() * per_pixel),
          own_(std::move(samples)), samples_(own_) {}
    SampleRectangle(SampleRectangle&&) noexcept = default;

    [[nodiscard]] const PixelRectangle& pixels() const { return pixels_; }
    [[nodiscard]] std::span<const EyeSample> pixel(std::uint32_t x, std::uint32_t y) const {
        return samples_.subspan(
            (y - pixels_.top) * stride_ + std::size_t{x - pixels_.left} * per_pixel_, per_pixel_);
    }
    [[nodiscard]] const EyeSample& middle(std::uint32_t x, std::uint32_t y) const {
        return pixel(x, y)[per_pixel_ / 2];
    }

private:
    PixelRectangle pixels_;
    std::size_t per_pixel_, stride_;
    std::vector<EyeSample> own_;
    std::span<const EyeSample> samples_;
};

/// Finds what a camera's samples see, tile by tile: by projecting the triangles where all of a tile
/// stop the eye's rays, by rays elsewhere, or where there are many more triangles than samples.
class EyeSamples {
public:
    /// Keeps what is found, 12 bytes a sample, if it comes to at most `max_bytes`; finds it anew
    /// each time otherwise. `rays` say where an eye's rays stop. Both must outlive this object.
    ///
    /// Cost:    O(triangles), and of all samples where they are kept.
    EyeSamples(const SeenMesh& mesh, const prt::RayScene& rays, const glm::vec3& eye,
               const prt::PictureRays& grid, const PictureTiles& tiles, std::size_t max_bytes,
               const std::stop_token& stop);

    /// Returns what a tile and `ring` pixels around it see; at most PictureTiles::LargestRing.
    ///
    /// Threads: may be called from any number of threads at once.
    [[nodiscard]] SampleRectangle of(std::uint32_t tile, std::uint32_t ring) const;

    [[nodiscard]] const prt::TwinTriangles& twins() const { return *twins_; }

private:
    void find(std::uint32_t tile, const PixelRectangle& pixels, std::span<EyeSample> samples) const;
    void trace(const PixelRectangle& pixels, std::span<EyeSample> samples) const;

    const SeenMesh& mesh_;
    glm::vec3 eye_;
    prt::PictureRays grid_;
    PictureTiles tiles_;
    /// The other side of surfaces that the mesh has twice.
    std::unique_ptr<const prt::TwinTriangles> twins_;
    std::optional<Raster> raster_;
    /// [height * width * samples per pixel]; empty when they are found anew.
    std::vector<EyeSample> kept_;
};

} // namespace relumine::relight
