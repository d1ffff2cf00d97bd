#include "mesh/formats/mtl_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/joined.h"
#include "files/output_file.h"
#include "mesh/formats/clamped.h"
#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

bool is_file(const std::filesystem::path& path) {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
}

double finite(const TextReader& reader, std::string_view word) {
    const double value = reader.number(word);
    if (!std::isfinite(value))
        reader.fail("a finite number", excerpt(word));
    return value;
}

float number_between(const TextReader& reader, std::string_view word, double min, double max) {
    const double value = reader.number(word);
    if (!(value >= min && value <= max))
        reader.fail(fmt::format("a number of {} to {}", min, max), excerpt(word));
    return static_cast<float>(value);
}

std::string rest_of(std::span<const std::string_view> words) {
    return files::joined(words, " ");
}

bool is_number(std::string_view word) {
    return !word.empty() && word.find_first_not_of("0123456789+-.eE") == std::string_view::npos;
}

std::string in_small_letters(std::string_view text) {
    std::string result(text);
    for (char& letter : result)
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return result;
}

/// Returns the entry of a folder with a name, whatever its capitals; of several the first by name.
std::filesystem::path entry_named(const std::filesystem::path& folder, const std::string& name) {
    std::error_code error;
    if (name == ".." || std::filesystem::exists(folder / name, error))
        return folder / name;
    std::filesystem::path found;
    for (const auto& entry : std::filesystem::directory_iterator(
             folder.empty() ? std::filesystem::path(".") : folder, error)) {
        const std::filesystem::path other = entry.path().filename();
        if (in_small_letters(other.string()) == in_small_letters(name) &&
            (found.empty() || other < found.filename()))
            found = folder / other;
    }
    return found;
}

/// Returns the comments at the beginning of a library, which name the program that wrote it.
std::string comments_of(std::string_view text) {
    constexpr std::size_t Beginning = 1024;
    std::string result;
    TextReader reader(text.substr(0, std::min(text.find('\0'), Beginning)));
    while (reader.next_line())
        if (reader.words()[0].starts_with('#'))
            result += in_small_letters(files::joined(reader.words(), " ")) + "\n";
    return result;
}

} // namespace

std::filesystem::path find_file(const std::filesystem::path& folder, const std::string& name) {
    if (name.empty())
        return {};
    if (is_file(folder / name))
        return folder / name;
    std::string with_slashes = name;
    std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
    if (is_file(folder / with_slashes))
        return folder / with_slashes;
    std::vector<std::string> parts;
    for (const std::filesystem::path& part : std::filesystem::path(with_slashes))
        if (part != "/" && part != "." && !part.empty())
            parts.push_back(part.string());
    for (std::size_t first = 0; first < parts.size(); ++first) {
        std::filesystem::path path = folder;
        for (std::size_t i = first; i < parts.size(); ++i) {
            path = entry_named(path, parts[i]);
            if (path.empty())
                break;
        }
        if (!path.empty() && is_file(path))
            return path;
        // Only a path as it is written leads out of the folder.
        while (first + 1 < parts.size() && parts[first + 1] == "..")
            ++first;
    }
    return {};
}

/// Finds a file, and says where it is not the one that is named. Names it among the missing.
std::optional<std::filesystem::path> MtlLibrary::find(const std::filesystem::path& folder,
                                                      const std::string& name) {
    const std::filesystem::path path = find_file(folder, name);
    if (path.empty()) {
        if (std::find(missing.begin(), missing.end(), name) == missing.end())
            missing.push_back(name);
        return std::nullopt;
    }
    std::string with_slashes = name;
    std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
    const std::string note =
        fmt::format("{} is read from {}", name, path.lexically_relative(folder_).string());
    if (path != folder / name && path != folder / with_slashes &&
        std::find(notes.begin(), notes.end(), note) == notes.end())
        notes.push_back(note);
    return path;
}

