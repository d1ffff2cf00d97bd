#include "relumine/version.h"

#include <stdexcept>

#include <fmt/format.h>

#include "prt/visibility/ray_scene.h"

#define RELUMINE_AS_TEXT(number) #number
#define RELUMINE_VERSION_TEXT(major, minor, patch)                                                 \
    RELUMINE_AS_TEXT(major) "." RELUMINE_AS_TEXT(minor) "." RELUMINE_AS_TEXT(patch)

namespace relumine {

std::string_view version() {
    return RELUMINE_VERSION_TEXT(RELUMINE_VERSION_MAJOR, RELUMINE_VERSION_MINOR,
                                 RELUMINE_VERSION_PATCH);
}

std::string long_version() {
    std::string engine;
    try {
        engine = prt::ray_engine();
    } catch (const std::runtime_error& error) {
        engine = error.what();
    }
    return fmt::format("{} ({})", version(), engine);
}

} // namespace relumine
