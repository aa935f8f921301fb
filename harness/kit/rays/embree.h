#pragma once
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

// What Embree 3 and 4 have under different names and in different orders of arguments: docs/decisions/embree_versions.md. All
// else that the program calls is the same in both.
namespace gnomon::embree {

#if RTC_VERSION_MAJOR >= 4

using CallbackContext = RTCRayQueryContext;
constexpr int filter_flag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

template <class Arguments>
void fill(Arguments& arguments, RTCRayQueryContext& context, RTCFilterFunctionN filter, RTCRayQueryFlags coherence) {
  // Without the flag only geometries that request it are filtered.
  arguments.flags = static_cast<RTCRayQueryFlags>(coherence | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
  arguments.context = &context;
  arguments.filter = filter;
}

#else

using CallbackContext = RTCIntersectContext;
constexpr int filter_flag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

inline void fill(RTCIntersectContext& context, RTCFilterFunctionN filter, RTCIntersectContextFlags coherence) {
  context.flags = coherence;
  context.filter = filter;
}

#endif

/// What a query hands to its filter and to the callbacks of shapes. An object that has it as its first member is found at their
/// `args->context`.
struct Context : CallbackContext {
  Context() {
#if RTC_VERSION_MAJOR >= 4
    rtcInitRayQueryContext(this);
#else
    rtcInitIntersectContext(this);
#endif
  }
};

/// The nearest hit of one ray. The filter is called for every triangle that the ray meets; null: all of them count. The scene
/// needs filter_flag.
inline void intersect(RTCScene scene, RTCRayHit& ray, Context& context, RTCFilterFunctionN filter) {
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  fill(arguments, context, filter, RTC_RAY_QUERY_FLAG_INCOHERENT);
  rtcIntersect1(scene, &ray, &arguments);
#else
  fill(context, filter, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect1(scene, &context, &ray);
#endif
}

/// Whether anything blocks one ray: its tfar is minus infinity then.
inline void occlude(RTCScene scene, RTCRay& ray, Context& context, RTCFilterFunctionN filter) {
#if RTC_VERSION_MAJOR >= 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  fill(arguments, context, filter, RTC_RAY_QUERY_FLAG_INCOHERENT);
  rtcOccluded1(scene, &ray, &arguments);
#else
  fill(context, filter, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcOccluded1(scene, &context, &ray);
#endif
}

/// The same of 16 rays that lie close together. `lanes`, at a multiple of 64 bytes, are -1 where there is a ray, else 0.
inline void occlude(const int* lanes, RTCScene scene, RTCRay16* rays, Context& context, RTCFilterFunctionN filter) {
#if RTC_VERSION_MAJOR >= 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  fill(arguments, context, filter, RTC_RAY_QUERY_FLAG_COHERENT);
  rtcOccluded16(lanes, scene, rays, &arguments);
#else
  fill(context, filter, RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcOccluded16(lanes, scene, &context, rays);
#endif
}

/// Makes a hit one of no instance.
inline void set_no_instance(RTCHitN* hits, unsigned count, unsigned lane) {
  RTCHitN_instID(hits, count, lane, 0) = RTC_INVALID_GEOMETRY_ID;
#ifdef RTC_GEOMETRY_INSTANCE_ARRAY
  RTCHitN_instPrimID(hits, count, lane, 0) = RTC_INVALID_GEOMETRY_ID;
#endif
}

}  // namespace gnomon::embree
