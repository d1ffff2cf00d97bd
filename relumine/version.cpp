#include "relumine/version.h"

#define RELUMINE_AS_TEXT(number) #number
#define RELUMINE_VERSION_TEXT(major, minor, patch)                                                 \
    RELUMINE_AS_TEXT(major) "." RELUMINE_AS_TEXT(minor) "." RELUMINE_AS_TEXT(patch)

namespace relumine {

std::string_view version() {
    return RELUMINE_VERSION_TEXT(RELUMINE_VERSION_MAJOR, RELUMINE_VERSION_MINOR,
                                 RELUMINE_VERSION_PATCH);
}

} // namespace relumine
