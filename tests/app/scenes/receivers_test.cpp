// Scenes whose receivers are pixels or texels, from the mesh to the picture.
#include <string>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

/// A square of two units in the plane y = 0 with uvs that fill the atlas; as PLY.
std::string square_ply(bool twice = false) {
    const std::string corners = "-1 0 -1 0 1\n-1 0 1 0 0\n1 0 1 1 0\n1 0 -1 1 1\n";
    const std::string above = "-1 1 -1 0 1\n-1 1 1 0 0\n1 1 1 1 0\n1 1 -1 1 1\n";
    return "ply\nformat ascii 1.0\nelement vertex " + std::string(twice ? "8" : "4") +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty "
           "float v\n"
           "element face " +
           std::string(twice ? "2" : "1") +
           "\nproperty list uchar int vertex_indices\nend_header\n" + corners +
           (twice ? above : "") + "4 0 1 2 3\n" + (twice ? "4 4 5 6 7\n" : "");
}

class Receivers : public AppTest {
protected:
    Receivers() {
        write("mesh.obj", octahedron_obj());
        write("square.ply", square_ply());
        write("white.hdr", white_hdr());
    }
    void make_pixels(const std::string& receivers = "pixels:24x16:2") const {
        succeed({"precompute", "mesh.obj", "-o", "px.prt", "--face-resolution", "16", "--tolerance",
                 "0.05", "--receivers", receivers, "--view", "auto", "-q", "--refine", "off"});
    }
    void make_texels() const {
        succeed("precompute square.ply -o tx.prt --face-resolution 32 --receivers texels:8x8 -q");
    }
};

TEST_F(Receivers, PixelsBecomeThePictureOfTheirView) {
    const nlohmann::json made =
        succeed("precompute mesh.obj -o px.prt --face-resolution 16 --tolerance 0.05 --receivers "
                "pixels:24x16:2 --view 0,1,5,0,0,0,40 --json --refine off")
            .json();
    EXPECT_EQ(made["layout"]["kind"], "pixels");
    EXPECT_EQ(made["vertices"], 6);
    const auto num_receivers = made["receivers"].get<std::size_t>();
    EXPECT_GT(num_receivers, 100u);
    EXPECT_LT(num_receivers, 24u * 16u * 4u);
    succeed("relight px.prt white.hdr -o lit.png");
    EXPECT_EQ(png_size(read("lit.png")), (Size{24, 16}));
    succeed("relight px.prt white.hdr -o lit.exr");
    EXPECT_EQ(exr_size(read("lit.exr")), (Size{24, 16}));
    succeed("relight px.prt white.hdr -o cut.exr --background none");
    EXPECT_EQ(exr_size(read("cut.exr")), (Size{24, 16}));
    succeed("relight px.prt white.hdr -o lit.npy");
    const auto values = npy_values(read("lit.npy"));
    EXPECT_EQ(values.size(), num_receivers);
    for (const auto& value :
         values) // a white furnace: flat faces under smooth normals see a little less
        EXPECT_LT(value[0], 1.01f);

    const nlohmann::json info = succeed("info px.prt --json").json();
    EXPECT_EQ(info["receivers"], num_receivers);
    EXPECT_EQ(info["layout"]["samples_per_axis"], 2);
    EXPECT_EQ(info["layout"]["fov"], 40.0);
    EXPECT_NEAR(info["layout"]["coverage"].get<double>(),
                static_cast<double>(num_receivers) / (24 * 16 * 4), 1e-9);
    EXPECT_NE(succeed("info px.prt").out.find("pixels 24 x 16, 2 x 2 samples each"),
              std::string::npos);
}

TEST_F(Receivers, AllCommandsTakePixels) {
    make_pixels();
    write("frame.0001.hdr", lamp_hdr(32));
    write("frame.0002.hdr", lamp_hdr(64));
    succeed("animate px.prt frame.%04d.hdr -o lit.%04d.png --vertices all.npy --exposure 1");
    EXPECT_EQ(png_size(read("lit.0002.png")), (Size{24, 16}));
    succeed("relight px.prt frame.0002.hdr -o one.png --exposure 1");
    EXPECT_EQ(read("lit.0002.png"), read("one.png"));
    succeed("edit px.prt white.hdr -o edited.png --disc 0,1,0,10 --gain 3");
    EXPECT_EQ(png_size(read("edited.png")), (Size{24, 16}));
    succeed("edit px.prt white.hdr -o who.exr --disc 0,1,0,10 --who 0,1,0");
    const nlohmann::json verified =
        succeed("verify px.prt white.hdr --face-resolution 16 --samples 50 --json").json();
    EXPECT_LT(verified["relative_l2"], 0.05);
    EXPECT_TRUE(verified.contains("worst_receiver"));
    const nlohmann::json lights =
        succeed("lights white.hdr -o list.json -n 16 --scene px.prt --json").json();
    EXPECT_LT(lights["relative_l2"], 0.5);
    succeed("relight px.prt --lights list.json -o by_list.png");
    fail("view px.prt white.hdr -o window.png", {});
}

