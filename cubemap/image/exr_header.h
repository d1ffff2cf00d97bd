// Whether OpenEXR may be let at a file.
#pragma once

#include <cstdint>

#include <ImfIO.h>

namespace relumine::cubemap {

/// OpenEXR believes what a header declares and allocates it: attributes of gigabytes, tables of two
/// thousand million rows, blocks of 256 rows of one that has millions of pixels. This walks over
/// the headers of all parts first and throws std::runtime_error for what is not in the file of
/// `num_bytes`: an attribute or what it holds, a table of chunks, or a block that no compression
/// could make so small. Everything else is left to OpenEXR. The stream ends where it began, at the
/// file's start.
void check_exr_header(Imf::IStream& stream, std::uint64_t num_bytes);

} // namespace relumine::cubemap
