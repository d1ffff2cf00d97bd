// A lock that gives a folder to one process at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <utility>

#include "files/posix_file.h"

namespace relumine::files {

/// A lock on a folder. It is held until the object or the process ends, however the process ends.
class FolderLock {
public:
    /// Takes the lock. Returns null while another process, or another lock of this process, has the
    /// folder. On a file system without locks every call succeeds.
    /// Throws:  std::runtime_error for a path that is no folder.
    [[nodiscard]] static std::unique_ptr<FolderLock> acquire(const std::filesystem::path& folder);

private:
    explicit FolderLock(Descriptor&& folder) : folder_(std::move(folder)) {}
    Descriptor folder_;
};

} // namespace relumine::files
