// What the receivers of a scene are: vertices of its mesh, pixels of a picture, texels of a
// lightmap, or points in space. Each kind answers for itself.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/receivers/camera.h"

namespace relumine::prt {

/// What holds for all layouts of a kind.
struct ReceiverKind {
    /// The name of its receivers, in files and options.
    std::string_view name;
    /// One receiver.
    std::string_view one;
    /// What its receivers are a part of.
    std::string_view whole;
    /// They are the mesh's vertices: any camera can look at them, values between them are
    /// interpolated, and files of meshes hold them.
    bool are_vertices = false;
    /// A picture of them is what an eye sees: in colours, with a background.
    bool are_seen = true;
    /// They lie on the mesh and have its normals; otherwise they are points in space.
    bool have_surface = true;
};

/// The size of a picture or a lightmap; 0 x 0 for vertices.
struct PlaceGrid {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t samples_per_axis = 1;
};

/// Receiver i is vertex i of the mesh.
struct VertexLayout {
    static constexpr ReceiverKind Kind{
        .name = "vertices", .one = "vertex", .whole = "the mesh", .are_vertices = true};
    bool operator==(const VertexLayout&) const = default;

    [[nodiscard]] static PlaceGrid grid() { return {}; }
    [[nodiscard]] static std::vector<std::uint32_t>* places() { return nullptr; }
    [[nodiscard]] static const Camera* own_camera() { return nullptr; }
    static void members(auto&) {}
};

/// Receivers are the points where the rays of a picture first meet the mesh. The other samples see
/// the background.
struct PixelLayout {
    static constexpr ReceiverKind Kind{
        .name = "pixels", .one = "pixel sample", .whole = "its samples"};
    /// Samples of a pixel that may share receivers, in all and on a side.
    static constexpr std::uint32_t EdgeSamplesPerAxis = 4;
    static constexpr std::uint32_t EdgeSamples = EdgeSamplesPerAxis * EdgeSamplesPerAxis;
    Camera camera = {};
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// n: each pixel has n x n samples.
    std::uint32_t samples_per_axis = 1;
    /// [num_receivers] ascending: the sample of each receiver; several where surfaces are seen
    /// through, nearest first. Samples count pixel by pixel, row by
    /// row from the top, n^2 to a pixel.
    std::vector<std::uint32_t> samples = {};
    /// [num_receivers], or empty where each receiver stands for its sample alone: which samples of
    /// its pixel a receiver stands for, a bit each. The lowest is its own in `samples`.
    std::vector<std::uint16_t> shares = {};

    [[nodiscard]] std::size_t samples_per_pixel() const {
        return std::size_t{samples_per_axis} * samples_per_axis;
    }
    /// Returns how many samples a receiver stands for.
    [[nodiscard]] std::size_t num_shown(std::size_t receiver) const {
        return shares.empty() ? 1 : static_cast<std::size_t>(std::popcount(shares[receiver]));
    }
    /// Returns how many receivers an even pixel has on a side.
    [[nodiscard]] std::uint32_t receivers_per_axis() const {
        return shares.empty() ? samples_per_axis : 1;
    }
    /// Whether `shares` are empty, or sets of samples that do not meet but for layers.
    [[nodiscard]] bool have_shares_that_fit() const;
    [[nodiscard]] std::size_t num_samples() const {
        return std::size_t{width} * height * samples_per_pixel();
    }
    bool operator==(const PixelLayout&) const = default;

    [[nodiscard]] PlaceGrid grid() const { return {width, height, samples_per_axis}; }
    [[nodiscard]] std::vector<std::uint32_t>* places() { return &samples; }
    [[nodiscard]] const Camera* own_camera() const { return &camera; }
    void members(auto& member) {
        member("width", width);
        member("height", height);
        member("samples_per_axis", samples_per_axis);
        member("eye", camera.eye);
        member("target", camera.target);
        member("fov_degrees", camera.fov_degrees);
        member.unusual("roll_degrees", camera.roll_degrees, 0.0f);
    }
};

/// Receivers are the texels of a lightmap that the mesh's uvs touch. u runs to the right, v
/// upwards: the top row is at v = 1.
struct TexelLayout {
    static constexpr ReceiverKind Kind{
        .name = "texels", .one = "texel", .whole = "the atlas", .are_seen = false};
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// [num_receivers] ascending: the texel of each receiver, row by row from the top.
    std::vector<std::uint32_t> texels = {};

