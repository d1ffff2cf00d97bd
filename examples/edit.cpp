// Lighting design in code: light layers over an environment, dragged, undone, read by another
// thread, and asked who lights what.
#include <cstdio>
#include <vector>

#include "cubemap/layers/layer_file.h"
#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "prt/precompute.h"
#include "prt/visibility/ray_scene.h"
#include "relight/contribution.h"
#include "relight/light_editor.h"

int main() {
    using namespace relumine;

    // A scene, as in relight.cpp; prt::load_scene() reads one that is precomputed.
    const mesh::TriangleMesh mesh = data_gen::blob(5000);
    const prt::RayScene rays(mesh);
    const float bias = prt::automatic_bias(mesh);
    const prt::Transfer transfer =
        prt::precompute(prt::vertex_receivers(mesh), rays, {.tolerance = 0.03f, .bias = bias});
    relight::LightEditor editor(
        transfer,
        {.blockers = &rays, .positions = mesh.positions, .bias = bias, .tolerance = 0.03f});
    editor.set_base(data_gen::sun_and_sky(128));

    // Any number of layers is one update; mark() makes a step that undo() comes back to.
    cubemap::LightLayer key{.name = "key",
                            .region = cubemap::Disc{.direction = {1, 1, 1}, .radius_degrees = 8},
                            .effect = cubemap::Emit{.radiance = {40, 38, 35}}};
    const cubemap::LightLayer dim{.name = "less ground",
                                  .region =
                                      cubemap::Disc{.direction = {0, -1, 0}, .radius_degrees = 90},
                                  .effect = cubemap::Gain{.factor = 0.25f}};
    editor.set_layers({dim, key});
    editor.mark();

    // A drag: many edits, each relights only what it touches, then one step of undo.
    double seconds = 0.0;
    for (int event = 0; event < 20; ++event) {
        std::get<cubemap::Disc>(key.region).direction.x -= 0.1;
        seconds += editor.set_layer(1, key).seconds;
    }
    editor.mark();
    const std::vector<glm::vec3> dragged(editor.radiance().begin(), editor.radiance().end());
    editor.undo();
    editor.redo(); // bit by bit what it was

    std::vector<glm::vec3> seen; // any thread may ask at any time
    editor.snapshot(seen);

    // Which directions light receiver 0? Its integral over the sphere is the receiver's radiance.
    const std::uint32_t receiver = 0;
    const cubemap::CubeMap who = relight::contribution_map(editor.relighter(), {&receiver, 1});
    cubemap::save_layers("layers.json",
                         {.layers = {editor.layers().begin(), editor.layers().end()}});
    std::printf("20 events, %.2f ms each; receiver 0: %.4f, by direction %.4f\n", 50.0 * seconds,
                static_cast<double>(seen[0].g), cubemap::total_power(who).y);
    return seen == dragged ? 0 : 1;
}
