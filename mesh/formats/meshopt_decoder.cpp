#include "mesh/formats/meshopt_decoder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

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
         (filter == "EXPONENTIAL" ||
          ((filter == "OCTAHEDRAL" || filter == "COLOR") && (stride == 4 || stride == 8)) ||
          (filter == "QUATERNION" && stride == 8)));
    if (!filter_fits)
        throw std::runtime_error(fmt::format("expected a filter for {} of {} bytes, got {}", mode,
                                             stride, excerpt(filter)));
    if (count * stride / MaxMeshoptRatio > num_bytes)
        throw std::runtime_error(fmt::format("expected the data of {} elements of {} bytes, got {}",
                                             count, stride, num_bytes));
}

/// Undoes the filter COLOR of KHR_meshopt_compression, which the library does not have yet: Y, Co,
/// Cg and alpha with a bit less, all scaled by the bits that alpha's highest one tells.
template<typename Unsigned>
void decode_colors(std::span<std::byte> bytes) {
    const auto as_signed = [](Unsigned value) {
        return int{std::bit_cast<std::make_signed_t<Unsigned>>(value)};
    };
    for (std::size_t at = 0; at + 4 * sizeof(Unsigned) <= bytes.size();
         at += 4 * sizeof(Unsigned)) {
        std::array<Unsigned, 4> color{};
        std::memcpy(color.data(), &bytes[at], sizeof color);
        const int y = color[0], co = as_signed(color[1]), cg = as_signed(color[2]),
                  alpha = color[3];
        const int range = static_cast<int>(std::bit_ceil(static_cast<unsigned>(alpha) + 1)) - 1;
        const double scale =
            range == 0 ? 0.0 : double{std::numeric_limits<Unsigned>::max()} / range;
        const std::array<int, 4> levels = {y + co - cg, y + cg, y - co - cg,
                                           (alpha << 1 & range) | (alpha & 1)};
        for (std::size_t i = 0; i < 4; ++i)
            color[i] = static_cast<Unsigned>(std::lround(
                std::clamp(levels[i] * scale, 0.0, double{std::numeric_limits<Unsigned>::max()})));
        std::memcpy(&bytes[at], color.data(), sizeof color);
    }
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
        throw std::runtime_error(
            !data.empty() && data[0] == std::byte{0xa1}
                ? "expected vertices packed by meshopt's codec of version 0, got version 1, which "
                  "is not read; gltfpack -c and -cc write version 0"
                : fmt::format("expected compressed {}, got broken data", view.mode));
    if (view.filter == "OCTAHEDRAL")
        meshopt_decodeFilterOct(result.data(), view.count, view.stride);
    else if (view.filter == "QUATERNION")
        meshopt_decodeFilterQuat(result.data(), view.count, view.stride);
    else if (view.filter == "EXPONENTIAL")
        meshopt_decodeFilterExp(result.data(), view.count, view.stride);
    else if (view.filter == "COLOR")
        view.stride == 4 ? decode_colors<std::uint8_t>(result)
                         : decode_colors<std::uint16_t>(result);
    return result;
}

} // namespace relumine::mesh
