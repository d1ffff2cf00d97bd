// What the readers of the file formats return to load_environment().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/image/color_space.h"
#include "cubemap/image/environment.h"
#include "cubemap/image/file_bytes.h"
#include "files/output_file.h"

namespace relumine::cubemap {

/// The content of a decoded file. An alpha channel is not read.
struct ImageFile : Picture {
    /// The layout that the file itself states by OpenEXR's `envmap` attribute. Empty: none stated.
    std::optional<Layout> envmap;
    /// The layout of a format that has but one. Empty: none
    std::optional<Layout> layout;
    FacesOf faces_of = FacesOf::OpenExr;
    /// True: 16-bit floats, in which radiance above 65504 is infinite.
    bool is_half = false;
    /// What a user may want to know, for example "luminance only".
    std::vector<std::string> remarks;
    /// Pixels of alpha 0.
    std::size_t num_transparent = 0;
};

/// A file whose pixels are not held: bands of rows are read when they are asked for.
///
/// Threads: read() may be called from several at once.
class ImageRows {
public:
    virtual ~ImageRows() = default;

    struct Counts {
        /// Pixels of alpha 0
        std::size_t num_transparent = 0;
        /// Pixels whose colour Rec. 709 cannot show
        std::size_t num_outside = 0;
    };
    /// Decodes the rows [first, first + pixels.size() / width) as the format's decode() does.
    ///
    /// Throws:  std::runtime_error "name: expected X, got Y".
    virtual Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const = 0;

