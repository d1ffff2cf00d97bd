// The header of a PLY file: which data follow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::mesh::ply_format {

/// The number types of the format.
enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

/// A property of an element: a number or a list of numbers.
struct Property {
    std::string_view name;
    Type type = Type::Int8;
    /// Type of a list's length. Empty: the property is no list.
    std::optional<Type> size_type;
};

/// A kind of element, and how many of it follow.
struct Element {
    std::string_view name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

/// The whole header.
struct Header {
    std::string_view format;
    std::vector<Element> elements;
    /// A comment says that save() wrote the file.
    bool is_ours = false;
    /// The first image that a comment names, as MeshLab does.
    std::string image = {};
    /// Number of lines that the format does not have, which are skipped, and the first one's word.
    std::size_t num_unknown = 0;
    std::string_view unknown = {};
    /// Size of the header: the data begin there.
    std::size_t num_bytes = 0;
};

/// Returns the size in bytes in the binary formats.
[[nodiscard]] std::size_t size_of(Type type);
[[nodiscard]] bool is_float(Type type);

/// Reads the header of a whole file. Names point into `file`. Elements have different names; their
/// counts are not checked.
/// Throws:  std::runtime_error "expected X, got Y".
[[nodiscard]] Header read_header(std::string_view file);

} // namespace relumine::mesh::ply_format
