#include "mesh/formats/gltf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "files/output_file.h"
#include "mesh/formats/gltf_left_out.h"
#include "mesh/formats/meshopt_decoder.h"
#include "mesh/formats/mtl_reader.h"
#include "mesh/materials/material.h"
#include "mesh/text_reader.h"

namespace relumine::mesh::gltf {

namespace {

[[noreturn]] void fail(std::string_view expected, std::string_view got) {
    throw std::runtime_error(fmt::format("expected {}, got {}", expected, got));
}

bool is_structured(const Json& value) {
    return value.type() == Json::Type::Array || value.type() == Json::Type::Object;
}

/// Describes a value for an error message. Arrays and objects are not written out: they may nest as
/// deep as the file is long.
std::string described(const Json& value) {
    return is_structured(value) ? std::string(name(value.type())) : excerpt(value.text());
}

[[noreturn]] void fail(const char* key, std::string_view expected, const Json& got) {
    fail(fmt::format("{} as \"{}\"", expected, key), described(got));
}

/// Returns null if the object does not have the key.
const Json* find(const Json& object, const char* key) {
    if (object.type() != Json::Type::Object)
        fail(fmt::format("an object with \"{}\"", key), name(object.type()));
    return object.find(key);
}

const Json& require(const Json& object, const char* key) {
    const Json* value = find(object, key);
    if (value == nullptr)
        fail(fmt::format("\"{}\"", key), "none");
    return *value;
}

std::uint32_t word(std::span<const std::byte> bytes, std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

/// Decodes RFC 4648; '=' ends the data.
std::vector<std::byte> base64(std::string_view text) {
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() / 4 * 3);
    std::uint32_t bits = 0;
    int num_bits = 0;
    while (text.ends_with('='))
        text.remove_suffix(1);
    constexpr std::string_view Alphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<int, 256> values{};
    values.fill(-1);
    for (std::size_t i = 0; i < Alphabet.size(); ++i)
        values[static_cast<unsigned char>(Alphabet[i])] = static_cast<int>(i);
    for (const char c : text) {
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0)
            fail("base64 in a data URI", excerpt(std::string_view(&c, 1)));
        bits = (bits << 6u | static_cast<std::uint32_t>(value)) & 0xffffu;
        num_bits += 6;
        if (num_bits >= 8) {
            num_bits -= 8;
            bytes.push_back(
                static_cast<std::byte>(bits >> static_cast<unsigned>(num_bits) & 0xffu));
        }
    }
    return bytes;
}

/// Returns the length of the UTF-8 character at the front, 0 if there is none. Continuation bytes
/// alone are checked; the JSON parser checks the rest.
std::size_t utf8_length(std::string_view text) {
    const auto first = static_cast<unsigned char>(text[0]);
    const std::size_t length = first < 0x80                    ? 1
                               : first >= 0xc2 && first < 0xe0 ? 2
                               : first >= 0xe0 && first < 0xf0 ? 3
                               : first >= 0xf0 && first < 0xf5 ? 4
                                                               : 0;
    if (length == 0 || length > text.size())
        return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((static_cast<unsigned char>(text[i]) & 0xc0u) != 0x80u)
            return 0;
    return length;
}

/// Turns bytes that are no UTF-8 into the characters of Latin-1.
std::string with_latin1(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        if (length == 0) {
            const auto byte = static_cast<unsigned char>(text[0]);
            result += static_cast<char>(0xc0u | byte >> 6u);
            result += static_cast<char>(0x80u | (byte & 0x3fu));
        } else {
            result += text.substr(0, length);
        }
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return result;
}

/// Turns the characters of Latin-1 back into bytes.
std::string latin1_bytes(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if ((byte == 0xc2 || byte == 0xc3) && i + 1 < text.size())
            result += static_cast<char>((byte & 3u) << 6u |
                                        (static_cast<unsigned char>(text[++i]) & 0x3fu));
        else
            result += text[i];
    }
    return result;
}

