#include "files/shared_memory.h"

#include <cerrno>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "files/descriptor.h"
#include "files/posix_file.h"

namespace relumine::files {

void write_shared_memory(const std::string& name, std::span<const std::byte> bytes) {
    const std::string bare = name.starts_with('/') ? name.substr(1) : name;
    if (bare.empty() || bare.find('/') != std::string::npos || bare.find('\0') != std::string::npos)
        throw std::runtime_error(
            fmt::format("expected the name of shared memory like /radiance, got '{}'", name));
    const Descriptor object(::shm_open(("/" + bare).c_str(), O_RDWR | O_CLOEXEC, 0));
    struct stat status{};
    if (!object.is_open() || ::fstat(object.get(), &status) != 0)
        fail(name, "write shared memory", errno);
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size < bytes.size())
        throw std::runtime_error(fmt::format(
            "{}: expected shared memory of {} bytes or more, got {}", name, bytes.size(), size));
    // Written, not mapped: a reader that makes the object smaller meanwhile could end the process.
    write_at(name, object.get(), 0, bytes, bytes.size(), size);
}

} // namespace relumine::files
