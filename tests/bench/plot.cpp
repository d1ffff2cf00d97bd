#include "tests/bench/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace relumine::bench {

namespace {

constexpr double PlotWidth = 720.0;
constexpr double PlotHeight = 440.0;
constexpr double Left = 72.0;
constexpr double Right = 170.0; // for the legend
constexpr double Top = 40.0;
constexpr double Bottom = 56.0;

// Okabe and Ito's colours, which colour-blind readers can tell apart.
constexpr std::array Colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                "#e69f00", "#56b4e9", "#000000"};

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '>')
            result += "&gt;";
        else
            result += c;
    }
    return result;
}

/// Turns values into positions along an axis, [0, 1].
class Axis {
public:
    explicit Axis(Scale scale) : scale_(scale) {}

    [[nodiscard]] bool shows(double value) const {
        return std::isfinite(value) && (scale_ == Scale::Linear || value > 0.0);
    }

    void include(double value) {
        low_ = std::min(low_, value);
        high_ = std::max(high_, value);
    }

    /// Widens the range of included values to round numbers. Call it once.
    void finish() {
        if (low_ > high_)
            low_ = high_ = 1.0;
        if (scale_ == Scale::Log) {
            // Whole powers of two or ten would waste the plot. A twentieth of the range stays free
            // at both ends.
            const double margin = std::max(0.05 * std::log(high_ / low_), 0.05);
            low_ *= std::exp(-margin);
            high_ *= std::exp(margin);
            return;
        }
        if (low_ == high_) {
            low_ -= 0.5;
            high_ += 0.5;
        }
        step_ = round_step((high_ - low_) / 6.0);
        low_ = step_ * std::floor(low_ / step_);
        high_ = step_ * std::ceil(high_ / step_);
    }

    [[nodiscard]] double position(double value) const {
        return scale_ == Scale::Log ? std::log(value / low_) / std::log(high_ / low_)
                                    : (value - low_) / (high_ - low_);
    }

    [[nodiscard]] std::vector<double> ticks() const {
        std::vector<double> result;
        if (scale_ == Scale::Linear) {
            const auto count = static_cast<int>(std::lround((high_ - low_) / step_));
            for (int i = 0; i <= count; ++i)
                result.push_back(low_ + i * step_);
            return result;
        }
        // 1, 2, 5 of each decade, or decades alone where these would be too many.
        const bool decades_only = high_ / low_ > 2e3;
        const auto first = static_cast<int>(std::floor(std::log10(low_)));
        const auto last = static_cast<int>(std::floor(std::log10(high_)));
        for (int decade = first; decade <= last; ++decade)
            for (const double factor : {1.0, 2.0, 5.0})
                if (const double value = factor * std::pow(10.0, decade);
                    value >= low_ && value <= high_ && (factor == 1.0 || !decades_only))
                    result.push_back(value);
        return result;
    }

private:
    /// Returns the next of 1, 2, 5 times a power of ten.
    static double round_step(double step) {
        const double decade = std::pow(10.0, std::floor(std::log10(step)));
        for (const double factor : {1.0, 2.0, 5.0})
            if (step <= factor * decade)
                return factor * decade;
        return 10.0 * decade;
    }

    Scale scale_;
    double low_ = std::numeric_limits<double>::infinity();
    double high_ = -std::numeric_limits<double>::infinity();
    double step_ = 1.0;
};

/// Prints a tick's number. A remainder of rounding counts as 0.
std::string number(double value) {
    return fmt::format("{:.4g}", std::abs(value) < 1e-12 ? 0.0 : value);
}

class Writer {
public:
    explicit Writer(const Plot& plot) : plot_(plot), x_(plot.x_scale), y_(plot.y_scale) {
        for (const Plot::Series& series : plot.series) {
            if (series.x.size() != series.y.size())
                throw std::invalid_argument("expected as many y as x in a plot's series");
            for (std::size_t i = 0; i < series.x.size(); ++i)
                if (shows(series, i)) {
                    x_.include(series.x[i]);
                    y_.include(series.y[i]);
                }
        }
        x_.finish();
        y_.finish();
    }