/// Reads one value of a line "Kd 0.5" or three of "Kd 0.5 0.5 0.5".
glm::vec3 MtlLibrary::color(const Material& material, const TextReader& reader, double max) {
    const auto& words = reader.words();
    if (words.size() != 2 && words.size() != 4)
        reader.fail(fmt::format("1 or 3 numbers of {}", words[0]),
                    fmt::format("{}", words.size() - 1));
    glm::vec3 result(0.0f);
    std::vector<std::string> warnings;
    for (std::size_t i = 0; i < 3; ++i)
        result[static_cast<int>(i)] = static_cast<float>(
            clamped("material " + material.name, words[0],
                    finite(reader, words[words.size() == 2 ? 1 : i + 1]), 0.0, max, warnings));
    if (!warnings.empty())
        warnings_.push_back(warnings.front());
    return result;
}

float MtlLibrary::scalar(const Material& material, const TextReader& reader, double max) {
    const auto& words = reader.words();
    if (words.size() != 2)
        reader.fail(fmt::format("1 number of {}", words[0]), fmt::format("{}", words.size() - 1));
    return static_cast<float>(clamped("material " + material.name, words[0],
                                      finite(reader, words[1]), 0.0, max, warnings_));
}

void MtlLibrary::read(const std::string& name) {
    const std::optional<std::filesystem::path> path = find(folder_, name);
    if (!path)
        return;
    has_library_ = true;
    const std::vector<std::byte> bytes = files::read(*path);
    try {
        parse(bytes, name, path->parent_path());
    } catch (const std::runtime_error& error) {
        is_broken_ = true;
        warnings_.push_back(
            fmt::format("{} cannot be read, its materials are grey: {}", name, error.what()));
    }
}

std::uint32_t MtlLibrary::add(const std::string& name) {
    const auto [place, is_new] =
        indices_.try_emplace(name, static_cast<std::uint32_t>(materials.size()));
    if (is_new)
        materials.emplace_back();
    materials[place->second] = {.name = name};
    unsettled_[place->second] = {};
    return place->second;
}

std::uint32_t MtlLibrary::index_of(const std::string& name) {
    if (const auto found = indices_.find(name); found != indices_.end())
        return found->second;
    if (has_library_ && !is_broken_ && !name.empty())
        missing.push_back(fmt::format("material {}", name));
    const std::uint32_t index = add(name);
    if (is_broken_)
        materials[index] = unreadable_material(name);
    return index;
}

/// Reads map_Kd [options] file name. The name may have blanks, so options end at the first unknown
/// one.
std::optional<TextureSlot> MtlLibrary::texture(std::span<const std::string_view> words,
                                               const TextReader& reader,
                                               const std::filesystem::path& folder, bool is_alpha) {
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
        if (option == "-bm")
            bump_ = number_between(reader, words[1], -1e6, 1e6);
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
    const std::optional<std::filesystem::path> path = find(folder, name);
    if (!path)
        return std::nullopt;
    const std::optional<std::uint32_t> index = texture_of(*path, name, is_alpha);
    if (!index)
        return std::nullopt;
    slot.texture = *index;
    return slot;
}

/// Returns the texture of an image file, or of its alpha. Each is read once.
std::optional<std::uint32_t> MtlLibrary::texture_of(const std::filesystem::path& path,
                                                    const std::string& name, bool is_alpha) {
    const auto [place, is_new] = texture_indices_.try_emplace({path.string(), is_alpha});
    if (!is_new)
        return place->second;
    try {
        const std::vector<std::byte> file = files::read(path);
        textures.push_back(is_alpha ? decode_alpha_texture(file, VOrigin::Bottom, budget_)
                                    : decode_texture(file, VOrigin::Bottom, budget_));
        textures.back().name = is_alpha ? name + " (alpha)" : name;
        place->second = static_cast<std::uint32_t>(textures.size() - 1);
    } catch (const std::runtime_error& error) {
        warnings_.push_back(fmt::format("the image {} is left out: {}", name, error.what()));
    }
    return place->second;
}

/// Drops a texture that was read for nothing, if it is a new one.
void MtlLibrary::forget(std::uint32_t texture, std::size_t num_before) {
    if (textures.size() == num_before)
        return;
    textures.pop_back();
    std::erase_if(texture_indices_, [&](const auto& one) { return one.second == texture; });
}

