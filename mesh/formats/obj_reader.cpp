// Reads Wavefront OBJ: v (with colours), vt, vn, f, o, g, s, mtllib and usemtl. The rest of the
// format (lines, curves) is skipped.
//
// The project has its own reader, because no library in Debian reads OBJ without silent changes:
// - OpenMesh drops vertices with an unreadable or non-finite number, so later indices mean other
//   vertices, and drops faces with a continued line.
// - tinyobjloader reads such numbers as 0, wraps indices at 32 bits, takes a comment behind a face
//   for corners, and stores at most 255 corners per face.
// - Assimp makes a vertex of every corner.
// - CGAL refuses lines and points, misreads tabs, and does not know continued lines.
#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/extension.h"
#include "files/joined.h"
#include "mesh/formats/corner_vertices.h"
#include "mesh/formats/mtl_reader.h"
#include "mesh/formats/polygon_soup.h"
#include "mesh/formats/soup_colors.h"
#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

constexpr std::uint32_t NoIndex = std::numeric_limits<std::uint32_t>::max();

/// Indices of an OBJ corner, counted from 0. NoIndex: no texture coordinate or no normal.
struct Corner {
    std::uint32_t position = NoIndex;
    std::uint32_t uv = NoIndex;
    std::uint32_t normal = NoIndex;
};

class ObjReader {
public:
    ObjReader(std::string_view text, const std::filesystem::path& folder)
        : reader_(text, '#'), folder_(folder), library_(folder) {}
    PolygonSoup read();

private:
    bool next_statement();
    void read_vertex();
    void read_uv();
    void read_face();
    void read_libraries();
    void begin_group();
    [[nodiscard]] std::string rest_of_statement() const;
    [[nodiscard]] std::uint32_t index(std::string_view word, std::size_t count) const;
    [[nodiscard]] Corner corner(std::string_view word) const;
    void check_indices();
    [[nodiscard]] bool sum_normals();
    void gather_normals();
    void read_smoothing();
    void gather_smoothing();
    void gather_uvs();
    void gather_corner_uvs();
    void gather_materials();

    TextReader reader_;
    std::filesystem::path folder_;
    MtlLibrary library_;
    /// Distinct names, in the order of use.
    std::vector<std::string> used_materials_;
    std::map<std::string, std::uint32_t> material_indices_, group_indices_;
    /// Material and group of the next faces.
    std::uint32_t material_ = NoIndex, group_ = NoIndex;
    /// Smoothing group of the next faces. The groups of faces are gathered at each change.
    std::uint32_t smoothing_ = 1;
    std::vector<std::string_view> words_;
    PolygonSoup soup_;
    std::vector<glm::vec2> uvs_;
    std::vector<glm::vec3> normals_;
    /// Parallel to soup_.corners.
    std::vector<Corner> corners_;
};

/// Reads a statement: a line, and the lines that a backslash at its end joins to it.
bool ObjReader::next_statement() {
    words_.clear();
    while (reader_.next_line()) {
        words_.insert(words_.end(), reader_.words().begin(), reader_.words().end());
        if (!words_.back().ends_with('\\'))
            return true;
        words_.back().remove_suffix(1);
        if (words_.back().empty())
            words_.pop_back();
    }
    return !words_.empty();
}

void ObjReader::read_vertex() {
    // The values are x y z, x y z w, x y z r g b or x y z r g b a. The weight w is for curves
    // alone.
    const std::size_t num_values = words_.size() - 1;
    if (num_values < 3 || num_values == 5 || num_values > 7)
        reader_.fail("3, 4, 6 or 7 numbers of a vertex", fmt::format("{}", num_values));
    std::array<double, 7> values{};
    for (std::size_t i = 0; i < num_values; ++i)
        values[i] = reader_.number(words_[i + 1]);
    if (num_values >= 6) {
        soup_.colors.resize(soup_.positions.size(), no_color());
        soup_.colors.emplace_back(glm::dvec3(values[3], values[4], values[5]));
    }
    soup_.add_position({values[0], values[1], values[2]});
}

void ObjReader::read_uv() {
    if (words_.size() < 2 || words_.size() > 4)
        reader_.fail("1, 2 or 3 texture coordinates", fmt::format("{}", words_.size() - 1));
    uvs_.emplace_back(reader_.number(words_[1]),
                      words_.size() > 2 ? reader_.number(words_[2]) : 0.0);
}

/// Returns an index counted from 0. The file counts from 1, or backwards from the newest element
/// (-1). An index may refer to elements later in the file.
std::uint32_t ObjReader::index(std::string_view word, std::size_t count) const {
    const std::int64_t written = reader_.integer(word);
    const std::int64_t result =
        written > 0 ? written - 1 : static_cast<std::int64_t>(count) + written;
    if (written == 0 || result < 0 || result >= std::int64_t{NoIndex})
        reader_.fail(fmt::format("an index (1 is the first, -1 the newest of {})", count),
                     excerpt(word));
    return static_cast<std::uint32_t>(result);
}

