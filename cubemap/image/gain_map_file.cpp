// JPEG with a gain map: a picture for any screen and, behind it in the same file, how much brighter
// each pixel is on one that can show it. Here each pixel gets all of its light.
// Based on: Adobe, "Gain Map Specification" 1.0 (XMP, hdrgm); ISO 21496-1:2025, whose numbers
// libultrahdr writes behind "urn:iso:std:iso:ts:21496:-1".
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/matrix.hpp>

#include "cubemap/image/color_space.h"
#include "cubemap/image/file_bytes.h"
#include "cubemap/image/icc_profile.h"
#include "cubemap/image/image_file.h"
#include "files/jpeg_decoder.h"

namespace relumine::cubemap {

namespace {

constexpr std::string_view XmpMark{"http://ns.adobe.com/xap/1.0/\0", 29};
constexpr std::string_view IsoMark{"urn:iso:std:iso:ts:21496:-1\0", 28};
constexpr std::string_view IccMark{"ICC_PROFILE\0", 12};

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// One of the JPEG pictures of a file.
struct Jpeg {
    std::uint64_t begin = 0, end = 0;
    std::uint32_t width = 0, height = 0;
    std::string xmp;
    /// Behind the mark
    std::vector<std::byte> iso, icc;
};

/// How the map's numbers become light. A map of one colour has the same for all three.
struct GainMap {
    /// The gains of the smallest and the largest number of the map, in powers of two
    glm::dvec3 least{0.0}, most{0.0};
    glm::dvec3 gamma{1.0};
    /// Added to the picture before, and taken off the result
    glm::dvec3 offset_before{1.0 / 64}, offset_after{1.0 / 64};
    /// The screen that shows everything, in powers of two above white
    double headroom = 0.0;
    bool base_is_brighter = false;
    /// Gains are for the colours of the picture, not for those of the map's profile
    bool has_colors_of_base = true;
};

/// Walks over the pictures of a file. The first is the one that every program shows.
class JpegPictures {
public:
    explicit JpegPictures(std::span<const std::byte> bytes) : bytes_(bytes) {}

    /// Returns the next picture; empty where there is none, or one that is damaged.
    std::optional<Jpeg> next() {
        const std::size_t found = text_of(bytes_).find("\xff\xd8\xff", at_);
        if (found == std::string_view::npos)
            return std::nullopt;
        Jpeg jpeg;
        jpeg.begin = found;
        at_ = found + 2;
        while (at_ + 2 <= bytes_.size()) {
            if (byte(at_) != 0xff) { // the data of a scan
                ++at_;
                continue;
            }
            const unsigned marker = byte(at_ + 1);
            constexpr unsigned End = 0xd9;
            if (marker == End)
                break;
            // Fill bytes, stuffed ones, and markers without data.
            if (marker == 0xff || marker == 0 || marker == 1 ||
                (marker >= 0xd0 && marker <= 0xd8)) {
                at_ += marker == 0xff ? 1 : 2;
                continue;
            }
            const std::size_t length =
                at_ + 4 <= bytes_.size() ? byte(at_ + 2) << 8 | byte(at_ + 3) : 0;
            if (length < 2 || length > bytes_.size() - at_ - 2)
                return std::nullopt;
            take(marker, bytes_.subspan(at_ + 4, length - 2), jpeg);
            at_ += 2 + length;
        }
        at_ = std::min(at_ + 2, bytes_.size());
        jpeg.end = at_;
        return jpeg;
    }

private:
    [[nodiscard]] unsigned byte(std::size_t at) const {
        return std::to_integer<unsigned>(bytes_[at]);
    }