/// Notes statements that change what a surface looks like and are not read.
void MtlLibrary::note_unread(std::span<const std::string_view> words) {
    constexpr std::array<std::string_view, 13> Maps = {
        "map_Ns", "map_Bump", "map_bump", "bump",   "disp",     "refl", "map_Tr",
        "map_Ps", "map_Pc",   "map_Pcr",  "map_Tf", "map_disp", "decal"};
    constexpr std::array<std::string_view, 2> Numbers = {"aniso", "anisor"};
    const std::string_view keyword = words[0];
    const auto is_only = [&](std::string_view digit) { // 0, 0.0, 1.000 ...
        return std::all_of(words.begin() + 1, words.end(), [&](std::string_view word) {
            return word.starts_with(digit) &&
                   word.find_first_not_of("0.", digit.size()) == std::string_view::npos;
        });
    };
    const bool is_unread =
        std::find(Maps.begin(), Maps.end(), keyword) != Maps.end() ||
        (std::find(Numbers.begin(), Numbers.end(), keyword) != Numbers.end() && !is_only("0")) ||
        (keyword == "Tf" && !is_only("1"));
    if (is_unread)
        note(keyword);
}

void MtlLibrary::note(std::string_view unread) {
    if (std::find(unread_.begin(), unread_.end(), unread) == unread_.end())
        unread_.emplace_back(unread);
}

std::vector<std::string> MtlLibrary::take_warnings() {
    if (!unread_.empty())
        warnings_.push_back(fmt::format("the materials have {}, which {} not read",
                                        files::joined(unread_, ", "),
                                        unread_.size() == 1 ? "is" : "are"));
    return std::move(warnings_);
}

/// Whether the texels are vectors of length 1 that stand on the surface, not heights.
bool is_of_normals(const Texture& texture) {
    std::size_t num_normals = 0;
    for (const auto& texel : texture.texels) {
        const glm::vec3 n = glm::vec3(texel[0], texel[1], texel[2]) / 127.5f - 1.0f;
        num_normals += n.z > 0.0f && std::abs(glm::length(n) - 1.0f) < 0.15f ? 1 : 0;
    }
    constexpr double Most = 0.9;
    return static_cast<double>(num_normals) >= Most * static_cast<double>(texture.texels.size());
}

/// Reads `norm`, and `bump` where its image has normals: many programs write these so.
void MtlLibrary::read_normal_map(Material& material, const TextReader& reader,
                                 const std::filesystem::path& folder) {
    bump_ = 1.0f;
    const std::size_t num_before = textures.size();
    std::optional<TextureSlot> slot = texture(std::span(reader.words()).subspan(1), reader, folder);
    if (!slot)
        return;
    if (reader.words()[0] != "norm" && !is_of_normals(textures[slot->texture])) {
        note_unread(reader.words());
        forget(slot->texture, num_before);
        return;
    }
    slot->is_srgb = false;
    material.normal_scale = bump_;
    if (bump_ != 0.0f)
        material.normal_texture = slot;
}

/// Reads map_d: a grey image, or one whose alpha is meant. One of black and white alone is a mask.
void MtlLibrary::read_alpha_map(Material& material, const TextReader& reader,
                                const std::filesystem::path& folder) {
    const auto words = std::span(reader.words()).subspan(1);
    const auto is_full = [](const auto& texel) {
        return texel[0] == 255;
    };
    const std::size_t num_before = textures.size();
    std::optional<TextureSlot> slot = texture(words, reader, folder, true);
    if (slot && std::all_of(textures[slot->texture].texels.begin(),
                            textures[slot->texture].texels.end(), is_full)) {
        forget(slot->texture, num_before);
        slot = texture(words, reader, folder);
    }
    if (!slot)
        return;
    slot->is_srgb = false;
    const auto& texels = textures[slot->texture].texels;
    const auto num_sharp = std::count_if(texels.begin(), texels.end(), [](const auto& texel) {
        return texel[0] < 16 || texel[0] > 239;
    });
    constexpr double LeastOfMask = 0.9;
    material.alpha_mode =
        static_cast<double>(num_sharp) >= LeastOfMask * static_cast<double>(texels.size())
            ? AlphaMode::Mask
            : AlphaMode::Blend;
    material.alpha_texture = slot;
}