    [[nodiscard]] std::string document() {
        put(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" )"
            R"(font-family="sans-serif" font-size="12">)",
            PlotWidth, PlotHeight);
        put(R"(<rect width="{}" height="{}" fill="white"/>)", PlotWidth, PlotHeight);
        put(R"(<text x="{}" y="22" font-size="15" text-anchor="middle">{}</text>)",
            0.5 * (Left + PlotWidth - Right), escaped(plot_.title));
        grid();
        for (std::size_t i = 0; i < plot_.series.size(); ++i)
            series(plot_.series[i], i);
        put("</svg>");
        return std::move(text_);
    }

private:
    template<typename... Values>
    void put(fmt::format_string<Values...> format, Values&&... values) {
        text_ += fmt::format(format, std::forward<Values>(values)...);
        text_ += '\n';
    }

    [[nodiscard]] bool shows(const Plot::Series& series, std::size_t i) const {
        return x_.shows(series.x[i]) && y_.shows(series.y[i]);
    }
    [[nodiscard]] double across(double value) const {
        return Left + x_.position(value) * (PlotWidth - Left - Right);
    }
    [[nodiscard]] double down(double value) const {
        return PlotHeight - Bottom - y_.position(value) * (PlotHeight - Top - Bottom);
    }

    void grid() {
        const double bottom = PlotHeight - Bottom;
        const double right = PlotWidth - Right;
        for (const double tick : x_.ticks()) {
            put(R"(<line x1="{0:.1f}" y1="{1}" x2="{0:.1f}" y2="{2}" stroke="#dddddd"/>)",
                across(tick), Top, bottom);
            put(R"(<text x="{:.1f}" y="{}" text-anchor="middle">{}</text>)", across(tick),
                bottom + 17.0, number(tick));
        }
        for (const double tick : y_.ticks()) {
            put(R"(<line x1="{0}" y1="{1:.1f}" x2="{2}" y2="{1:.1f}" stroke="#dddddd"/>)", Left,
                down(tick), right);
            put(R"(<text x="{}" y="{:.1f}" text-anchor="end">{}</text>)", Left - 6.0,
                down(tick) + 4.0, number(tick));
        }
        put(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="black"/>)", Left, Top,
            right - Left, bottom - Top);
        put(R"(<text x="{}" y="{}" text-anchor="middle">{}</text>)", 0.5 * (Left + right),
            PlotHeight - 16.0, escaped(plot_.x_label));
        put(R"svg(<text x="18" y="{0}" text-anchor="middle" transform="rotate(-90 18 {0})">{1}</text>)svg",
            0.5 * (Top + bottom), escaped(plot_.y_label));
    }

    void series(const Plot::Series& series, std::size_t index) {
        const char* colour = Colours[index % Colours.size()];
        std::string points;
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (!shows(series, i))
                continue;
            points += fmt::format("{:.1f},{:.1f} ", across(series.x[i]), down(series.y[i]));
            if (!series.line || series.x.size() <= MaxMarked)
                put(R"(<circle cx="{:.1f}" cy="{:.1f}" r="2.5" fill="{}"/>)", across(series.x[i]),
                    down(series.y[i]), colour);
        }
        if (series.line)
            put(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.8"/>)", points,
                colour);
        const double y = Top + 12.0 + 20.0 * static_cast<double>(index);
        put(R"(<rect x="{}" y="{}" width="16" height="4" fill="{}"/>)", PlotWidth - Right + 12.0,
            y - 2.0, colour);
        put(R"(<text x="{}" y="{}">{}</text>)", PlotWidth - Right + 34.0, y + 4.0,
            escaped(series.name));
    }

    static constexpr std::size_t MaxMarked = 40; // points of a line; more would hide it

    const Plot& plot_;
    Axis x_;
    Axis y_;
    std::string text_;
};

} // namespace

std::string svg(const Plot& plot) {
    return Writer(plot).document();
}

} // namespace relumine::bench
