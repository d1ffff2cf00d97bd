#include "mesh/formats/gltf_accessors.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "mesh/text_reader.h"

namespace relumine::mesh::gltf {

namespace {

/// A checked accessor: `count` elements, `stride` bytes apart, all inside `bytes`.
struct Elements {
    std::span<const std::byte> bytes;
    std::size_t count = 0;
    std::size_t stride = 0;
    std::uint64_t component_type = 0;
    bool normalized = false;
};

std::size_t component_size(std::uint64_t type) {
    switch (type) {
    case 5120: // BYTE
    case 5121: // UNSIGNED_BYTE
        return 1;
    case 5122: // SHORT
    case 5123: // UNSIGNED_SHORT
        return 2;
    case 5125: // UNSIGNED_INT
    case 5126: // FLOAT
        return 4;
    default:
        throw std::runtime_error(fmt::format("expected a componentType of glTF, got {}", type));
    }
}

std::uint32_t num_components_of(const std::string& type) {
    constexpr std::array<const char*, 4> Names = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const auto found = std::find(Names.begin(), Names.end(), type);
    if (found == Names.end())
        throw std::runtime_error(fmt::format(
            "expected SCALAR, VEC2, VEC3 or VEC4 as an accessor's type, got {}", excerpt(type)));
    return static_cast<std::uint32_t>(found - Names.begin()) + 1;
}

Elements elements_of(Document& document, std::uint64_t index, std::uint32_t num_components) {
    const Json& accessor = document.element("accessors", index);
    if (accessor.find("sparse") || !accessor.find("bufferView"))
        throw std::runtime_error(
            fmt::format("expected accessor {} in a buffer view of its own, got a {} one", index,
                        accessor.find("sparse") ? "sparse" : "zero"));
    Elements elements;
    elements.component_type = whole(accessor, "componentType");
    elements.normalized = flag(accessor, "normalized");
    const std::uint32_t has = num_components_of(text(accessor, "type"));
    if (has < num_components || (num_components == 1 && has != 1))
        throw std::runtime_error(fmt::format("expected {} components of accessor {}, got {}",
                                             num_components, index, has));
    const std::uint64_t view = whole(accessor, "bufferView");
    const std::uint64_t size = component_size(elements.component_type) * has;
    const std::uint64_t stride = whole(document.element("bufferViews", view), "byteStride", size);
    const std::uint64_t offset = whole(accessor, "byteOffset", 0);
    const std::uint64_t count = whole(accessor, "count");
    elements.bytes = document.view(view);
    if (stride < size || stride > 252 + size)
        throw std::runtime_error(fmt::format(
            "expected a byteStride of {} or more for accessor {}, got {}", size, index, stride));
    if (count == 0 || offset > elements.bytes.size() || size > elements.bytes.size() - offset ||
        count - 1 > (elements.bytes.size() - offset - size) / stride)
        throw std::runtime_error(fmt::format(
            "expected accessor {} inside its buffer view of {} bytes, got {} elements at {}", index,
            elements.bytes.size(), count, offset));
    elements.bytes = elements.bytes.subspan(offset);
    elements.count = count;
    elements.stride = stride;
    return elements;
}

template<class Component>
Component component(const Elements& elements, std::size_t element, std::size_t place) {
    Component value{};
    std::memcpy(&value, elements.bytes.data() + element * elements.stride + place * sizeof value,
                sizeof value);
    return value;
}

template<class Component>
std::vector<float> floats(const Elements& elements, std::uint32_t num_components) {
    std::vector<float> values;
    values.reserve(elements.count * num_components);
    for (std::size_t i = 0; i < elements.count; ++i)
        for (std::uint32_t j = 0; j < num_components; ++j) {
            auto value = static_cast<float>(component<Component>(elements, i, j));
            if constexpr (std::is_integral_v<Component>)
                if (elements.normalized)
                    value = std::max(
                        value / static_cast<float>(std::numeric_limits<Component>::max()), -1.0f);
            values.push_back(value);
        }
    return values;
}

} // namespace

Floats read_floats(Document& document, std::uint64_t accessor, std::uint32_t num_components) {
    const Elements elements = elements_of(document, accessor, num_components);
    Floats result{.count = elements.count};
    switch (elements.component_type) {
    case 5120:
        result.values = floats<std::int8_t>(elements, num_components);
        break;
    case 5121:
        result.values = floats<std::uint8_t>(elements, num_components);
        break;
    case 5122:
        result.values = floats<std::int16_t>(elements, num_components);
        break;
    case 5123:
        result.values = floats<std::uint16_t>(elements, num_components);
        break;
    case 5125:
        result.values = floats<std::uint32_t>(elements, num_components);
        break;
    default:
        result.values = floats<float>(elements, num_components);
    }
    return result;
}

std::vector<std::uint32_t> read_indices(Document& document, std::uint64_t accessor) {
    const Elements elements = elements_of(document, accessor, 1);
    std::vector<std::uint32_t> indices(elements.count);
    for (std::size_t i = 0; i < indices.size(); ++i) {
        if (elements.component_type == 5121)
            indices[i] = component<std::uint8_t>(elements, i, 0);
        else if (elements.component_type == 5123)
            indices[i] = component<std::uint16_t>(elements, i, 0);
        else if (elements.component_type == 5125)
            indices[i] = component<std::uint32_t>(elements, i, 0);
        else
            throw std::runtime_error(
                fmt::format("expected unsigned integers as indices, got componentType {}",
                            elements.component_type));
    }
    return indices;
}

} // namespace relumine::mesh::gltf