/// Reads the extension for physically based rendering.
bool MtlLibrary::read_physical(Material& material, const TextReader& reader,
                               const std::filesystem::path& folder) {
    const std::vector<std::string_view>& words = reader.words();
    const std::string_view keyword = words[0];
    const auto map = [&](std::optional<TextureSlot>& slot) {
        slot = texture(std::span(words).subspan(1), reader, folder);
        if (slot)
            slot->is_srgb = false;
    };
    if (keyword == "Pr")
        material.roughness = scalar(material, reader);
    else if (keyword == "Pm")
        material.metallic = scalar(material, reader);
    else if (keyword == "Pc")
        material.coat = scalar(material, reader);
    else if (keyword == "Pcr")
        material.coat_roughness = scalar(material, reader);
    else if (keyword == "Ps")
        material.sheen = glm::vec3(scalar(material, reader));
    else if (keyword == "map_Pr")
        map(material.roughness_texture);
    else if (keyword == "map_Pm")
        map(material.metallic_texture);
    else
        return false;
    material.model = MaterialModel::MetallicRoughness;
    return true;
}

/// Reads a statement of a material.
void MtlLibrary::read_value(Material& material, const TextReader& reader,
                            const std::filesystem::path& folder) {
    const std::vector<std::string_view>& words = reader.words();
    const std::string_view keyword = words[0];
    const auto map = [&] {
        return texture(std::span(words).subspan(1), reader, folder);
    };
    if (keyword == "Kd")
        material.base_color = color(material, reader);
    else if (keyword == "Ks")
        material.specular = color(material, reader);
    else if (keyword == "Ke")
        material.emission = color(material, reader, 1e6);
    else if (keyword == "Ns")
        material.exponent = scalar(material, reader, 1e6);
    else if (keyword == "d" || keyword == "Tr")
        read_alpha(material, reader);
    else if (keyword == "Ka")
        unsettled_[index_of(material.name)].ambient = color(material, reader, 1e6).r;
    else if (keyword == "illum")
        unsettled_[index_of(material.name)].illumination =
            static_cast<int>(scalar(material, reader, 100.0));
    else if (keyword == "map_Kd")
        material.base_color_texture = map();
    else if (keyword == "map_Ks")
        material.specular_texture = map();
    else if (keyword == "map_Ke")
        material.emission_texture = map();
    else if (keyword == "map_d")
        read_alpha_map(material, reader, folder);
    else if (keyword == "norm" ||
             ((keyword == "map_Bump" || keyword == "map_bump" || keyword == "bump") &&
              material.normal_texture == std::nullopt))
        read_normal_map(material, reader, folder);
    else if (!read_physical(material, reader, folder))
        note_unread(words);
}

/// Reads d, d -halo, whose part that depends on the eye is left out, or Tr.
void MtlLibrary::read_alpha(const Material& material, const TextReader& reader) {
    const std::span<const std::string_view> words = reader.words();
    Unsettled& own = unsettled_[index_of(material.name)];
    if (words.size() == 3 && words[1] == "-halo") {
        note("d -halo");
        own.d = static_cast<float>(clamped("material " + material.name, "d",
                                           finite(reader, words[2]), 0.0, 1.0, warnings_));
        return;
    }
    (words[0] == "d" ? own.d : own.transparency) = scalar(material, reader);
}

/// Tr is 1 - d, but some programs write d there. So where only Tr stands, MeshLab's is d, and that
/// of a library is which has 1 and never 0: 1 - d would be invisible.
void MtlLibrary::settle_alphas(Writer writer) {
    bool has_zero = false, has_one = false;
    for (const auto& [index, own] : unsettled_) {
        has_zero = has_zero || (!own.d && own.transparency == 0.0f);
        has_one = has_one || (!own.d && own.transparency == 1.0f);
    }
    const bool is_opacity = writer == Writer::MeshLab || (has_one && !has_zero);
    if (is_opacity && has_one)
        notes.emplace_back(writer == Writer::MeshLab
                               ? "Tr 1 is opaque, as MeshLab writes it"
                               : "Tr 1 is taken as opaque: as transparency it would be invisible");
    std::vector<std::string> invisible;
    for (const auto& [index, own] : unsettled_) {
        const float of_tr =
            own.transparency ? is_opacity ? *own.transparency : 1.0f - *own.transparency : 1.0f;
        Material& material = materials[index];
        material.alpha = own.d.value_or(of_tr);
        if (material.alpha == 0.0f && material.alpha_texture)
            material.alpha = 1.0f; // the map says something
        if (material.alpha == 0.0f)
            invisible.push_back(material.name);
        if (material.alpha < 1.0f && material.alpha_mode == AlphaMode::Opaque)
            material.alpha_mode = AlphaMode::Blend;
    }
    if (!invisible.empty())
        warnings_.push_back(fmt::format("{} invisible, since d is 0 or Tr 1: {}",
                                        invisible.size() == 1 ? "a material is" : "materials are",
                                        files::joined(invisible, ", ")));
}

