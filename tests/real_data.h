// Real meshes and environments that are not part of the repository (docs/data.md): in the folder
// that the environment variable RELUMINE_DATA names. Tests that want them skip where it is absent.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace relumine {

/// The folder, or an empty path where the variable is not set.
inline std::filesystem::path real_data_folder() {
    const char* const folder = std::getenv("RELUMINE_DATA");
    return folder != nullptr ? folder : "";
}

/// The path of a file "envs/debevec/grace_cross.hdr"; empty where it is absent.
inline std::filesystem::path real_data(const std::filesystem::path& name) {
    const std::filesystem::path folder = real_data_folder();
    if (folder.empty() || !std::filesystem::exists(folder / name))
        return {};
    return folder / name;
}

/// What a skipped test or bench says.
inline std::string absent_data(const std::filesystem::path& name) {
    return "no " + name.string() +
           (real_data_folder().empty() ? "" : " in " + real_data_folder().string()) +
           "; set RELUMINE_DATA to the folder that holds it";
}

} // namespace relumine
