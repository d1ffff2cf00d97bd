// Textures of engines: DDS, KTX and KTX 2 with a cube or one picture of floats.
// Based on: Microsoft, "Programming Guide for DDS"; Khronos, "KTX File Format" 1.0 and 2.0.
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "cubemap/image/color_space.h"
#include "cubemap/image/file_bytes.h"
#include "cubemap/image/image_file.h"
#include "cubemap/image/texel_decoder.h"
#include "files/compression.h"

namespace relumine::cubemap {

namespace {

using TexelKind = TexelFormat::Kind;
constexpr std::string_view DdsMark = "DDS ", KtxMark{"\xabKTX 11\xbb\r\n\x1a\n", 12},
                           Ktx2Mark{"\xabKTX 20\xbb\r\n\x1a\n", 12};

/// A name that a container has for a format.
struct NamedFormat {
    std::uint32_t name;
    TexelFormat format;
};
using FormatNames = std::span<const NamedFormat>;

// DXGI_FORMAT
constexpr std::array<NamedFormat, 9> OfDxgi = {{{2, {TexelKind::Floats, 4}},
                                                {6, {TexelKind::Floats, 3}},
                                                {10, {TexelKind::Halves, 4}},
                                                {26, {TexelKind::PackedFloats}},
                                                {41, {TexelKind::Floats, 1}},
                                                {54, {TexelKind::Halves, 1}},
                                                {67, {TexelKind::SharedExponents}},
                                                {95, {TexelKind::Bc6Unsigned}},
                                                {96, {TexelKind::Bc6Signed}}}};
// D3DFORMAT, as a FourCC
constexpr std::array<NamedFormat, 4> OfDirect3D9 = {{{113, {TexelKind::Halves, 4}},
                                                     {116, {TexelKind::Floats, 4}},
                                                     {111, {TexelKind::Halves, 1}},
                                                     {114, {TexelKind::Floats, 1}}}};
// VkFormat
constexpr std::array<NamedFormat, 10> OfVulkan = {{{76, {TexelKind::Halves, 1}},
                                                   {90, {TexelKind::Halves, 3}},
                                                   {97, {TexelKind::Halves, 4}},
                                                   {100, {TexelKind::Floats, 1}},
                                                   {106, {TexelKind::Floats, 3}},
                                                   {109, {TexelKind::Floats, 4}},
                                                   {122, {TexelKind::PackedFloats}},
                                                   {123, {TexelKind::SharedExponents}},
                                                   {143, {TexelKind::Bc6Unsigned}},
                                                   {144, {TexelKind::Bc6Signed}}}};
// glInternalFormat of what is compressed
constexpr std::array<NamedFormat, 2> OfOpenGlBlocks = {
    {{0x8e8f, {TexelKind::Bc6Unsigned}}, {0x8e8e, {TexelKind::Bc6Signed}}}};

/// Where the first level of a texture lies.
struct Texture {
    TexelFormat format;
    std::uint32_t width = 0, height = 0;
    bool is_cube = false;
    std::uint64_t offset = 0;
    /// From the beginning of a face to that of the next, and of rows (of blocks)
    std::uint64_t face_stride = 0, row_stride = 0;
    /// What was unpacked; empty: offsets are those of the file
    std::vector<std::byte> unpacked = {};
    bool is_bottom_up = false;
    /// The faces show Direct3D's world mirrored along Z, as OpenGL sees it with a plain lookup
    bool is_mirrored = false;
    std::uint32_t num_levels = 1;
};

TexelFormat format_named(const FileBytes& file, FormatNames formats, std::uint32_t name,
                         std::string_view kind) {
    const auto found = std::ranges::find(formats, name, &NamedFormat::name);
    if (found == formats.end())
        file.refuse("a texture of floats, halves, R11G11B10, R9G9B9E5 or BC6H",
                    fmt::format("{} {}", kind, name));
    return found->format;
}

std::uint64_t num_blocks_high(const TexelFormat& format, std::uint32_t height) {
    return (std::uint64_t{height} + format.rows_together() - 1) / format.rows_together();
}

/// Checks a texture's size, and sets where faces lie that follow each other.
void place_faces(const FileBytes& file, Texture& texture) {
    const std::uint64_t num_faces = texture.is_cube ? 6 : 1;
    if (texture.is_cube && texture.width != texture.height)
        file.refuse("square faces", fmt::format("{}x{}", texture.width, texture.height));
    // BC6H has one without zstd.
    constexpr std::uint64_t MostPixelsPerByte = 1, MostUnderZstd = 500;
    file.check_size(texture.width, num_faces * texture.height,
                    texture.unpacked.empty() ? MostPixelsPerByte : MostUnderZstd);
    texture.row_stride = texture.format.row_bytes(texture.width);
    texture.face_stride = texture.row_stride * num_blocks_high(texture.format, texture.height);
}

Texture texture_of_dds(const FileBytes& file) {
    constexpr std::uint64_t HeaderEnd = 128, Dx10End = 148;
    const Fields head(file, file.read(0, std::min(file.size(), Dx10End)));
    constexpr std::uint32_t Cube = 0x200, AllFaces = 0xfc00, HasFourCc = 4;
    constexpr std::uint32_t Dx10 = 0x30315844; // "DX10"
    Texture texture;
    texture.width = head.u32(16);
    texture.height = head.u32(12);
    texture.num_levels = std::max(1U, head.u32(28));
    const std::uint32_t four_cc = (head.u32(80) & HasFourCc) != 0 ? head.u32(84) : 0;
    const std::uint32_t caps = head.u32(112);
    if (four_cc == Dx10) {
        texture.format = format_named(file, OfDxgi, head.u32(128), "DXGI format");
        constexpr std::uint32_t TextureCube = 4;
        texture.is_cube = (head.u32(136) & TextureCube) != 0;
        texture.offset = Dx10End;
    } else {
        texture.format =
            format_named(file, OfDirect3D9, four_cc,
                         four_cc == 0 ? "8-bit colours, Direct3D 9 format" : "Direct3D 9 format");
        texture.is_cube = (caps & Cube) != 0;
        if (texture.is_cube && (caps & AllFaces) != AllFaces)
            file.refuse("all faces of a cube", "some");
        texture.offset = HeaderEnd;
    }
    place_faces(file, texture);
    // The levels of a face follow each other.
    for (std::uint32_t level = 1; level < std::min(texture.num_levels, 32U); ++level) {
        const std::uint32_t width = std::max(1U, texture.width >> level);
        const std::uint32_t height = std::max(1U, texture.height >> level);
        texture.face_stride +=
            texture.format.row_bytes(width) * num_blocks_high(texture.format, height);
    }
    return texture;
}

/// Returns the value of a KTX key; empty where it is absent. Pairs stand at multiples of 4.
std::string key_value(const Fields& pairs, std::string_view key) {
    const std::vector<std::byte>& bytes = pairs.bytes();
    for (std::uint64_t at = 0; at + 4 <= bytes.size();) {
        const std::uint64_t size = pairs.u32(at);
        at += 4;
        if (size > bytes.size() - at)
            return {};
        const std::string_view pair(reinterpret_cast<const char*>(bytes.data()) + at, size);
        if (pair.starts_with(key) && pair.size() > key.size() && pair[key.size()] == '\0')
            return std::string(pair.substr(key.size() + 1));
        at += (size + 3) / 4 * 4;
    }
    return {};
}

Texture texture_of_ktx(const FileBytes& file) {
    constexpr std::uint64_t HeaderEnd = 64;
    const std::vector<std::byte> bytes = file.read(0, std::min(file.size(), HeaderEnd));
    const Fields head(file, bytes);
    constexpr std::uint32_t LittleEndian = 0x04030201;
    if (head.u32(12) != LittleEndian)
        file.refuse("a little-endian KTX", "another byte order");
    const std::uint32_t type = head.u32(16), gl_format = head.u32(24);
    constexpr std::uint32_t Float = 0x1406, Half = 0x140b, PackedFloats = 0x8c3b,
                            PackedFloatsOfCmgen = 0x8c3a, SharedExponents = 0x8c3e;
    constexpr std::uint32_t Red = 0x1903, Rgb = 0x1907, Rgba = 0x1908;
    const std::size_t num_channels = gl_format == Rgba ? 4 : gl_format == Rgb ? 3 : 1;
    Texture texture;
    if (type == 0)
        texture.format =
            format_named(file, OfOpenGlBlocks, head.u32(28), "OpenGL's compressed format");
    else if ((type == Float || type == Half) &&
             (gl_format == Red || gl_format == Rgb || gl_format == Rgba))
        texture.format = {type == Float ? TexelKind::Floats : TexelKind::Halves, num_channels};
    else if (type == PackedFloats || type == PackedFloatsOfCmgen)
        texture.format = {TexelKind::PackedFloats};
    else if (type == SharedExponents)
        texture.format = {TexelKind::SharedExponents};
    else
        texture.format = format_named(file, {}, type, "OpenGL's type");
    texture.is_mirrored = type == PackedFloatsOfCmgen;
    texture.width = head.u32(36);
    texture.height = head.u32(40);
    texture.is_cube = head.u32(52) == 6;
    texture.num_levels = std::max(1U, head.u32(56));
    const std::uint32_t num_bytes_of_pairs = head.u32(60);
    texture.is_bottom_up =
        !texture.is_cube &&
        key_value(Fields(file, file.read(HeaderEnd, num_bytes_of_pairs)), "KTXorientation")
                .find("T=u") != std::string::npos;
    texture.offset = HeaderEnd + num_bytes_of_pairs + 4; // behind the level's size
    place_faces(file, texture);
    texture.row_stride = (texture.row_stride + 3) / 4 * 4;
    texture.face_stride = texture.row_stride * num_blocks_high(texture.format, texture.height);
    return texture;
}

/// Returns the colours that a KTX 2 file's data format descriptor names; empty for linear Rec. 709.
std::optional<ColorSpace> space_of_ktx2(const FileBytes& file, const Fields& head) {
    constexpr std::uint32_t PrimariesAt = 13, LeastSize = 16;
    const std::uint32_t size = head.u32(52);
    if (size < LeastSize)
        return std::nullopt;
    const Fields descriptor(file, file.read(head.u32(48), LeastSize));
    constexpr std::array<std::string_view, 12> Ids = {"",
                                                      "",
                                                      "",
                                                      "",
                                                      "lin_rec2020_scene",
                                                      "",
                                                      "lin_ap0_scene",
                                                      "lin_ap1_scene",
                                                      "",
                                                      "",
                                                      "lin_p3d65_scene",
                                                      "lin_adobergb_scene"};
    const std::uint64_t primaries = descriptor.number(PrimariesAt, 1);
    return primaries < Ids.size() ? space_of_id(Ids[primaries]) : std::nullopt;
}

Texture texture_of_ktx2(const FileBytes& file) {
    constexpr std::uint64_t HeaderEnd = 80, LevelBytes = 24;
    const Fields head(file, file.read(0, std::min(file.size(), HeaderEnd + LevelBytes)));
    const std::uint32_t vk_format = head.u32(12), packing = head.u32(44);
    if (vk_format == 0 || packing == 1)
        file.refuse("a texture of floats, halves, R11G11B10, R9G9B9E5 or BC6H",
                    "one of Basis Universal");
    Texture texture;
    texture.format = format_named(file, OfVulkan, vk_format, "Vulkan's format");
    texture.width = head.u32(20);
    texture.height = std::max(1U, head.u32(24));
    const std::uint32_t num_faces = head.u32(36);
    if (head.u32(28) > 1 || head.u32(32) > 1 || (num_faces != 1 && num_faces != 6))
        file.refuse("a cube or one picture", fmt::format("{} layers of {} faces, {} deep",
                                                         head.u32(32), num_faces, head.u32(28)));
    texture.is_cube = num_faces == 6;
    texture.num_levels = std::max(1U, head.u32(40));
    texture.is_bottom_up =
        !texture.is_cube &&
        key_value(Fields(file, file.read(head.u32(56), head.u32(60))), "KTXorientation")
            .starts_with("ru");
    texture.offset = head.number(HeaderEnd, 8);
    constexpr std::uint32_t Zstd = 2;
    if (packing == 0) {
        place_faces(file, texture);
        return texture;
    }
    if (packing != Zstd)
        file.refuse("a KTX 2 file without supercompression or with zstd",
                    fmt::format("scheme {}", packing));
    const std::vector<std::byte> packed = file.read(texture.offset, head.number(HeaderEnd + 8, 8));
    texture.unpacked.resize(1);
    place_faces(file, texture);
    const std::uint64_t num_bytes = texture.face_stride * num_faces;
    if (num_bytes / files::MaxCompressionRatio > packed.size())
        file.refuse(fmt::format("data for {} bytes of pixels", num_bytes),
                    fmt::format("{} bytes", packed.size()));
    texture.unpacked.resize(num_bytes);
    if (!files::decompress(packed, texture.unpacked))
        file.refuse(fmt::format("{} bytes of pixels packed by zstd", num_bytes), "others");
    texture.offset = 0;
    return texture;
}

class TextureRows : public ImageRows {
public:
    TextureRows(FileBytes file, Texture texture, std::optional<ColorSpace> space)
        : file_(std::move(file)), texture_(std::move(texture)) {
        const std::uint32_t num_faces = texture_.is_cube ? 6 : 1;
        head_.width = texture_.width;
        head_.height = num_faces * texture_.height;
        head_.is_half = texture_.format.is_half();
        if (texture_.is_cube) {
            head_.layout = Layout::Cube;
            head_.faces_of = texture_.is_mirrored ? FacesOf::OpenGl : FacesOf::Direct3D;
            head_.remarks.emplace_back(texture_.is_mirrored
                                           ? "faces mirrored as filament's cmgen writes them"
                                           : "faces as Direct3D shows them");
        }
        if (texture_.num_levels > 1)
            head_.remarks.push_back(fmt::format("the first of {} levels", texture_.num_levels));
        if (space)
            colors_.emplace(*space);
        const std::uint64_t end =
            texture_.offset + (num_faces - 1) * texture_.face_stride +
            texture_.row_stride * num_blocks_high(texture_.format, texture_.height);
        const std::uint64_t size =
            texture_.unpacked.empty() ? file_.size() : texture_.unpacked.size();
        if (end > size)
            file_.refuse(fmt::format("{} bytes", end), fmt::format("a file of {} bytes", size));
    }

