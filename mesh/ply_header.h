// The header of a PLY file: what its data are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace relumine::mesh::ply_format {

/// The format's types of numbers.
enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

struct Property {
    std::string_view name;
    Type type = Type::Int8;
    /// Of a list's length
    std::optional<Type> size_type;
};

struct Element {
    std::string_view name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    std::string_view format;
    std::vector<Element> elements;
    /// Where the data begins
    std::size_t num_bytes = 0;
};

/// In bytes, in the binary formats
[[nodiscard]] std::size_t size_of(Type type);
[[nodiscard]] bool is_float(Type type);

/// Reads the header of a whole file; its names point into `file`. Elements have different names;
/// their counts may be any. Throws std::runtime_error "expected X, got Y".
[[nodiscard]] Header read_header(std::string_view file);

} // namespace relumine::mesh::ply_format
