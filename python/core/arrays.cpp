#include "arrays.h"

#include <cstring>

namespace relumine::python {

namespace {

/// Appends the axis of a vector's components.
Shape shape_of(Shape outer, std::size_t count, py::ssize_t components) {
    if (outer.empty())
        outer.push_back(static_cast<py::ssize_t>(count));
    outer.push_back(components);
    return outer;
}

template<typename Value>
std::vector<Value> copied(const py::buffer& array, const std::string& format,
                          std::size_t item_size) {
    const py::buffer_info info = array.request();
    py::ssize_t stride = info.itemsize;
    for (py::ssize_t axis = info.ndim; axis-- > 0;) {
        const auto i = static_cast<std::size_t>(axis);
        if (info.shape[i] > 1 && info.strides[i] != stride)
            throw py::type_error("expected a contiguous array");
        stride *= info.shape[i];
    }
    if (info.format != format || static_cast<std::size_t>(info.itemsize) != item_size)
        throw py::type_error("expected an array of elements '" + format + "', got '" + info.format +
                             "'");
    const std::size_t bytes = static_cast<std::size_t>(info.size) * item_size;
    if (bytes % sizeof(Value) != 0)
        throw py::type_error("expected an array of whole vectors");
    std::vector<Value> result(bytes / sizeof(Value));
    if (bytes != 0)
        std::memcpy(result.data(), info.ptr, bytes);
    return result;
}

template<typename Value>
Array kept(std::vector<Value> values, const std::string& format, std::size_t item_size,
           Shape shape) {
    auto owner = std::make_shared<const std::vector<Value>>(std::move(values));
    const void* data = owner->data();
    return {std::move(owner), data, format, item_size, std::move(shape)};
}

py::buffer_info info_of(const Array& array) {
    Shape strides(array.shape.size());
    auto stride = static_cast<py::ssize_t>(array.item_size);
    for (std::size_t axis = array.shape.size(); axis-- > 0;) {
        strides[axis] = stride;
        stride *= array.shape[axis];
    }
    // Python's protocol has no const pointers; `readonly` stands in for it.
    return {const_cast<void*>(array.data), // NOLINT(cppcoreguidelines-pro-type-const-cast)
            static_cast<py::ssize_t>(array.item_size),
            array.format,
            static_cast<py::ssize_t>(array.shape.size()),
            array.shape,
            strides,
            true};
}

} // namespace

Array view(std::shared_ptr<const void> owner, std::span<const glm::vec3> values, Shape outer) {
    return {std::move(owner), values.data(), "f", sizeof(float),
            shape_of(std::move(outer), values.size(), 3)};
}

Array view(std::shared_ptr<const void> owner, std::span<const glm::vec2> values) {
    return {std::move(owner), values.data(), "f", sizeof(float), shape_of({}, values.size(), 2)};
}

Array view(std::shared_ptr<const void> owner, std::span<const mesh::Triangle> values) {
    return {std::move(owner), values.data(), "I", sizeof(std::uint32_t),
            shape_of({}, values.size(), 3)};
}

Array owned(std::vector<glm::vec3> values, Shape outer) {
    Shape shape = shape_of(std::move(outer), values.size(), 3);
    return kept(std::move(values), "f", sizeof(float), std::move(shape));
}

Array owned(std::vector<glm::dvec3> values) {
    Shape shape = shape_of({}, values.size(), 3);
    return kept(std::move(values), "d", sizeof(double), std::move(shape));
}

Array owned(std::vector<double> values) {
    Shape shape = {static_cast<py::ssize_t>(values.size())};
    return kept(std::move(values), "d", sizeof(double), std::move(shape));
}

Array owned(std::vector<std::uint32_t> values) {
    Shape shape = {static_cast<py::ssize_t>(values.size())};
    return kept(std::move(values), "I", sizeof(std::uint32_t), std::move(shape));
}

Array owned(std::vector<float> values, Shape shape) {
    return kept(std::move(values), "f", sizeof(float), std::move(shape));
}

Array owned(std::vector<std::uint8_t> values, Shape shape) {
    return kept(std::move(values), "B", sizeof(std::uint8_t), std::move(shape));
}

Array owned(cubemap::CubeMap map) {
    const auto resolution = static_cast<py::ssize_t>(map.resolution);
    return owned(std::move(map.texels), {6, resolution, resolution});
}

std::vector<glm::vec3> vec3s(const py::buffer& array) {
    return copied<glm::vec3>(array, "f", sizeof(float));
}

std::vector<glm::dvec3> dvec3s(const py::buffer& array) {
    return copied<glm::dvec3>(array, "d", sizeof(double));
}

std::vector<glm::vec2> vec2s(const py::buffer& array) {
    return copied<glm::vec2>(array, "f", sizeof(float));
}

std::vector<mesh::Triangle> triangles(const py::buffer& array) {
    return copied<mesh::Triangle>(array, "I", sizeof(std::uint32_t));
}

std::vector<std::uint32_t> uint32s(const py::buffer& array) {
    return copied<std::uint32_t>(array, "I", sizeof(std::uint32_t));
}

std::vector<double> doubles(const py::buffer& array) {
    return copied<double>(array, "d", sizeof(double));
}

void bind_arrays(py::module_& module) {
    py::class_<Array>(module, "Array", py::buffer_protocol()).def_buffer(&info_of);
}

} // namespace relumine::python
