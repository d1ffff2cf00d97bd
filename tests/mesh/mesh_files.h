// What the tests of the mesh folder share: a small polygon mesh in every format, and what every
// loaded mesh must fulfil.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/formats/polygon_soup.h"
#include "mesh/load.h"
#include "tests/own_folder.h"

namespace relumine::mesh {

/// A box of 1 x 2 x 3 with its lowest corner at the origin: five quads, two triangles, outward.
inline const std::vector<glm::vec3> BoxPositions = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0},
                                                    {0, 0, 3}, {1, 0, 3}, {1, 2, 3}, {0, 2, 3}};
inline const std::vector<std::vector<std::uint32_t>> BoxFaces = {
    {0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
inline constexpr double BoxArea = 22.0;

inline std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text));
}

/// Lines "prefix x y z suffix" of the box.
inline std::string box_vertex_lines(const std::string& prefix = "",
                                    const std::string& suffix = "") {
    std::string text;
    for (const glm::vec3& p : BoxPositions)
        text += fmt::format("{}{} {} {}{}\n", prefix, p.x, p.y, p.z, suffix);
    return text;
}

/// Lines "4 0 3 2 1 suffix" of the box.
inline std::string box_face_lines(const std::string& suffix = "") {
    std::string text;
    for (const auto& face : BoxFaces)
        text += fmt::format("{} {}{}\n", face.size(), fmt::join(face, " "), suffix);
    return text;
}

inline std::string replace_all(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

inline double area(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const Triangle& t : mesh.triangles)
        sum += 0.5 * glm::length(glm::cross(
                         glm::dvec3(mesh.positions[t[1]]) - glm::dvec3(mesh.positions[t[0]]),
                         glm::dvec3(mesh.positions[t[2]]) - glm::dvec3(mesh.positions[t[0]])));
    return sum;
}

/// Signed volume inside a closed mesh whose faces look outward.
inline double volume(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const Triangle& t : mesh.triangles)
        sum += glm::dot(
                   glm::dvec3(mesh.positions[t[0]]),
                   glm::cross(glm::dvec3(mesh.positions[t[1]]), glm::dvec3(mesh.positions[t[2]]))) /
               6.0;
    return sum;
}

/// What TriangleMesh promises; empty if all is well.
inline std::string defect(const TriangleMesh& mesh) {
    const auto is_finite = [](const glm::vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    const std::size_t n = mesh.num_vertices();
    if (n == 0 || mesh.triangles.empty())
        return "empty";
    if (mesh.normals.size() != n || (!mesh.colors.empty() && mesh.colors.size() != n) ||
        (!mesh.uvs.empty() && mesh.uvs.size() != n))
        return "attributes of another size";
    for (const Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle)
            if (vertex >= n)
                return "index out of range";
    if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), is_finite))
        return "position not finite";
    if (!std::all_of(mesh.colors.begin(), mesh.colors.end(), is_finite))
        return "colour not finite";
    for (const glm::vec3& normal : mesh.normals)
        if (normal != glm::vec3(0.0f) && !(std::abs(glm::length(normal) - 1.0f) < 1e-5f))
            return "normal of another length";
    return "";
}

/// The box with all its vertices in order and its faces cut into the right triangles.
inline void expect_box(const TriangleMesh& mesh) {
    EXPECT_EQ(defect(mesh), "");
    EXPECT_EQ(mesh.positions, BoxPositions);
    EXPECT_EQ(mesh.num_triangles(), 12u);
    EXPECT_NEAR(area(mesh), BoxArea, 1e-6);
    EXPECT_NEAR(volume(mesh), 6.0, 1e-6);
}

inline TriangleMesh gltf(std::string_view file, NormalSource normals = NormalSource::File) {
    return to_mesh(read_gltf(bytes_of(file), {}), normals);
}
inline TriangleMesh obj(std::string_view text, NormalSource normals = NormalSource::File) {
    return to_mesh(read_obj(bytes_of(text)), normals);
}
inline TriangleMesh off(std::string_view text, NormalSource normals = NormalSource::File) {
    return to_mesh(read_off(bytes_of(text)), normals);
}
inline TriangleMesh ply(std::string_view text, NormalSource normals = NormalSource::File) {
    return to_mesh(read_ply(bytes_of(text)), normals);
}
inline TriangleMesh stl(std::string_view text, NormalSource normals = NormalSource::File) {
    return to_mesh(read_stl(bytes_of(text)), normals);
}

/// Runs a loader that must refuse its input with a message of one line that contains `part`.
template<class Load>
void expect_refusal(Load load, const std::string& part) {
    try {
        static_cast<void>(load());
        ADD_FAILURE() << "accepted; expected a refusal with " << part;
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr(part));
        EXPECT_THAT(error.what(), testing::HasSubstr("expected"));
        EXPECT_EQ(std::string(error.what()).find_first_of("\r\n"), std::string::npos);
    }
}

/// A folder for the files of one test.
class MeshFileTest : public tests::FolderTest {
protected:
    [[nodiscard]] std::filesystem::path write(const std::string& name,
                                              std::string_view content) const {
        std::ofstream(folder_ / name, std::ios::binary) << content;
        return folder_ / name;
    }
};

/// PLY of the box, with options for everything that differs between writers.
struct PlyOptions {
    std::string format = "ascii";
    std::string coordinate_type = "float";
    std::string size_type = "uchar";
    std::string index_type = "int";
    std::string index_name = "vertex_indices";
    /// Short, uchar r g b, and a list before the coordinates
    bool vertex_extras = false;
    /// Texture coordinates before the indices
    bool face_list_before = false;
    bool face_list_after = false;
    /// The element face before the element vertex
    bool faces_first = false;
    /// With a list, in front
    bool other_element = false;
};
std::string box_ply(const PlyOptions& options = {});

/// Binary STL of the box.
std::string box_binary_stl();

} // namespace relumine::mesh
