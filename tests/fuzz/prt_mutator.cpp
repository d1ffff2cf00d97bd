// How libFuzzer changes a .prt file. Changed bytes would only ever meet the checksums. So most
// mutations take the file apart, change what is in one section, and put it together again, packed
// and signed.
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "files/output_file.h"
#include "prt/scene/packed_sections.h"
#include "prt/scene/section_file.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/prt_file.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using namespace relumine;
using Bytes = std::vector<std::byte>;

/// Numbers from the edges of what a section may hold.
constexpr std::array Floats = {0.0f,
                               -0.0f,
                               1.0f,
                               -1.0f,
                               1.0001f,
                               1e-30f,
                               1e19f,
                               -1e20f,
                               1e30f,
                               3e38f,
                               std::numeric_limits<float>::denorm_min(),
                               std::numeric_limits<float>::infinity(),
                               -std::numeric_limits<float>::infinity(),
                               std::numeric_limits<float>::quiet_NaN()};
constexpr std::array<std::uint32_t, 6> Integers = {0, 1, 16, 17, 0x7fffffff, 0xffffffff};

template<typename Number>
void put_somewhere(Bytes& bytes, Number number, std::mt19937& random) {
    if (bytes.size() < sizeof number)
        return;
    const std::size_t at = random() % (bytes.size() / sizeof number) * sizeof number;
    std::memcpy(bytes.data() + at, &number, sizeof number);
}

void mutate_bytes(Bytes& bytes, std::size_t max_size) {
    const std::size_t size = bytes.size();
    bytes.resize(std::max(max_size, size));
    bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size,
                                  std::max<std::size_t>(max_size, 1)));
}

void mutate(prt::Sections& sections, std::size_t max_size, std::mt19937& random) {
    auto section =
        std::next(sections.begin(), static_cast<std::ptrdiff_t>(random() % sections.size()));
    switch (random() % 8) {
    case 0:
        sections.erase(section);
        break;
    case 1:
        section->second.clear();
        break;
    case 2:
        put_somewhere(section->second, Integers[random() % Integers.size()], random);
        break;
    case 3:
    case 4:
    case 5:
        put_somewhere(section->second, Floats[random() % Floats.size()], random);
        break;
    default:
        mutate_bytes(section->second, std::min<std::size_t>(max_size, section->second.size() + 64));
    }
}

} // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned int seed) {
    std::mt19937 random(seed);
    const Bytes given = fuzz::with_checksums(fuzz::bytes(data, size));
    const std::filesystem::path path = fuzz::file("mutated.prt", given);
    Bytes result;
    try {
        prt::Sections sections = prt::read_sections(path);
        // The container itself, one time in eight.
        if (sections.empty() || random() % 8 == 0)
            return LLVMFuzzerMutate(data, size, max_size);
        mutate(sections, max_size, random);
        prt::write_sections(path, prt::to_write(std::move(sections)));
        result = files::read(path);
    } catch (const std::exception&) { // no .prt file yet
    }
    if (result.empty() || result.size() > max_size)
        return LLVMFuzzerMutate(data, size, max_size);
    std::memcpy(data, result.data(), result.size());
    return result.size();
}