    [[nodiscard]] std::uint32_t rows_together() const override {
        return texture_.format.rows_together();
    }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        const std::uint32_t width = head_.width;
        const std::uint32_t together = texture_.format.rows_together();
        std::vector<std::byte> bytes;
        std::optional<std::uint64_t> at;
        for (std::uint32_t row = 0; row < pixels.size() / width; ++row) {
            std::uint32_t face = (first + row) / texture_.height;
            std::uint32_t y = (first + row) % texture_.height;
            const std::span<glm::vec3> target = pixels.subspan(std::size_t{row} * width, width);
            const bool is_vertical = face == 2 || face == 3;
            if (texture_.is_bottom_up || (texture_.is_mirrored && is_vertical))
                y = texture_.height - 1 - y;
            if (texture_.is_cube && !texture_.is_mirrored && face >= 4)
                face = 9 - face; // +Z is -Z
            const std::uint64_t place =
                texture_.offset + face * texture_.face_stride + y / together * texture_.row_stride;
            if (at != place)
                bytes = bytes_at(place);
            at = place;
            texture_.format.decode(bytes, y % together, target);
            if (texture_.is_mirrored && !is_vertical)
                std::ranges::reverse(target);
        }
        return {.num_outside = colors_ ? colors_->convert(pixels) : 0};
    }

private:
    [[nodiscard]] std::vector<std::byte> bytes_at(std::uint64_t place) const {
        const std::uint64_t size = texture_.format.row_bytes(texture_.width);
        if (texture_.unpacked.empty())
            return file_.read(place, size);
        const auto piece = std::span(texture_.unpacked).subspan(place, size);
        return {piece.begin(), piece.end()};
    }

