// Installed headers include this one first: an older language gets one error, not hundreds.
#pragma once

#if !defined(__cplusplus) || __cplusplus <= 201703L
#error "Relumine needs C++20: compile with -std=c++20"
// A file that is not there ends the compilation, which #error alone does not.
#define RELUMINE_END "relumine/needs/-std=c++20"
#include RELUMINE_END
#endif
