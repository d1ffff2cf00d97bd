#include "tests/fuzz/environment_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    relumine::fuzz::read_environment(relumine::fuzz::bytes(data, size));
    return 0;
}
