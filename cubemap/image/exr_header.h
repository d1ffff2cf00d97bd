// A check of .exr headers before OpenEXR reads a file.
#pragma once

#include <cstdint>

#include <ImfIO.h>

namespace relumine::cubemap {

/// Refuses files whose headers declare more than the file of `num_bytes` can hold. OpenEXR believes
/// a header and allocates what it declares: attributes of gigabytes, tables of two thousand million
/// rows, blocks of 256 rows with millions of pixels each.
///
/// The check walks over the headers of all parts. It refuses an attribute or a table of chunks that
/// goes beyond the file, and a block that no compression could make so small. OpenEXR checks
/// everything else. The stream ends at the file's start, where it began.
/// Throws:  std::runtime_error.
void check_exr_header(Imf::IStream& stream, std::uint64_t num_bytes);

} // namespace relumine::cubemap