    static void take(unsigned marker, std::span<const std::byte> data, Jpeg& jpeg) {
        constexpr unsigned App1 = 0xe1, App2 = 0xe2;
        const std::string_view text = text_of(data);
        const auto behind = [&](std::size_t start) {
            return data.subspan(std::min(start, data.size()));
        };
        const bool is_frame =
            marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        const auto u16 = [&](std::size_t at) {
            return std::to_integer<std::uint32_t>(data[at]) << 8 |
                   std::to_integer<std::uint32_t>(data[at + 1]);
        };
        if (is_frame && data.size() >= 5) {
            jpeg.height = u16(1);
            jpeg.width = u16(3);
        } else if (marker == App1 && text.starts_with(XmpMark)) {
            jpeg.xmp += text.substr(XmpMark.size());
        } else if (marker == App2 && text.starts_with(IsoMark)) {
            jpeg.iso.assign(behind(IsoMark.size()).begin(), data.end());
        } else if (marker == App2 && text.starts_with(IccMark)) {
            const auto piece = behind(IccMark.size() + 2); // number and count of pieces
            jpeg.icc.insert(jpeg.icc.end(), piece.begin(), piece.end());
        }
    }

    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

/// Reads the numbers of one name of Adobe's header: an attribute, an element, or a list of three.
std::optional<glm::dvec3> xmp_numbers(std::string_view xmp, std::string_view name) {
    const std::string key = fmt::format("hdrgm:{}", name);
    std::size_t at = xmp.find(key);
    while (at != std::string_view::npos &&
           xmp.substr(at + key.size()).find_first_of("=> \t\r\n") != 0)
        at = xmp.find(key, at + 1);
    if (at == std::string_view::npos)
        return std::nullopt;
    std::string_view rest = xmp.substr(at + key.size());
    const bool is_attribute =
        rest.find_first_of("=>") < rest.size() && rest[rest.find_first_of("=>")] == '=';
    rest = rest.substr(0, is_attribute ? rest.find_first_of("\"'", rest.find_first_of("\"'") + 1)
                                       : rest.find(fmt::format("/{}", key)));
    std::vector<double> numbers;
    while (numbers.size() < 3 && !rest.empty()) {
        double value = 0.0;
        const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
        const bool is_number = error == std::errc() && std::isfinite(value);
        if (is_number)
            numbers.push_back(value);
        rest.remove_prefix(is_number ? static_cast<std::size_t>(end - rest.data()) : 1);
        // The next number begins behind a quote, a blank or a tag.
        if (!is_number || !rest.empty())
            rest.remove_prefix(std::min(rest.find_first_of("-.0123456789"), rest.size()));
    }
    if (numbers.empty())
        return std::nullopt;
    return numbers.size() == 3 ? glm::dvec3(numbers[0], numbers[1], numbers[2])
                               : glm::dvec3(numbers[0]);
}

std::optional<GainMap> gain_map_of_xmp(std::string_view xmp) {
    const auto most = xmp_numbers(xmp, "GainMapMax");
    if (!most)
        return std::nullopt;
    GainMap map;
    map.most = *most;
    map.least = xmp_numbers(xmp, "GainMapMin").value_or(map.least);
    map.gamma = xmp_numbers(xmp, "Gamma").value_or(map.gamma);
    map.offset_before = xmp_numbers(xmp, "OffsetSDR").value_or(map.offset_before);
    map.offset_after = xmp_numbers(xmp, "OffsetHDR").value_or(map.offset_after);
    map.headroom = xmp_numbers(xmp, "HDRCapacityMax").value_or(*most).x;
    const std::size_t brighter = xmp.find("hdrgm:BaseRenditionIsHDR");
    map.base_is_brighter = brighter != std::string_view::npos &&
                           xmp.substr(brighter, 40).find("True") != std::string_view::npos;
    return map;
}

GainMap gain_map_of_iso(const Fields& fields) {
    constexpr unsigned ManyChannels = 128, ColorsOfBase = 64, OneDenominator = 8;
    const auto flags = static_cast<unsigned>(fields.number(4, 1));
    std::uint64_t at = 5;
    const std::uint32_t denominator = (flags & OneDenominator) != 0 ? fields.u32(at) : 0;
    at += denominator != 0 ? 4 : 0;
    const auto fraction = [&](bool is_signed) {
        const std::uint32_t bits = fields.u32(at);
        at += 4;
        const double value =
            is_signed ? static_cast<std::int32_t>(bits) : static_cast<double>(bits);
        if (denominator != 0)
            return value / denominator;
        at += 4;
        return value / fields.u32(at - 4);
    };
    GainMap map;
    const double base_headroom = fraction(false);
    map.headroom = fraction(false);
    map.base_is_brighter = base_headroom > map.headroom;
    map.has_colors_of_base = (flags & ColorsOfBase) != 0;
    const int num_channels = (flags & ManyChannels) != 0 ? 3 : 1;
    for (int i = 0; i < 3; ++i) {
        if (i >= num_channels) {
            for (glm::dvec3* each :
                 {&map.least, &map.most, &map.gamma, &map.offset_before, &map.offset_after})
                (*each)[i] = (*each)[0];
            continue;
        }
        map.least[i] = fraction(true);
        map.most[i] = fraction(true);
        map.gamma[i] = fraction(false);
        map.offset_before[i] = fraction(true);
        map.offset_after[i] = fraction(true);
    }
    return map;
}

/// Pixels of bytes as they were decoded.
struct Bytes {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;

