// Meshes that are none, through `precompute` and `info`: one line, at once, in little memory. What
// else the readers refuse is in tests/mesh/formats/.
#include <cstring>

#include <sys/stat.h>

#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class MeshFiles : public AppTest {
protected:
    /// Refused by both commands, naming the file.
    void refused(const std::string& name, const std::string& content,
                 const std::string& part = "expected") const {
        write(name, content);
        for (const std::vector<std::string>& arguments :
             {std::vector<std::string>{"info", name}, {"precompute", name, "-o", "new.prt"}}) {
            const Result result = fail(arguments, {name, part});
            EXPECT_LT(result.processor_seconds, AtOnce) << name;
            EXPECT_LT(result.peak_bytes, 200'000'000u * SanitizerFactor) << name;
        }
    }
};

const char* const PlyHeader =
    "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty "
    "float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n";

std::string ply(const std::string& vertices, const std::string& faces, const std::string& data) {
    std::string text = PlyHeader;
    text.replace(text.find("{}"), 2, vertices);
    text.replace(text.find("{}"), 2, faces);
    return text + data;
}

TEST_F(MeshFiles, EmptyOnes) {
    for (const char* name : {"mesh.obj", "mesh.ply", "mesh.off", "mesh.stl"}) {
        refused(name, "");
        refused(name, "\n\n");
    }
    refused("mesh.ply", ply("0", "0", ""));
    refused("mesh.off", "OFF\n0 0 0\n");
    refused("mesh.stl", "solid nothing\nendsolid nothing\n");
}

TEST_F(MeshFiles, HugeDeclaredSizes) {
    for (const char* huge :
         {"1000000000", "4294967295", "100000000000", "99999999999999999999999"}) {
        refused("mesh.ply", ply(huge, "1", "0 0 0\n"));
        refused("mesh.ply", ply("3", huge, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
        refused("mesh.off", std::string("OFF\n") + huge + " 1 0\n0 0 0\n");
        refused("mesh.off", std::string("OFF\n3 ") + huge + " 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    }
    refused("mesh.stl", std::string(80, ' ') + "\xff\xff\xff\xff" + std::string(50, '\0'));
    refused("mesh.ply", ply("-3", "1", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
}

TEST_F(MeshFiles, SizeWithoutExtentAndFarAway) {
    // One point three times: a mesh, though nothing can be seen of it.
    write("point.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n");
    succeed("info point.obj");
    write("far.obj", "v 0 0 0\nv 3e38 0 0\nv 0 3e38 0\nf 1 2 3\n");
    fail("precompute far.obj -o new.prt", {"expected"});
}

TEST_F(MeshFiles, UnknownKindsAndPaths) {
    refused("mesh.fbx", "Kaydara", "expected a mesh file");
    refused("mesh.usdz", "PK", "pip install relumine[usd]");
    refused("mesh", octahedron_obj(), "expected a mesh file");
    refused("mesh.prt.txt", octahedron_obj(), "expected a mesh file");
    fail("info missing.obj", {"missing.obj", "cannot read"});
    fail("precompute missing.obj -o new.prt", {"missing.obj", "cannot read"});
    fail("precompute missing -o new.prt", {"missing", "cannot read"});
    fs::create_directory(folder() / "folder.ply");
    fail("info folder.ply", {"folder.ply", "regular file"});
    fail("precompute folder.ply -o new.prt", {"folder.ply", "regular file"});
    ASSERT_EQ(::mkfifo((folder() / "pipe.ply").c_str(), 0600), 0);
    fail("info pipe.ply", {"pipe.ply", "regular file"});
}

TEST_F(MeshFiles, OneKindUnderTheNameOfAnother) {
    write("mesh.obj", octahedron_obj());
    succeed("precompute mesh.obj -o scene.prt --face-resolution 16 --refine off");
    refused("scene.ply", read("scene.prt"));
    refused("scene.off", read("scene.prt"));
    refused("scene.obj", read("scene.prt"));
    refused("scene.stl", read("scene.prt"));
    refused("env.obj", white_hdr());
    fail("precompute scene.prt -o new.prt", {"scene.prt", "expected a mesh file"});
    write("mesh.prt", octahedron_obj());
    fail("info mesh.prt", {"mesh.prt", "expected a .prt scene"});
}

} // namespace
} // namespace relumine::app
