// Options as data. Each is declared once, in options_of() beside the struct that it fills: name,
// variable, help, range, and where it counts. The command line, its completion, Python,
// docs/command-line.md and the record of `animate --resume` read these rows.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "relumine/options/option_words.h"

namespace relumine {

/// An option that does not fit: "--fov: expected 0.01 to 179, got '200'".
class OptionError : public std::invalid_argument {
public:
    explicit OptionError(const std::string& message) : std::invalid_argument(message) {}
    OptionError(std::string name, const std::string& why)
        : std::invalid_argument(name + ": " + why), option(std::move(name)), reason(why) {}
    /// "--fov"; empty where the message is of no single option
    std::string option = {};
    std::string reason = {};
};

/// What there is to say of an option beside its name, its variable and its help.
struct OptionFacts {
    /// The receivers of scenes, to be joined
    enum Receivers : unsigned {
        OnVertices = 1,
        OnPixels = 2,
        OnTexels = 4,
        OnPoints = 8,
        OnAll = 15
    };

    /// The value names a file, or a folder.
    bool file = false, folder = false;
    bool required = false;
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
    /// What the help calls the value: "FLOAT"
    std::string type = {};
    /// The only words that are allowed; empty: any text
    std::vector<std::string> choices = {};
    /// Stands for a value that is left out; none: it may not be.
    std::optional<std::string> bare = {};
    /// A value for tests, where the type does not tell of one
    std::string example = {};
    /// Another option, by its name: this one is refused without it, or beside it.
    std::string needs = {}, excludes = {};
    /// Between the values of one argument; 0: an argument is one value.
    char separator = 0;
    /// The help shows the value that the variable has at first.
    bool shows_default = true;
    /// Files made under another value differ: the record of `animate --resume` has the option.
    bool shapes_frames = true;
    /// Whether the library and Python alone have it: commands leave it out.
    bool library_only = false;
    /// Scenes of other receivers have no use for it: "camera" is what they have not.
    unsigned receivers = OnAll;
    std::string part = {};
};

/// One option, bound to its variable, which must outlive the row.
struct OptionRow : OptionFacts {
    /// "--fov", "-o,--output"; "MESH" for an argument
    std::string name = {};
    std::string help = {};
    bool is_flag = false;
    /// May be given several times
    bool repeats = false;
    /// The variable as text when it was declared: its default
    std::string initial = {};
    /// Sets the variable from one text, or several where it repeats. Throws std::invalid_argument.
    std::function<void(std::span<const std::string>)> read = {};
    /// The variable as a text that read() takes; empty: nothing is set.
    std::function<std::string()> show = {};

    [[nodiscard]] bool is_argument() const { return !name.starts_with('-'); }
    /// "-o", "--output"; none for an argument
    [[nodiscard]] std::vector<std::string> names() const;
    /// "--output"; "MESH" for an argument
    [[nodiscard]] std::string long_name() const;
    /// "floor_albedo" of --floor-albedo: as Python spells it
    [[nodiscard]] std::string key() const;
    /// "0.01 to 179"; empty: all numbers
    [[nodiscard]] std::string range() const;
    /// What the help shows as default
    [[nodiscard]] std::string shown_default() const {
        return shows_default && !required && !is_flag ? initial : "";
    }

