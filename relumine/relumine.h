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
#include "relumine/camera_path.h"
#include "relumine/environment.h"
#include "relumine/fit.h"
#include "relumine/harmonics_file.h"
#include "relumine/light.h"
#include "relumine/light_edits.h"
#include "relumine/light_mix.h"
#include "relumine/lit_scene.h"
#include "relumine/material.h"
#include "relumine/mesh.h"
#include "relumine/option_table.h"
#include "relumine/output.h"
#include "relumine/output_options.h"
#include "relumine/precompute.h"
#include "relumine/precompute_options.h"
#include "relumine/precompute_table.h"
#include "relumine/questions.h"
#include "relumine/scene.h"
#include "relumine/scene_cache.h"
#include "relumine/shared_radiance.h"
#include "relumine/version.h"
// IWYU pragma: end_exports
