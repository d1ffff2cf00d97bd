// Memory that the heap holds back.
#pragma once

#include <cstdlib> // defines __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace relumine::prt {

/// Gives what was freed in thousands of small blocks back to the system, where it would stay with
/// the process until its end, unused.
inline void return_free_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

} // namespace relumine::prt
