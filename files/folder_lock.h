// One process at a time in a folder.
#pragma once

#include <filesystem>
#include <memory>
#include <utility>

#include "files/posix_file.h"

namespace relumine::files {

/// Held as long as this lives or the process does, however that ends.
class FolderLock {
public:
    /// None while another process (or another lock of this one) has the folder. A file system
    /// without locks gives them to all. Throws std::runtime_error for what is no folder.
    [[nodiscard]] static std::unique_ptr<FolderLock> acquire(const std::filesystem::path& folder);

private:
    explicit FolderLock(Descriptor&& folder) : folder_(std::move(folder)) {}
    Descriptor folder_;
};

} // namespace relumine::files
