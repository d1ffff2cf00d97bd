// The shared library's own terminate handler. That of libstdc++, which is linked in, prints the
// exception's name and needs its whole demangler for that: 60 KB. No exception gets here:
// c_door.cpp turns all into codes.
#include <cstdlib>

namespace __gnu_cxx {

void __verbose_terminate_handler(); // NOLINT(bugprone-reserved-identifier): libstdc++'s name

void __verbose_terminate_handler() { // NOLINT(bugprone-reserved-identifier)
    std::abort();
}

} // namespace __gnu_cxx