    [[nodiscard]] glm::dvec3 at(std::uint32_t x, std::uint32_t y) const {
        const std::uint8_t* pixel = &rgb[3 * (std::size_t{y} * width + x)];
        return glm::dvec3(pixel[0], pixel[1], pixel[2]) / 255.0;
    }
};

class GainMapRows : public ImageRows {
public:
    explicit GainMapRows(FileBytes file) : file_(std::move(file)) {
        const std::vector<std::byte> bytes = file_.read(0, file_.size());
        JpegPictures pictures(bytes);
        base_ = pictures.next().value_or(Jpeg{});
        bool is_of_iso = false;
        for (std::optional<Jpeg> next = pictures.next(); next && !is_found_;
             next = pictures.next()) {
            constexpr std::size_t VersionBytes = 4; // all that the first picture has
            is_of_iso = next->iso.size() > VersionBytes;
            const std::optional<GainMap> found =
                is_of_iso ? gain_map_of_iso(Fields(file_, next->iso, true))
                          : gain_map_of_xmp(next->xmp);
            if (!found)
                continue;
            is_found_ = true;
            map_ = *found;
            map_jpeg_ = *next;
        }
        if (!is_found_)
            file_.refuse("a picture with light above white",
                         base_.xmp.find("hdrgm:") != std::string::npos || !base_.iso.empty()
                             ? "a JPEG whose gain map is missing"
                             : "a JPEG without a gain map, which holds no light above white: use "
                               "the .hdr or .exr that it was made from");
        check();
        constexpr std::uint64_t MostPixelsPerByte = 1000;
        file_.check_size(base_.width, base_.height, MostPixelsPerByte);
        file_.check_size(map_jpeg_.width, map_jpeg_.height, MostPixelsPerByte);
        head_.width = base_.width;
        head_.height = base_.height;
        const glm::dvec3 brightest =
            (1.0 + map_.offset_before) * glm::exp2(map_.most) - map_.offset_after;
        head_.remarks.push_back(fmt::format(
            "gain map of {} ({}x{}), white is 1 and the most is {:.4g}, all of it "
            "shown from {:.3g} stops above white on",
            is_of_iso ? "ISO 21496-1" : "Adobe's header", map_jpeg_.width, map_jpeg_.height,
            std::max({brightest.x, brightest.y, brightest.z}), map_.headroom));
        find_colors();
    }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        std::call_once(is_decoded_, [&] {
            picture_ = decoded(base_);
            gains_ = decoded(map_jpeg_);
        });
        const std::uint32_t width = head_.width;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const auto x = static_cast<std::uint32_t>(i % width);
            const auto y = first + static_cast<std::uint32_t>(i / width);
            const glm::dvec3 gain = glm::exp2(
                glm::mix(map_.least, map_.most, glm::pow(map_at(x, y), 1.0 / map_.gamma)));
            const glm::dvec3 light = to_gains_ * picture_at(x, y);
            pixels[i] = (light + map_.offset_before) * gain - map_.offset_after;
        }
        // What the offsets leave below 0 is no light.
        for (glm::vec3& pixel : pixels)
            pixel = glm::max(pixel, glm::vec3(0.0f));
        return {.num_outside = colors_ ? colors_->convert(pixels) : 0};
    }

private:
    void check() const {
        if (map_.base_is_brighter)
            file_.refuse("a gain map that makes a picture brighter", "one that makes it darker");
        constexpr double MostStops = 32.0, MostOffset = 1e3; // Adobe's own have 10
        for (int i = 0; i < 3; ++i)
            if (!(std::abs(map_.most[i]) <= MostStops && std::abs(map_.least[i]) <= MostStops &&
                  map_.gamma[i] > 1e-3 && map_.gamma[i] < 1e3 &&
                  std::abs(map_.offset_before[i]) <= MostOffset &&
                  std::abs(map_.offset_after[i]) <= MostOffset))
                file_.refuse("a gain map of up to 32 stops",
                             fmt::format("{:g} to {:g} stops, gamma {:g}, offsets {:g} and {:g}",
                                         map_.least[i], map_.most[i], map_.gamma[i],
                                         map_.offset_before[i], map_.offset_after[i]));
    }

