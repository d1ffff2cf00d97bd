// The door to the library: from a mesh to a picture in any light.
//
//     using namespace relumine;
//     LitScene lit(precompute(load_mesh("bunny.ply", {.floor_vertices = 193})));
//     lit.light(load_environment("grace.exr"));
//     save(lit, "bunny.png", {.albedo = glm::vec3(0.8f)});
//
// load_mesh() reads a mesh, precompute() finds which light reaches it, save_scene() and
// load_scene() keep that; LitScene lights it with any environment or light list and edits it;
// verify(), lit_by() and others ask about it, draw() and save() show it. Errors are exceptions
// derived from std::exception. Nothing here prints.
#pragma once

// IWYU pragma: begin_exports
#include "cubemap/layers/layer_file.h"
#include "relumine/ask/fit.h"
#include "relumine/ask/questions.h"
#include "relumine/in/environment.h"
#include "relumine/in/material.h"
#include "relumine/in/mesh.h"
#include "relumine/in/precompute.h"
#include "relumine/in/precompute_options.h"
#include "relumine/in/scene.h"
#include "relumine/in/scene_cache.h"
#include "relumine/light/edits.h"
#include "relumine/light/harmonics_file.h"
#include "relumine/light/light.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/camera_path.h"
#include "relumine/out/first_sight.h"
#include "relumine/out/light_mix.h"
#include "relumine/out/output.h"
#include "relumine/out/output_options.h"
#include "relumine/out/shared_radiance.h"
#include "relumine/version.h"
// IWYU pragma: end_exports
