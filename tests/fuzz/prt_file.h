// The container of a .prt file, forged: its sizes and checksums made to fit whatever is in it. They
// keep out accidents, not people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relumine::fuzz {

/// Returns the file with the size and the checksums that its header and sections need.
[[nodiscard]] std::vector<std::byte> with_checksums(std::span<const std::byte> file);

/// Makes a file one of another version. Its header must be whole.
void set_version(std::vector<std::byte>& file, std::uint32_t version);

} // namespace relumine::fuzz
