/* Relighting for programs that embed it: a scene that `relumine precompute` made, lit by any
 * environment.
 *
 * librelumine_runtime needs libc, libm and zstd. No exception leaves it, it prints nothing, and it
 * starts no thread: loops run on the caller's (RelumineJobs). docs/runtime.md says what is left out
 * beside the program.
 *
 * Vectors:  x, y, z of a right-handed world, +Y up. Colours: linear red, green, blue.
 * Structs:  `size` comes first and is sizeof the struct; a later version may know longer ones.
 *
 * Errors:   functions return RELUMINE_OK or a code, and nothing has changed unless it is
 * RELUMINE_OK; relumine_last_error() says in one sentence why.
 *
 * Threads:  a scene is used by one thread at a time, several scenes by several. */
#ifndef RELUMINE_RUNTIME_H
#define RELUMINE_RUNTIME_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(RELUMINE_RUNTIME_BUILD)
#define RELUMINE_API __attribute__((visibility("default")))
#else
#define RELUMINE_API
#endif

/* Programs that were compiled with another number before the point do not fit the library. */
#define RELUMINE_RUNTIME_VERSION 101 /* 10,000 major + 100 minor + patch */

typedef enum RelumineResult {
    RELUMINE_OK = 0,
    RELUMINE_WRONG_ARGUMENT = 1, /* NULL, a wrong size, a number out of range */
    RELUMINE_WRONG_FILE = 2,     /* no scene, a broken one, or one of another version */
    RELUMINE_OUT_OF_MEMORY = 3,
    RELUMINE_NOT_LIT = 4,   /* asked before there is light */
    RELUMINE_NOT_THERE = 5, /* bounces or harmonics of a scene that was opened without */
    RELUMINE_FAILED = 6
} RelumineResult;

/* A scene and its light. */
typedef struct RelumineScene RelumineScene;

/* Calls `piece(of, i)` for every i below num_pieces, on any threads, and returns when all have
 * returned. */
typedef void (*RelumineRun)(void* user, size_t num_pieces, void (*piece)(void* of, size_t i),
                            void* of);

typedef struct RelumineJobs {
    size_t size;
    RelumineRun run;
    void* user;
    uint32_t num_threads; /* how many pieces may run at the same time */
} RelumineJobs;

typedef struct RelumineOpenOptions {
    size_t size;
    /* NULL: one thread. Copied; `user` must outlive the scene. Results are the same with any number
     * of threads. */
    const RelumineJobs* jobs;
    uint32_t harmonics; /* 2 or 3: keep the arriving light as spherical harmonics of this order; 0:
                           do not */
} RelumineOpenOptions;

typedef enum RelumineKind {
    RELUMINE_VERTICES = 0,
    RELUMINE_PIXELS = 1,
    RELUMINE_TEXELS = 2,
    RELUMINE_POINTS = 3
} RelumineKind;

typedef struct RelumineInfo {
    size_t size;
    uint32_t kind; /* RelumineKind */
    uint32_t num_receivers;
    uint32_t num_clusters;
    uint32_t num_vertices;
    uint32_t num_triangles;
    uint32_t num_harmonics; /* coefficients of a receiver and channel: 0, 4 or 9 */
    uint32_t has_bounces;   /* 1: relumine_bounce() works */
    uint32_t width, height; /* of a picture or a lightmap; 0 otherwise */
    float tolerance;        /* of the precompute, 1/sr */
    uint32_t resolution;    /* of the cube map that lights the scene; 0 where none does */
} RelumineInfo;

/* A light so far away that its direction is the same everywhere. */
typedef struct RelumineLight {
    float direction[3];  /* unit, from the scene to the light */
    float irradiance[3]; /* on a surface that faces it */
} RelumineLight;

typedef struct RelumineBounces {
    size_t size;
    uint32_t num_bounces; /* exactly so many; 0: as many as `tolerance` asks for */
    float tolerance;      /* relative error of all bounces, such as 0.001 */
    uint32_t
        is_step; /* 1: one step on from the bounces before, for light that changes at every frame */
} RelumineBounces;

/* The number of the library that was linked, in the form of RELUMINE_RUNTIME_VERSION. */
RELUMINE_API uint32_t relumine_runtime_version(void);
/* Why the last call of this thread failed; "" after one that did not. It lasts until the thread's
 * next call. */
RELUMINE_API const char* relumine_last_error(void);

/* Opens a file of `relumine precompute` (.prt) or `relumine export runtime`. `options` may be NULL.
 */
RELUMINE_API RelumineResult relumine_open(const char* path, const RelumineOpenOptions* options,
                                          RelumineScene** scene);
/* The same from memory, which may go away afterwards. */
RELUMINE_API RelumineResult relumine_open_bytes(const void* bytes, size_t num_bytes,
                                                const RelumineOpenOptions* options,
                                                RelumineScene** scene);
/* NULL is allowed. */
RELUMINE_API void relumine_close(RelumineScene* scene);
/* Set info->size first. */
RELUMINE_API RelumineResult relumine_info(const RelumineScene* scene, RelumineInfo* info);

/* Geometry into the caller's arrays. `count` is their number of elements, and must be 3 x
 * num_receivers, or 3 x num_triangles. Receivers of RELUMINE_VERTICES are the scene's vertices:
 * those of the mesh file in its order, and behind them those that `precompute` added where the mesh
 * was coarse (not with --refine off) and a floor's. */
