// The name that somebody meant who wrote another one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace relumine::files {

/// Returns the name that differs least from `text`: letters left out, added, changed, or swapped
/// with their neighbour. Capital letters and the dashes in front do not count. A name that begins
/// with `text` is near, too, and so is one that other programs call `text`. Empty where no name is
/// near.
///
/// Cost:    the product of the lengths, for each name.
[[nodiscard]] std::string_view nearest_name(std::string_view text,
                                            std::span<const std::string_view> names);

/// Returns "; did you mean NAME?", or nothing where no name is near. For the end of a message.
[[nodiscard]] std::string did_you_mean(std::string_view text,
                                       std::span<const std::string_view> names);
[[nodiscard]] std::string did_you_mean(std::string_view text, std::span<const std::string> names);

} // namespace relumine::files
