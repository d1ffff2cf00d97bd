#include "mesh/formats/draco_decoder.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

/// Copies the values of all vertices. The mapping from vertices to values is part of the data, so
/// it is checked.
template<class Stored>
std::vector<float> values_of(const draco::PointAttribute& stored, const DracoAttribute& wanted,
                             std::uint32_t num_vertices) {
    std::vector<float> values;
    values.reserve(std::size_t{num_vertices} * wanted.num_components);
    const std::size_t num_bytes = stored.buffer()->data_size();
    for (std::uint32_t vertex = 0; vertex < num_vertices; ++vertex) {
        const auto index = stored.mapped_index(draco::PointIndex(vertex));
        const auto begin = static_cast<std::size_t>(stored.GetBytePos(index));
        const std::size_t size = sizeof(Stored) * wanted.num_components;
        if (index.value() >= stored.size() || size > num_bytes || begin > num_bytes - size)
            throw std::runtime_error(
                fmt::format("expected Draco values of {} vertices, got a value that is not there",
                            num_vertices));
        for (std::uint32_t j = 0; j < wanted.num_components; ++j) {
            Stored value{};
            std::memcpy(&value, stored.buffer()->data() + begin + j * sizeof value, sizeof value);
            auto number = static_cast<float>(value);
            if constexpr (std::is_integral_v<Stored>)
                if (wanted.is_normalized)
                    number = std::max(
                        number / static_cast<float>(std::numeric_limits<Stored>::max()), -1.0f);
            values.push_back(number);
        }
    }
    return values;
}

std::vector<float> values_of(const draco::Mesh& mesh, const DracoAttribute& wanted) {
    const draco::PointAttribute* stored = mesh.GetAttributeByUniqueId(wanted.id);
    if (stored == nullptr || stored->buffer() == nullptr)
        throw std::runtime_error(
            fmt::format("expected an attribute {} in the Draco data, got none", wanted.id));
    if (stored->num_components() < wanted.num_components)
        throw std::runtime_error(
            fmt::format("expected {} components of the Draco attribute {}, got {}",
                        wanted.num_components, wanted.id, int{stored->num_components()}));
    if (!stored->is_mapping_identity() && stored->indices_map_size() < mesh.num_points())
        throw std::runtime_error(
            fmt::format("expected Draco values of {} vertices, got those of {}", mesh.num_points(),
                        stored->indices_map_size()));
    switch (stored->data_type()) {
    case draco::DT_INT8:
        return values_of<std::int8_t>(*stored, wanted, mesh.num_points());
    case draco::DT_UINT8:
        return values_of<std::uint8_t>(*stored, wanted, mesh.num_points());
    case draco::DT_INT16:
        return values_of<std::int16_t>(*stored, wanted, mesh.num_points());
    case draco::DT_UINT16:
        return values_of<std::uint16_t>(*stored, wanted, mesh.num_points());
    case draco::DT_INT32:
        return values_of<std::int32_t>(*stored, wanted, mesh.num_points());
    case draco::DT_UINT32:
        return values_of<std::uint32_t>(*stored, wanted, mesh.num_points());
    case draco::DT_FLOAT32:
        return values_of<float>(*stored, wanted, mesh.num_points());
    default:
        throw std::runtime_error(
            fmt::format("expected a number of glTF as the Draco attribute {}, got type {}",
                        wanted.id, int{stored->data_type()}));
    }
}

std::unique_ptr<draco::Mesh> decoded(std::span<const std::byte> data) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok())
        throw std::runtime_error(fmt::format("expected a Draco mesh, got broken data ({})",
                                             excerpt(result.status().error_msg_string())));
    return std::move(result).value();
}

} // namespace

DracoMesh decode_draco(std::span<const std::byte> data,
                       std::span<const DracoAttribute> attributes) {
    const std::unique_ptr<draco::Mesh> mesh = decoded(data);
    DracoMesh result{.num_vertices = mesh->num_points()};
    result.triangles.reserve(mesh->num_faces());
    for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
        const auto& corners = mesh->face(face);
        for (const draco::PointIndex& corner : corners)
            if (corner.value() >= mesh->num_points())
                throw std::runtime_error(fmt::format("expected Draco indices below {}, got {}",
                                                     mesh->num_points(), corner.value()));
        result.triangles.push_back({corners[0].value(), corners[1].value(), corners[2].value()});
    }
    for (const DracoAttribute& attribute : attributes)
        result.values.push_back(values_of(*mesh, attribute));
    return result;
}

} // namespace relumine::mesh
