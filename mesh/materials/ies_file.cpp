// Reads LM-63 files: keywords up to a line TILT=, then numbers alone.
//
// Based on: ANSI/IESNA LM-63-02; the differences of other years as Ian Ashdown, "Parsing the IESNA
// LM-63 Photometric Data File", has them.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "files/counted.h"
#include "files/output_file.h"
#include "mesh/materials/light_profile.h"
#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

/// Angles this near to where they should end do so.
constexpr double Rounding = 0.01;

class IesReader {
public:
    /// `text` has no commas and must outlive the reader.
    explicit IesReader(std::string_view text) : text_(text), reader_(text) {}

    ReadLightProfile read() {
        skip_keywords();
        static_cast<void>(number("the number of lamps"));
        static_cast<void>(number("lumens of a lamp"));
        double factor = positive("the candela multiplier");
        table_.vertical.resize(count("the number of vertical angles"));
        table_.horizontal.resize(count("the number of horizontal angles"));
        check_type();
        for (const char* what : {"the units of lengths", "a width", "a length", "a height"})
            static_cast<void>(number(what));
        factor *= positive("the ballast factor");
        factor *= factor_behind_ballast();
        static_cast<void>(number("the watts"));
        read_angles();
        read_candela(factor);
        if (!reader_.at_end())
            result_.left_out.emplace_back("what stands behind the last intensity");
        result_.profile = LightProfile(std::move(table_));
        return std::move(result_);
    }

private:
    /// Goes behind the line TILT=, and behind what belongs to it.
    void skip_keywords() {
        std::string tilt;
        for (bool is_first = true; tilt.empty(); is_first = false) {
            if (!reader_.next_line())
                throw std::runtime_error("expected a line TILT=NONE of LM-63, got none");
            std::string line;
            for (const std::string_view word : reader_.words())
                line += word;
            if (is_first)
                has_ballast_lamp_factor_ =
                    line.starts_with("IESNA91") || line.starts_with("IESNA:LM-63-1986") ||
                    line.starts_with("IESNA:LM-63-1991") ||
                    !(line.starts_with("IESNA:") || line.starts_with("IES:"));
            if (line.starts_with("TILT="))
                tilt = line;
        }
        if (tilt != "TILT=NONE" && tilt != "TILT=INCLUDE")
            reader_.fail("TILT=NONE or TILT=INCLUDE", excerpt(tilt));
        static_cast<void>(reader_.next_line());
        if (tilt == "TILT=NONE")
            return;
        static_cast<void>(number("how the lamp stands in the luminaire"));
        const std::size_t num_pairs = count("the number of tilts");
        for (std::size_t i = 0; i < 2 * num_pairs; ++i)
            static_cast<void>(number("tilts and their factors"));
        result_.left_out.emplace_back("factors of tilted lamps (TILT=INCLUDE)");
    }

    double number(const char* what) {
        const double value = reader_.number(reader_.next_word(what));
        if (!std::isfinite(value))
            reader_.fail(what, fmt::format("{}", value));
        return value;
    }

    double positive(const char* what) {
        const double value = number(what);
        if (!(value > 0.0))
            reader_.fail(fmt::format("{} above 0", what), fmt::format("{:g}", value));
        return value;
    }

    /// A count of numbers, which take two bytes each at least.
    std::size_t count(const char* what) {
        const double value = number(what);
        if (!(value >= 1.0 && value <= static_cast<double>(text_.size() / 2 + 1)) ||
            value != std::floor(value))
            reader_.fail(fmt::format("{} that fits into the file", what),
                         fmt::format("{:g}", value));
        return static_cast<std::size_t>(value);
    }

    void check_type() {
        const double type = number("the type of photometry");
        if (type == 2.0 || type == 3.0)
            reader_.fail("photometry of Type C (1)", type == 2.0 ? "Type B (2)" : "Type A (3)");
        if (type != 1.0)
            reader_.fail("photometry of Type C (1)", fmt::format("{:g}", type));
    }

    /// Up to 1991 this number is a factor. Since 1995 it waits for a use, and since 2019 it tells
    /// how the file was made.
    double factor_behind_ballast() {
        if (has_ballast_lamp_factor_)
            return positive("the ballast-lamp photometric factor");
        static_cast<void>(number("the number behind the ballast factor"));
        return 1.0;
    }

    void read_angles() {
        for (float& angle : table_.vertical)
            angle = static_cast<float>(number("a vertical angle"));
        for (float& angle : table_.horizontal)
            angle = static_cast<float>(number("a horizontal angle"));
        float& last = table_.horizontal.back();
        for (const float end : {90.0f, 180.0f, 270.0f, 360.0f})
            if (std::abs(double{last} - double{end}) < Rounding)
                last = end;
        // A circle that ends before it begins again.
        is_open_ = table_.horizontal.size() > 2 && table_.horizontal.front() == 0.0f &&
                   last > 180.0f && last < 360.0f;
    }

    void read_candela(double factor) {
        const std::size_t n = table_.vertical.size();
        if (n > text_.size() / table_.horizontal.size())
            reader_.fail(fmt::format("{} x {} intensities", table_.horizontal.size(), n),
                         "a shorter file");
        std::size_t num_negative = 0;
        table_.candela.reserve((table_.horizontal.size() + 1) * n);
        for (std::size_t i = 0; i < n * table_.horizontal.size(); ++i) {
            const double candela = factor * number("an intensity");
            num_negative += candela < 0.0 ? 1 : 0;
            if (candela > double{MaxCandela})
                reader_.fail(fmt::format("intensities of up to {:g} candela", MaxCandela),
                             fmt::format("{:g}", candela));
            table_.candela.push_back(static_cast<float>(std::max(candela, 0.0)));
        }
        if (num_negative > 0)
            result_.left_out.push_back(
                fmt::format("{} below 0", files::counted(num_negative, "intensity")));
        if (is_open_) {
            table_.horizontal.push_back(360.0f);
            for (std::size_t i = 0; i < n; ++i)
                table_.candela.push_back(table_.candela[i]);
        }
    }

    std::string_view text_;
    TextReader reader_;
    bool has_ballast_lamp_factor_ = false, is_open_ = false;
    LightProfileTable table_;
    ReadLightProfile result_;
};

} // namespace

ReadLightProfile read_light_profile(std::span<const std::byte> file) {
    std::string text(as_text(file));
    std::replace(text.begin(), text.end(), ',', ' ');
    try {
        return IesReader(text).read();
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(error.what());
    }
}

ReadLightProfile load_light_profile(const std::filesystem::path& path) {
    const std::vector<std::byte> file = files::read(path);
    try {
        return read_light_profile(file);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
}

} // namespace relumine::mesh
