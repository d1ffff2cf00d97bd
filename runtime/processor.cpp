// Which instruction sets the processor has, for Highway's kernels. In the runtime this stands in
// the place of libhwy, of which nothing else is needed.
#include <cstdint>

#include <hwy/targets.h>

namespace hwy {

int64_t SupportedTargets() {
    int64_t targets = HWY_STATIC_TARGET;
#if HWY_ARCH_X86_64
    __builtin_cpu_init();
    // As libhwy asks: what each of its targets may use, switched on by the system, too.
    const auto has = [](auto... features) {
        return (... && (features != 0));
    };
    if (has(__builtin_cpu_supports("ssse3")))
        targets |= HWY_SSSE3;
    if (has(__builtin_cpu_supports("sse4.1"), __builtin_cpu_supports("sse4.2"),
            __builtin_cpu_supports("pclmul"), __builtin_cpu_supports("aes")))
        targets |= HWY_SSE4;
    if (has(__builtin_cpu_supports("avx2"), __builtin_cpu_supports("fma"),
            __builtin_cpu_supports("bmi"), __builtin_cpu_supports("bmi2"),
            __builtin_cpu_supports("lzcnt"), __builtin_cpu_supports("f16c"))) {
        targets |= HWY_AVX2;
        if (has(__builtin_cpu_supports("avx512f"), __builtin_cpu_supports("avx512vl"),
                __builtin_cpu_supports("avx512dq"), __builtin_cpu_supports("avx512bw"),
                __builtin_cpu_supports("avx512cd")))
            targets |= HWY_AVX3;
    }
#endif
    return targets;
}

ChosenTarget& GetChosenTarget() {
    static ChosenTarget chosen;
    return chosen;
}

} // namespace hwy
