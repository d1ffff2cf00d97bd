/* Does with the native runtime what light_scene.mjs does with the one in WebAssembly:
 *     light_scene SCENE MAP RESOLUTION OUT
 * MAP and OUT are floats; OUT gets radiance after each step, and the light as harmonics. */
#include <stdio.h>
#include <stdlib.h>

#include "relumine_runtime.h"

enum { Harmonics = 3, Face = 2, X = 3, Y = 5, Width = 7, Height = 4 };

static void require(int is_right, const char* what) {
    if (is_right)
        return;
    fprintf(stderr, "%s: %s\n", what, relumine_last_error());
    exit(1);
}

static void write_radiance(const RelumineScene* scene, float* rgb, size_t count, FILE* out) {
    require(relumine_radiance(scene, rgb, count) == RELUMINE_OK, "radiance");
    require(fwrite(rgb, sizeof *rgb, count, out) == count, "write");
}

int main(int argc, char** argv) {
    require(argc == 5, "usage");
    RelumineScene* scene = NULL;
    const RelumineOpenOptions options = {.size = sizeof options, .harmonics = Harmonics};
    RelumineInfo info = {.size = sizeof info};
    require(relumine_open(argv[1], &options, &scene) == RELUMINE_OK && relumine_info(scene, &info) == RELUMINE_OK, argv[1]);
    const uint32_t resolution = (uint32_t)strtoul(argv[3], NULL, 10);
    const size_t map_size = 18 * (size_t)resolution * resolution;
    const size_t count = 3 * (size_t)info.num_receivers, num_harmonics = count * info.num_harmonics;
    float* map = malloc(map_size * sizeof *map);
    float* rgb = malloc(num_harmonics * sizeof *rgb);
    FILE* in = fopen(argv[2], "rb");
    FILE* out = fopen(argv[4], "wb");
    require(map != NULL && rgb != NULL && in != NULL && out != NULL, argv[4]);
    require(fread(map, sizeof *map, map_size, in) == map_size, argv[2]);
    fclose(in);

    require(relumine_light_cube_map(scene, resolution, map) == RELUMINE_OK, "light");
    write_radiance(scene, rgb, count, out);
    /* The map's first texels, ten times as bright, in another place. */
    for (int i = 0; i < 3 * Width * Height; ++i)
        map[i] *= 10.0f;
    require(relumine_update(scene, Face, X, Y, Width, Height, map) == RELUMINE_OK, "update");
    write_radiance(scene, rgb, count, out);
    require(relumine_turn(scene, 33.0) == RELUMINE_OK, "turn");
    write_radiance(scene, rgb, count, out);
    require(relumine_harmonics(scene, rgb, num_harmonics) == RELUMINE_OK, "harmonics");
    require(fwrite(rgb, sizeof *rgb, num_harmonics, out) == num_harmonics, "write");
    require(relumine_bounce(scene, NULL) == RELUMINE_OK, "bounce");
    write_radiance(scene, rgb, count, out);
    require(relumine_light_lat_long(scene, 2 * resolution, resolution, 0, map) == RELUMINE_OK, "light");
    write_radiance(scene, rgb, count, out);
    relumine_close(scene);
    free(map);
    free(rgb);
    return fclose(out) == 0 ? 0 : 1;
}
