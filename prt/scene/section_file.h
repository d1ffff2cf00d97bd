// Writing a file of named, compressed, checksummed sections: the container of .prt files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "prt/scene/packed_sections.h"

namespace relumine::prt {

/// The bytes of a section that will be written: bytes of its own, a view of an array that lasts
/// until then, or a function that makes them, piece by piece, when their turn has come. So a save
/// needs little memory beside the scene.
class SectionContent {
public:
    /// Fills `piece` with the bytes of the section from `begin` on. Pieces may be asked for at the
    /// same time.
    using Fill = std::function<void(std::uint64_t begin, std::span<std::byte> piece)>;

    /// Fills `piece` with the bytes that follow those of the call before.
    using Next = std::function<void(std::span<std::byte> piece)>;

    SectionContent() = default;
    SectionContent(std::vector<std::byte> own) : content_(std::move(own)) {}
    SectionContent(std::uint64_t size, Fill fill) : content_(Maker{size, std::move(fill)}) {}

    /// `elements` must last until the section is written.
    template<typename Element>
    [[nodiscard]] static SectionContent view(const std::vector<Element>& elements) {
        static_assert(std::is_trivially_copyable_v<Element>);
        SectionContent content;
        content.content_ = std::as_bytes(std::span(elements));
        return content;
    }
    template<typename Element>
    static SectionContent view(std::vector<Element>&&) = delete;

    /// Bytes that can only be had from the first to the last, once.
    [[nodiscard]] static SectionContent in_order(std::uint64_t size, Next next) {
        SectionContent content;
        content.content_ = InOrder{size, std::move(next)};
        return content;
    }

    [[nodiscard]] std::uint64_t size() const;
    /// For bytes that come in order: puts the next `size` into `made`, for bytes() to return.
    void take_next(std::size_t size, std::vector<std::byte>& made) const;
    /// Returns `size` bytes from `begin` on. `made` keeps them if the function makes them.
    [[nodiscard]] std::span<const std::byte> bytes(std::uint64_t begin, std::size_t size,
                                                   std::vector<std::byte>& made) const;

private:
    struct Maker {
        std::uint64_t size;
        Fill fill;
    };
    struct InOrder {
        std::uint64_t size;
        Next next;
    };
    std::variant<std::vector<std::byte>, std::span<const std::byte>, Maker, InOrder> content_;
};

/// Sections to write, by name.
using NewSections = std::map<std::string, SectionContent>;

/// Returns the sections of a file, to write them again.
[[nodiscard]] NewSections to_write(Sections sections);

/// Writes sections compressed (zstd), with sizes and xxHash64 checksums; whole or not at all.
/// Returns the file's size.
///
/// Memory:  at most 64 MiB.
/// Throws:  std::runtime_error that names the path.
std::uint64_t write_sections(const std::filesystem::path& path, const NewSections& sections);

/// How well sections of bytes in memory are packed.
enum class Packing { Fast, Best };

/// Returns the bytes of a file of sections, to send them.
[[nodiscard]] std::vector<std::byte> packed_sections(const NewSections& sections,
                                                     Packing packing = Packing::Fast);

} // namespace relumine::prt
