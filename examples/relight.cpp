// The smallest complete use of the library: a mesh, its light transfer, two environments, an edit,
// a picture.
#include <cstdio>
#include <vector>

#include "cubemap/cube_map.h"
#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "prt/precompute.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/picture.h"
#include "relight/relighter.h"

int main() {
    using namespace relumine;

    // Once per mesh: which light reaches which vertex. mesh::load() reads your own.
    const mesh::TriangleMesh mesh = data_gen::blob(5000);
    const prt::RayScene rays(mesh);
    const float bias = prt::automatic_bias(mesh);
    const float tolerance = 0.03f;
    const prt::Transfer transfer =
        prt::precompute(prt::vertex_receivers(mesh), rays, {.tolerance = tolerance, .bias = bias});

    // Then any environment, in milliseconds. cubemap::load_environment() and resample() read your
    // own.
    relight::Relighter relighter(
        transfer,
        {.blockers = &rays, .positions = mesh.positions, .bias = bias, .tolerance = tolerance});
    relighter.set_environment(data_gen::two_soft_boxes(64));
    const relight::RelightTimes times = relighter.set_environment(data_gen::sun_and_sky(64));

    // A part of the environment changes; only what it touches is computed.
    const std::vector<glm::vec3> bright(8 * 8, glm::vec3(5.0f));
    const relight::UpdateReport edit =
        relighter.update_region({cubemap::Face::PositiveX, 20, 10, 28, 18}, bright);

    relight::save_picture("relight.png",
                          relight::draw(mesh, rays, relighter.radiance(), relighter.environment(),
                                        relight::automatic_camera(mesh),
                                        {.width = 320, .height = 240}));
    std::printf("%zu clusters, relit in %.2f ms, edit touched %zu clusters in %.2f ms\n",
                transfer.num_clusters(), 1e3 * (times.seconds_bin + times.seconds_relight),
                edit.num_clusters, 1e3 * edit.seconds);
}