    /// Checks texts and sets the variable. Throws OptionError.
    void set(std::span<const std::string> texts) const;
    void set(const std::string& text) const { set(std::span(&text, 1)); }
};

/// Returns all options as one text, to tell whether files were made with the same.
[[nodiscard]] std::string settings_of(const OptionTable& table);

/// A number and nothing else, as options read it: "1.5", "-2e3". None for other text.
[[nodiscard]] std::optional<double> parse_number(const std::string& text);

/// Decimal digits and nothing else, not above 2^32 - 1. None for other text.
[[nodiscard]] std::optional<std::uint32_t> parse_count(std::string_view text);

/// Two sides with a small x between them: "640x480". None for other text.
[[nodiscard]] std::optional<std::pair<std::uint32_t, std::uint32_t>>
parse_sides(std::string_view text);

/// "a,b" as its words; an empty text is one empty word.
[[nodiscard]] std::vector<std::string> split(std::string_view text, char separator);

/// Splits NAME=TEXT,NAME=TEXT into names and their texts. A word without = belongs to the text
/// before it, with its comma. Throws as refuse_text(form, whole) where the first word has none.
[[nodiscard]] std::vector<std::pair<std::string, std::string>>
named_texts(const std::string& list, const std::string& form, const std::string& whole);

/// Numbers with commas between. None for other text.
[[nodiscard]] std::optional<std::vector<double>> parse_numbers(const std::string& text);

/// Throws std::invalid_argument "expected X, got 'TEXT'".
[[noreturn]] void refuse_text(const std::string& expected, std::string_view text);

// How values are written: read() and show() are each other's inverse. Options of a kind of their
// own name a struct like these: row<ColorText>("--albedo", ...).

namespace option_text {

[[nodiscard]] std::uint64_t whole(const std::string& text, std::uint64_t max);
[[nodiscard]] long double real(const std::string& text, double max);
[[nodiscard]] std::size_t word(std::span<const std::string_view> words, const std::string& text);
[[nodiscard]] std::string shown(float number);
[[nodiscard]] std::string shown(double number);

} // namespace option_text

template<typename T>
struct ValueText;

template<>
struct ValueText<std::string> {
    static constexpr const char* Type = "TEXT";
    static std::string read(const std::string& text) { return text; }
    static std::string show(const std::string& value) { return value; }
};

template<>
struct ValueText<bool> {
    static constexpr const char* Type = "";
    static bool read(const std::string& text);
    static std::string show(bool value) { return value ? "true" : "false"; }
};

template<typename T>
    requires std::is_unsigned_v<T>
struct ValueText<T> {
    static constexpr const char* Type = "UINT";
    static T read(const std::string& text) {
        return static_cast<T>(option_text::whole(text, std::numeric_limits<T>::max()));
    }
    static std::string show(T value) { return std::to_string(value); }
};

template<typename T>
    requires std::is_floating_point_v<T>
struct ValueText<T> {
    static constexpr const char* Type = "FLOAT";
    static T read(const std::string& text) {
        return static_cast<T>(option_text::real(text, std::numeric_limits<T>::max()));
    }
    static std::string show(T value) { return option_text::shown(value); }
};

template<typename T>
    requires std::is_enum_v<T>
struct ValueText<T> {
    static constexpr const char* Type = "TEXT";
    static std::span<const std::string_view> choices() { return WordsOf<T>; }
    static T read(const std::string& text) {
        return static_cast<T>(option_text::word(WordsOf<T>, text));
    }
    static std::string show(T value) {
        return std::string(WordsOf<T>[static_cast<std::size_t>(value)]);
    }
};

/// A colour "R,G,B" or one number for all three, each of 0 to 1e6
struct ColorText {
    static constexpr const char* Type = "TEXT";
    static glm::vec3 read(const std::string& text);
    static std::string show(const glm::vec3& color);
};

/// Options take no position farther from the origin on any axis: rays begin there, and they must
/// stay within prt::LargestCoordinate.
inline constexpr double LargestPosition = 1e18;

/// A point or a direction "X,Y,Z", each within LargestPosition
struct PointText {
    static constexpr const char* Type = "TEXT";
    static glm::dvec3 read(const std::string& text);
    /// In the digits of a float where it is one.
    static std::string show(const glm::dvec3& point);
};

/// Declares one option. `Text` says how its value is written; otherwise its type does.
template<typename Text = void, typename T>
[[nodiscard]] OptionRow row(std::string name, T& value, std::string help, OptionFacts facts = {});

/// Declares an option with a value of its own kind: `read` throws std::invalid_argument for wrong
/// text.
[[nodiscard]] OptionRow row(std::string name, std::function<void(const std::string&)> read,
                            std::string help, OptionFacts facts = {});

// Implementation

namespace option_text {

/// What is inside of an optional or a vector
template<typename T>
struct Inner {
    using Type = T;
};
template<typename T>
struct Inner<std::optional<T>> : Inner<T> {};
template<typename T>
struct Inner<std::vector<T>> : Inner<T> {};

} // namespace option_text

template<typename Text, typename T>
OptionRow row(std::string name, T& value, std::string help, OptionFacts facts) {
    using Own = typename option_text::Inner<T>::Type;
    using How = std::conditional_t<std::is_void_v<Text>, ValueText<Own>, Text>;
    constexpr bool IsVector = std::is_same_v<T, std::vector<Own>>;
    OptionRow result{std::move(facts), std::move(name), std::move(help)};
    if (result.type.empty())
        result.type = result.file ? "FILE" : result.folder ? "FOLDER" : How::Type;
    result.is_flag = std::is_same_v<T, bool>;
    result.repeats = IsVector;
    if constexpr (requires { How::choices(); })
        result.choices.assign(How::choices().begin(), How::choices().end());
    result.read = [&value](std::span<const std::string> texts) {
        if constexpr (IsVector) {
            value.clear();
            for (const std::string& text : texts)
                value.push_back(How::read(text));
        } else {
            value = How::read(texts.back());
        }
    };
    result.show = [&value]() -> std::string {
        if constexpr (IsVector) {
            std::string all;
            for (const Own& each : value)
                all.append(all.empty() ? "" : " ").append(How::show(each));
            return all;
        } else if constexpr (requires { How::show(value); }) {
            return How::show(value);
        } else {
            return value ? How::show(*value) : "";
        }
    };
    result.initial = result.show();
    return result;
}

} // namespace relumine
