// glTF files that tests write.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {

using Json = nlohmann::json;

inline std::string base64(const std::string& bytes) {
    constexpr std::string_view Alphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t j = 0; j < 3; ++j)
            bits =
                bits << 8u | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
        for (std::size_t j = 0; j < 4; ++j)
            text += i + j > bytes.size() ? '=' : Alphabet[bits >> (18 - 6 * j) & 63u];
    }
    return text;
}

/// A model under construction: JSON and one buffer.
struct Model {
    Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
    std::string buffer;

    std::size_t add_view(const std::string& bytes, std::size_t stride = 0) {
        buffer.resize((buffer.size() + 3) / 4 * 4);
        Json view = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
        if (stride > 0)
            view["byteStride"] = stride;
        buffer += bytes;
        json["bufferViews"].push_back(view);
        return json["bufferViews"].size() - 1;
    }
    template<class Value>
    std::size_t add(const std::vector<Value>& values, int component_type, const char* type,
                    bool normalized = false, std::size_t count = 0) {
        const std::string bytes(reinterpret_cast<const char*>(values.data()),
                                values.size() * sizeof(Value));
        json["accessors"].push_back({{"bufferView", add_view(bytes)},
                                     {"componentType", component_type},
                                     {"type", type},
                                     {"normalized", normalized},
                                     {"count", count == 0 ? values.size() : count}});
        return json["accessors"].size() - 1;
    }
    [[nodiscard]] std::string embedded() const {
        Json copy = json;
        copy["buffers"] = {{{"byteLength", buffer.size()},
                            {"uri", "data:application/octet-stream;base64," + base64(buffer)}}};
        return copy.dump();
    }
    [[nodiscard]] std::string external(const std::string& uri) const {
        Json copy = json;
        copy["buffers"] = {{{"byteLength", buffer.size()}, {"uri", uri}}};
        return copy.dump();
    }
    [[nodiscard]] std::string glb() const {
        Json copy = json;
        copy["buffers"] = {{{"byteLength", buffer.size()}}};
        std::string text = copy.dump(), binary = buffer;
        text.resize((text.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        std::string file = "glTF";
        const auto word = [&file](std::size_t value) {
            const auto number = static_cast<std::uint32_t>(value);
            file.append(reinterpret_cast<const char*>(&number), 4);
        };
        word(2), word(12 + 8 + text.size() + 8 + binary.size());
        word(text.size()), word(0x4E4F534Au), file += text;
        word(binary.size()), word(0x004E4942u), file += binary;
        return file;
    }
};

/// A square in the plane z = 0 with uvs, two triangles, one node.
inline Model square() {
    Model model;
    const auto positions =
        model.add<glm::vec3>({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 5126, "VEC3");
    const auto uvs = model.add<glm::vec2>({{0, 1}, {1, 1}, {1, 0}, {0, 0}}, 5126, "VEC2");
    const auto indices = model.add<std::uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR");
    model.json["meshes"] = {{{"name", "square"},
                             {"primitives",
                              {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
                                {"indices", indices}}}}}};
    model.json["nodes"] = {{{"mesh", 0}}};
    return model;
}

} // namespace relumine::mesh
