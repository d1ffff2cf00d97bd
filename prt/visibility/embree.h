// What this project uses of Embree, the same for versions 3 and 4. Since version 4 a query has
// arguments, which hold the flags that were part of its context.
#pragma once

#if RELUMINE_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>
#include <string>
#include <type_traits>

namespace relumine::prt::embree {

struct DeviceDeleter {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
using DeviceHandle = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter>;

/// Starts Embree. What a system's Embree is built without, queries would miss in silence.
///
/// Throws:  std::runtime_error where it cannot start here, or lacks packets or filters.
[[nodiscard]] DeviceHandle new_device();

/// Throws what the device's last error means; `action` is what it was asked to do.
void throw_on_error(RTCDevice device, const char* action);

/// Returns "Embree 4.3.3".
[[nodiscard]] std::string version_of(RTCDevice device);

#if RELUMINE_EMBREE >= 4

/// What Embree hands on to filters.
using Context = RTCRayQueryContext;
using Flags = RTCRayQueryFlags;
inline constexpr Flags Coherent = RTC_RAY_QUERY_FLAG_COHERENT,
                       Incoherent = RTC_RAY_QUERY_FLAG_INCOHERENT;

inline void begin(Context& context) {
    rtcInitRayQueryContext(&context);
}

/// Returns Embree's usual arguments, which rtcInitOccludedArguments() or
/// rtcInitIntersectArguments() sets, with these two.
template<class Arguments>
Arguments arguments(void (*set_usual)(Arguments*), Context& context, Flags flags = Incoherent) {
    Arguments result;
    set_usual(&result);
    result.context = &context;
    result.flags = flags;
    return result;
}

inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
    RTCOccludedArguments asked = arguments(rtcInitOccludedArguments, context);
    rtcOccluded1(scene, &ray, &asked);
}

inline void occluded(RTCScene scene, Context& context, Flags flags, const int* valid,
                     RTCRay16& rays) {
    RTCOccludedArguments asked = arguments(rtcInitOccludedArguments, context, flags);
    rtcOccluded16(valid, scene, &rays, &asked);
}

inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray) {
    RTCIntersectArguments asked = arguments(rtcInitIntersectArguments, context);
    rtcIntersect1(scene, &ray, &asked);
}

inline void intersect(RTCScene scene, Context& context, Flags flags, const int* valid,
                      RTCRayHit16& rays) {
    RTCIntersectArguments asked = arguments(rtcInitIntersectArguments, context, flags);
    rtcIntersect16(valid, scene, &rays, &asked);
}

#else

/// What Embree hands on to filters.
using Context = RTCIntersectContext;
using Flags = RTCIntersectContextFlags;
inline constexpr Flags Coherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT,
                       Incoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;

inline void begin(Context& context) {
    rtcInitIntersectContext(&context);
}

inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
    rtcOccluded1(scene, &context, &ray);
}

inline void occluded(RTCScene scene, Context& context, Flags flags, const int* valid,
                     RTCRay16& rays) {
    context.flags = flags;
    rtcOccluded16(valid, scene, &context, &rays);
}

inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray) {
    rtcIntersect1(scene, &context, &ray);
}

inline void intersect(RTCScene scene, Context& context, Flags flags, const int* valid,
                      RTCRayHit16& rays) {
    context.flags = flags;
    rtcIntersect16(valid, scene, &context, &rays);
}

#endif

} // namespace relumine::prt::embree
