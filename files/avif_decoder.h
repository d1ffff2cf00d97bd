// Decodes AVIF files. The only user of libavif, which builds with RELUMINE_HDR_PHOTOS have.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace relumine::files {

/// The first picture of an AVIF file.
class AvifPicture {
public:
    /// Reads the header. The bytes must outlive this object.
    ///
    /// Throws:  std::runtime_error "expected a whole AVIF picture, got X".
    explicit AvifPicture(std::span<const std::byte> file);
    ~AvifPicture();
    AvifPicture(AvifPicture&&) noexcept;

    struct Head {
        std::uint32_t width = 0, height = 0;
        /// Bits of each channel
        std::uint32_t num_bits = 8;
        bool has_alpha = false;
        /// The file turns or mirrors its picture, which decode() does not.
        bool is_turned = false;
        /// A code point of ITU-T H.273
        unsigned transfer = 0;
        static constexpr unsigned Pq = 16, Hlg = 18;
        /// x and y of red, green, blue and white
        std::array<float, 8> primaries{};
    };
    [[nodiscard]] const Head& head() const { return head_; }

    /// Decodes to 8 or 16 bits, [height][width][3], or 4 with alpha, from the top left. Colours are
    /// not multiplied by alpha, and lie on the file's own curve.
    ///
    /// Throws:  as the constructor.
    void decode(std::span<std::uint8_t> values, bool with_alpha) const;
    void decode(std::span<std::uint16_t> values, bool with_alpha) const;

private:
    void decode(std::span<std::uint8_t> bytes, std::uint32_t num_bits, bool with_alpha) const;

    struct Impl;
    std::unique_ptr<Impl> impl_;
    Head head_;
};

/// Whether bytes begin as an AVIF file does, one picture or several.
[[nodiscard]] bool is_avif(std::span<const std::byte> file);

} // namespace relumine::files
