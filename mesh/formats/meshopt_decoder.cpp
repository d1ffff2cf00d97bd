#include "mesh/formats/meshopt_decoder.h"

#include <stdexcept>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

void check(const MeshoptView& view, std::size_t num_bytes) {
    const auto& [count, stride, mode, filter] = view;
    const bool is_attributes = mode == "ATTRIBUTES";
    if (!is_attributes && mode != "TRIANGLES" && mode != "INDICES")
        throw std::runtime_error(fmt::format(
            "expected ATTRIBUTES, TRIANGLES or INDICES as \"mode\", got {}", excerpt(mode)));
    const bool fits = !is_attributes ? stride == 2 || stride == 4
                                     : stride > 0 && stride <= 256 && stride % 4 == 0;
    if (!fits || (mode == "TRIANGLES" && count % 3 != 0))
        throw std::runtime_error(fmt::format(
            "expected compressed {} as the extension allows them, got {} elements of {} bytes",
            mode, count, stride));
    const bool filter_fits =
        filter == "NONE" ||
        (is_attributes &&
         (filter == "EXPONENTIAL" || (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
          (filter == "QUATERNION" && stride == 8)));
    if (!filter_fits)
        throw std::runtime_error(fmt::format("expected a filter for {} of {} bytes, got {}", mode,
                                             stride, excerpt(filter)));
    if (count * stride / MaxMeshoptRatio > num_bytes)
        throw std::runtime_error(fmt::format("expected the data of {} elements of {} bytes, got {}",
                                             count, stride, num_bytes));
}

} // namespace

std::vector<std::byte> decode_meshopt(std::span<const std::byte> data, const MeshoptView& view) {
    check(view, data.size());
    std::vector<std::byte> result(view.count * view.stride);
    const auto* bytes = reinterpret_cast<const unsigned char*>(data.data());
    using Decoder = int(void*, std::size_t, std::size_t, const unsigned char*, std::size_t);
    Decoder* decode = meshopt_decodeVertexBuffer;
    if (view.mode == "TRIANGLES")
        decode = meshopt_decodeIndexBuffer;
    else if (view.mode == "INDICES")
        decode = meshopt_decodeIndexSequence;
    if (decode(result.data(), view.count, view.stride, bytes, data.size()) != 0)
        throw std::runtime_error(fmt::format("expected compressed {}, got broken data", view.mode));
    if (view.filter == "OCTAHEDRAL")
        meshopt_decodeFilterOct(result.data(), view.count, view.stride);
    else if (view.filter == "QUATERNION")
        meshopt_decodeFilterQuat(result.data(), view.count, view.stride);
    else if (view.filter == "EXPONENTIAL")
        meshopt_decodeFilterExp(result.data(), view.count, view.stride);
    return result;
}

} // namespace relumine::mesh
