// What the fuzz targets share. A target hands one input to one reader, as the program would, and
// holds it to its promise: it either reads the input or throws std::runtime_error with a message
// "expected X, got Y"; no crash, leak, other exception or endless loop.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <type_traits>

/// Begins the function of a target: the one that libFuzzer calls, or one of the target's own name
/// where all targets are one program.
#ifdef RELUMINE_FUZZ
#define RELUMINE_FUZZ_TARGET(name)                                                                 \
    extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
#else
#define RELUMINE_FUZZ_TARGET(name)                                                                 \
    extern "C" int relumine_fuzz_##name(const std::uint8_t* data, std::size_t size)
#endif

namespace relumine::fuzz {

/// Inputs that a reader took so far. The corpus test wants some in every folder.
extern std::atomic<std::size_t> num_accepted;

/// An input as the readers take it.
[[nodiscard]] std::span<const std::byte> bytes(const std::uint8_t* data, std::size_t size);

/// Ends the process with the sentence, which libFuzzer counts as a crash, unless it is true.
void require(bool condition, std::string_view sentence);

/// Requires what is said of messages above.
void require_message(const std::runtime_error& error);

/// What `read` returns, or nothing where it refuses the input the way it should.
template<typename Read>
auto accepted(const Read& read) -> std::optional<std::invoke_result_t<Read>> {
    try {
        std::optional<std::invoke_result_t<Read>> result = read();
        ++num_accepted;
        return result;
    } catch (const std::runtime_error& error) {
        require_message(error);
        return std::nullopt;
    }
}

/// A folder of this thread, below the system's folder for temporary files, that goes away with it.
/// Holds the files that inputs may name: four_colors.png, pixel.exr, mesh.mtl, buffer.bin.
[[nodiscard]] const std::filesystem::path& folder();

/// Writes an input to a file of that folder, for readers that take paths.
[[nodiscard]] std::filesystem::path file(std::string_view name, std::span<const std::byte> content);

} // namespace relumine::fuzz
