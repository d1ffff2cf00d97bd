// A glTF 2.0 file: its JSON, read strictly, and its bytes.
//
// The project has its own reader because of three faults of tinygltf: it takes properties of a
// wrong type for absent ones, it decodes all images of a file, and it does not check where data
// lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/json.h"
#include "mesh/formats/gltf_pointers.h"

namespace relumine::mesh::gltf {

using files::Json;

/// Returns a number of the array called `name`.
[[nodiscard]] std::uint64_t whole_value(const Json& value, const char* name);

/// These functions return a property of an object, or its default. A property without default must
/// exist.
/// Throws:  std::runtime_error "expected X, got Y" for another type or range.
[[nodiscard]] std::uint64_t whole(const Json& object, const char* key,
                                  std::optional<std::uint64_t> fallback = {});
[[nodiscard]] double number(const Json& object, const char* key,
                            std::optional<double> fallback = {});
/// Returns a truth value; false if it is absent.
[[nodiscard]] bool flag(const Json& object, const char* key);
[[nodiscard]] std::string text(const Json& object, const char* key,
                               const std::string& fallback = {});
/// Returns an array of finite numbers, as many as `fallback` has. Returns `fallback` if the
/// property is absent.
[[nodiscard]] std::vector<double> numbers(const Json& object, const char* key,
                                          std::vector<double> fallback);
/// Returns the object or array of a name. Returns an empty one if it is absent.
[[nodiscard]] const Json& child(const Json& object, const char* key);
/// Returns the values of an array. Returns none if it is absent.
[[nodiscard]] const Json::Array& items(const Json& object, const char* key);

/// A parsed file, and the buffers that it names.
class Document {
public:
    /// `file` is a whole .gltf or .glb and must outlive the document. Versions other than 2 are
    /// refused, and required extensions without which there is no mesh. `max_bytes` is the limit of
    /// take_memory().
    Document(std::span<const std::byte> file, std::filesystem::path folder,
             std::uint64_t max_bytes);

    [[nodiscard]] const Json& root() const { return root_; }
    /// Sets properties of the file. References to its JSON are invalid then.
    void change(const Changes& changes, std::vector<std::string>& lost) {
        root_ = changes.applied(root_, lost);
    }
    /// Returns the size of the file and of the buffers beside it that were needed so far.
    [[nodiscard]] std::uint64_t num_bytes() const;
    /// Counts memory that a mesh needs beyond the file's bytes: a file may repeat what it holds.
    /// Throws:  std::runtime_error if all that was taken is more than max_bytes.
    void take_memory(std::uint64_t bytes);
    /// Returns an element of one of the document's arrays: "accessors", "nodes" ...
    [[nodiscard]] const Json& element(const char* array, std::uint64_t index) const;
    [[nodiscard]] std::size_t count(const char* array) const { return items(root_, array).size(); }

    /// Returns one line for each extension that the file uses and the reader does not: what is
    /// lost. Those of materials are left_out() (mesh/formats/gltf_left_out.h).
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

    /// Returns the bytes of a buffer view, checked against its buffer, and decoded if
    /// KHR_meshopt_compression or EXT_meshopt_compression packed them.
    [[nodiscard]] std::span<const std::byte> view(std::uint64_t index);

    /// Returns the content of a URI: a data: URI or a file. Nothing if there is no such file.
    [[nodiscard]] std::optional<std::vector<std::byte>> fetch(const std::string& uri);

private:
    void split_glb(std::span<const std::byte> file);
    void check_extensions();
    [[nodiscard]] std::span<const std::byte> buffer(std::uint64_t index);
    /// Returns the bytes that an object with buffer, byteOffset and byteLength names.
    [[nodiscard]] std::span<const std::byte> part(const Json& description, std::uint64_t view);
    [[nodiscard]] std::vector<std::byte> unpacked(const Json& packed, std::uint64_t view);

    std::filesystem::path folder_;
    std::uint64_t file_bytes_;
    std::string_view json_text_;
    std::uint64_t max_bytes_, num_taken_bytes_ = 0;
    /// The binary chunk of a .glb.
    std::optional<std::span<const std::byte>> chunk_;
    Json root_;
    /// The buffers of URIs, each loaded when it was first needed.
    std::vector<std::optional<std::vector<std::byte>>> buffers_;
    /// The buffer views that were packed, each decoded when it was first needed.
    std::vector<std::optional<std::vector<std::byte>>> views_;
    std::uint64_t num_unpacked_bytes_ = 0;
    std::vector<std::string> warnings_;
};

} // namespace relumine::mesh::gltf
