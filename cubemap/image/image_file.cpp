#include "cubemap/image/image_file.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "files/extension.h"
#include "files/joined.h"

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

constexpr ImageFormat Formats[] = {
    {.extension = ".exr",
     .name = "OpenEXR",
     .marks = is_exr,
     .decode = decode_exr,
     .size = size_of_exr,
     .rows = exr_rows,
     .write = write_plain_exr,
     .has_envmap = true},
    {.extension = ".hdr",
     .name = "Radiance .hdr",
     .marks = is_hdr,
     .decode = decode_hdr,
     .size = size_of_hdr,
     .rows = hdr_rows,
     .write = write_hdr},
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
    if (head.starts_with("\xff\xd8\xff") || head.starts_with("\x89PNG") || is_webp)
        return "a JPEG, PNG or WebP picture, which holds no light above white: use the .hdr or "
               ".exr that it was made from";
    return extension == ".prt" ? "a scene: the scene stands first, the environment behind it"
                               : "something else";
}

} // namespace

std::string image_extensions() {
    std::vector<std::string_view> names;
    for (const ImageFormat& format : Formats)
        names.push_back(format.extension);
    return files::joined_by_or(names);
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
    const auto* found =
        std::ranges::find(Formats, files::extension_of(path), &ImageFormat::extension);
    return found != std::end(Formats) ? found : nullptr;
}

} // namespace relumine::cubemap
