#include "cubemap/image/texel_decoder.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <half.h>

#include "cubemap/image/bc6h.h"

namespace relumine::cubemap {

namespace {

constexpr std::uint32_t BlockSide = 4;
constexpr std::size_t BlockBytes = 16;

std::uint32_t little_endian(const std::byte* at, std::size_t num_bytes) {
    std::uint32_t result = 0;
    for (std::size_t i = num_bytes; i-- > 0;)
        result = result << 8 | std::to_integer<std::uint32_t>(at[i]);
    return result;
}

/// Returns a float without a sign: 5 bits of exponent above those of the mantissa, as of a half.
float small_float(std::uint32_t bits, int num_mantissa_bits) {
    return imath_half_to_float(static_cast<std::uint16_t>(bits << (10 - num_mantissa_bits)));
}

} // namespace

std::uint64_t TexelFormat::row_bytes(std::uint32_t width) const {
    switch (kind) {
    case Kind::Halves:
        return std::uint64_t{2} * num_channels * width;
    case Kind::Floats:
        return std::uint64_t{4} * num_channels * width;
    case Kind::PackedFloats:
    case Kind::SharedExponents:
        return std::uint64_t{4} * width;
    case Kind::Bc6Unsigned:
    case Kind::Bc6Signed:
        break;
    }
    return (width + std::uint64_t{BlockSide} - 1) / BlockSide * BlockBytes;
}

void TexelFormat::decode(std::span<const std::byte> bytes, std::uint32_t row,
                         std::span<glm::vec3> pixels) const {
    const std::byte* at = bytes.data();
    const std::size_t sample_bytes = kind == Kind::Floats ? 4 : 2;
    const auto sample = [&](std::size_t index) {
        const std::uint32_t bits = little_endian(at + index * sample_bytes, sample_bytes);
        return kind == Kind::Floats ? std::bit_cast<float>(bits)
                                    : imath_half_to_float(static_cast<std::uint16_t>(bits));
    };
    for (std::size_t x = 0; x < pixels.size(); ++x) {
        switch (kind) {
        case Kind::Halves:
        case Kind::Floats:
            pixels[x] = num_channels == 1
                            ? glm::vec3(sample(x))
                            : glm::vec3(sample(num_channels * x), sample(num_channels * x + 1),
                                        sample(num_channels * x + 2));
            break;
        case Kind::PackedFloats: {
            const std::uint32_t bits = little_endian(at + 4 * x, 4);
            pixels[x] = {small_float(bits & 0x7ff, 6), small_float(bits >> 11 & 0x7ff, 6),
                         small_float(bits >> 22, 5)};
            break;
        }
        case Kind::SharedExponents: {
            const std::uint32_t bits = little_endian(at + 4 * x, 4);
            const float scale = std::ldexp(1.0f, static_cast<int>(bits >> 27) - 15 - 9);
            pixels[x] = scale * glm::vec3(bits & 0x1ff, bits >> 9 & 0x1ff, bits >> 18 & 0x1ff);
            break;
        }
        case Kind::Bc6Unsigned:
        case Kind::Bc6Signed: {
            const auto block =
                decode_bc6h(bytes.subspan(x / BlockSide * BlockBytes).first<BlockBytes>(),
                            kind == Kind::Bc6Signed);
            const std::size_t end = std::min<std::size_t>(x + BlockSide, pixels.size());
            std::copy_n(block.begin() + row * BlockSide, end - x,
                        pixels.begin() + static_cast<std::ptrdiff_t>(x));
            x = end - 1;
            break;
        }
        }
    }
}

} // namespace relumine::cubemap