TEST_F(Receivers, TexelsBecomeALightmap) {
    make_texels();
    succeed("relight tx.prt white.hdr -o map.exr");
    EXPECT_EQ(exr_size(read("map.exr")), (Size{8, 8}));
    succeed("relight tx.prt white.hdr -o map.png");
    EXPECT_EQ(png_size(read("map.png")), (Size{8, 8}));
    succeed("relight tx.prt white.hdr -o map.npy");
    const auto values = npy_values(read("map.npy"));
    ASSERT_EQ(values.size(), 64u);
    for (const auto& value : values) // nothing blocks: the white furnace
        EXPECT_NEAR(value[0], 1.0f, 2e-3f);
    EXPECT_EQ(succeed("info tx.prt --json").json()["layout"]["coverage"], 1.0);
    EXPECT_LT(succeed("verify tx.prt white.hdr --json").json()["relative_l2"], 2e-3);
}

TEST_F(Receivers, OverlappingChartsAreAWarning) {
    // The centres of the four on the diagonal are inside no triangle, but on edges.
    write("twice.ply", square_ply(true));
    const std::vector<std::string> command = {"precompute",  "twice.ply",         "-o",
                                              "tx.prt",      "--face-resolution", "8",
                                              "--receivers", "texels:4x4"};
    const auto with = [&command](const std::string& option) {
        std::vector<std::string> arguments = command;
        arguments.push_back(option);
        return arguments;
    };
    const std::string warning =
        "warning: 12 texels lie in several triangles, the first at column 1, row 0";
    const Result made = succeed(command);
    EXPECT_NE(made.err.find(warning), std::string::npos) << made.described();
    EXPECT_EQ(made.out.find("warning"), std::string::npos) << made.described();
    const Result as_json = succeed(with("--json"));
    EXPECT_NE(as_json.err.find(warning), std::string::npos) << as_json.described();
    EXPECT_EQ(as_json.json()["texels_overlapping"], 12);
    ASSERT_EQ(as_json.json()["warnings"].size(), 1u);
    EXPECT_EQ("warning: " + as_json.json()["warnings"][0].get<std::string>() + "\n", as_json.err);
    EXPECT_EQ(succeed(with("--json")).json()["warnings"].size(), 1u) << "also with -q";
    EXPECT_EQ(succeed(with("-q")).err, "");
}

TEST_F(Receivers, OutputsThatDoNotFit) {
    make_pixels();
    make_texels();
    for (const char* scene : {"px.prt", "tx.prt"}) {
        for (const char* output : {"new.ply", "new.glb"}) {
            misuse({"relight", scene, "white.hdr", "-o", output},
                   "--output: expected .png, .exr or .npy");
            misuse({"edit", scene, "white.hdr", "-o", output, "--disc", "0,1,0,10"}, output);
        }
        misuse({"relight", scene, "white.hdr", "-o", "new.png", "--eye", "1,2,3"},
               "--eye: expected no camera");
        misuse({"relight", scene, "white.hdr", "-o", "new.png", "--size", "8x8"},
               "--size: expected no camera");
        fail({"view", scene, "white.hdr", "-o", "new.png"}, {});
    }
    misuse("relight tx.prt white.hdr -o new.png --background none",
           "--background: expected no background for a scene whose receivers are texels");
    misuse("relight px.prt white.hdr -o new.npy --albedo mesh", "--albedo");
}

TEST_F(Receivers, ReceiversThatCannotBe) {
    const auto precompute = [](const std::string& mesh, const std::string& receivers,
                               const std::string& view = "") {
        std::vector<std::string> arguments = {"precompute", mesh,          "-o",
                                              "new.prt",    "--receivers", receivers};
        if (!view.empty())
            arguments.insert(arguments.end(), {"--view", view});
        return arguments;
    };
    misuse(precompute("mesh.obj", "pixels:8x8"), "--view");
    misuse(precompute("mesh.obj", "vertices", "left"), "--view");
    for (const char* receivers :
         {"pixels", "pixels:8", "pixels:8x", "pixels:8x8:", "pixels:8x8:2:2", "pixels:8x8x8",
          "pixels:-8x8", "pixels:0x8", "pixels:8x99999", "pixels:8x8:0", "pixels:8x8:99",
          "pixels:16384x16384:8", "faces", "texels:"})
        misuse(precompute("mesh.obj", receivers, "auto"), "--receivers");
    misuse(precompute("square.ply", "texels:8x8:2"), "--receivers");
    for (const char* view : {"left", "1,2,3", "1,2,3,4,5,x", "1,2,3,4,5,6,7,8", "1,2,3,1,2,3",
                             "0,0,5,0,0,0,0", "0,0,5,0,0,0,180", "nan,0,5,0,0,0"})
        misuse(precompute("mesh.obj", "pixels:8x8", view), "--view");
    fail(precompute("mesh.obj", "pixels:8x8", "0,0,5,0,0,9"), {"mesh.obj: ", "sees nothing"});
    fail(precompute("mesh.obj", "texels:8x8"), {"mesh.obj: ", "uvs"});
}

} // namespace
} // namespace relumine::app
