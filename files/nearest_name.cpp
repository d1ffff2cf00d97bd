// The distance is that of optimal string alignment: Boytsov, "Indexing Methods for Approximate
// Dictionary Searching" (2011), Section 2.
#include "files/nearest_name.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

namespace relumine::files {

namespace {

/// Longer texts are no misspelt names, and comparing them would take long.
constexpr std::size_t MaxNameLength = 64;

/// What counts in a name.
std::string letters_of(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of('-'), text.size()));
    std::string letters(text);
    for (char& c : letters)
        c = c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return letters;
}

/// How many letters must be added, left out, changed or swapped to make `a` from `b`.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j)
        last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool differ = a[i - 1] != b[j - 1];
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (differ ? 1 : 0)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
        before_last = last;
        last = row;
    }
    return last.back();
}

/// Words of other programs, and what they are called here.
constexpr std::array<std::array<std::string_view, 2>, 26> Synonyms = {{
    {"rotation", "rotate"},
    {"azimuth", "rotate"},
    {"yaw", "rotate"},
    {"angle", "rotate"},
    {"pitch", "tilt"},
    {"brightness", "exposure"},
    {"ev", "exposure"},
    {"tonemapping", "tone-map"},
    {"resolution", "size"},
    {"width", "size"},
    {"height", "size"},
    {"bg", "background"},
    {"alpha", "transparent"},
    {"ground", "floor"},
    {"jobs", "threads"},
    {"diffuse", "albedo"},
    {"color", "albedo"},
    {"projection", "layout"},
    {"equirectangular", "latlong"},
    {"equirect", "latlong"},
    {"panorama", "latlong"},
    {"spherical", "latlong"},
    {"lightprobe", "angular"},
    {"probe", "angular"},
    {"chrome", "mirrorball"},
    {"cubemap", "cube"},
}};

/// Returns the name whose synonym is a text of these letters. Empty if there is none.
std::string_view named_otherwise(const std::string& letters,
                                 std::span<const std::string_view> names) {
    for (const auto& [other, own] : Synonyms)
        for (const std::string_view name : names)
            if (letters == other && letters_of(name) == own)
                return name;
    return {};
}

} // namespace

std::string_view nearest_name(std::string_view text, std::span<const std::string_view> names) {
    const std::string letters = letters_of(text);
    if (letters.empty() || letters.size() > MaxNameLength)
        return {};
    if (const std::string_view name = named_otherwise(letters, names); !name.empty())
        return name;
    std::string_view nearest;
    // A third of the letters may be wrong, in short names one.
    std::size_t least = std::max<std::size_t>(1, letters.size() / 3) + 1;
    for (const std::string_view name : names) {
        const std::string other = letters_of(name);
        // One letter is near to every other.
        if (other.size() < 2 || letters.size() < 2 || other.size() > MaxNameLength)
            continue;
        const bool begins = letters.size() >= 3 && other.starts_with(letters);
        if (const std::size_t far = begins ? 1 : distance(letters, other); far < least) {
            least = far;
            nearest = name;
        }
    }
    return nearest;
}

std::string did_you_mean(std::string_view text, std::span<const std::string_view> names) {
    const std::string_view name = nearest_name(text, names);
    return name.empty() ? std::string() : "; did you mean " + std::string(name) + "?";
}

std::string did_you_mean(std::string_view text, std::span<const std::string> names) {
    return did_you_mean(text, std::vector<std::string_view>(names.begin(), names.end()));
}

} // namespace relumine::files