/// Blender's exporter writes the Specular of its Principled BSDF into Ks, its roughness into Ns,
/// and metallic into Ka. MeshLab writes Ks 1 whatever it shows.
void MtlLibrary::settle_highlights(Writer writer) {
    std::size_t num_read = 0;
    for (const auto& [index, own] : unsettled_) {
        Material& material = materials[index];
        if (writer == Writer::Other || material.model != MaterialModel::Phong)
            continue;
        const float specular = material.specular.r;
        if (specular == 0.0f && !material.specular_texture)
            continue;
        ++num_read;
        material.specular = glm::vec3(0.0f);
        if (writer == Writer::MeshLab)
            continue;
        // Specular 0.5 is an F0 of 0.04.
        const float mirror = writer == Writer::Blender ? 1000.0f : 900.0f;
        material.model = MaterialModel::MetallicRoughness;
        material.roughness = 1.0f - std::sqrt(std::min(material.exponent / mirror, 1.0f));
        material.metallic =
            own.illumination == 3 || own.illumination == 6 ? std::min(own.ambient, 1.0f) : 0.0f;
        material.specular_tint = glm::vec3(2.0f * specular);
        material.exponent = 0.0f;
    }
    if (num_read != 0)
        notes.emplace_back(
            writer == Writer::MeshLab
                ? "Ks is left out: MeshLab writes it whatever it shows"
                : "Ks and Ns are read as Specular and roughness, as Blender writes them");
}

/// Settles what statements mean together.
void MtlLibrary::finish(Material& material) {
    // A map says something beside a factor of 0, which many programs write, and beside none.
    if (material.emission_texture && material.emission == glm::vec3(0.0f))
        material.emission = glm::vec3(1.0f);
    if (material.metallic_texture && material.metallic == 0.0f)
        material.metallic = 1.0f;
    if (material.model == MaterialModel::Phong) {
        if (material.specular_texture && material.specular == glm::vec3(0.0f))
            material.specular = glm::vec3(1.0f);
        return;
    }
    // The format has no roughness of fibres.
    constexpr float RoughnessOfCloth = 0.5f;
    if (material.sheen != glm::vec3(0.0f))
        material.sheen_roughness = RoughnessOfCloth;
    if (material.specular_texture) {
        note("map_Ks of materials with a roughness");
        material.specular_texture.reset();
    }
}

void MtlLibrary::parse(std::span<const std::byte> bytes, const std::string& name,
                       const std::filesystem::path& folder) {
    const std::string comments = comments_of(as_text(bytes));
    // Those before 3.3 do not name their version, and have another scale of Ns.
    const Writer writer = comments.find("meshlab") != std::string::npos         ? Writer::MeshLab
                          : comments.find("# blender mtl") != std::string::npos ? Writer::BlenderOld
                          : comments.find("# blender") != std::string::npos     ? Writer::Blender
                                                                                : Writer::Other;
    TextReader reader(as_text(bytes), '#');
    unsettled_.clear();
    std::optional<std::uint32_t> current;
    while (reader.next_line()) {
        const std::vector<std::string_view>& words = reader.words();
        if (words[0] == "newmtl") {
            current = add(rest_of(std::span(words).subspan(1)));
            continue;
        }
        if (!current) // of no material
            continue;
        try {
            read_value(materials[*current], reader, folder);
        } catch (const std::runtime_error& error) {
            warnings_.push_back(fmt::format("{} of the material {} is left out: {}: {}", words[0],
                                            materials[*current].name, name, error.what()));
        }
    }
    settle_alphas(writer);
    settle_highlights(writer);
    for (const auto& [index, own] : unsettled_)
        finish(materials[index]);
}

} // namespace relumine::mesh