/// Decodes %20 and the like.
std::string percent_decoded(std::string_view uri) {
    const auto digit = [](char c) {
        return c >= '0' && c <= '9'   ? c - '0'
               : c >= 'a' && c <= 'f' ? c - 'a' + 10
               : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                      : -1;
    };
    std::string result;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 &&
            digit(uri[i + 2]) >= 0) {
            result += static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
            i += 2;
        } else {
            result += uri[i];
        }
    }
    if (result.find('\0') != std::string::npos)
        fail("a file name in a URI", excerpt(result));
    return result;
}

/// Says what is lost without an extension. Empty for others: their loss is unknown, and a file that
/// requires one of them is refused.
std::string lost_without(std::string_view extension) {
    struct Loss {
        std::string_view extension, loss, remedy = {};
    };
    constexpr std::string_view Images = "its images are left out; without another image, a surface "
                                        "has its factors alone";
    constexpr auto Losses = std::to_array<Loss>({
        {"EXT_lights_image_based",
         "the file brings its own environment, which does not light the scene"},
#ifndef RELUMINE_HDR_PHOTOS
        {"EXT_texture_avif", Images, ". A build with RELUMINE_HDR_PHOTOS reads them"},
#endif
        {"KHR_texture_basisu", Images,
         ". python3 -m relumine reads them: pip install relumine[basis]"},
        {"KHR_xmp", "its metadata are left out"},
        {"KHR_xmp_json_ld", "its metadata are left out"},
        {"MSFT_lod", "the finest level of detail is shown"},
        {"MSFT_texture_dds", Images},
    });
    const auto* found = std::find_if(Losses.begin(), Losses.end(),
                                     [&](const Loss& loss) { return loss.extension == extension; });
    return found == Losses.end() ? std::string() : fmt::format("{}{}", found->loss, found->remedy);
}

} // namespace

std::uint64_t whole_value(const Json& value, const char* name) {
    // Sums and products of two such numbers stay far from 2^64.
    constexpr double Max = 1e12;
    if (value.type() != Json::Type::Number || !(value.number() >= 0.0 && value.number() <= Max) ||
        value.number() != std::floor(value.number()))
        fail(name, "a whole number", value);
    return static_cast<std::uint64_t>(value.number());
}

std::uint64_t whole(const Json& object, const char* key, std::optional<std::uint64_t> fallback) {
    const Json* value = fallback ? find(object, key) : &require(object, key);
    return value == nullptr ? *fallback : whole_value(*value, key);
}

double number(const Json& object, const char* key, std::optional<double> fallback) {
    const Json* value = fallback ? find(object, key) : &require(object, key);
    if (value == nullptr)
        return *fallback;
    if (value->type() != Json::Type::Number || !std::isfinite(value->number()))
        fail(key, "a number", *value);
    return value->number();
}

bool flag(const Json& object, const char* key) {
    const Json* value = find(object, key);
    if (value != nullptr && value->type() != Json::Type::Boolean)
        fail(key, "true or false", *value);
    return value != nullptr && value->boolean();
}

std::string text(const Json& object, const char* key, const std::string& fallback) {
    const Json* value = find(object, key);
    if (value == nullptr)
        return fallback;
    if (value->type() != Json::Type::String)
        fail(key, "text", *value);
    return value->string();
}

std::vector<double> numbers(const Json& object, const char* key, std::vector<double> fallback) {
    const Json* value = find(object, key);
    if (value == nullptr)
        return fallback;
    if (value->type() != Json::Type::Array || value->size() != fallback.size() ||
        !std::all_of(value->values().begin(), value->values().end(), [](const Json& item) {
            return item.type() == Json::Type::Number && std::isfinite(item.number());
        }))
        fail(key, fmt::format("{} numbers", fallback.size()), *value);
    std::vector<double> result;
    for (const Json& item : value->values())
        result.push_back(item.number());
    return result;
}

const Json& child(const Json& object, const char* key) {
    static const Json none = Json::Object{};
    const Json* value = find(object, key);
    if (value == nullptr)
        return none;
    if (!is_structured(*value))
        fail(key, "an object or an array", *value);
    return *value;
}

const Json::Array& items(const Json& object, const char* key) {
    static const Json::Array none;
    const Json* value = find(object, key);
    if (value == nullptr)
        return none;
    if (value->type() != Json::Type::Array)
        fail(key, "an array", *value);
    return value->values();
}

