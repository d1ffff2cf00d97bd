#include "mesh/save.h"

#include <limits>

#include <tiny_gltf.h>

#include "files/output_file.h"
#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

class SaveTest : public MeshFileTest {
protected:
    [[nodiscard]] std::size_t num_files() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(folder_), {}));
    }
    const TriangleMesh box_ = ply(box_ply());
    const std::vector<glm::vec3> colors_ = {{0, 0, 0},     {1, 0, 0},           {0, 100.5f, 0},
                                            {0, 0, 1e-6f}, {1, 0.1f, 1},        {2, 2, 2},
                                            {3, 3, 3},     {0.25f, 0.5f, 0.75f}};
};

TEST_F(SaveTest, PlyLoadsAgainUnchanged) {
    save(folder_ / "box.ply", box_, colors_);
    const TriangleMesh loaded = load(folder_ / "box.ply");
    EXPECT_EQ(loaded.positions, box_.positions);
    EXPECT_EQ(loaded.triangles, box_.triangles);
    EXPECT_EQ(loaded.colors, colors_) << "floats, beyond 1 as well";
    for (std::size_t i = 0; i < loaded.num_vertices(); ++i)
        EXPECT_NEAR(glm::distance(loaded.normals[i], box_.normals[i]), 0.0f, 1e-6f);
    EXPECT_EQ(num_files(), 1u);
}

/// The values of an accessor, which must fill its buffer view.
template<class Value>
std::vector<Value> values_of(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
    const tinygltf::BufferView& view =
        model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
    std::vector<Value> values(accessor.count);
    EXPECT_EQ(view.byteLength, values.size() * sizeof(Value));
    EXPECT_EQ(view.byteOffset % 4, 0u);
    std::memcpy(values.data(), model.buffers.at(0).data.data() + view.byteOffset, view.byteLength);
    return values;
}

TEST_F(SaveTest, GlbHoldsWhatItShould) {
    TriangleMesh mesh = box_;
    mesh.normals[3] = glm::vec3(0.0f);
    save(folder_ / "box.GLB", mesh, colors_);
    EXPECT_EQ(num_files(), 1u);

    tinygltf::Model model;
    std::string error, warning;
    ASSERT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning,
                                                        (folder_ / "box.GLB").string()))
        << error;
    EXPECT_EQ(error + warning, "");
    EXPECT_EQ(model.asset.version, "2.0");
    EXPECT_THAT(model.extensionsUsed, testing::ElementsAre("KHR_materials_unlit"));
    EXPECT_EQ(model.scenes.at(static_cast<std::size_t>(model.defaultScene)).nodes,
              std::vector<int>{0});
    const tinygltf::Primitive& primitive = model.meshes.at(0).primitives.at(0);
    EXPECT_EQ(model.materials.at(static_cast<std::size_t>(primitive.material))
                  .extensions.count("KHR_materials_unlit"),
              1u);

    const tinygltf::Accessor& position =
        model.accessors.at(static_cast<std::size_t>(primitive.attributes.at("POSITION")));
    EXPECT_EQ(position.minValues, (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(position.maxValues, (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(values_of<glm::vec3>(model, primitive.attributes.at("POSITION")), mesh.positions);
    const int color = primitive.attributes.at("COLOR_0");
    EXPECT_EQ(model.accessors.at(static_cast<std::size_t>(color)).componentType,
              TINYGLTF_COMPONENT_TYPE_FLOAT);
    EXPECT_EQ(model.accessors.at(static_cast<std::size_t>(color)).type, TINYGLTF_TYPE_VEC3);
    EXPECT_EQ(values_of<glm::vec3>(model, color), colors_);
    for (const glm::vec3& normal : values_of<glm::vec3>(model, primitive.attributes.at("NORMAL")))
        EXPECT_NEAR(glm::length(normal), 1.0f, 1e-5f) << "glTF knows no zero normals";
    const tinygltf::Accessor& indices =
        model.accessors.at(static_cast<std::size_t>(primitive.indices));
    EXPECT_EQ(indices.componentType, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    std::vector<std::uint32_t> expected;
    for (const Triangle& triangle : mesh.triangles)
        expected.insert(expected.end(), triangle.begin(), triangle.end());
    EXPECT_EQ(values_of<std::uint32_t>(model, primitive.indices), expected);
}

TEST_F(SaveTest, FailingLeavesNothingBehind) {
    for (const char* name : {"box.ply", "box.glb"}) {
        const std::filesystem::path target = write(name, "old");
        std::vector<glm::vec3> bad = colors_;
        bad[5].y = std::numeric_limits<float>::quiet_NaN();
        expect_refusal([&] { return save(target, box_, bad), 0; },
                       "finite colours, got 2 nan 2 at vertex 5");
        bad.pop_back();
        expect_refusal([&] { return save(target, box_, bad), 0; }, "expected 8 colours, got 7");
        expect_refusal([&] { return save(target, TriangleMesh{}, {}), 0; }, "triangles");
        EXPECT_EQ(files::read(target).size(), 3u);
        EXPECT_THROW(save(folder_ / "missing" / name, box_, colors_), std::runtime_error);
    }
    expect_refusal([&] { return save(folder_ / "box.obj", box_, colors_), 0; }, ".ply or .glb");
    EXPECT_EQ(num_files(), 2u);
}

} // namespace
} // namespace relumine::mesh
