#include "mesh/glb_writer.h"

#include <bit>
#include <cstring>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <tiny_gltf.h> // its implementation, and stb, are compiled into the library

namespace relumine::mesh {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");
static_assert(sizeof(glm::vec3) == 12 && sizeof(Triangle) == 12, "arrays are written as they are");

/// Appends an array to the model's one buffer, with its own view and accessor. Returns the
/// accessor's index.
template<class Value>
int append(tinygltf::Model& model, std::span<const Value> values, int target, int component_type,
           int type, std::size_t count) {
    std::vector<unsigned char>& data = model.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = values.size_bytes();
    view.target = target;
    data.resize(data.size() + values.size_bytes());
    std::memcpy(data.data() + view.byteOffset, values.data(), values.size_bytes());

    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = count;
    model.bufferViews.push_back(std::move(view));
    model.accessors.push_back(std::move(accessor));
    return static_cast<int>(model.accessors.size()) - 1;
}

int append(tinygltf::Model& model, std::span<const glm::vec3> values) {
    return append(model, values, TINYGLTF_TARGET_ARRAY_BUFFER, TINYGLTF_COMPONENT_TYPE_FLOAT,
                  TINYGLTF_TYPE_VEC3, values.size());
}

/// Sets the exact bounds of positions, which the format demands.
void set_bounds(tinygltf::Accessor& accessor, std::span<const glm::vec3> positions) {
    glm::vec3 min = positions[0], max = positions[0];
    for (const glm::vec3& position : positions) {
        min = glm::min(min, position);
        max = glm::max(max, position);
    }
    accessor.minValues = {min.x, min.y, min.z};
    accessor.maxValues = {max.x, max.y, max.z};
}

tinygltf::Material unlit_material() {
    tinygltf::Material material;
    material.name = "radiance";
    material.doubleSided = true;
    material.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object());
    return material;
}

} // namespace

std::string glb(const TriangleMesh& mesh, std::span<const glm::vec3> colors) {
    const std::uint64_t num_bytes =
        std::uint64_t{mesh.num_vertices()} * 36 + std::uint64_t{mesh.num_triangles()} * 12;
    constexpr std::uint64_t MaxBytes =
        // Leaves room for the JSON part.
        std::numeric_limits<std::uint32_t>::max() - 65536;
    if (num_bytes > MaxBytes)
        throw std::runtime_error(
            fmt::format("expected at most {} bytes in a .glb file, got {}", MaxBytes, num_bytes));

    std::vector<glm::vec3> normals = mesh.normals;
    normals.resize(mesh.num_vertices(), glm::vec3(0.0f));
    for (glm::vec3& normal : normals)
        if (normal == glm::vec3(0.0f))
            normal.y = 1.0f;

    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "Relumine";
    model.extensionsUsed = {"KHR_materials_unlit"};
    model.buffers.resize(1);
    model.buffers[0].data.reserve(num_bytes);
    model.materials.push_back(unlit_material());

    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = 0;
    primitive.attributes["POSITION"] = append(model, mesh.positions);
    set_bounds(model.accessors.back(), mesh.positions);
    primitive.attributes["NORMAL"] = append(model, normals);
    primitive.attributes["COLOR_0"] = append(model, colors);
    primitive.indices = append(
        model, std::span(mesh.triangles), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER,
        TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 3 * mesh.num_triangles());

    model.meshes.resize(1);
    model.meshes[0].primitives.push_back(std::move(primitive));
    model.nodes.resize(1);
    model.nodes[0].mesh = 0;
    model.scenes.resize(1);
    model.scenes[0].nodes = {0};
    model.defaultScene = 0;

    std::ostringstream stream;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true) || !stream)
        throw std::runtime_error(
            "expected a glTF model that can be written, got an error of the writer");
    return std::move(stream).str();
}

} // namespace relumine::mesh
