// What headers say of options: which words an enumeration has, and that there is a table. Who reads
// or writes rows includes relumine/options/option_table.h.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace relumine {

struct OptionFacts;
struct OptionRow;
using OptionTable = std::vector<OptionRow>;

/// The words of an enumeration, in the order of its values. Specialised beside the enumeration.
template<typename Enum>
inline constexpr std::span<const std::string_view> WordsOf = {};

} // namespace relumine