Document::Document(std::span<const std::byte> file, std::filesystem::path folder,
                   std::uint64_t max_bytes)
    : folder_(std::move(folder)), file_bytes_(file.size()), json_text_(as_text(file)),
      max_bytes_(max_bytes) {
    if (json_text_.starts_with("glTF"))
        split_glb(file);
    try {
        try {
            root_ = files::parse_json(json_text_);
        } catch (const files::JsonError&) {
            // A name in the encoding of an old program must not make the whole file unreadable.
            root_ = files::parse_json(with_latin1(json_text_));
        }
    } catch (const files::JsonError& error) {
        fail("glTF's JSON", error.what());
    }
    const std::string version = text(child(root_, "asset"), "version", "none");
    if (!version.starts_with("2."))
        fail("glTF version 2", excerpt(version));
    check_extensions();
    buffers_.resize(count("buffers"));
    views_.resize(count("bufferViews"));
}

std::uint64_t Document::num_bytes() const {
    std::uint64_t result = file_bytes_;
    for (const auto& buffer : buffers_)
        result += buffer ? buffer->size() : 0;
    return result;
}

void Document::take_memory(std::uint64_t bytes) {
    num_taken_bytes_ += bytes;
    if (num_taken_bytes_ > max_bytes_)
        throw std::runtime_error(fmt::format(
            "expected a mesh that fits into {:.3g} GB, half of the free memory; got "
            "one of {:.3g} GB or more, with all repetitions",
            static_cast<double>(max_bytes_) * 1e-9, static_cast<double>(num_taken_bytes_) * 1e-9));
}

/// Finds the JSON chunk and the binary chunk behind the header. Further chunks are for extensions.
void Document::split_glb(std::span<const std::byte> file) {
    if (file.size() < 20)
        fail("a .glb file of 20 bytes or more", fmt::format("{}", file.size()));
    if (word(file, 4) != 2)
        fail("version 2 of .glb", fmt::format("{}", word(file, 4)));
    if (word(file, 8) > file.size())
        fail(fmt::format("the {} bytes that the .glb file declares", word(file, 8)),
             fmt::format("{}", file.size()));
    file = file.first(std::max<std::size_t>(word(file, 8), 20));
    constexpr std::uint32_t JsonChunk = 0x4E4F534Au, BinaryChunk = 0x004E4942u;
    if (word(file, 16) != JsonChunk || word(file, 12) > file.size() - 20)
        fail("a JSON chunk first in the .glb file",
             fmt::format("{} bytes of type {:08x}", word(file, 12), word(file, 16)));
    json_text_ = as_text(file.subspan(20, word(file, 12)));
    file = file.subspan(20 + std::size_t{word(file, 12)});
    if (file.size() < 8 || word(file, 4) != BinaryChunk)
        return;
    if (word(file, 0) > file.size() - 8)
        fail(fmt::format("a binary chunk of {} bytes", word(file, 0)),
             fmt::format("{}", file.size() - 8));
    chunk_ = file.subspan(8, word(file, 0));
}

void Document::check_extensions() {
    constexpr auto Understood = std::to_array<std::string_view>({
#ifdef RELUMINE_HDR_PHOTOS
        "EXT_texture_avif",
#endif
        "EXT_lights_ies", "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "EXT_texture_webp",
        "KHR_animation_pointer", "KHR_draco_mesh_compression", "KHR_lights_punctual",
        "KHR_materials_variants", "KHR_mesh_quantization", "KHR_meshopt_compression",
        "KHR_node_visibility", "KHR_texture_transform"});
    const auto names = [this](const char* key) {
        std::set<std::string> result;
        for (const Json& name : items(root_, key)) {
            if (name.type() != Json::Type::String)
                fail(fmt::format("names in \"{}\"", key), described(name));
            result.insert(name.string());
        }
        return result;
    };
    const auto is_understood = [&](const std::string& name) {
        return is_of_materials(name) ||
               std::find(Understood.begin(), Understood.end(), name) != Understood.end();
    };
    for (const std::string& name : names("extensionsRequired"))
        if (!is_understood(name) && lost_without(name).empty())
            fail("required extensions that are understood", excerpt(name));
    for (const std::string& name : names("extensionsUsed"))
        if (!is_understood(name))
            warnings_.push_back(fmt::format(
                "the extension {} is not read: {}", excerpt(name),
                lost_without(name).empty() ? "what it describes is left out" : lost_without(name)));
}

