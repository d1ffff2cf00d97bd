// The mesh and the environment that the tests give to the examples: boulder.ply and sky.exr.
#include <vector>

#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/mesh_files.h"

int main() {
    using namespace relumine;
    mesh::TriangleMesh mesh = data_gen::blob(5000);
    mesh.colors.assign(mesh.num_vertices(), glm::vec3(1.0f));
    mesh::save("boulder.ply", mesh);
    cubemap::save_environment("sky.exr", data_gen::sun_and_sky(64), cubemap::Layout::LatLong);
}
