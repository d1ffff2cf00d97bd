// Draws a frame of an engine, by the library where there is one, else by the runtime.
#include <fmt/format.h>

#ifdef RELUMINE_RUNTIME_ALONE
extern "C" double mean_radiance(const char* scene);
#else
#include <glm/vec3.hpp>

#include "relumine/relumine.h"

namespace {
double mean_radiance(const char* path) {
    relumine::LitScene lit(relumine::load_scene(path));
    lit.light(relumine::cubemap::CubeMap(16, glm::vec3(1.0f)));
    double sum = 0.0;
    for (const glm::vec3& color : lit.radiance())
        sum += color.g;
    return sum / static_cast<double>(lit.radiance().size());
}
} // namespace
#endif

int main(int argc, char** argv) {
    if (argc != 2)
        return 2;
    const double mean = mean_radiance(argv[1]);
    fmt::print("the mean radiance under an even sky is {:.4f}\n", mean);
    return mean > 0.5 && mean <= 1.001 ? 0 : 1;
}
