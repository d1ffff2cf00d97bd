// Reads what save_lit() writes into a .ply file, by the format's own words and not by Relumine's
// reader.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "files/output_file.h"

namespace relumine::mesh {

struct LitVertex {
    std::array<std::uint8_t, 3> shown = {};
    glm::vec3 radiance = glm::vec3(0.0f);
};

inline std::vector<LitVertex> lit_ply(const std::filesystem::path& path, std::size_t num_vertices) {
    const std::vector<std::byte> file = files::read(path);
    const std::string text(reinterpret_cast<const char*>(file.data()), file.size());
    const std::string end = "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                            "property float radiance_red\nproperty float radiance_green\nproperty "
                            "float radiance_blue\n";
    constexpr std::size_t SizeOfShape = 24, SizeOfVertex = SizeOfShape + 3 + 12;
    const std::string last = "end_header\n";
    const std::size_t begin = text.find(last) + last.size();
    if (text.find(end) > begin || file.size() < begin + num_vertices * SizeOfVertex)
        throw std::runtime_error("expected a lit mesh");
    std::vector<LitVertex> vertices(num_vertices);
    for (std::size_t i = 0; i < num_vertices; ++i) {
        const std::byte* at = file.data() + begin + i * SizeOfVertex + SizeOfShape;
        std::memcpy(vertices[i].shown.data(), at, 3);
        std::memcpy(&vertices[i].radiance, at + 3, 12);
    }
    return vertices;
}

} // namespace relumine::mesh
