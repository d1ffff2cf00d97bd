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
    /// What `bytes` shows if no buffer view has these elements as they are.
    std::vector<std::byte> own;
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
    if (type == "MAT4")
        return 16;
    if (found == Names.end())
        throw std::runtime_error(
            fmt::format("expected SCALAR, VEC2, VEC3, VEC4 or MAT4 as an accessor's type, got {}",
                        excerpt(type)));
    return static_cast<std::uint32_t>(found - Names.begin()) + 1;
}

template<class Component>
Component component(const Elements& elements, std::size_t element, std::size_t place) {
    Component value{};
    std::memcpy(&value, elements.bytes.data() + element * elements.stride + place * sizeof value,
                sizeof value);
    return value;
}

std::uint32_t index_in(const Elements& elements, std::size_t i) {
    switch (elements.component_type) {
    case 5121:
        return component<std::uint8_t>(elements, i, 0);
    case 5123:
        return component<std::uint16_t>(elements, i, 0);
    case 5125:
        return component<std::uint32_t>(elements, i, 0);
    default:
        throw std::runtime_error(
            fmt::format("expected unsigned integers as indices, got componentType {}",
                        elements.component_type));
    }
}

/// Finds `count` elements of `size` bytes in a buffer view. `place` is an object with bufferView
/// and byteOffset; `name` is for errors.
Elements elements_in_view(Document& document, const Json& place, std::uint64_t count,
                          std::uint64_t size, const std::string& name) {
    const std::uint64_t view = whole(place, "bufferView");
    const std::uint64_t stride = whole(document.element("bufferViews", view), "byteStride", size);
    const std::uint64_t offset = whole(place, "byteOffset", 0);
    Elements elements;
    elements.bytes = document.view(view);
    if (stride < size || stride > 252 + size)
        throw std::runtime_error(
            fmt::format("expected a byteStride of {} or more for {}, got {}", size, name, stride));
    if (count == 0 || offset > elements.bytes.size() || size > elements.bytes.size() - offset ||
        count - 1 > (elements.bytes.size() - offset - size) / stride)
        throw std::runtime_error(
            fmt::format("expected {} inside its buffer view of {} bytes, got {} elements at {}",
                        name, elements.bytes.size(), count, offset));
    elements.bytes = elements.bytes.subspan(offset);
    elements.count = count;
    elements.stride = stride;
    return elements;
}

/// Copies elements of `size` bytes next to each other. Without a buffer view they are zeros.
Elements own_elements(Document& document, const Json& accessor, std::uint64_t size,
                      const std::string& name) {
    const std::uint64_t count = whole(accessor, "count");
    if (count == 0)
        throw std::runtime_error(fmt::format("expected elements of {}, got 0 elements", name));
    document.take_memory(count * size);
    Elements own;
    if (accessor.find("bufferView"))
        own = elements_in_view(document, accessor, count, size, name);
    own.own.resize(count * size);
    for (std::size_t i = 0; i < count && !own.bytes.empty(); ++i)
        std::memcpy(&own.own[i * size], &own.bytes[i * own.stride], size);
    own.bytes = own.own;
    own.count = count;
    own.stride = size;
    return own;
}

/// Puts the elements of "sparse" over those of the accessor.
void replace_sparse(Document& document, const Json& sparse, std::uint64_t size,
                    const std::string& name, Elements& elements) {
    const std::uint64_t count = whole(sparse, "count");
    if (count == 0)
        return;
    const Json& place = child(sparse, "indices");
    const std::uint64_t type = whole(place, "componentType");
    Elements indices =
        elements_in_view(document, place, count, component_size(type), "indices of " + name);
    indices.component_type = type;
    const Elements values =
        elements_in_view(document, child(sparse, "values"), count, size, "values of " + name);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t target = index_in(indices, i);
        if (target >= elements.count)
            throw std::runtime_error(fmt::format("expected sparse indices of {} below {}, got {}",
                                                 name, elements.count, target));
        std::memcpy(&elements.own[target * size], &values.bytes[i * values.stride], size);
    }
}

Elements elements_of(Document& document, std::uint64_t index, std::uint32_t num_components) {
    const Json& accessor = document.element("accessors", index);
    const std::string name = fmt::format("accessor {}", index);
    const std::uint64_t component_type = whole(accessor, "componentType");
    const std::uint32_t has = num_components_of(text(accessor, "type"));
    if (has < num_components || (num_components == 1 && has != 1) ||
        (has == 16) != (num_components == 16))
        throw std::runtime_error(fmt::format("expected {} components of accessor {}, got {}",
                                             num_components, index, has));
    const std::uint64_t size = component_size(component_type) * has;
    const Json& sparse = child(accessor, "sparse");
    const bool is_in_view = accessor.find("bufferView") && sparse.size() == 0;
    Elements elements =
        is_in_view ? elements_in_view(document, accessor, whole(accessor, "count"), size, name)
                   : own_elements(document, accessor, size, name);
    if (sparse.size() != 0)
        replace_sparse(document, sparse, size, name, elements);
    elements.component_type = component_type;
    elements.normalized = flag(accessor, "normalized");
    return elements;
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

std::uint32_t num_components(const Document& document, std::uint64_t accessor) {
    return num_components_of(text(document.element("accessors", accessor), "type"));
}

std::vector<std::uint32_t> read_indices(Document& document, std::uint64_t accessor) {
    const Elements elements = elements_of(document, accessor, 1);
    std::vector<std::uint32_t> indices(elements.count);
    for (std::size_t i = 0; i < indices.size(); ++i)
        indices[i] = index_in(elements, i);
    return indices;
}

} // namespace relumine::mesh::gltf
