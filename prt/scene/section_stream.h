// A section of a file that is read again, a little at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "prt/scene/packed_sections.h"

namespace relumine::prt {

/// Unpacks a section from its file, from its begin to its end. The file is open only while bytes
/// are read, so any number of streams may go on together.
///
/// Memory:  what zstd needs for a frame of the section, until the end.
class SectionStream {
public:
    explicit SectionStream(StoredSection section);
    ~SectionStream();
    SectionStream(SectionStream&&) noexcept;
    SectionStream& operator=(SectionStream&&) = delete;

    /// Fills `bytes` with the next bytes of the section.
    ///
    /// Throws:  std::runtime_error that names the path, also where the file has changed since it
    /// was
    ///          opened, which shows at the end of the section at the latest.
    void read(std::span<std::byte> bytes);

private:
    class Unpacking;

    [[noreturn]] void fail() const;

    StoredSection section_;
    std::unique_ptr<Unpacking> unpacking_;
    std::uint64_t done_ = 0;
};

} // namespace relumine::prt