RELUMINE_API RelumineResult relumine_positions(const RelumineScene* scene, float* xyz,
                                               size_t count);
RELUMINE_API RelumineResult relumine_normals(const RelumineScene* scene, float* xyz, size_t count);
RELUMINE_API RelumineResult relumine_triangles(const RelumineScene* scene, uint32_t* vertices,
                                               size_t count);
/* The sample or texel of each receiver, row by row from the top; count: num_receivers. Not for
 * vertices. */
RELUMINE_API RelumineResult relumine_places(const RelumineScene* scene, uint32_t* places,
                                            size_t count);

/* Lights the scene. Radiance is finite and not negative. Cost: milliseconds.
 *
 * Cube map: [6][resolution][resolution][3], each face as it is seen from the middle of the cube:
 *
 *     face   to the right   downwards
 *      +X        +Z            -Y
 *      -X        -Z            -Y
 *      +Y        +X            -Z
 *      -Y        +X            +Z
 *      +Z        -X            -Y
 *      -Z        +X            -Y
 *
 * Lat-long: [height][width][3], twice as wide as high; the top row is +Y. Column x lies at a = 2 pi
 * (0.5 - (x + 0.5) / width) from +Z towards +X: +Z in the middle, +X at a quarter, -X at three
 * quarters. It becomes a cube map of `resolution`, 0: as fine as the picture. */
RELUMINE_API RelumineResult relumine_light_cube_map(RelumineScene* scene, uint32_t resolution,
                                                    const float* rgb);
RELUMINE_API RelumineResult relumine_light_lat_long(RelumineScene* scene, uint32_t width,
                                                    uint32_t height, uint32_t resolution,
                                                    const float* rgb);
/* Distant lights in place of an environment; none of them: darkness. */
RELUMINE_API RelumineResult relumine_light_list(RelumineScene* scene, const RelumineLight* lights,
                                                size_t count);
/* Turns the environment about +Y, from how it stood before its first turn: light from +Z comes from
 * +X at 90 degrees. Updates since the first turn are lost. */
RELUMINE_API RelumineResult relumine_turn(RelumineScene* scene, double degrees);
/* The same with a coarser copy of the map, halved until an edge has at most `resolution` texels:
 * for light that turns while it is looked at. Its texels are those that relumine_update() changes.
 */
RELUMINE_API RelumineResult relumine_turn_coarse(RelumineScene* scene, double degrees,
                                                 uint32_t resolution);
/* New radiance for the texels [x, x + width) x [y, y + height) of a face of the lit (and turned)
 * cube map. Cost: in proportion to what these texels light. */
RELUMINE_API RelumineResult relumine_update(RelumineScene* scene, uint32_t face, uint32_t x,
                                            uint32_t y, uint32_t width, uint32_t height,
                                            const float* rgb);

/* The diffuse reflectance with which light bounces; count: 3 x num_receivers. A file of `export
 * runtime` has it. */
RELUMINE_API RelumineResult relumine_set_albedo(RelumineScene* scene, const float* rgb,
                                                size_t count);
/* Finds the light that surfaces send to each other and adds it to the radiance. `how` may be NULL.
 * New light has no bounces until the next call; relumine_update() keeps those before. */
RELUMINE_API RelumineResult relumine_bounce(RelumineScene* scene, const RelumineBounces* how);

/* Outgoing radiance for albedo 1, which is irradiance over pi, of each receiver: multiply it with
 * the base colour. For points: the mean over the sphere. Into the caller's array; count: 3 x
 * num_receivers. */
RELUMINE_API RelumineResult relumine_radiance(const RelumineScene* scene, float* rgb, size_t count);
/* The same as IEEE half floats; what is larger than 65,504 becomes 65,504. */
RELUMINE_API RelumineResult relumine_radiance_half(const RelumineScene* scene, uint16_t* rgb,
                                                   size_t count);
/* The cube map that lights the scene, turned and updated; count: 18 x resolution^2. */
RELUMINE_API RelumineResult relumine_environment(const RelumineScene* scene, float* rgb,
                                                 size_t count);
/* What lights a receiver: the cube map, each texel times the part of its light that arrives, also
 * by way of other surfaces once the light has bounced. The sum of all texels times their solid
 * angles is the receiver's radiance. count: 18 x resolution^2. */
RELUMINE_API RelumineResult relumine_contribution(const RelumineScene* scene, uint32_t receiver,
                                                  float* rgb, size_t count);
/* How much of the sky each receiver sees around directions: parts of 255 into the caller's array,
 * [receiver][direction]. A part is the mean of a cone of `radius` radians (0 to pi / 2), weighted
 * by the cosine to the receiver's normal. It darkens highlights that the caller finds without
 * shadows, such as those of a prefiltered environment: ask for directions all around once, and look
 * the mirrored eye up. xyz: 3 x num_directions; count: num_directions times how many receivers are
 * asked for, the first ones, such as a scene's without its floor. No light is needed. */
RELUMINE_API RelumineResult relumine_visible_parts(const RelumineScene* scene, const float* xyz,
                                                   size_t num_directions, float radius,
                                                   uint8_t* parts, size_t count);
/* The arriving light, bounces left out; count: 3 x num_harmonics x num_receivers,
 * [receiver][coefficient][channel]. docs/harmonics.md says basis, order, sign and scale. */
RELUMINE_API RelumineResult relumine_harmonics(const RelumineScene* scene, float* rgb,
                                               size_t count);

#ifdef __cplusplus
}
#endif

#endif
