// A precompute in parts and by teams of processes, its checkpoints, and the files of both.
#pragma once

// IWYU pragma: begin_exports
#include "prt/arithmetic.h"
#include "prt/parts/part_facts.h"
#include "prt/parts/part_file.h"
#include "prt/scene/checkpoint_file.h"
#include "prt/scene/relighting_file.h"
#include "prt/scene/scene_file.h"
#include "prt/team.h"
#include "prt/work.h"
// IWYU pragma: end_exports
