/* The header compiles as C, and wrong calls get a code and a sentence. */
#include <stdio.h>
#include <string.h>

#include "relumine_runtime.h"

static int failures = 0;

static void expect(RelumineResult got, RelumineResult expected, const char* text) {
    if (got == expected && strstr(relumine_last_error(), text) != NULL)
        return;
    fprintf(stderr, "expected %d and '%s', got %d: %s\n", expected, text, got, relumine_last_error());
    ++failures;
}

int main(void) {
    RelumineScene* scene = NULL;
    if (relumine_runtime_version() != RELUMINE_RUNTIME_VERSION)
        ++failures;
    expect(relumine_open("nothing.prt", NULL, NULL), RELUMINE_WRONG_ARGUMENT, "scene: expected a pointer");
    expect(relumine_open(NULL, NULL, &scene), RELUMINE_WRONG_ARGUMENT, "path: expected a pointer");
    expect(relumine_open("nothing.prt", NULL, &scene), RELUMINE_WRONG_FILE, "nothing.prt: cannot read");
    expect(relumine_open_bytes("no scene", 8, NULL, &scene), RELUMINE_WRONG_FILE, "memory: expected");

    RelumineOpenOptions options = {.size = sizeof options + 8};
    expect(relumine_open("nothing.prt", &options, &scene), RELUMINE_WRONG_ARGUMENT, "options: expected a size");
    options = (RelumineOpenOptions){.size = sizeof options, .harmonics = 7};
    expect(relumine_open("nothing.prt", &options, &scene), RELUMINE_WRONG_ARGUMENT, "order");
    RelumineJobs jobs = {.size = sizeof jobs, .num_threads = 4};
    options = (RelumineOpenOptions){.size = sizeof options, .jobs = &jobs};
    expect(relumine_open("nothing.prt", &options, &scene), RELUMINE_WRONG_ARGUMENT, "jobs.run: expected a pointer");
    /* An older struct ends earlier. */
    options = (RelumineOpenOptions){.size = sizeof options.size};
    expect(relumine_open("nothing.prt", &options, &scene), RELUMINE_WRONG_FILE, "nothing.prt");

    float rgb[3] = {0};
    RelumineInfo info = {.size = sizeof info};
    expect(relumine_info(NULL, &info), RELUMINE_WRONG_ARGUMENT, "scene");
    expect(relumine_light_cube_map(NULL, 1, rgb), RELUMINE_WRONG_ARGUMENT, "scene");
    expect(relumine_radiance(NULL, rgb, 3), RELUMINE_WRONG_ARGUMENT, "scene");
    relumine_close(NULL);
    if (scene != NULL)
        ++failures;
    return failures;
}