const Json& Document::element(const char* array, std::uint64_t index) const {
    const Json::Array& elements = items(root_, array);
    if (index >= elements.size())
        fail(fmt::format("indices of \"{}\" below {}", array, elements.size()),
             fmt::format("{}", index));
    return elements[index];
}

std::span<const std::byte> Document::buffer(std::uint64_t index) {
    const Json& description = element("buffers", index);
    const std::uint64_t num_bytes = whole(description, "byteLength");
    const std::string uri = text(description, "uri");
    std::span<const std::byte> bytes;
    if (uri.empty()) {
        if (index != 0 || !chunk_)
            fail(fmt::format("a uri of buffer {}", index), "none");
        bytes = *chunk_;
    } else {
        std::optional<std::vector<std::byte>>& loaded = buffers_[index];
        if (!loaded)
            loaded = fetch(uri);
        if (!loaded)
            fail(fmt::format("the file {} beside it", excerpt(uri)), "none");
        bytes = *loaded;
    }
    if (bytes.size() < num_bytes)
        fail(fmt::format("a buffer {} of {} bytes", index, num_bytes),
             fmt::format("{}", bytes.size()));
    return bytes.first(num_bytes);
}

std::span<const std::byte> Document::part(const Json& description, std::uint64_t view) {
    const std::span<const std::byte> bytes = buffer(whole(description, "buffer"));
    const std::uint64_t offset = whole(description, "byteOffset", 0);
    const std::uint64_t length = whole(description, "byteLength");
    if (offset > bytes.size() || length > bytes.size() - offset)
        fail(fmt::format("buffer view {} inside its buffer of {} bytes", view, bytes.size()),
             fmt::format("{} bytes at {}", length, offset));
    return bytes.subspan(offset, length);
}

std::vector<std::byte> Document::unpacked(const Json& packed, std::uint64_t view) {
    const std::span<const std::byte> data = part(packed, view);
    const MeshoptView layout{.count = whole(packed, "count"),
                             .stride = whole(packed, "byteStride"),
                             .mode = text(packed, "mode"),
                             .filter = text(packed, "filter", "NONE")};
    // As much as views of different data can give. Views of the same data would have no limit.
    num_unpacked_bytes_ += layout.count * layout.stride;
    if (num_unpacked_bytes_ / MaxMeshoptRatio > num_bytes())
        fail(fmt::format("at most {} bytes for each of the file's in packed buffer views",
                         MaxMeshoptRatio),
             "more");
    try {
        return decode_meshopt(data, layout);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("buffer view {}: {}", view, error.what()));
    }
}

std::span<const std::byte> Document::view(std::uint64_t index) {
    const Json& description = element("bufferViews", index);
    const Json& extensions = child(description, "extensions");
    const Json& ratified = child(extensions, "KHR_meshopt_compression");
    const Json& packed =
        ratified.size() != 0 ? ratified : child(extensions, "EXT_meshopt_compression");
    if (packed.size() == 0)
        return part(description, index);
    std::optional<std::vector<std::byte>>& view = views_[index];
    if (!view)
        view = unpacked(packed, index);
    return *view;
}

std::optional<std::vector<std::byte>> Document::fetch(const std::string& uri) {
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos ||
            !std::string_view(uri).substr(0, comma).ends_with(";base64"))
            fail("base64 in a data URI", excerpt(uri));
        return base64(std::string_view(uri).substr(comma + 1));
    }
    const std::string name = percent_decoded(uri);
    std::filesystem::path path = find_file(folder_, name);
    if (path.empty())
        path = find_file(folder_, latin1_bytes(name));
    if (path.empty())
        return std::nullopt;
    const auto is_as_written = [&](std::string other) {
        const bool is_whole = path == folder_ / other;
        std::replace(other.begin(), other.end(), '\\', '/');
        return is_whole || path == folder_ / other;
    };
    if (!is_as_written(name) && !is_as_written(latin1_bytes(name)))
        warnings_.push_back(
            fmt::format("{} is read from {}", uri, path.lexically_relative(folder_).string()));
    return files::read(path);
}

} // namespace relumine::mesh::gltf
