#include "mesh/formats/mtl_reader.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "files/joined.h"
#include "files/output_file.h"
#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

bool is_file(const std::filesystem::path& path) {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
}

float number_between(const TextReader& reader, std::string_view word, double min, double max) {
    const double value = reader.number(word);
    if (!(value >= min && value <= max))
        reader.fail(fmt::format("a number of {} to {}", min, max), excerpt(word));
    return static_cast<float>(value);
}

/// Reads one value of a line "Kd 0.5" or three of "Kd 0.5 0.5 0.5".
glm::vec3 color(const TextReader& reader) {
    const auto& words = reader.words();
    if (words.size() != 2 && words.size() != 4)
        reader.fail(fmt::format("1 or 3 numbers of {}", words[0]),
                    fmt::format("{}", words.size() - 1));
    glm::vec3 result(0.0f);
    for (int i = 0; i < 3; ++i)
        result[i] = number_between(
            reader, words[words.size() == 2 ? 1 : static_cast<std::size_t>(i) + 1], 0.0, 1.0);
    return result;
}

float scalar(const TextReader& reader, double max) {
    const auto& words = reader.words();
    if (words.size() != 2)
        reader.fail(fmt::format("1 number of {}", words[0]), fmt::format("{}", words.size() - 1));
    return number_between(reader, words[1], 0.0, max);
}

std::string rest_of(std::span<const std::string_view> words) {
    return files::joined(words, " ");
}

bool is_number(std::string_view word) {
    return !word.empty() && word.find_first_not_of("0123456789+-.eE") == std::string_view::npos;
}

} // namespace

std::filesystem::path find_file(const std::filesystem::path& folder, const std::string& name) {
    if (name.empty())
        return {};
    if (is_file(folder / name))
        return folder / name;
    std::string with_slashes = name;
    std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
    return is_file(folder / with_slashes) ? folder / with_slashes : std::filesystem::path();
}

void MtlLibrary::read(const std::string& name) {
    const std::filesystem::path path = find_file(folder_, name);
    if (path.empty()) {
        missing.push_back(name);
        return;
    }
    has_library_ = true;
    const std::vector<std::byte> bytes = files::read(path);
    try {
        parse(bytes, path.parent_path());
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("{}: {}", name, error.what()));
    }
}

std::uint32_t MtlLibrary::add(const std::string& name) {
    const auto [place, is_new] =
        indices_.try_emplace(name, static_cast<std::uint32_t>(materials.size()));
    if (is_new)
        materials.emplace_back();
    materials[place->second] = {.name = name};
    return place->second;
}

std::uint32_t MtlLibrary::index_of(const std::string& name) {
    if (const auto found = indices_.find(name); found != indices_.end())
        return found->second;
    if (has_library_ && !name.empty())
        missing.push_back(fmt::format("material {}", name));
    return add(name);
}

/// Reads map_Kd [options] file name. The name may have blanks, so options end at the first unknown
/// one.
std::optional<TextureSlot> MtlLibrary::texture(std::span<const std::string_view> words,
                                               const TextReader& reader,
                                               const std::filesystem::path& folder) {
    TextureSlot slot{.is_srgb = true};
    glm::vec2 scale(1.0f);
    while (!words.empty() && words[0].starts_with('-')) {
        const std::string_view option = words[0];
        // The largest and the smallest number of an option's arguments.
        const bool is_vector = option == "-s" || option == "-o" || option == "-t";
        const bool is_pair = option == "-mm";
        const bool is_single = option == "-clamp" || option == "-blendu" || option == "-blendv" ||
                               option == "-cc" || option == "-boost" || option == "-texres" ||
                               option == "-bm" || option == "-imfchan" || option == "-type";
        if (!is_vector && !is_pair && !is_single)
            break; // a name that begins with -
        std::size_t num_arguments = is_vector ? 0 : is_pair ? 2 : 1;
        while (is_vector && num_arguments < 3 && num_arguments + 1 < words.size() &&
               is_number(words[num_arguments + 1]))
            ++num_arguments;
        if (num_arguments == 0 || words.size() < num_arguments + 1)
            reader.fail(fmt::format("arguments of {}", option), "the end of the line");
        if (option == "-clamp" && words[1] == "on")
            slot.wrap = {Wrap::Clamp, Wrap::Clamp};
        if (option == "-s" || option == "-o")
            for (std::size_t i = 0; i < std::min<std::size_t>(num_arguments, 2); ++i)
                (option == "-s" ? scale : slot.uv_offset)[static_cast<int>(i)] =
                    number_between(reader, words[i + 1], -1e6, 1e6);
        words = words.subspan(num_arguments + 1);
    }
    if (words.empty())
        reader.fail("the file name of a texture", "none");
    slot.uv_from_mesh_uv = glm::mat2(scale.x, 0.0f, 0.0f, scale.y);
    const std::string name = rest_of(words);
    const std::filesystem::path path = find_file(folder, name);
    if (path.empty()) {
        if (std::find(missing.begin(), missing.end(), name) == missing.end())
            missing.push_back(name);
        return std::nullopt;
    }
    const auto [place, is_new] =
        texture_indices_.try_emplace(path.string(), static_cast<std::uint32_t>(textures.size()));
    if (is_new) {
        const std::vector<std::byte> bytes = files::read(path);
        try {
            textures.push_back(decode_texture(bytes, VOrigin::Bottom));
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(fmt::format("{}: {}", name, error.what()));
        }
        textures.back().name = name;
    }
    slot.texture = place->second;
    return slot;
}

void MtlLibrary::parse(std::span<const std::byte> bytes, const std::filesystem::path& folder) {
    TextReader reader(as_text(bytes), '#');
    constexpr std::uint32_t None = 0xffffffffu;
    std::uint32_t current = None;
    while (reader.next_line()) {
        const auto& words = reader.words();
        const std::string_view keyword = words[0];
        if (keyword == "newmtl") {
            current = add(rest_of(std::span(words).subspan(1)));
            continue;
        }
        const bool is_known = keyword == "Kd" || keyword == "Ks" || keyword == "Ns" ||
                              keyword == "Pr" || keyword == "Pm" || keyword == "map_Kd";
        if (!is_known)
            continue;
        if (current == None)
            reader.fail("newmtl before the first value", excerpt(keyword));
        Material& material = materials[current];
        if (keyword == "Kd")
            material.base_color = color(reader);
        else if (keyword == "Ks")
            material.specular = color(reader);
        else if (keyword == "Ns")
            material.exponent = scalar(reader, 1e6);
        else if (keyword == "map_Kd")
            material.base_color_texture = texture(std::span(words).subspan(1), reader, folder);
        else {
            (keyword == "Pr" ? material.roughness : material.metallic) = scalar(reader, 1.0);
            material.model = MaterialModel::MetallicRoughness;
        }
    }
}

} // namespace relumine::mesh