    [[nodiscard]] std::size_t num_texels() const { return std::size_t{width} * height; }
    bool operator==(const TexelLayout&) const = default;

    [[nodiscard]] PlaceGrid grid() const { return {width, height}; }
    [[nodiscard]] std::vector<std::uint32_t>* places() { return &texels; }
    [[nodiscard]] static const Camera* own_camera() { return nullptr; }
    void members(auto& member) {
        member("width", width);
        member("height", height);
    }
};

/// Receivers are points in space, in any order. A picture has them row by row.
struct PointLayout {
    static constexpr ReceiverKind Kind{.name = "points",
                                       .one = "point",
                                       .whole = "the points",
                                       .are_seen = false,
                                       .have_surface = false};
    /// Points in a row of a picture.
    static constexpr std::uint32_t PointsPerRow = 1024;
    std::uint32_t count = 0;
    /// [count] 0, 1, 2, ...
    std::vector<std::uint32_t> indices = {};
    bool operator==(const PointLayout&) const = default;

    [[nodiscard]] PlaceGrid grid() const {
        return {count < PointsPerRow ? count : PointsPerRow,
                count / PointsPerRow + (count % PointsPerRow != 0 ? 1 : 0)};
    }
    [[nodiscard]] std::vector<std::uint32_t>* places() { return &indices; }
    [[nodiscard]] static const Camera* own_camera() { return nullptr; }
    void members(auto& member) { member("count", count); }
};

/// Receivers are the middles of the cells that a box is cut into, x fastest, then y, then z. A
/// picture has nx columns, and ny rows for each z.
struct GridLayout {
    static constexpr ReceiverKind Kind{.name = "grid",
                                       .one = "grid point",
                                       .whole = "the grid",
                                       .are_seen = false,
                                       .have_surface = false};
    std::uint32_t nx = 0, ny = 0, nz = 0;
    glm::vec3 low{0.0f};
    glm::vec3 high{0.0f};
    /// [nx * ny * nz] 0, 1, 2, ...
    std::vector<std::uint32_t> indices = {};
    bool operator==(const GridLayout&) const = default;

    [[nodiscard]] PlaceGrid grid() const { return {nx, ny * nz}; }
    [[nodiscard]] std::vector<std::uint32_t>* places() { return &indices; }
    [[nodiscard]] static const Camera* own_camera() { return nullptr; }
    void members(auto& member) {
        member("nx", nx);
        member("ny", ny);
        member("nz", nz);
        member("low", low);
        member("high", high);
    }
};

/// The list of kinds.
using ReceiverLayout =
    std::variant<VertexLayout, PixelLayout, TexelLayout, PointLayout, GridLayout>;

/// The largest number of samples or texels. It bounds what is allocated. A picture of
/// 8192 x 8192 with four samples a pixel has as many.
inline constexpr std::size_t MaxLayoutPlaces = std::size_t{1} << 28;

[[nodiscard]] const ReceiverKind& kind_of(const ReceiverLayout& layout);

/// Whether the receivers are the mesh's vertices.
[[nodiscard]] bool on_vertices(const ReceiverLayout& layout);

/// Returns "vertices", "pixels 1024 x 768, 3 x 3 samples each", "pixels 1024 x 768, 4 x 4 samples
/// at edges", "texels 512 x 512", "points 2000" or "grid 16 x 8 x 16".
[[nodiscard]] std::string description(const ReceiverLayout& layout);

/// Returns how many places for receivers there are: samples or texels. None for vertices.
[[nodiscard]] std::size_t num_places(const ReceiverLayout& layout);

/// Returns the place of each receiver, ascending. None for vertices.
[[nodiscard]] std::span<const std::uint32_t> places(const ReceiverLayout& layout);

/// Returns how many places have a receiver.
[[nodiscard]] std::size_t num_places_taken(const ReceiverLayout& layout);

/// Returns the camera that the receivers belong to. Null: none.
[[nodiscard]] const Camera* own_camera(const ReceiverLayout& layout);

/// Checks the size and the camera of pixels or texels, before anything is done with them.
/// Throws:  std::invalid_argument.
void check_size(const ReceiverLayout& layout);

} // namespace relumine::prt
