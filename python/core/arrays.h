// Arrays between Python and the library, through Python's buffer protocol: no numpy is needed to
// compile, and one binary serves every version of it. The Python sources bring what users give into
// the element types below.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <pybind11/pybind11.h>

#include "relumine/in/environment_files.h"
#include "relumine/in/mesh_files.h"

namespace relumine::python {

namespace py = pybind11;
using Shape = std::vector<py::ssize_t>;

/// Numbers of the library that Python reads in place. Keeps their owner alive.
struct Array {
    std::shared_ptr<const void> owner;
    const void* data = nullptr;
    /// The type of an item in Python's struct module: "f", "d", "I" or "B".
    std::string format;
    std::size_t item_size = 0;
    Shape shape;
};

/// Views of memory that `owner` keeps, of shape [..., 3] or [...]. `outer` replaces the first axis.
[[nodiscard]] Array view(std::shared_ptr<const void> owner, std::span<const glm::vec3> values,
                         Shape outer = {});
[[nodiscard]] Array view(std::shared_ptr<const void> owner, std::span<const glm::vec2> values);
[[nodiscard]] Array view(std::shared_ptr<const void> owner, std::span<const mesh::Triangle> values);

/// Arrays of values that nobody else owns.
[[nodiscard]] Array owned(std::vector<glm::vec3> values, Shape outer = {});
[[nodiscard]] Array owned(std::vector<glm::dvec3> values);
[[nodiscard]] Array owned(std::vector<double> values);
[[nodiscard]] Array owned(std::vector<std::uint32_t> values);
[[nodiscard]] Array owned(std::vector<float> values, Shape shape);
[[nodiscard]] Array owned(std::vector<std::uint8_t> values, Shape shape);
/// [6, R, R, 3]
[[nodiscard]] Array owned(cubemap::CubeMap map);

/// Copies of what Python gives: contiguous arrays of float32, float64 and uint32.
///
/// Throws:  py::type_error for any other element type or order.
[[nodiscard]] std::vector<glm::vec3> vec3s(const py::buffer& array);
[[nodiscard]] std::vector<glm::dvec3> dvec3s(const py::buffer& array);
[[nodiscard]] std::vector<glm::vec2> vec2s(const py::buffer& array);
[[nodiscard]] std::vector<mesh::Triangle> triangles(const py::buffer& array);
[[nodiscard]] std::vector<std::uint32_t> uint32s(const py::buffer& array);
[[nodiscard]] std::vector<double> doubles(const py::buffer& array);

void bind_arrays(py::module_& module);

} // namespace relumine::python
