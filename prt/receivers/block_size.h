// How many receivers are handled together.
#pragma once

#include <cstddef>

namespace relumine::prt {

/// Receivers are handled in blocks of 16 neighbours.
inline constexpr std::size_t BlockSize = 16;

} // namespace relumine::prt