    /// A picture without a profile is of sRGB.
    void find_colors() {
        const auto space_of_jpeg = [&](const Jpeg& jpeg) {
            return jpeg.icc.empty() ? std::nullopt : space_of_icc(jpeg.icc, head_.remarks);
        };
        const std::optional<ColorSpace> base = space_of_jpeg(base_);
        const bool is_converted = base && base->name != "sRGB";
        std::optional<ColorSpace> light = is_converted ? base : std::nullopt;
        if (!map_.has_colors_of_base) {
            light = space_of_jpeg(map_jpeg_);
            if (light && light->name == "sRGB")
                light.reset();
            const glm::dmat3 from = is_converted ? to_rec709(base->primaries) : glm::dmat3(1.0);
            to_gains_ =
                (light ? glm::inverse(to_rec709(light->primaries)) : glm::dmat3(1.0)) * from;
        }
        if (light) {
            light->transfer = Transfer::Linear;
            colors_.emplace(*light);
        }
        for (std::size_t i = 0; i < linear_of_byte_.size(); ++i)
            linear_of_byte_[i] =
                linear(static_cast<float>(i) / 255.0f, base ? base->transfer : Transfer::Srgb);
    }

    [[nodiscard]] Bytes decoded(const Jpeg& jpeg) const {
        Bytes result;
        const std::vector<std::byte> bytes = file_.read(jpeg.begin, jpeg.end - jpeg.begin);
        try {
            files::decode_jpeg(bytes, [&](std::uint32_t width, std::uint32_t height) {
                if (width != jpeg.width || height != jpeg.height)
                    file_.refuse("a JPEG picture of one size", "one of several");
                result.width = width;
                result.height = height;
                result.rgb.resize(std::size_t{3} * width * height);
                return result.rgb.data();
            });
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(fmt::format("{}: {}", file_.name(), error.what()));
        }
        return result;
    }

    [[nodiscard]] glm::dvec3 picture_at(std::uint32_t x, std::uint32_t y) const {
        const std::uint8_t* pixel = &picture_.rgb[3 * (std::size_t{y} * picture_.width + x)];
        return {linear_of_byte_[pixel[0]], linear_of_byte_[pixel[1]], linear_of_byte_[pixel[2]]};
    }

    /// Returns the map between its pixels' centres.
    [[nodiscard]] glm::dvec3 map_at(std::uint32_t x, std::uint32_t y) const {
        struct Between {
            std::uint32_t before, behind;
            double share;
        };
        const auto place = [](std::uint32_t at, std::uint32_t size, std::uint32_t map_size) {
            const double middle =
                std::clamp((at + 0.5) * map_size / size - 0.5, 0.0, map_size - 1.0);
            const auto before = static_cast<std::uint32_t>(middle);
            return Between{before, std::min(before + 1, map_size - 1), middle - before};
        };
        const Between column = place(x, head_.width, gains_.width);
        const Between row = place(y, head_.height, gains_.height);
        const auto along = [&](std::uint32_t of_row) {
            return glm::mix(gains_.at(column.before, of_row), gains_.at(column.behind, of_row),
                            column.share);
        };
        return glm::mix(along(row.before), along(row.behind), row.share);
    }

    FileBytes file_;
    Jpeg base_, map_jpeg_;
    bool is_found_ = false;
    GainMap map_;
    /// From the picture's colours to those that the gains are for
    glm::dmat3 to_gains_{1.0};
    std::array<double, 256> linear_of_byte_{};
    mutable std::once_flag is_decoded_;
    mutable Bytes picture_, gains_;
};

} // namespace

bool is_jpeg(std::span<const std::byte> bytes) {
    return text_of(bytes).starts_with("\xff\xd8\xff");
}

std::unique_ptr<ImageRows> open_gain_map(FileBytes file) {
    return std::make_unique<GainMapRows>(std::move(file));
}

} // namespace relumine::cubemap
