// POSIX shared memory, for results that another program takes without a file.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace relumine::files {

/// Writes bytes to the start of a shared memory object that its reader has made. The object is as
/// large as before, and its reader removes it.
///
/// `name` is one name after a slash: "/radiance". The slash may be left out.
/// Throws:  std::runtime_error "NAME: ..." for another name, for an object that is not there, may
///          not be written, or is too small.
void write_shared_memory(const std::string& name, std::span<const std::byte> bytes);

} // namespace relumine::files
