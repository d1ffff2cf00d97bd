#include "prt/scene/section_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relumine::prt {

std::vector<std::byte> packed(const std::vector<bool>& flags) {
    std::vector<std::byte> bytes((flags.size() + 7) / 8);
    for (std::size_t i = 0; i < flags.size(); ++i)
        bytes[i / 8] |= static_cast<std::byte>(static_cast<unsigned>(flags[i]) << (i % 8));
    return bytes;
}

void SectionReader::fail(std::string_view section, std::string_view expected) const {
    throw std::runtime_error(fmt::format("{}: expected {}, got a damaged section '{}'",
                                         path_.string(), expected, section));
}

const std::vector<std::byte>& SectionReader::bytes(const std::string& name) const {
    const auto found = sections_.find(name);
    if (found == sections_.end())
        throw std::runtime_error(
            fmt::format("{}: expected a section '{}', got none", path_.string(), name));
    return found->second;
}

nlohmann::json SectionReader::json(const std::string& name) const {
    const std::vector<char> text = elements<char>(name);
    nlohmann::json json = nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
    if (json.is_discarded() || std::find(text.begin(), text.end(), '\0') != text.end())
        fail(name, "JSON text");
    return json;
}

std::vector<bool> SectionReader::bits(const std::string& name, std::size_t count) const {
    const std::vector<std::byte>& stored = bytes(name);
    if (stored.size() != count / 8 + static_cast<std::size_t>(count % 8 != 0))
        fail(name, fmt::format("{} bits", count));
    std::vector<bool> result(count);
    for (std::size_t i = 0; i < count; ++i)
        result[i] = (stored[i / 8] >> (i % 8) & std::byte{1}) != std::byte{0};
    if (count % 8 != 0 && (stored.back() >> (count % 8)) != std::byte{0})
        fail(name, fmt::format("{} bits", count));
    return result;
}

std::uint32_t natural(const nlohmann::json& json) {
    if (!json.is_number_unsigned() ||
        json.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max())
        throw std::out_of_range("expected an integer of 32 bits");
    return json.get<std::uint32_t>();
}

float real(const nlohmann::json& json) {
    if (!json.is_number() || !(std::abs(json.get<double>()) <= std::numeric_limits<float>::max()))
        throw std::out_of_range("expected a number");
    return json.get<float>();
}

} // namespace relumine::prt
