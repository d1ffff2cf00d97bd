// Which instruction sets the processor has, for Highway's kernels. In the runtime this stands in
// the place of libhwy, of which nothing else is needed.
#include <cstdint>

#include <hwy/targets.h>

#if HWY_ARCH_X86_64
#include <cpuid.h>
#endif

namespace {

#if HWY_ARCH_X86_64
/// The two that clang 14 has no name for.
bool has_lzcnt_and_f16c() {
    unsigned a = 0, b = 0, c = 0, d = 0;
    const bool has_f16c = __get_cpuid(1, &a, &b, &c, &d) != 0 && (c >> 29 & 1u) != 0;
    return has_f16c && __get_cpuid(0x80000001u, &a, &b, &c, &d) != 0 && (c >> 5 & 1u) != 0;
}
#endif

} // namespace

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
            __builtin_cpu_supports("bmi"), __builtin_cpu_supports("bmi2"), has_lzcnt_and_f16c())) {
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
