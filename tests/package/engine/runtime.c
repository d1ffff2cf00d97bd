#include <stdlib.h>

#include "relumine_runtime.h"

/* Under an even sky of radiance 1, or -1. */
double mean_radiance(const char* path) {
    RelumineScene* scene = NULL;
    RelumineInfo info = {.size = sizeof info};
    static float sky[4 * 2 * 3];
    for (size_t i = 0; i < sizeof sky / sizeof *sky; ++i)
        sky[i] = 1.0f;
    if (relumine_open(path, NULL, &scene) != RELUMINE_OK || relumine_info(scene, &info) != RELUMINE_OK ||
        relumine_light_lat_long(scene, 4, 2, 16, sky) != RELUMINE_OK)
        return -1;
    const size_t count = 3 * (size_t)info.num_receivers;
    float* radiance = malloc(count * sizeof *radiance);
    double sum = 0;
    if (radiance == NULL || relumine_radiance(scene, radiance, count) != RELUMINE_OK)
        return -1;
    for (size_t i = 0; i < count; ++i)
        sum += radiance[i];
    free(radiance);
    relumine_close(scene);
    return sum / (double)count;
}