/// Reads v, v/t, v//n or v/t/n. v/ and v// occur too.
Corner ObjReader::corner(std::string_view word) const {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const std::string_view rest = word.substr(std::min(slash + 1, word.size()));
    const std::size_t second_slash = std::min(rest.find('/'), rest.size());
    const std::string_view uv = rest.substr(0, second_slash);
    const std::string_view normal = rest.substr(std::min(second_slash + 1, rest.size()));
    Corner result;
    result.position = index(word.substr(0, slash), soup_.positions.size());
    if (!uv.empty())
        result.uv = index(uv, uvs_.size());
    if (!normal.empty())
        result.normal = index(normal, normals_.size());
    return result;
}

void ObjReader::read_face() {
    for (std::size_t i = 1; i < words_.size(); ++i) {
        corners_.push_back(corner(words_[i]));
        soup_.corners.push_back(corners_.back().position);
    }
    soup_.end_face();
    soup_.face_materials.push_back(material_);
    soup_.face_groups.push_back(group_);
}

std::string ObjReader::rest_of_statement() const {
    return files::joined(std::span(words_).subspan(1), " ");
}

/// Reads one name with blanks, or several names, with blanks or without. All occur.
void ObjReader::read_libraries() {
    const std::string whole = rest_of_statement();
    if (words_.size() == 2 || !find_file(folder_, whole).empty()) {
        library_.read(whole);
        return;
    }
    std::string name;
    for (std::size_t i = 1; i < words_.size(); ++i) {
        name += (name.empty() ? "" : " ") + std::string(words_[i]);
        if (i + 1 == words_.size() || files::extension_of(words_[i]) == ".mtl")
            library_.read(std::exchange(name, {}));
    }
}

/// Begins an object or a group. The newest o or g names the next faces.
void ObjReader::begin_group() {
    const std::string name = words_.size() > 1 ? rest_of_statement() : std::string("default");
    const auto [place, is_new] =
        group_indices_.try_emplace(name, static_cast<std::uint32_t>(soup_.groups.size()));
    if (is_new)
        soup_.groups.push_back(name);
    group_ = place->second;
}

/// Many files refer to texture coordinates or normals but have none. Such files are read without
/// them.
void ObjReader::check_indices() {
    const auto check = [](const char* what, std::uint32_t index, std::size_t count) {
        if (index != NoIndex && index >= count)
            throw std::runtime_error(fmt::format("expected {} indices of 1 to {}, got {}", what,
                                                 count, std::uint64_t{index} + 1));
    };
    for (Corner& corner : corners_) {
        if (uvs_.empty())
            corner.uv = NoIndex;
        if (normals_.empty())
            corner.normal = NoIndex;
        check("vertex", corner.position, soup_.positions.size());
        check("texture coordinate", corner.uv, uvs_.size());
        check("normal", corner.normal, normals_.size());
    }
}

/// Reads the smoothing group of the next faces: a number, or off. The faces before the first such
/// statement are smooth.
void ObjReader::read_smoothing() {
    soup_.face_smoothing.resize(soup_.face_ends.size(), smoothing_);
    const std::string_view word = words_.size() > 1 ? words_[1] : "on";
    if (word == "off")
        smoothing_ = 0;
    else if (std::from_chars(word.data(), word.data() + word.size(), smoothing_).ec != std::errc())
        smoothing_ = 1;
}

/// A vertex whose corners have normals that are alike gets their sum. A corner without a normal
/// takes what the others of its vertex have. Returns false if those of some vertex differ.
bool ObjReader::sum_normals() {
    std::vector<glm::vec3> sums(soup_.positions.size(), glm::vec3(0.0f)), first = sums;
    for (const Corner& corner : corners_) {
        const glm::vec3 normal =
            corner.normal == NoIndex ? glm::vec3(0.0f) : normals_[corner.normal];
        const float length = glm::length(normal);
        if (!(length > 0.0f))
            continue;
        glm::vec3& of_vertex = first[corner.position];
        if (of_vertex == glm::vec3(0.0f))
            of_vertex = normal / length;
        if (!are_alike(of_vertex, normal / length))
            return false;
        sums[corner.position] += normal / length;
    }
    const auto is_one = [](const glm::vec3& normal) {
        return normal != glm::vec3(0.0f);
    };
    if (std::any_of(first.begin(), first.end(), is_one))
        soup_.normals = std::move(sums);
    return true;
}

void ObjReader::gather_normals() {
    if (normals_.empty() || sum_normals())
        return;
    soup_.corner_normals.reserve(corners_.size());
    for (const Corner& corner : corners_)
        soup_.corner_normals.push_back(corner.normal == NoIndex ? glm::vec3(0.0f)
                                                                : normals_[corner.normal]);
}

