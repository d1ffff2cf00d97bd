// What the receivers of a scene are: vertices of its mesh, pixels of a picture or texels of a
// lightmap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "prt/receivers/camera.h"

namespace relumine::prt {

/// Receiver i is vertex i of the mesh.
struct VertexLayout {
    bool operator==(const VertexLayout&) const = default;
};

/// Receivers are the points where the rays of a picture first meet the mesh. The other samples see
/// the background.
struct PixelLayout {
    Camera camera = {};
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// n: each pixel has n x n samples.
    std::uint32_t samples_per_axis = 1;
    /// [num_receivers] ascending: the sample of each receiver. Samples count pixel by pixel, row by
    /// row from the top, n^2 to a pixel.
    std::vector<std::uint32_t> samples = {};

    [[nodiscard]] std::size_t samples_per_pixel() const {
        return std::size_t{samples_per_axis} * samples_per_axis;
    }
    [[nodiscard]] std::size_t num_samples() const {
        return std::size_t{width} * height * samples_per_pixel();
    }
    bool operator==(const PixelLayout&) const = default;
};

/// Receivers are the texels of a lightmap that the mesh's uvs touch. u runs to the right, v
/// upwards: the top row is at v = 1.
struct TexelLayout {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// [num_receivers] ascending: the texel of each receiver, row by row from the top.
    std::vector<std::uint32_t> texels = {};

    [[nodiscard]] std::size_t num_texels() const { return std::size_t{width} * height; }
    bool operator==(const TexelLayout&) const = default;
};

using ReceiverLayout = std::variant<VertexLayout, PixelLayout, TexelLayout>;

/// The largest number of samples or texels. It bounds what is allocated. A picture of
/// 8192 x 8192 with four samples a pixel has as many.
inline constexpr std::size_t MaxLayoutPlaces = std::size_t{1} << 28;

/// Returns the name of one receiver: "vertex", "pixel sample" or "texel".
[[nodiscard]] std::string receiver_name(const ReceiverLayout& layout);

/// Returns "vertices", "pixels 1024 x 768, 3 x 3 samples each" or "texels 512 x 512".
[[nodiscard]] std::string description(const ReceiverLayout& layout);

} // namespace relumine::prt
