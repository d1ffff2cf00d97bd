#include "tests/mesh/encoders.h"

#include <stdexcept>

#include <draco/compression/encode.h>
#include <draco/compression/expert_encode.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

namespace relumine::mesh {

namespace {

template<class Value>
int add_attribute(draco::PointCloud& cloud, draco::GeometryAttribute::Type type,
                  draco::DataType component, std::uint8_t num_components, std::uint32_t id,
                  const std::vector<Value>& values) {
    if (values.empty())
        return -1;
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, num_components, component, component != draco::DT_FLOAT32,
                   sizeof(Value), 0);
    const int index =
        cloud.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
    cloud.attribute(index)->set_unique_id(id);
    for (std::uint32_t i = 0; i < values.size(); ++i)
        cloud.attribute(index)->SetAttributeValue(draco::AttributeValueIndex(i), &values[i]);
    return index;
}

} // namespace

std::string draco_data(const DracoSource& source) {
    using draco::GeometryAttribute;
    draco::Mesh mesh;
    mesh.set_num_points(static_cast<std::uint32_t>(source.positions.size()));
    for (const auto& [a, b, c] : source.triangles)
        mesh.AddFace({draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
    const int indices[] = {
        add_attribute(mesh, GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, 7, source.positions),
        add_attribute(mesh, GeometryAttribute::NORMAL, draco::DT_FLOAT32, 3, 5, source.normals),
        add_attribute(mesh, GeometryAttribute::TEX_COORD, draco::DT_FLOAT32, 2, 3, source.uvs)};
    add_attribute(mesh, GeometryAttribute::COLOR, draco::DT_UINT8, 4, 1, source.colors);
    draco::EncoderBuffer buffer;
    draco::Status status;
    if (source.is_point_cloud) {
        draco::Encoder encoder;
        encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
        status = encoder.EncodePointCloudToBuffer(mesh, &buffer);
    } else {
        draco::ExpertEncoder encoder(mesh);
        encoder.SetEncodingMethod(source.is_sequential ? draco::MESH_SEQUENTIAL_ENCODING
                                                       : draco::MESH_EDGEBREAKER_ENCODING);
        for (const int index : indices)
            if (index >= 0 && source.quantization_bits > 0)
                encoder.SetAttributeQuantization(index, source.quantization_bits);
        status = encoder.EncodeToBuffer(&buffer);
    }
    if (!status.ok())
        throw std::runtime_error(status.error_msg_string());
    return {buffer.data(), buffer.size()};
}

namespace {

/// Calls an encoder with room for `bound` bytes.
template<class Encode>
std::string encoded(std::size_t bound, const Encode& encode) {
    std::vector<unsigned char> bytes(bound);
    bytes.resize(encode(bytes.data(), bound));
    return {bytes.begin(), bytes.end()};
}

} // namespace

std::string meshopt_attributes(const std::string& values, std::size_t stride) {
    const std::size_t count = values.size() / stride;
    return encoded(meshopt_encodeVertexBufferBound(count, stride),
                   [&](unsigned char* bytes, std::size_t size) {
                       return meshopt_encodeVertexBuffer(bytes, size, values.data(), count, stride);
                   });
}

std::string meshopt_triangles(const std::vector<std::uint32_t>& indices) {
    return encoded(meshopt_encodeIndexBufferBound(indices.size(), indices.size()),
                   [&](unsigned char* bytes, std::size_t size) {
                       return meshopt_encodeIndexBuffer(bytes, size, indices.data(),
                                                        indices.size());
                   });
}

std::string meshopt_indices(const std::vector<std::uint32_t>& indices) {
    return encoded(meshopt_encodeIndexSequenceBound(indices.size(), indices.size()),
                   [&](unsigned char* bytes, std::size_t size) {
                       return meshopt_encodeIndexSequence(bytes, size, indices.data(),
                                                          indices.size());
                   });
}

std::string webp(int width, int height, const std::vector<std::array<std::uint8_t, 4>>& pixels) {
    std::uint8_t* bytes = nullptr;
    const std::size_t size =
        WebPEncodeLosslessRGBA(pixels.front().data(), width, height, 4 * width, &bytes);
    std::string file(reinterpret_cast<const char*>(bytes), size);
    WebPFree(bytes);
    return file;
}

} // namespace relumine::mesh
