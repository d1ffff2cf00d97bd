// Makes a program compute as on a processor without this one's best instruction sets. Loaded before
// a program (LD_PRELOAD), or linked into a test program. RELUMINE_PROCESSOR is avx2 or sse4.
// RELUMINE_EMBREE_LACKS is packets, filters or backs: what Embree says it is built without.
#include "tests/processor/limits.h"

#include <cstdlib>
#include <string_view>

#include <dlfcn.h>
#include <hwy/highway.h>

#include "prt/visibility/embree.h"

namespace {

const char* embree_settings = nullptr;

bool is_limited_to(std::string_view name) {
    const char* limit = std::getenv("RELUMINE_PROCESSOR");
    return limit != nullptr && limit == name;
}

/// Before main, as kernels are chosen once.
[[gnu::constructor]] void limit_kernels() {
#if HWY_ARCH_X86
    // Better targets have lower bits.
    if (is_limited_to("avx2"))
        hwy::DisableTargets(HWY_AVX2 - 1);
    if (is_limited_to("sse4"))
        hwy::DisableTargets(HWY_SSE4 - 1);
#endif
}

} // namespace

namespace relumine::processor {

void set_embree(const char* settings) {
    embree_settings = settings;
}

} // namespace relumine::processor

/// Stands before Embree's own function, which it calls.
RTC_API RTCDevice rtcNewDevice(const char* config) {
    using Start = RTCDevice (*)(const char*);
    static const auto start = reinterpret_cast<Start>(::dlsym(RTLD_NEXT, "rtcNewDevice"));
    if (embree_settings != nullptr)
        return start(embree_settings);
    return start(is_limited_to("avx2")   ? "isa=avx2"
                 : is_limited_to("sse4") ? "isa=sse4.2"
                                         : config);
}

/// Stands before Embree's own function, too.
RTC_API ssize_t rtcGetDeviceProperty(RTCDevice device, RTCDeviceProperty property) {
    const char* lack = std::getenv("RELUMINE_EMBREE_LACKS");
    const std::string_view lacking = lack == nullptr ? "" : lack;
    if (lacking == "packets" && (property == RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED ||
                                 property == RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED ||
                                 property == RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED))
        return 0;
    if (lacking == "filters" && property == RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED)
        return 0;
    if (lacking == "backs" && property == RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED)
        return 1;
    using Ask = ssize_t (*)(RTCDevice, RTCDeviceProperty);
    static const auto ask = reinterpret_cast<Ask>(::dlsym(RTLD_NEXT, "rtcGetDeviceProperty"));
    return ask(device, property);
}
