// A mesh to a picture: first MESH.ply SCENE.prt PICTURE.png
#include <cstdio>
#include <exception>

#include "relumine/relumine.h"

int main(int argc, char** argv) try {
    using namespace relumine;
    if (argc != 4)
        return std::fputs("first MESH.ply SCENE.prt PICTURE.png\n", stderr), 2;
    // Once per mesh: which light reaches which vertex.
    LitScene lit(precompute(load_mesh(argv[1]), {.tolerance = 0.03f, .output = argv[2]}));
    // Then any light, in milliseconds: a grey sky with a soft key light in it.
    lit.light(cubemap::CubeMap(64, glm::vec3(0.3f)));
    set_layers(lit, {{.name = "key",
                      .region = cubemap::Disc{.direction = {1, 1, 1}, .radius_degrees = 10},
                      .effect = cubemap::Emit{.radiance = glm::vec3(20.0f, 18.0f, 15.0f)}}});
    save(lit, argv[3], {.albedo = glm::vec3(0.8f), .width = 320, .height = 240});
} catch (const std::exception& error) {
    std::fprintf(stderr, "first: %s\n", error.what());
    return 1;
}