/// One group for all is none.
void ObjReader::gather_smoothing() {
    std::vector<std::uint32_t>& groups = soup_.face_smoothing;
    groups.resize(soup_.face_ends.size(), smoothing_);
    if (groups.empty() ||
        (groups.front() != 0 &&
         std::adjacent_find(groups.begin(), groups.end(), std::not_equal_to<>()) == groups.end()))
        groups.clear();
}

/// The mesh has uvs if every corner has a texture coordinate and the corners of each vertex agree.
void ObjReader::gather_uvs() {
    std::vector<std::optional<glm::vec2>> gathered(soup_.positions.size());
    for (const Corner& corner : corners_) {
        if (corner.uv == NoIndex)
            return;
        std::optional<glm::vec2>& uv = gathered[corner.position];
        if (uv && *uv != uvs_[corner.uv])
            return;
        uv = uvs_[corner.uv];
    }
    soup_.uvs.reserve(gathered.size());
    for (const std::optional<glm::vec2>& uv : gathered)
        soup_.uvs.push_back(uv.value_or(glm::vec2(0.0f)));
}

/// Used if the corners of a vertex disagree. Each corner has its own uv; a corner without one gets
/// (0, 0).
void ObjReader::gather_corner_uvs() {
    if (!soup_.uvs.empty() || uvs_.empty())
        return;
    soup_.corner_uvs.reserve(corners_.size());
    for (const Corner& corner : corners_)
        soup_.corner_uvs.push_back(corner.uv == NoIndex ? glm::vec2(0.0f) : uvs_[corner.uv]);
}

/// Turns names into materials at the end, because libraries may follow the faces. Faces before the
/// first usemtl or o have "default".
void ObjReader::gather_materials() {
    if (used_materials_.empty()) {
        soup_.face_materials.clear();
    } else {
        std::vector<std::uint32_t> indices;
        for (const std::string& name : used_materials_)
            indices.push_back(library_.index_of(name));
        for (std::uint32_t& material : soup_.face_materials) {
            if (material == NoIndex) {
                material = static_cast<std::uint32_t>(indices.size());
                indices.push_back(static_cast<std::uint32_t>(library_.materials.size()));
                library_.materials.push_back({.name = "default"});
                std::replace(soup_.face_materials.begin(), soup_.face_materials.end(), NoIndex,
                             material);
            }
            material = indices[material];
        }
        soup_.materials = std::move(library_.materials);
        soup_.textures = std::move(library_.textures);
    }
    soup_.missing = std::move(library_.missing);
    soup_.notes = std::move(library_.notes);
    for (std::string& warning : library_.take_warnings())
        soup_.warnings.push_back(std::move(warning));
    if (soup_.groups.empty()) {
        soup_.face_groups.clear();
    } else if (std::find(soup_.face_groups.begin(), soup_.face_groups.end(), NoIndex) !=
               soup_.face_groups.end()) {
        group_indices_.try_emplace("default", static_cast<std::uint32_t>(soup_.groups.size()));
        if (group_indices_.at("default") == soup_.groups.size())
            soup_.groups.emplace_back("default");
        std::replace(soup_.face_groups.begin(), soup_.face_groups.end(), NoIndex,
                     group_indices_.at("default"));
    }
}

PolygonSoup ObjReader::read() {
    while (next_statement()) {
        const std::string_view keyword = words_[0];
        if (keyword == "v")
            read_vertex();
        else if (keyword == "vt")
            read_uv();
        else if (keyword == "vn") {
            if (words_.size() != 4)
                reader_.fail("3 numbers of a normal", fmt::format("{}", words_.size() - 1));
            normals_.emplace_back(reader_.number(words_[1]), reader_.number(words_[2]),
                                  reader_.number(words_[3]));
        } else if (keyword == "f" || keyword == "fo") // fo: faces in files of the eighties
            read_face();
        else if (keyword == "o" || keyword == "g")
            begin_group();
        else if (keyword == "s")
            read_smoothing();
        else if (keyword == "mtllib")
            read_libraries();
        else if (keyword == "usemtl") {
            const auto [place, is_new] = material_indices_.try_emplace(
                rest_of_statement(), static_cast<std::uint32_t>(used_materials_.size()));
            if (is_new)
                used_materials_.push_back(place->first);
            material_ = place->second;
        }
    }
    check_indices();
    gather_normals();
    gather_smoothing();
    gather_uvs();
    gather_corner_uvs();
    gather_materials();
    if (!soup_.colors.empty())
        soup_.colors.resize(soup_.positions.size(), no_color());
    // MeshLab, Blender and three.js read and write them so.
    soup_.color_custom = {.curve = ColorCurve::Srgb,
                          .may_be_whole = true,
                          .reason = "as other programs write them into .obj"};
    return std::move(soup_);
}

} // namespace

PolygonSoup read_obj(std::span<const std::byte> bytes, const std::filesystem::path& folder) {
    return ObjReader(as_text(bytes), folder).read();
}

} // namespace relumine::mesh
