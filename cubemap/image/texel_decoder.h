// Rows of pixels as graphics processors hold them: floats, halves, packed floats, BC6H.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// How a texture holds light.
struct TexelFormat {
    enum class Kind { Halves, Floats, PackedFloats, SharedExponents, Bc6Unsigned, Bc6Signed };
    Kind kind = Kind::Halves;
    /// Halves and floats have 1 (grey), 3, or 4 with alpha, which is not read
    std::size_t num_channels = 3;

    [[nodiscard]] bool has_blocks() const {
        return kind == Kind::Bc6Unsigned || kind == Kind::Bc6Signed;
    }
    /// Returns how many rows of pixels lie together.
    [[nodiscard]] std::uint32_t rows_together() const { return has_blocks() ? 4 : 1; }
    /// Returns the bytes of `rows_together()` rows.
    [[nodiscard]] std::uint64_t row_bytes(std::uint32_t width) const;
    /// Returns true where radiance above 65504 is infinite.
    [[nodiscard]] bool is_half() const {
        return kind != Kind::Floats && kind != Kind::SharedExponents;
    }

    /// Decodes a row of pixels. `row` is the one of its block, below rows_together().
    void decode(std::span<const std::byte> bytes, std::uint32_t row,
                std::span<glm::vec3> pixels) const;
};

} // namespace relumine::cubemap
