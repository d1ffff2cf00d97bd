#include "tests/fuzz/environment_target.h"

RELUMINE_FUZZ_TARGET(avif) {
    relumine::fuzz::read_environment(relumine::fuzz::bytes(data, size));
    return 0;
}