    /// What decode() returns, without pixels and transparent ones, and without the remark on
    /// colours.
    [[nodiscard]] const ImageFile& head() const { return head_; }
    /// Returns how many rows, from a multiple of it on, are decoded together. Fewer cost as much.
    [[nodiscard]] virtual std::uint32_t rows_together() const { return 1; }
    /// Null: colours stay as they are.
    [[nodiscard]] const ColorConversion* colors() const { return colors_ ? &*colors_ : nullptr; }

protected:
    ImageFile head_;
    std::optional<ColorConversion> colors_;
};

/// Returns the rows of a file; null for one that is only read whole: with luminance and chroma, a
/// display window of its own, or tiles of many rows.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] std::unique_ptr<ImageRows> exr_rows(const std::filesystem::path& path);
[[nodiscard]] std::unique_ptr<ImageRows> hdr_rows(const std::filesystem::path& path);

/// More pixels than any environment has: a cube of 6 x 9459^2. A larger file is refused as damaged
/// before memory is allocated.
inline constexpr std::uint64_t MaxPixels = std::uint64_t{1} << 29;

/// Returns true if a file's first bytes mark it as of a format.
[[nodiscard]] bool is_avif(std::span<const std::byte> bytes);
[[nodiscard]] bool is_exr(std::span<const std::byte> bytes);
[[nodiscard]] bool is_hdr(std::span<const std::byte> bytes);
[[nodiscard]] bool is_dds(std::span<const std::byte> bytes);
[[nodiscard]] bool is_jpeg(std::span<const std::byte> bytes);
[[nodiscard]] bool is_jxl(std::span<const std::byte> bytes);
[[nodiscard]] bool is_ktx(std::span<const std::byte> bytes);
[[nodiscard]] bool is_pfm(std::span<const std::byte> bytes);
[[nodiscard]] bool is_tiff(std::span<const std::byte> bytes);

/// Reads what stands before the pixels.
/// Throws:  std::runtime_error "name: expected X, got Y", as read() of what is returned does.
[[nodiscard]] std::unique_ptr<ImageRows> open_avif(FileBytes file);
[[nodiscard]] std::unique_ptr<ImageRows> open_dds(FileBytes file);
[[nodiscard]] std::unique_ptr<ImageRows> open_gain_map(FileBytes file);
[[nodiscard]] std::unique_ptr<ImageRows> open_jxl(FileBytes file);
[[nodiscard]] std::unique_ptr<ImageRows> open_ktx(FileBytes file);
[[nodiscard]] std::unique_ptr<ImageRows> open_pfm(FileBytes file);
[[nodiscard]] std::unique_ptr<ImageRows> open_tiff(FileBytes file);
/// Decodes all rows.
[[nodiscard]] ImageFile whole(const ImageRows& rows);

/// Decodes a file's content. `name` stands for the file in messages.
/// Throws:  std::runtime_error "name: expected X, got Y".
[[nodiscard]] ImageFile decode_exr(std::span<const std::byte> bytes, const std::string& name);
[[nodiscard]] ImageFile decode_hdr(std::span<const std::byte> bytes, const std::string& name);

/// Returns the size that decode_exr() would find, from the header alone.
[[nodiscard]] ImageSize exr_size(const std::filesystem::path& path);
/// Returns the size that decode_hdr() would find. `head` holds the first bytes of a file of
/// `num_bytes`.
[[nodiscard]] ImageSize hdr_size(std::span<const std::byte> head, std::size_t num_bytes,
                                 const std::string& name);

/// Pixels that stand beside a picture in its file.
struct ExrLayer {
    /// Without a dot, and different from all others.
    std::string name;
    /// [number of the picture's pixels] in the picture's order.
    std::span<const glm::vec3> pixels;
};

/// Returns an .exr file: 32-bit float RGB, ZIP. The `envmap` attribute is set if samples lie on the
/// borders. The file has a channel A if the picture has alpha, and three channels NAME.R, NAME.G,
/// NAME.B for each layer.
[[nodiscard]] std::vector<std::byte> encode_exr(const EnvironmentImage& image,
                                                std::span<const ExrLayer> layers = {});
/// Adds the same bytes to an empty file. They are written while others are compressed.
/// Throws:  as files::OutputFile::write().
void write_exr(files::OutputFile& file, const EnvironmentImage& image,
               std::span<const ExrLayer> layers = {});
/// Returns an .hdr file: RGBE, run-length encoded, rounded to nearest.
/// Throws:  std::invalid_argument for radiance that RGBE cannot hold.
[[nodiscard]] std::vector<std::byte> encode_hdr(const EnvironmentImage& image);

/// The beginning of a file.
struct FileHead {
    std::filesystem::path path;
    /// At most MaxHeadBytes
    std::vector<std::byte> bytes;
    /// The whole file's
    std::size_t num_bytes = 0;
};
inline constexpr std::size_t MaxHeadBytes = 1 << 16;

/// A format of environments and pictures: a row in image_file.cpp.
struct ImageFormat {
    /// ".exr"; of others that mean the same
    std::array<std::string_view, 2> extensions;
    /// "OpenEXR", for messages
    std::string_view name;
    /// Whether a file's first bytes mark it. The extension of a file that is read does not count.
    bool (*marks)(std::span<const std::byte> bytes);
    ImageFile (*decode)(std::span<const std::byte> bytes, const std::string& name);
    ImageSize (*size)(const FileHead& head);
    std::unique_ptr<ImageRows> (*rows)(const std::filesystem::path& path);
    /// Null: files are read alone
    void (*write)(files::OutputFile& file, const EnvironmentImage& image) = nullptr;
    /// Files state by an attribute that samples lie on the borders
    bool has_envmap = false;
};

/// Returns the extensions of files that are written: ".exr or .hdr".
[[nodiscard]] std::string written_extensions();
/// Returns the format of a file's first bytes.
///
/// Throws:  std::runtime_error "path: expected X, got Y", which tells what it is where that is
/// seen.
[[nodiscard]] const ImageFormat& format_of(std::span<const std::byte> bytes,
                                           const std::filesystem::path& path);
/// Returns the format that a name's extension tells, in capitals or not; null for another.
[[nodiscard]] const ImageFormat* format_of_name(const std::filesystem::path& path);

} // namespace relumine::cubemap
