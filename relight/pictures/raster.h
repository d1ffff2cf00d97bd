// What a camera's samples see, by projecting triangles in place of tracing rays.
//
// Based on: M. Olano and T. Greer, "Triangle scan conversion using 2D homogeneous coordinates",
// 1997. Differs from it: sums are in double for each triangle, and rows of samples are cut by the
// edges in place of testing each sample.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/camera.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/coplanar_faces.h"
#include "prt/visibility/ray_scene.h"
#include "prt/visibility/twin_triangles.h"

namespace relumine::relight {

/// The point where a sample's ray meets the mesh.
struct EyeSample {
    static constexpr std::uint32_t NoTriangle = ~std::uint32_t{0};
    std::uint32_t triangle = NoTriangle;
    /// Weights of the triangle's second and third vertex.
    float second = 0.0f, third = 0.0f;

    [[nodiscard]] bool hits() const { return triangle != NoTriangle; }
    [[nodiscard]] prt::MeshPoint point() const {
        return {.triangle = triangle, .barycentric = {second, third}};
    }
};

/// [left, right) x [top, bottom)
struct PixelRectangle {
    std::uint32_t left = 0, top = 0, right = 0, bottom = 0;
    [[nodiscard]] std::size_t width() const { return right - left; }
    [[nodiscard]] std::size_t size() const { return width() * (bottom - top); }
};

/// A picture cut into squares.
struct PictureTiles {
    /// Pixels on a side: small enough for the caches, large enough that a ring of pixels around it
    /// is a small part of the work.
    static constexpr std::uint32_t Size = 32;
    /// Tiles are found with at most so many pixels around them.
    static constexpr std::uint32_t LargestRing = 3;

    std::uint32_t width = 0, height = 0;

    [[nodiscard]] std::uint32_t columns() const { return (width + Size - 1) / Size; }
    [[nodiscard]] std::uint32_t rows() const { return (height + Size - 1) / Size; }
    [[nodiscard]] std::uint32_t count() const { return columns() * rows(); }
    /// The pixels of a tile and of a ring around it.
    [[nodiscard]] PixelRectangle pixels(std::uint32_t tile, std::uint32_t ring) const {
        const std::uint32_t x = tile % columns() * Size, y = tile / columns() * Size;
        return {x - std::min(x, ring), y - std::min(y, ring), std::min(x + Size + ring, width),
                std::min(y + Size + ring, height)};
    }
};

/// The triangles before a camera, dealt out to the tiles of its picture.
///
/// Finds the nearest triangle of each sample as rays do, but for samples that an edge passes within
/// a few thousandths of a sample's width.
class Raster {
public:
    /// All must outlive this object.
    ///
    /// Cost:    O(triangles), some 30 ns each; 4 bytes for each triangle and tile that it touches.
    Raster(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
           const prt::TwinTriangles& twins, const glm::vec3& eye, const prt::PictureRays& grid,
           const PictureTiles& tiles);

    /// Finds what pixels of a tile, and up to PictureTiles::LargestRing around it, see. Returns
    /// false, and finds nothing, where rays may pass one of the tile's triangles.
    ///
    /// Shape:   samples is [pixels][samples per pixel], row by row.
    [[nodiscard]] bool find(std::uint32_t tile, const PixelRectangle& pixels,
                            std::span<EyeSample> samples) const;

private:
    /// [left, right) x [top, bottom) of tiles.
    struct TileRange {
        std::uint16_t left = 0, top = 0, right = 0, bottom = 0;
    };
    struct Planes;
    struct Box;
    class Depths;

    [[nodiscard]] Planes planes_of(std::uint32_t triangle) const;
    [[nodiscard]] Box box_of(std::uint32_t triangle) const;
    [[nodiscard]] TileRange tiles_of(const Box& box) const;
    [[nodiscard]] bool meets(const Planes& planes, std::size_t tile) const;
    void deal();
    [[nodiscard]] EyeSample sample(std::uint32_t triangle, const Planes& planes, double x,
                                   double y) const;

    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    const prt::TwinTriangles& twins_;
    PictureTiles tiles_;
    std::uint32_t per_axis_;
    glm::dvec3 eye_, forward_;
    /// Direction of the sample in the top left corner, and the steps to the next ones; at distance
    /// 1.
    glm::dvec3 first_, right_, down_;
    /// 1 over the squares of the steps' lengths.
    double over_right_ = 0.0, over_down_ = 0.0;
    prt::CoplanarFaces coplanar_;
    /// [num_tiles + 1] where each tile's triangles begin, and the triangles, ascending.
    std::vector<std::size_t> begins_;
    std::vector<std::uint32_t> triangles_;
};

} // namespace relumine::relight
