// The container of a .prt file, forged: its sizes and checksums made to fit whatever is in it. They
// keep out accidents, not people.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace relumine::fuzz {

/// Returns the file with the size and the checksums that its header and sections need.
[[nodiscard]] std::vector<std::byte> with_checksums(std::span<const std::byte> file);

} // namespace relumine::fuzz
