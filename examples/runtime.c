/* Lights a scene by the runtime alone, and writes a point cloud in its colours:
 *     runtime SCENE.prt OUT.ply */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "relumine_runtime.h"

enum { Width = 64, Height = 32 };

/* A sky that is brighter towards the top, and a window at -X: +Z is in the middle, +X left of it. */
static void paint_sky(float* rgb) {
    for (int y = 0; y < Height; ++y)
        for (int x = 0; x < Width; ++x, rgb += 3) {
            const float up = cosf(3.14159265f * ((float)y + 0.5f) / Height);
            const int in_window = abs(x - 3 * Width / 4) < 3 && abs(y - Height / 3) < 3;
            rgb[0] = in_window ? 12.0f : 0.3f + 0.2f * up;
            rgb[1] = in_window ? 10.0f : 0.4f + 0.2f * up;
            rgb[2] = in_window ? 8.0f : 0.6f + 0.2f * up;
        }
}

static int failed(const char* what) {
    fprintf(stderr, "%s: %s\n", what, relumine_last_error());
    return 1;
}

int main(int argc, char** argv) {
    if (argc != 3) {
        fprintf(stderr, "usage: runtime SCENE.prt OUT.ply\n");
        return 2;
    }
    RelumineScene* scene = NULL;
    RelumineInfo info = {.size = sizeof info};
    if (relumine_open(argv[1], NULL, &scene) != RELUMINE_OK || relumine_info(scene, &info) != RELUMINE_OK)
        return failed("open");
    static float sky[Height * Width * 3];
    paint_sky(sky);
    if (relumine_light_lat_long(scene, Width, Height, 0, sky) != RELUMINE_OK)
        return failed("light");

    const size_t count = 3 * (size_t)info.num_receivers;
    float* positions = malloc(count * sizeof *positions);
    float* radiance = malloc(count * sizeof *radiance);
    if (positions == NULL || radiance == NULL || relumine_positions(scene, positions, count) != RELUMINE_OK ||
        relumine_radiance(scene, radiance, count) != RELUMINE_OK)
        return failed("radiance");
    FILE* out = fopen(argv[2], "w");
    if (out == NULL) {
        fprintf(stderr, "%s: cannot be written\n", argv[2]);
        return 1;
    }
    fprintf(out, "ply\nformat ascii 1.0\nelement vertex %u\n", info.num_receivers);
    fprintf(out, "property float x\nproperty float y\nproperty float z\n");
    fprintf(out, "property float red\nproperty float green\nproperty float blue\nend_header\n");
    for (size_t i = 0; i < count; i += 3)
        fprintf(out, "%g %g %g %g %g %g\n", positions[i], positions[i + 1], positions[i + 2], radiance[i],
                radiance[i + 1], radiance[i + 2]);
    const int is_written = fclose(out) == 0;
    free(positions);
    free(radiance);
    relumine_close(scene);
    return is_written ? 0 : 1;
}
