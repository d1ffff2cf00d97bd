// What this project uses of Embree, the same for versions 3 and 4. Since version 4 a query has
// arguments, which hold the flags that were part of its context.
#pragma once

#if RELUMINE_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace relumine::prt::embree {

#if RELUMINE_EMBREE >= 4

/// What Embree hands on to filters.
using Context = RTCRayQueryContext;
using Flags = RTCRayQueryFlags;
inline constexpr Flags Coherent = RTC_RAY_QUERY_FLAG_COHERENT,
                       Incoherent = RTC_RAY_QUERY_FLAG_INCOHERENT;

inline void begin(Context& context) {
    rtcInitRayQueryContext(&context);
}

inline RTCOccludedArguments occluded_arguments(Context& context, Flags flags) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    arguments.flags = flags;
    return arguments;
}

inline RTCIntersectArguments intersect_arguments(Context& context, Flags flags) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    arguments.flags = flags;
    return arguments;
}

inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
    RTCOccludedArguments arguments = occluded_arguments(context, Incoherent);
    rtcOccluded1(scene, &ray, &arguments);
}

inline void occluded(RTCScene scene, Context& context, Flags flags, const int* valid,
                     RTCRay16& rays) {
    RTCOccludedArguments arguments = occluded_arguments(context, flags);
    rtcOccluded16(valid, scene, &rays, &arguments);
}

inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray) {
    RTCIntersectArguments arguments = intersect_arguments(context, Incoherent);
    rtcIntersect1(scene, &ray, &arguments);
}

inline void intersect(RTCScene scene, Context& context, Flags flags, const int* valid,
                      RTCRayHit16& rays) {
    RTCIntersectArguments arguments = intersect_arguments(context, flags);
    rtcIntersect16(valid, scene, &rays, &arguments);
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
