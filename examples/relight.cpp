// A precomputed scene in the light of a file: relight SCENE.prt ENVIRONMENT.exr PICTURE.png
#include <cstdio>
#include <exception>
#include <vector>

#include "relumine/relumine.h"

int main(int argc, char** argv) try {
    using namespace relumine;
    if (argc != 4)
        return std::fputs("relight SCENE.prt ENVIRONMENT.exr PICTURE.png\n", stderr), 2;
    LitScene lit(load_scene(argv[1]));
    const UpdateReport times =
        lit.light(load_environment(argv[2], {.face_resolution = 64, .rotate_degrees = 90.0}));

    // A part of the environment changes; only what it touches is computed.
    const std::vector<glm::vec3> bright(64, glm::vec3(5.0f));
    const UpdateReport edit =
        lit.environment().update_region({cubemap::Face::PositiveX, 20, 10, 28, 18}, bright);
    save(lit, argv[3], {.exposure_ev = 0.5, .width = 320, .height = 240});

    // How far from the truth is it? Exact integration for some vertices.
    const Verification check = verify(lit, {.num_samples = 50});
    std::printf("%zu clusters, relit in %.2f ms, edit touched %zu clusters in %.2f ms, "
                "relative error %.4f\n",
                lit.scene().transfer.num_clusters(),
                1e3 * (times.seconds_bin + times.seconds_relight), edit.num_clusters,
                1e3 * edit.seconds, check.error.relative_l2);
    return check.error.relative_l2 < 0.1 ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "relight: %s\n", error.what());
    return 1;
}
