// The version of the library: 0.1.x keeps what 0.1.0 promises.
#pragma once

#include <string>
#include <string_view>

#define RELUMINE_VERSION_MAJOR 0
#define RELUMINE_VERSION_MINOR 1
#define RELUMINE_VERSION_PATCH 0
/// For comparisons by the preprocessor: 10,000 major + 100 minor + patch.
#define RELUMINE_VERSION                                                                           \
    (RELUMINE_VERSION_MAJOR * 10000 + RELUMINE_VERSION_MINOR * 100 + RELUMINE_VERSION_PATCH)

namespace relumine {

/// Returns the version of the library that was linked, such as "0.1.0". The macros are those of the
/// headers that were compiled.
[[nodiscard]] std::string_view version();

/// Returns the version and the library that traces rays: "0.1.0 (Embree 4.3.3)", or in its place
/// why it cannot start here. Cost: some milliseconds.
[[nodiscard]] std::string long_version();

} // namespace relumine
