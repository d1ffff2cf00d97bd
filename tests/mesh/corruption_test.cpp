// Every truncation and every single changed byte of a small file of each format: the readers must
// refuse the result or read a valid mesh, quickly.
#include <ctime>

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

struct Sample {
    std::string name;
    std::string content;
    TriangleMesh (*load)(std::string_view, NormalSource);
    /// Truncations to this many bytes or fewer must be refused
    std::size_t last_refused_end;
    /// A byte becomes every so manieth value, the next byte the values beside them.
    int step = 1;
};

std::string small_obj() {
    return "o a\nusemtl m\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 .5 .5 .5\nv .5 .5 "
           "1 1 1 "
           "1\nvt 0 0\nvt "
           "1 1\nvn 0 0 1\n"
           "f 1/1/1 2/2/1 3/1/1 4/2/1\nf -1//1 1//1 \\\n2//1\n";
}

std::string small_gltf() {
    // A triangle of three positions, bytes as indices, a material and a texture that is not there.
    return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,2,1]}],)"
           R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],)"
           R"("materials":[{"pbrMetallicRoughness":{"roughnessFactor":0.5,"baseColorTexture":{"index":0}}}],)"
           R"("textures":[{"source":0}],"images":[{"uri":"x"}],)"
           R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
           R"({"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],)"
           R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],)"
           R"("buffers":[{"byteLength":39,"uri":"data:;base64,)"
           R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC"}]})";
}

std::string small_off() {
    return "CNOFF # c\n5 2 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 255 0 255\n1 1 0 0 0 1 0 0 "
           "255 255\n"
           "0 1 0 0 0 1 9 9 9 9\n.5 .5 1 1 0 0 9 9 9 9\n4 0 1 2 3 255 0 0\n3 4 0 1\n";
}

std::string small_ply(const std::string& format) {
    return box_ply({.format = format,
                    .vertex_extras = true,
                    .face_list_before = true,
                    .face_list_after = true});
}

std::string small_ascii_stl() {
    return "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
           "0\nendloop\nendfacet\n"
           "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 "
           "0\nendloop\nendfacet\nendsolid a\n";
}

std::vector<Sample> samples() {
    const auto without_tail = [](const std::string& content, std::size_t tail) {
        return content.size() - tail;
    };
    return {
        {"obj", small_obj(), obj, small_obj().find("f 1") + 1},
        {"gltf", small_gltf(), gltf, without_tail(small_gltf(), 1), 6},
        {"off", small_off(), off, without_tail(small_off(), 3)},
        {"ply_ascii", small_ply("ascii"), ply, without_tail(small_ply("ascii"), 5)},
        {"ply_little", small_ply("binary_little_endian"), ply,
         without_tail(small_ply("binary_little_endian"), 1)},
        {"ply_big", small_ply("binary_big_endian"), ply,
         without_tail(small_ply("binary_big_endian"), 1)},
        {"stl_ascii", small_ascii_stl(), stl, without_tail(small_ascii_stl(), 4)},
        {"stl_binary", box_binary_stl(), stl, without_tail(box_binary_stl(), 1)},
    };
}

/// Loads; says whether that was refused. Whatever is accepted must be valid.
bool is_refused(const Sample& sample, std::string_view content) {
    const auto start = std::clock();
    bool refused = false;
    try {
        EXPECT_EQ(defect(sample.load(content, NormalSource::File)), "") << sample.name;
    } catch (const std::runtime_error& error) {
        refused = true;
        EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
    }
    EXPECT_LT(std::clock() - start, 20 * CLOCKS_PER_SEC) << sample.name;
    return refused;
}

class CorruptionTest : public testing::TestWithParam<Sample> {};

TEST_P(CorruptionTest, TheWholeFileIsAccepted) {
    EXPECT_FALSE(is_refused(GetParam(), GetParam().content));
}

TEST_P(CorruptionTest, EveryTruncationIsRefusedOrHarmless) {
    const Sample& sample = GetParam();
    for (std::size_t end = 0; end < sample.content.size(); ++end) {
        // A copy of its own, so that the address sanitizer sees reads behind its end.
        const std::vector<char> copy(sample.content.begin(),
                                     sample.content.begin() + static_cast<std::ptrdiff_t>(end));
        const bool refused = is_refused(sample, std::string_view(copy.data(), copy.size()));
        EXPECT_TRUE(refused || end > sample.last_refused_end)
            << sample.name << " cut to " << end << " bytes";
    }
}

TEST_P(CorruptionTest, EveryChangedByteIsRefusedOrHarmless) {
    std::string content = GetParam().content;
    int first = 0;
    for (char& byte : content) {
        const char original = byte;
        first = (first + 1) % GetParam().step;
        for (int value = first; value < 256; value += GetParam().step) {
            byte = static_cast<char>(value);
            if (byte != original)
                is_refused(GetParam(), content);
        }
        byte = original;
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, CorruptionTest, testing::ValuesIn(samples()),
                         [](const auto& test) { return test.param.name; });

} // namespace
} // namespace relumine::mesh
