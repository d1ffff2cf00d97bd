// A glTF 2.0 file: its JSON, read strictly, and its bytes.
//
// Our own reader: tinygltf takes properties of a wrong type for absent ones, decodes all images of
// a file, and leaves checking what lies where to its callers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace relumine::mesh::gltf {

using Json = nlohmann::json;

/// A number of an array called `name`.
[[nodiscard]] std::uint64_t whole_value(const Json& value, const char* name);

/// Properties of an object with their defaults. All throw std::runtime_error "expected X, got Y"
/// for another type or range. Where there is no default the property must exist.
[[nodiscard]] std::uint64_t whole(const Json& object, const char* key,
                                  std::optional<std::uint64_t> fallback = {});
[[nodiscard]] double number(const Json& object, const char* key,
                            std::optional<double> fallback = {});
/// A number of 0 to 1.
[[nodiscard]] float fraction(const Json& object, const char* key, float fallback);
[[nodiscard]] std::string text(const Json& object, const char* key,
                               const std::string& fallback = {});
/// An array of finite numbers, `fallback` where it is absent; of that one's size.
[[nodiscard]] std::vector<double> numbers(const Json& object, const char* key,
                                          std::vector<double> fallback);
/// The object or array of that name; an empty one where it is absent.
[[nodiscard]] const Json& child(const Json& object, const char* key);

class Document {
public:
    /// `file`: the whole of a .gltf or .glb, which must outlive the document. Refuses versions
    /// other than 2, and required extensions that are not understood.
    Document(std::span<const std::byte> file, std::filesystem::path folder);

    [[nodiscard]] const Json& root() const { return root_; }
    /// Of the file and of the buffers beside it that were needed so far.
    [[nodiscard]] std::uint64_t num_bytes() const;
    /// Element of one of the document's arrays: "accessors", "nodes" ...
    [[nodiscard]] const Json& element(const char* array, std::uint64_t index) const;
    [[nodiscard]] std::size_t count(const char* array) const { return child(root_, array).size(); }

    /// The bytes of a buffer view, checked against its buffer.
    [[nodiscard]] std::span<const std::byte> view(std::uint64_t index);

    /// The content of a URI: of data:, or of a file; nothing where there is no such file.
    [[nodiscard]] std::optional<std::vector<std::byte>> fetch(const std::string& uri) const;

private:
    void split_glb(std::span<const std::byte> file);
    void check_extensions() const;
    [[nodiscard]] std::span<const std::byte> buffer(std::uint64_t index);

    std::filesystem::path folder_;
    std::uint64_t file_bytes_;
    std::string_view json_text_;
    /// The binary one of a .glb
    std::optional<std::span<const std::byte>> chunk_;
    Json root_;
    /// Those of URIs, once they were needed
    std::vector<std::optional<std::vector<std::byte>>> buffers_;
};

} // namespace relumine::mesh::gltf