    FileBytes file_;
    Texture texture_;
};

bool begins_with(std::span<const std::byte> bytes, std::string_view mark) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size())
        .starts_with(mark);
}

} // namespace

bool is_dds(std::span<const std::byte> bytes) {
    return begins_with(bytes, DdsMark);
}
bool is_ktx(std::span<const std::byte> bytes) {
    return begins_with(bytes, KtxMark) || begins_with(bytes, Ktx2Mark);
}

std::unique_ptr<ImageRows> open_dds(FileBytes file) {
    Texture texture = texture_of_dds(file);
    return std::make_unique<TextureRows>(std::move(file), std::move(texture), std::nullopt);
}

std::unique_ptr<ImageRows> open_ktx(FileBytes file) {
    const std::vector<std::byte> mark = file.read(0, Ktx2Mark.size());
    if (!begins_with(mark, Ktx2Mark)) {
        Texture texture = texture_of_ktx(file);
        return std::make_unique<TextureRows>(std::move(file), std::move(texture), std::nullopt);
    }
    Texture texture = texture_of_ktx2(file);
    const std::optional<ColorSpace> space = space_of_ktx2(file, Fields(file, file.read(0, 80)));
    return std::make_unique<TextureRows>(std::move(file), std::move(texture), space);
}

} // namespace relumine::cubemap
