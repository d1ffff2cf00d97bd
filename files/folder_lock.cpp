#include "files/folder_lock.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/file.h>

namespace relumine::files {

std::unique_ptr<FolderLock> FolderLock::acquire(const std::filesystem::path& folder) {
    Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!descriptor.is_open())
        fail(folder, "read", errno);
    if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return nullptr;
    return std::unique_ptr<FolderLock>(new FolderLock(std::move(descriptor)));
}

} // namespace relumine::files
