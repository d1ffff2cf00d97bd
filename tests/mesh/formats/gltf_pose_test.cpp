// Skins, morph targets and animations of glTF files, and broken ones.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "tests/mesh/encoders.h"
#include "tests/mesh/gltf_model.h"

namespace relumine::mesh {
namespace {

using testing::ElementsAre;

using GltfPoseTest = MeshFileTest;

/// The square with two joints: the lower edge hangs at the first, the upper one at the second.
Model skinned_square() {
    Model model = square();
    using Joints = std::array<std::uint8_t, 4>;
    Json& attributes = model.json["meshes"][0]["primitives"][0]["attributes"];
    const auto joints =
        model.add<Joints>({{0, 9, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}}, 5121, "VEC4");
    const auto weights = model.add<glm::vec4>(
        {{1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}, {0.5f, 0.5f, 0, 0}}, 5126, "VEC4");
    attributes["JOINTS_0"] = joints, attributes["WEIGHTS_0"] = weights;
    // Joint 1 rests at (0, 1, 0): its inverse bind matrix goes back by that.
    const auto inverse =
        model.add<std::array<float, 16>>({{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                          {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1}},
                                         5126, "MAT4");
    model.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
    model.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                           {{"translation", {0, 0, 5}}, {"children", {2}}},
                           {{"translation", {0, 1, 0}}, {"scale", {2, 1, 1}}}};
    model.json["scenes"][0]["nodes"] = {0, 1};
    return model;
}

TEST_F(GltfPoseTest, SkinsStandAsTheirJointsSay) {
    Model model = skinned_square();
    const TriangleMesh mesh = gltf(model.embedded());
    EXPECT_EQ(defect(mesh), "");
    // Both joints stand 5 in front; the second one is twice as wide. The node's own place counts
    // nothing.
    EXPECT_THAT(mesh.positions, ElementsAre(glm::vec3(0, 0, 5), glm::vec3(1, 0, 5),
                                            glm::vec3(2, 1, 5), glm::vec3(0, 1, 5)));
    EXPECT_THAT(mesh.warnings, ElementsAre());
    // Joints outside of the scene have their place all the same.
    model.json["scenes"][0]["nodes"] = {0};
    EXPECT_EQ(gltf(model.embedded()).positions, mesh.positions);
}

TEST_F(GltfPoseTest, SkinsThatAreBroken) {
    const auto refused = [](const auto& change, const std::string& part) {
        Model model = skinned_square();
        change(model);
        expect_refusal([&] { return gltf(model.embedded()); }, part);
    };
    refused([](Model& m) { m.json["skins"][0]["joints"] = {1, 7}; }, "\"nodes\" below 3, got 7");
    refused([](Model& m) { m.json["skins"][0]["joints"] = {1}; },
            "joints of vertices below 1, as many as the skin has, got 1");
    refused([](Model& m) { m.json["skins"][0]["joints"] = {1, 2, 1}; },
            "3 inverse bind matrices of skin 0, one for each joint, got 2");
    refused([](Model& m) { m.json["nodes"][0]["skin"] = 3; }, "\"skins\" below 1, got 3");
    refused([](Model& m) { m.json["skins"][0]["joints"] = Json::array(); }, "joints of skin 0");
    const auto with_weights = [](const std::vector<glm::vec4>& weights) {
        Model model = skinned_square();
        const auto place = model.add<glm::vec4>(weights, 5126, "VEC4");
        model.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = place;
        return model.embedded();
    };
    expect_refusal([&] { return gltf(with_weights(std::vector<glm::vec4>(4, {-1, 2, 0, 0}))); },
                   "weights of joints of 0 or more, got -1");
    expect_refusal([&] { return gltf(with_weights(std::vector<glm::vec4>(4, {NAN, 0, 0, 0}))); },
                   "weights of joints of 0 or more, got nan");
    // Half of the weights: scaled, with a line.
    const TriangleMesh half = gltf(with_weights(std::vector<glm::vec4>(4, {0.5f, 0, 0, 0})));
    EXPECT_EQ(half.positions[2], glm::vec3(2, 1, 5));
    EXPECT_THAT(half.warnings, ElementsAre("the weights of joints do not sum to 1 at 4 vertices: "
                                           "they are scaled"));
}

TEST_F(GltfPoseTest, MorphTargetsHaveTheirWeights) {
    Model model = square();
    const auto up =
        model.add<glm::vec3>({{0, 0, 0}, {0, 0, 0}, {0, 0, 2}, {0, 0, 2}}, 5126, "VEC3");
    const auto wide =
        model.add<glm::vec3>({{0, 0, 0}, {4, 0, 0}, {4, 0, 0}, {0, 0, 0}}, 5126, "VEC3");
    Json& mesh = model.json["meshes"][0];
    mesh["primitives"][0]["targets"] = {{{"POSITION", up}}, {{"POSITION", wide}}};
    EXPECT_EQ(gltf(model.embedded()).positions[2], glm::vec3(1, 1, 0)) << "at rest";
    mesh["weights"] = {0.5, 0.0};
    const TriangleMesh bent = gltf(model.embedded());
    EXPECT_EQ(bent.positions[2], glm::vec3(1, 1, 1));
    EXPECT_LT(glm::distance(bent.normals[0], glm::normalize(glm::vec3(0, -1, 1))), 1e-6f)
        << "of the new faces";
    model.json["nodes"][0]["weights"] = {0.0, 0.25};
    EXPECT_EQ(gltf(model.embedded()).positions[2], glm::vec3(2, 1, 0)) << "the node's come first";
    model.json["nodes"][0]["weights"] = {1.0};
    expect_refusal([&] { return gltf(model.embedded()); },
                   "2 weights, one for each morph target, got 1");
}

/// Turns the square's node by 90 degrees within two seconds, and lifts it in steps.
Model turning_square() {
    Model model = square();
    const auto times = model.add<float>({1.0f, 3.0f}, 5126, "SCALAR");
    const float h = std::sqrt(0.5f);
    const auto turns = model.add<glm::vec4>({{0, 0, 0, 1}, {0, 0, h, h}}, 5126, "VEC4");
    const auto lifts = model.add<glm::vec3>({{0, 0, 1}, {0, 0, 2}}, 5126, "VEC3");
    // A spline from 1 to 3 that starts and ends flat: in-tangent, value, out-tangent.
    const auto scales = model.add<glm::vec3>(
        {{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {0, 0, 0}, {3, 3, 1}, {0, 0, 0}}, 5126, "VEC3");
    model.json["animations"] = {
        {{"name", "Turn"},
         {"samplers",
          {{{"input", times}, {"output", turns}},
           {{"input", times}, {"output", lifts}, {"interpolation", "STEP"}},
           {{"input", times}, {"output", scales}, {"interpolation", "CUBICSPLINE"}}}},
         {"channels",
          {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}},
           {{"sampler", 1}, {"target", {{"node", 0}, {"path", "translation"}}}},
           {{"sampler", 2}, {"target", {{"node", 0}, {"path", "scale"}}}}}}}};
    return model;
}

/// The square with a material, a light and an animation of whatever pointers lead to, from 0 to 2
/// seconds.
class Pointing {
public:
    Pointing() {
        model.json["materials"] = {{{"doubleSided", true}, {"alphaMode", "MASK"}}};
        model.json["meshes"][0]["primitives"][0]["material"] = 0;
        model.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
        model.json["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
        model.json["nodes"].push_back({{"mesh", 0}});
        model.json["scenes"][0]["nodes"] = {0, 1, 2};
        model.json["nodes"][2]["extensions"]["KHR_node_visibility"] = Json::object();
        model.json["extensionsUsed"] =
            model.json["extensionsRequired"] = {"KHR_animation_pointer", "KHR_node_visibility"};
        times_ = model.add<float>({0.0f, 2.0f}, 5126, "SCALAR");
        model.json["animations"] = {{{"name", "Glow"}}};
    }
    void point(const std::string& pointer, std::size_t output,
               const std::string& interpolation = "LINEAR") {
        Json& animation = model.json["animations"][0];
        animation["channels"].push_back(
            {{"sampler", animation["samplers"].size()},
             {"target",
              {{"path", "pointer"},
               {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
        animation["samplers"].push_back(
            {{"input", times_}, {"output", output}, {"interpolation", interpolation}});
    }

    Model model = square();

private:
    std::size_t times_;
};

TEST_F(GltfPoseTest, PointersOfAnimations) {
    Pointing pointing;
    Model& model = pointing.model;
    pointing.point("/materials/0/pbrMetallicRoughness/baseColorFactor",
                   model.add<glm::vec4>({{1, 0, 0, 1}, {0, 1, 0, 1}}, 5126, "VEC4"));
    pointing.point("/materials/0/alphaCutoff", model.add<float>({0.25f, 0.75f}, 5126, "SCALAR"));
    pointing.point("/extensions/KHR_lights_punctual/lights/0/intensity",
                   model.add<float>({0, 8}, 5126, "SCALAR"));
    pointing.point("/nodes/0/translation",
                   model.add<glm::vec3>({{0, 0, 0}, {0, 0, 4}}, 5126, "VEC3"));
    const float h = std::sqrt(0.5f);
    pointing.point("/nodes/1/rotation",
                   model.add<glm::vec4>({{0, 0, 0, 1}, {0, h, 0, h}}, 5126, "VEC4"));
    pointing.point("/nodes/2/extensions/KHR_node_visibility/visible",
                   model.add<std::array<std::uint8_t, 4>>({{1, 0, 0, 0}}, 5121, "SCALAR", false, 2),
                   "STEP");
    const auto path = write("a.gltf", model.embedded());
    const LoadedMesh mesh = load(path, {.pose = Pose{"Glow", 0.5}});
    EXPECT_THAT(mesh.warnings, ElementsAre());
    EXPECT_EQ(mesh.materials[0].base_color, glm::vec3(0.75f, 0.25f, 0.0f));
    EXPECT_EQ(mesh.materials[0].alpha_cutoff, 0.375f);
    EXPECT_EQ(mesh.lights.at(0).intensity, glm::vec3(2.0f));
    // A quarter of the turn from -Z to -X.
    EXPECT_NEAR(mesh.lights[0].direction.x, -std::sin(std::numbers::pi / 8.0), 1e-6);
    EXPECT_EQ(mesh.num_vertices(), 8u);
    EXPECT_EQ(mesh.positions[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(load(path, {.pose = Pose{"Glow", 2.0}}).num_vertices(), 4u) << "hidden by then";
    EXPECT_EQ(load(path).materials[0].base_color, glm::vec3(1.0f)) << "no pose is asked for";
}

TEST_F(GltfPoseTest, PointersThatLeadNowhere) {
    Pointing pointing;
    const auto ones = pointing.model.add<float>({1, 1}, 5126, "SCALAR");
    for (const char* pointer : {"/materials/1/alphaCutoff", "/materials/00/alphaCutoff", "nodes/0",
                                "/nodes/0/extensions/KHR_node_visibility/visible", "/scene/0", ""})
        pointing.point(pointer, ones);
    pointing.point(std::string(100000, '/'), ones);
    const auto path = write("a.gltf", pointing.model.embedded());
    EXPECT_THAT(load(path, {.pose = Pose{"Glow", 0.5}}).warnings,
                ElementsAre("7 pointers of the animation, which the file does not have: "
                            "'nodes/0'"));
    // A type that the property does not have.
    Pointing wrong;
    wrong.point("/nodes/0/translation", ones);
    static_cast<void>(wrong.model.add<float>({1, 1}, 5126, "SCALAR"));
    const auto other = write("b.gltf", wrong.model.embedded());
    expect_refusal([&] { static_cast<void>(load(other, {.pose = Pose{"Glow", 0.5}})); },
                   "3 numbers as \"translation\"");
}

TEST_F(GltfPoseTest, PosesOfAnimations) {
    const Model model = turning_square();
    const auto path = write("turn.gltf", model.embedded());
    const auto corner = [&](const std::string& animation, double seconds) {
        return load(path, {.pose = Pose{animation, seconds}}).positions[1];
    };
    EXPECT_EQ(load(path).positions[1], glm::vec3(1, 0, 0)) << "the node's own place";
    EXPECT_EQ(corner("Turn", 0.0), glm::vec3(1, 0, 1)) << "before the first key";
    EXPECT_LT(glm::distance(corner("Turn", 9.0), glm::vec3(0, 3, 2)), 1e-6f) << "after the last";
    // Half way: 45 degrees at even speed, the first step, and the middle of the spline.
    const float h = std::sqrt(0.5f);
    EXPECT_LT(glm::distance(corner("Turn", 2.0), glm::vec3(2 * h, 2 * h, 1)), 1e-6f);
    // A quarter: 22.5 degrees; 3 / 16 - 2 / 64 = 5 / 32 of the way from 1 to 3.
    const float angle = std::numbers::pi_v<float> / 8.0f, scale = 1.0f + 2.0f * 5.0f / 32.0f;
    EXPECT_LT(glm::distance(corner("0", 1.5),
                            glm::vec3(scale * std::cos(angle), scale * std::sin(angle), 1)),
              1e-6f);
    expect_refusal([&] { static_cast<void>(corner("Jump", 0.0)); },
                   "expected an animation of the file ('Turn') for its pose, got 'Jump'");
    expect_refusal([&] { static_cast<void>(corner("1", 0.0)); }, "got '1'");
    const auto still = write("still.gltf", square().embedded());
    expect_refusal([&] { static_cast<void>(load(still, {.pose = Pose{"Turn", 0.0}})); },
                   "which has none");
    const auto ply_file = write("box.ply", box_ply());
    expect_refusal([&] { static_cast<void>(load(ply_file, {.pose = Pose{"Turn", 0.0}})); },
                   "expected .glb or .gltf for a pose, got '.ply'");
}

TEST_F(GltfPoseTest, AnimationsThatAreBroken) {
    const auto refused = [&](const auto& change, const std::string& part) {
        Model model = turning_square();
        change(model.json["animations"][0]);
        const auto path = write("broken.gltf", model.embedded());
        expect_refusal([&] { static_cast<void>(load(path, {.pose = Pose{"Turn", 0.0}})); }, part);
    };
    refused([](Json& a) { a["samplers"][0]["interpolation"] = "SMOOTH"; }, "got 'SMOOTH'");
    refused([](Json& a) { a["channels"][0]["sampler"] = 5; }, "samplers below 3, got 5");
    refused([](Json& a) { a["channels"][0]["target"]["node"] = 5; }, "\"nodes\" below 1, got 5");
    refused([](Json& a) { a["samplers"][2].erase("interpolation"); },
            "2 values of an animation's \"scale\", one for each key, got 6");
    refused([](Json& a) { a["samplers"][0]["input"] = 0; }, "1 components");
}

} // namespace
} // namespace relumine::mesh
