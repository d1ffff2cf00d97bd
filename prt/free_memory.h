// Memory that the heap holds back.
#pragma once

#include <cstdlib> // defines __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace relumine::prt {

/// Gives freed memory back to the system. Thousands of small freed blocks would otherwise stay with
/// the process until its end.
inline void return_free_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

} // namespace relumine::prt
