#include "cubemap/image/image_file.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/extension.h"
#include "files/joined.h"
#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

ImageSize size_of_exr(const FileHead& head) {
    return exr_size(head.path);
}
ImageSize size_of_hdr(const FileHead& head) {
    return hdr_size(head.bytes, head.num_bytes, head.path.string());
}
void write_plain_exr(files::OutputFile& file, const EnvironmentImage& image) {
    write_exr(file, image);
}
void write_hdr(files::OutputFile& file, const EnvironmentImage& image) {
    file.write(encode_hdr(image));
}

/// The functions of a format that is read by its rows.
template<auto Open>
ImageFile decode_by_rows(std::span<const std::byte> bytes, const std::string& name) {
    return whole(*Open(FileBytes(bytes, name)));
}
template<auto Open>
ImageSize size_by_rows(const FileHead& head) {
    const std::unique_ptr<ImageRows> rows = Open(FileBytes(head.path));
    return {rows->head().width, rows->head().height};
}
/// Null where rows are not decoded in small bands.
template<auto Open>
std::unique_ptr<ImageRows> some_rows(const std::filesystem::path& path) {
    constexpr std::uint32_t MostTogether = 256;
    std::unique_ptr<ImageRows> rows = Open(FileBytes(path));
    return rows->rows_together() <= MostTogether ? std::move(rows) : nullptr;
}

constexpr ImageFormat Formats[] = {
    {.extensions = {".exr"},
     .name = "OpenEXR",
     .marks = is_exr,
     .decode = decode_exr,
     .size = size_of_exr,
     .rows = exr_rows,
     .write = write_plain_exr,
     .has_envmap = true},
    {.extensions = {".hdr"},
     .name = "Radiance .hdr",
     .marks = is_hdr,
     .decode = decode_hdr,
     .size = size_of_hdr,
     .rows = hdr_rows,
     .write = write_hdr},
    {.extensions = {".tif", ".tiff"},
     .name = "TIFF",
     .marks = is_tiff,
     .decode = decode_by_rows<open_tiff>,
     .size = size_by_rows<open_tiff>,
     .rows = some_rows<open_tiff>},
    {.extensions = {".pfm"},
     .name = "PFM",
     .marks = is_pfm,
     .decode = decode_by_rows<open_pfm>,
     .size = size_by_rows<open_pfm>,
     .rows = some_rows<open_pfm>},
    {.extensions = {".dds"},
     .name = "DDS",
     .marks = is_dds,
     .decode = decode_by_rows<open_dds>,
     .size = size_by_rows<open_dds>,
     .rows = some_rows<open_dds>},
    {.extensions = {".ktx2", ".ktx"},
     .name = "KTX",
     .marks = is_ktx,
     .decode = decode_by_rows<open_ktx>,
     .size = size_by_rows<open_ktx>,
     .rows = some_rows<open_ktx>},
    {.extensions = {".jpg", ".jpeg"},
     .name = "gain-map JPEG",
     .marks = is_jpeg,
     .decode = decode_by_rows<open_gain_map>,
     .size = size_by_rows<open_gain_map>,
     .rows = some_rows<open_gain_map>},
#ifdef RELUMINE_HDR_PHOTOS
    {.extensions = {".avif"},
     .name = "AVIF",
     .marks = is_avif,
     .decode = decode_by_rows<open_avif>,
     .size = size_by_rows<open_avif>,
     .rows = some_rows<open_avif>},
    {.extensions = {".jxl"},
     .name = "JPEG XL",
     .marks = is_jxl,
     .decode = decode_by_rows<open_jxl>,
     .size = size_by_rows<open_jxl>,
     .rows = some_rows<open_jxl>},
#endif
};

/// Says what a file is that is no environment.
std::string_view kind_of_other(const std::filesystem::path& path,
                               std::span<const std::byte> bytes) {
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()),
                                std::min<std::size_t>(bytes.size(), 12));
    const std::string extension = files::extension_of(path);
    const bool is_webp = head.starts_with("RIFF") && head.ends_with("WEBP");
    if (bytes.empty())
        return "an empty file";
    if (head.starts_with("\x89PNG") || is_webp)
        return "a PNG or WebP picture, which holds no light above white: use the .hdr or "
               ".exr that it was made from";
    if (is_avif(bytes) || is_jxl(bytes))
        return "AVIF or JPEG XL, which this build does not read (packages/hdr-photos.txt, "
               "-DRELUMINE_HDR_PHOTOS=ON)";
    return extension == ".prt" ? "a scene: the scene stands first, the environment behind it"
                               : "something else";
}

} // namespace

ImageFile whole(const ImageRows& rows) {
    ImageFile image = rows.head();
    const std::size_t width = image.width;
    image.pixels = files::large_vector<glm::vec3>(width * image.height);
    // Bands of at least this many rows keep the loop's own cost small.
    constexpr std::uint32_t FewRows = 16;
    const std::uint32_t together = std::max(1U, rows.rows_together());
    const std::uint32_t band = (FewRows + together - 1) / together * together;
    std::atomic<std::size_t> num_transparent = 0, num_outside = 0;
    files::parallel_for(0U, (image.height + band - 1) / band, [&](std::uint32_t index) {
        const std::uint32_t first = index * band, last = std::min(first + band, image.height);
        const ImageRows::Counts counts = rows.read(
            first, std::span(image.pixels).subspan(first * width, (last - first) * width));
        num_transparent += counts.num_transparent;
        num_outside += counts.num_outside;
    });
    image.num_transparent = num_transparent;
    if (rows.colors() != nullptr)
        image.remarks.push_back(rows.colors()->remark(num_outside));
    return image;
}

namespace {

std::string extensions(bool are_written) {
    std::vector<std::string_view> names;
    for (const ImageFormat& format : Formats)
        if (!are_written || format.write != nullptr)
            names.push_back(format.extensions.front());
    return files::joined_by_or(names);
}

} // namespace

std::string written_extensions() {
    return extensions(true);
}

std::string environment_extensions() {
    return extensions(false);
}

const ImageFormat& format_of(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    for (const ImageFormat& format : Formats)
        if (format.marks(bytes))
            return format;
    std::vector<std::string_view> names;
    for (const ImageFormat& format : Formats)
        names.push_back(format.name);
    throw std::runtime_error(fmt::format("{}: expected an {} file, got {}", path.string(),
                                         files::joined_by_or(names), kind_of_other(path, bytes)));
}

const ImageFormat* format_of_name(const std::filesystem::path& path) {
    const std::string extension = files::extension_of(path);
    for (const ImageFormat& format : Formats)
        for (const std::string_view each : format.extensions)
            if (!each.empty() && each == extension)
                return &format;
    return nullptr;
}

} // namespace relumine::cubemap
