// Parts of bytes in one array, each compressed on its own and in parallel. Made for checkpoints:
// speed matters more than size.
#pragma once

#include <cstddef>
#include <cstring>
#include <functional>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

namespace relumine::files {

/// Packs parts. `part(i)` makes part i.
/// Threads: `part` is called in parallel and in any order.
[[nodiscard]] std::vector<std::byte>
pack(std::size_t num_parts, const std::function<std::vector<std::byte>(std::size_t)>& part);

/// Passes the parts to the caller, one after the other.
/// Throws:  std::runtime_error for bytes that pack() did not make.
void unpack(std::span<const std::byte> packed,
            const std::function<void(std::span<const std::byte>)>& on_part);

/// Returns the parts of what pack() made, as they lie there.
/// Throws:  as unpack(), where the bytes are no list of parts.
[[nodiscard]] std::vector<std::span<const std::byte>>
packed_parts(std::span<const std::byte> packed);

/// The inverse of packed_parts().
[[nodiscard]] std::vector<std::byte>
joined_parts(std::span<const std::span<const std::byte>> parts);

/// Writes numbers one after the other, as they lie in memory.
class ByteWriter {
public:
    template<typename Number>
    void add(const Number& number) {
        add_all(std::span<const Number>(&number, 1));
    }
    template<typename Number>
    void add_all(std::span<const Number> numbers) {
        static_assert(std::is_trivially_copyable_v<Number>);
        const auto bytes = std::as_bytes(numbers);
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

private:
    std::vector<std::byte> bytes_;
};

/// Reads the numbers of a ByteWriter.
/// Throws:  std::runtime_error at the end of the bytes, before anything is allocated.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    template<typename Number>
    [[nodiscard]] Number next() {
        return next_all<Number>(1).front();
    }
    template<typename Number>
    [[nodiscard]] std::vector<Number> next_all(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<Number>);
        if (count > bytes_.size() / sizeof(Number))
            throw std::runtime_error("expected more bytes");
        std::vector<Number> numbers(count);
        if (count != 0)
            std::memcpy(numbers.data(), bytes_.data(), count * sizeof(Number));
        bytes_ = bytes_.subspan(count * sizeof(Number));
        return numbers;
    }
    [[nodiscard]] bool at_end() const { return bytes_.empty(); }

private:
    std::span<const std::byte> bytes_;
};

} // namespace relumine::files
