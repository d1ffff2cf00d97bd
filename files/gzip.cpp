#include "files/gzip.h"

#include <limits>
#include <stdexcept>

#include <zlib.h>

namespace relumine::files {

std::vector<std::byte> gzipped(std::span<const std::byte> bytes) {
    constexpr int GzipWindow = 15 + 16, Memory = 9;
    z_stream stream{};
    if (bytes.size() > std::numeric_limits<uInt>::max() ||
        deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, GzipWindow, Memory,
                     Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::runtime_error("gzip: out of memory");
    std::vector<std::byte> result(deflateBound(&stream, static_cast<uLong>(bytes.size())));
    // zlib does not write to its input.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(result.data());
    stream.avail_out = static_cast<uInt>(result.size());
    const int status = deflate(&stream, Z_FINISH);
    result.resize(static_cast<std::size_t>(stream.total_out));
    deflateEnd(&stream);
    if (status != Z_STREAM_END)
        throw std::runtime_error("gzip: cannot compress");
    return result;
}

} // namespace relumine::files
