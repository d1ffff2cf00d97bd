// Lighting design in code: light layers over an environment, dragged, undone, read by another
// thread, and asked what lights a point. edit SCENE.prt ENVIRONMENT.exr LAYERS.json
#include <cstdio>
#include <exception>
#include <vector>

#include "relumine/relumine.h"

int main(int argc, char** argv) try {
    using namespace relumine;
    if (argc != 4)
        return std::fputs("edit SCENE.prt ENVIRONMENT.exr LAYERS.json\n", stderr), 2;
    LitScene lit(load_scene(argv[1]));
    lit.light(load_environment(argv[2]));

    // Any number of layers is one update; mark() makes a step that undo() comes back to.
    cubemap::LightLayer key{.name = "key",
                            .region = cubemap::Disc{.direction = {1, 1, 1}, .radius_degrees = 8},
                            .effect = cubemap::Emit{.radiance = {40, 38, 35}}};
    const cubemap::LightLayer dim{.name = "less ground",
                                  .region =
                                      cubemap::Disc{.direction = {0, -1, 0}, .radius_degrees = 90},
                                  .effect = cubemap::Gain{.factor = 0.25f}};
    set_layers(lit, {dim, key});
    mark(lit);

    // A drag: many edits, each relights only what it touches, then one step of undo.
    double seconds = 0.0;
    for (int event = 0; event < 20; ++event) {
        std::get<cubemap::Disc>(key.region).direction.x -= 0.1;
        seconds += set_layer(lit, 1, key).seconds;
    }
    mark(lit);
    const std::vector<glm::vec3> dragged(lit.radiance().begin(), lit.radiance().end());
    undo(lit);
    redo(lit); // bit by bit what it was

    SharedRadiance shared; // any thread may ask it at any time
    shared.publish(lit.radiance());
    const std::vector<glm::vec3> seen = shared.snapshot();

    // Which directions light the vertex nearest to a point? Their integral is its radiance.
    const std::uint32_t receiver = nearest_receiver(lit.scene(), {0.0f, 2.0f, 0.0f});
    const cubemap::CubeMap who = contribution_map(lit, {&receiver, 1});
    cubemap::save_layers(argv[3], {.layers = lit.environment().state().layers});
    std::printf("20 events, %.2f ms each; vertex %u: %.4f, by direction %.4f\n", 50.0 * seconds,
                receiver, static_cast<double>(seen[receiver].g), cubemap::total_power(who).y);
    return seen == dragged ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "edit: %s\n", error.what());
    return 1;
}
