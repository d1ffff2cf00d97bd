#include "prt/visibility/embree.h"

#include <new>
#include <stdexcept>

#include <fmt/format.h>

namespace relumine::prt::embree {

std::string version_of(RTCDevice device) {
    const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
    return fmt::format("Embree {}.{}.{}", version / 10000, version / 100 % 100, version % 100);
}

void throw_on_error(RTCDevice device, const char* action) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        throw std::bad_alloc();
    if (error == RTC_ERROR_UNSUPPORTED_CPU)
        throw std::runtime_error("expected an Embree that is built for this processor's "
                                 "instruction sets, got " RTC_VERSION_STRING " without them");
    if (error != RTC_ERROR_NONE)
        throw std::runtime_error(
            fmt::format("Embree could not {} (error {})", action, static_cast<int>(error)));
}

DeviceHandle new_device() {
    DeviceHandle device(rtcNewDevice(nullptr));
    if (!device) {
        throw_on_error(nullptr, "start");
        throw std::runtime_error("Embree could not start");
    }
    const auto has = [&](RTCDeviceProperty property) {
        return rtcGetDeviceProperty(device.get(), property) != 0;
    };
    const auto require = [&](bool is_good, const char* what) {
        if (!is_good)
            throw std::runtime_error(fmt::format("expected an Embree built {}, got another {}",
                                                 what, version_of(device.get())));
    };
    require(has(RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED) ||
                has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ||
                has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED),
            "with packets of rays (EMBREE_RAY_PACKETS)");
    require(has(RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED),
            "with filter functions (EMBREE_FILTER_FUNCTION)");
    require(!has(RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED),
            "without culling of back faces (EMBREE_BACKFACE_CULLING)");
    return device;
}

} // namespace relumine::prt::embree
