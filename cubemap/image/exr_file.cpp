// Reads OpenEXR pictures in memory.
#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstring>
#include <functional>
#include <memory>
#include <set>
#include <stdexcept>

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <fmt/format.h>

#include "cubemap/image/color_space.h"
#include "cubemap/image/exr_header.h"
#include "cubemap/image/image_file.h"
#include "cubemap/image/image_layout.h"
#include "files/joined.h"
#include "files/large_vector.h"
#include "files/output_file.h"
#include "files/parallel.h"
#include "files/printable.h"

namespace relumine::cubemap {

namespace {

class MemoryInput : public Imf::IStream {
public:
    explicit MemoryInput(std::span<const std::byte> bytes) : Imf::IStream("file"), bytes_(bytes) {}
    bool read(char* destination, int n) override {
        if (n < 0 || static_cast<std::size_t>(n) > bytes_.size() - position_)
            throw std::runtime_error("the file ends too early");
        std::memcpy(destination, bytes_.data() + position_, static_cast<std::size_t>(n));
        position_ += static_cast<std::size_t>(n);
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override {
        if (position > bytes_.size())
            throw std::runtime_error("the file ends too early");
        position_ = position;
    }

private:
    std::span<const std::byte> bytes_;
    std::size_t position_ = 0;
};

/// The channels of a part that hold its colours.
struct Channels {
    enum class Kind { Rgb, Xyz, LuminanceChroma, Luminance } kind = Kind::Rgb;
    /// Names of red, green and blue, of X, Y and Z, or three times the name of luminance.
    std::array<std::string, 3> names;
    /// Common prefix of the names with its dot, or empty.
    std::string layer;
};

/// Whether a layer's name says that it is the picture: "ViewLayer.Combined." of Blender, "beauty."
/// of others.
bool is_beauty(const std::string& layer) {
    const std::size_t end = layer.size() - 1, begin = layer.rfind('.', end - 1) + 1;
    std::string name = layer.substr(begin, end - begin);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name == "combined" || name == "beauty" || name == "rgba" || name == "rgb";
}

/// Returns the channels R, G and B without a layer, else those of the only layer that has all three
/// or whose name says that it is the picture, else r, g and b, else X, Y and Z, else luminance.
std::optional<Channels> find_channels(const Imf::ChannelList& list) {
    const auto has = [&](const std::string& channel) {
        return list.findChannel(channel.c_str()) != nullptr;
    };
    std::set<std::string> layers;
    for (auto channel = list.begin(); channel != list.end(); ++channel) {
        const std::string name = channel.name();
        const std::string layer = name.substr(0, name.rfind('.') + 1);
        if (has(layer + "R") && has(layer + "G") && has(layer + "B"))
            layers.insert(layer);
    }
    if (!layers.contains("") && layers.size() > 1)
        std::erase_if(layers, [](const std::string& layer) { return !is_beauty(layer); });
    if (layers.contains("") || layers.size() == 1) {
        const std::string layer = layers.contains("") ? "" : *layers.begin();
        return Channels{Channels::Kind::Rgb, {layer + "R", layer + "G", layer + "B"}, layer};
    }
    if (has("r") && has("g") && has("b"))
        return Channels{Channels::Kind::Rgb, {"r", "g", "b"}, ""};
    if (has("X") && has("Y") && has("Z"))
        return Channels{Channels::Kind::Xyz, {"X", "Y", "Z"}, ""};
    if (!has("Y"))
        return std::nullopt;
    return Channels{has("RY") && has("BY") ? Channels::Kind::LuminanceChroma
                                           : Channels::Kind::Luminance,
                    {"Y", "Y", "Y"},
                    ""};
}

std::string names_of(const Imf::ChannelList& list) {
    std::vector<std::string> names;
    for (auto channel = list.begin(); channel != list.end(); ++channel)
        names.emplace_back(channel.name());
    return names.empty() ? "none" : fmt::format("{:.200}", files::joined(names, ", "));
}

struct Window {
    int x = 0, y = 0;
    std::uint32_t width = 0, height = 0;
};

/// Bytes of a file, in memory or on a disk. Each stream has its own place in them.
struct Source {
    std::function<std::unique_ptr<Imf::IStream>()> open;
    std::uint64_t num_bytes;
};

Source source_of(std::span<const std::byte> bytes) {
    return {[bytes] { return std::make_unique<MemoryInput>(bytes); }, bytes.size()};
}
Source source_of(const std::filesystem::path& path) {
    return {[path] { return std::make_unique<Imf::StdIFStream>(path.c_str()); }, files::size(path)};
}

class ExrDecoder {
public:
    ExrDecoder(Source source, std::string name)
        : source_(std::move(source)), name_(std::move(name)) {}

    ImageFile decode() {
        const auto stream = source_.open();
        check_exr_header(*stream, source_.num_bytes);
        Imf::MultiPartInputFile file(*stream, 0);
        choose_part(file);
        const Imf::Header& header = file.header(part_);
        window_ = window(header.dataWindow());
        check_size(header);

        ImageFile image;
        image.width = window_.width;
        image.height = window_.height;
        image.pixels =
            files::large_vector<glm::vec3>(static_cast<std::size_t>(image.width) * image.height);
        if (channels_.kind == Channels::Kind::LuminanceChroma)
            read_luminance_chroma(image);
        else
            read_bands(header, image);
        describe(header, file.parts(), image);
        if (const auto colors = colors_of(header))
            image.remarks.push_back(convert(*colors, image));
        show_display_window(header, image);
        return image;
    }

    /// Returns what decode() would give without pixels. Empty where rows cannot be read alone.
    std::optional<ImageFile> begin_rows(std::optional<ColorConversion>& colors) {
        const auto stream = source_.open();
        check_exr_header(*stream, source_.num_bytes);
        Imf::MultiPartInputFile file(*stream, 0);
        choose_part(file);
        const Imf::Header& header = file.header(part_);
        window_ = window(header.dataWindow());
        check_size(header);
        if (channels_.kind == Channels::Kind::LuminanceChroma || shows_display_window(header) ||
            (header.hasTileDescription() && header.tileDescription().ySize > BandHeight))
            return std::nullopt;
        ImageFile head;
        head.width = window_.width;
        head.height = window_.height;
        describe(header, file.parts(), head);
        colors = colors_of(header);
        return head;
    }

    /// Decodes rows of the data window, with colours as the file has them. Returns how many pixels
    /// have an alpha of 0.
    std::size_t read_rows(std::uint32_t first, std::span<glm::vec3> pixels) const {
        const auto height = static_cast<std::uint32_t>(pixels.size() / window_.width);
        const auto stream = source_.open();
        Imf::MultiPartInputFile file(*stream, 0);
        Imf::InputPart part(file, part_);
        const int top = window_.y + static_cast<int>(first);
        // The data window's coordinates address the frame buffer, so its base lies before the
        // pixels, perhaps before all memory. OpenEXR works out where.
        const auto slice = [&](void* data, std::size_t size) {
            return Imf::Slice::Make(Imf::FLOAT, data, {window_.x, top}, window_.width, height, size,
                                    size * window_.width);
        };
        Imf::FrameBuffer buffer;
        const std::size_t num_channels = channels_.kind == Channels::Kind::Luminance ? 1 : 3;
        for (std::size_t i = 0; i < num_channels; ++i)
            buffer.insert(channels_.names[i],
                          slice(reinterpret_cast<float*>(pixels.data()) + i, sizeof(glm::vec3)));
        const std::string alpha_name = channels_.layer + (channels_.names[0] == "r" ? "a" : "A");
        std::vector<float> alpha;
        if (part.header().channels().findChannel(alpha_name.c_str()) != nullptr) {
            alpha.resize(pixels.size());
            buffer.insert(alpha_name, slice(alpha.data(), sizeof(float)));
        }
        part.setFrameBuffer(buffer);
        part.readPixels(top, top + static_cast<int>(height) - 1);
        if (channels_.kind == Channels::Kind::Luminance)
            for (glm::vec3& pixel : pixels)
                pixel = glm::vec3(pixel.x);
        return static_cast<std::size_t>(std::count(alpha.begin(), alpha.end(), 0.0f));
    }

    /// Returns the size that decode() would give. Reads the header only.
    ImageSize size() {
        const auto stream = source_.open();
        check_exr_header(*stream, source_.num_bytes);
        Imf::MultiPartInputFile file(*stream, 0);
        choose_part(file);
        const Imf::Header& header = file.header(part_);
        const Window inner = window(header.dataWindow());
        const Window outer = window(header.displayWindow());
        return shows_display_window(header) ? ImageSize{outer.width, outer.height}
                                            : ImageSize{inner.width, inner.height};
    }

private:
    [[noreturn]] void fail(const std::string& expected, const std::string& got) const {
        throw std::runtime_error(fmt::format("{}: expected {}, got {}", name_, expected, got));
    }

    /// Chooses the first flat part with R, G and B, else the first with luminance.
    void choose_part(const Imf::MultiPartInputFile& file) {
        std::string found;
        bool is_chosen = false;
        for (int part = 0; part < file.parts(); ++part) {
            const Imf::Header& header = file.header(part);
            const bool deep = header.hasType() && Imf::isDeepData(header.type());
            found +=
                (part == 0 ? "" : "; ") + names_of(header.channels()) + (deep ? " (deep)" : "");
            const auto channels = deep ? std::nullopt : find_channels(header.channels());
            if (!channels || (is_chosen && channels->kind != Channels::Kind::Rgb))
                continue;
            part_ = part;
            channels_ = *channels;
            is_chosen = true;
            if (channels->kind == Channels::Kind::Rgb)
                break;
        }
        if (!is_chosen)
            fail("channels R, G and B, or Y", fmt::format("{:.200}", found));
    }

    [[nodiscard]] static Window window(const Imath::Box2i& box) {
        const auto extent = [](int low, int high) {
            return static_cast<std::int64_t>(high) - low + 1;
        };
        const std::int64_t width = extent(box.min.x, box.max.x),
                           height = extent(box.min.y, box.max.y);
        if (width < 1 || height < 1)
            return {box.min.x, box.min.y, 0, 0};
        return {box.min.x, box.min.y, static_cast<std::uint32_t>(width),
                static_cast<std::uint32_t>(height)};
    }

    /// Refuses sizes that the file cannot hold, before memory is allocated.
    void check_size(const Imf::Header& header) const {
        const std::uint64_t num_pixels = std::uint64_t{window_.width} * window_.height;
        const std::string size = fmt::format("{}x{}", window_.width, window_.height);
        if (num_pixels == 0 || num_pixels > MaxPixels)
            fail("a size that an environment can have", size);
        // Measured on black pictures of 4096x2048 at 12 bytes per pixel: they have up to 1862 times
        // the size of the file, with DWA 23426 times.
        const bool is_dwa = header.compression() == Imf::DWAA_COMPRESSION ||
                            header.compression() == Imf::DWAB_COMPRESSION;
        const std::uint64_t largest_ratio = is_dwa ? 50000 : 4000;
        constexpr std::uint64_t AlwaysAllowed = std::uint64_t{64} << 20;
        if (num_pixels * 12 > std::max(AlwaysAllowed, source_.num_bytes * largest_ratio))
            fail(fmt::format("data for {} pixels", size),
                 fmt::format("{} bytes", source_.num_bytes));
        if (header.hasTileDescription()) {
            const Imf::TileDescription& tiles = header.tileDescription();
            if (std::uint64_t{tiles.xSize} * tiles.ySize >
                std::max(num_pixels * 4, AlwaysAllowed / 12))
                fail(fmt::format("tiles for {} pixels", size),
                     fmt::format("{}x{}", tiles.xSize, tiles.ySize));
        }
    }

    /// A multiple of the rows per block of every compression (1, 16, 32 or 256).
    static constexpr std::uint32_t BandHeight = 256;

    /// Reads bands of rows in parallel, each through its own reader of the same bytes. OpenEXR's
    /// own threads would have to be switched on for the whole program.
    void read_bands(const Imf::Header& header, ImageFile& image) const {
        const std::uint32_t band_height = header.hasTileDescription()
                                              ? std::max(BandHeight, header.tileDescription().ySize)
                                              : BandHeight;
        const std::uint32_t num_bands = (window_.height + band_height - 1) / band_height;
        std::atomic<std::size_t> num_transparent = 0;
        files::parallel_for(0U, num_bands, [&](std::uint32_t band) {
            const std::uint32_t first = band * band_height;
            const std::uint32_t last = std::min(first + band_height, window_.height);
            num_transparent +=
                read_rows(first, std::span(image.pixels)
                                     .subspan(std::size_t{first} * window_.width,
                                              std::size_t{last - first} * window_.width));
        });
        image.num_transparent = num_transparent;
    }

    void read_luminance_chroma(ImageFile& image) const {
        if (part_ != 0)
            fail("luminance and chroma in the first part", fmt::format("part {}", part_));
        const auto stream = source_.open();
        Imf::RgbaInputFile file(*stream, 0);
        std::vector<Imf::Rgba> row(image.width);
        for (std::uint32_t y = 0; y < image.height; ++y) {
            const int line = window_.y + static_cast<int>(y);
            file.setFrameBuffer(row.data() - window_.x, 1, 0);
            file.readPixels(line);
            for (std::uint32_t x = 0; x < image.width; ++x)
                image.pixels[static_cast<std::size_t>(y) * image.width + x] = {row[x].r, row[x].g,
                                                                               row[x].b};
        }
    }

    void describe(const Imf::Header& header, int num_parts, ImageFile& image) const {
        const Imf::Channel* first = header.channels().findChannel(channels_.names[0]);
        image.is_half = first != nullptr && first->type == Imf::HALF;
        if (Imf::hasEnvmap(header)) {
            if (Imf::envmap(header) == Imf::ENVMAP_LATLONG)
                image.envmap = Layout::LatLong;
            else if (Imf::envmap(header) == Imf::ENVMAP_CUBE)
                image.envmap = Layout::Cube;
        }
        if (num_parts > 1)
            image.remarks.push_back(fmt::format("part {} of {}", part_ + 1, num_parts));
        if (!channels_.layer.empty())
            image.remarks.push_back(
                fmt::format("layer {}", channels_.layer.substr(0, channels_.layer.size() - 1)));
        if (channels_.kind == Channels::Kind::Luminance)
            image.remarks.emplace_back("luminance only");
        if (channels_.kind == Channels::Kind::LuminanceChroma)
            image.remarks.emplace_back("luminance and chroma");
    }

    /// What the header says of colours holds: its chromaticities, and the `colorInteropID` that
    /// Blender writes since version 5.
    [[nodiscard]] std::optional<ColorConversion> colors_of(const Imf::Header& header) const {
        if (channels_.kind == Channels::Kind::Xyz)
            return ColorConversion();
        if (channels_.kind == Channels::Kind::Luminance)
            return std::nullopt;
        const auto* id = header.findTypedAttribute<Imf::StringAttribute>("colorInteropID");
        std::optional<ColorSpace> space = id != nullptr ? space_of_id(id->value()) : std::nullopt;
        if (Imf::hasChromaticities(header)) {
            const Imf::Chromaticities& c = Imf::chromaticities(header);
            const auto xy = [](const Imath::V2f& v) {
                return glm::dvec2(v.x, v.y);
            };
            const std::optional<ColorSpace> stated =
                space_of({xy(c.red), xy(c.green), xy(c.blue), xy(c.white)});
            if (stated && space)
                space->primaries = stated->primaries;
            else if (stated)
                space = stated;
        }
        return space ? std::optional<ColorConversion>(*space) : std::nullopt;
    }

    /// Whether the picture is the display window, an environment's, and not the data window: what
    /// lies beyond it is overscan, and what it lacks is black.
    [[nodiscard]] static bool shows_display_window(const Imf::Header& header) {
        if (Imf::hasEnvmap(header) &&
            (Imf::envmap(header) == Imf::ENVMAP_LATLONG || Imf::envmap(header) == Imf::ENVMAP_CUBE))
            return false;
        const auto is_environment = [](const Window& of) {
            return of.width == 2 * std::uint64_t{of.height} ||
                   std::any_of(AllLayouts.begin(), AllLayouts.end(), [&](Layout layout) {
                       return layout != Layout::LatLong && fits(layout, of.width, of.height);
                   });
        };
        const Window display = window(header.displayWindow());
        const Imath::Box2i& inner = header.dataWindow();
        const Imath::Box2i& outer = header.displayWindow();
        const std::uint64_t num_pixels = std::uint64_t{display.width} * display.height;
        if (!is_environment(display) || num_pixels == 0 || num_pixels > MaxPixels || inner == outer)
            return false;
        const bool is_inside = outer.intersects(inner.min) && outer.intersects(inner.max);
        // A data window that is an environment itself has no overscan: parts share a display
        // window.
        return is_inside || (outer.intersects(inner) && !is_environment(window(inner)));
    }

    void show_display_window(const Imf::Header& header, ImageFile& image) const {
        if (!shows_display_window(header))
            return;
        const Window display = window(header.displayWindow());
        const std::uint64_t num_pixels = std::uint64_t{display.width} * display.height;
        // A tiny picture in a huge frame is believed only as long as memory is cheap.
        if (num_pixels > std::max<std::uint64_t>(image.pixels.size() * 64, std::uint64_t{1} << 22))
            fail(fmt::format("data for {}x{} pixels", display.width, display.height),
                 fmt::format("{}x{}", image.width, image.height));
        const Imath::Box2i& inner = header.dataWindow();
        const Imath::Box2i& outer = header.displayWindow();
        const Imath::V2i first(std::max(inner.min.x, outer.min.x),
                               std::max(inner.min.y, outer.min.y));
        const Imath::V2i last(std::min(inner.max.x, outer.max.x),
                              std::min(inner.max.y, outer.max.y));
        std::vector<glm::vec3> pixels(num_pixels, glm::vec3(0.0f));
        const auto index = [](const Window& in, int x, int y) {
            return static_cast<std::ptrdiff_t>((std::int64_t{y} - in.y) * std::int64_t{in.width} +
                                               (std::int64_t{x} - in.x));
        };
        for (int y = first.y; y <= last.y; ++y)
            std::copy_n(image.pixels.begin() + index(window_, first.x, y), last.x - first.x + 1,
                        pixels.begin() + index(display, first.x, y));
        image.pixels = std::move(pixels);
        image.width = display.width;
        image.height = display.height;
        if (Imath::Box2i(first, last) != inner)
            image.remarks.emplace_back("cut to the display window");
        if (Imath::Box2i(first, last) != outer)
            image.remarks.emplace_back("black outside the data window");
    }

    Source source_;
    std::string name_;
    int part_ = 0;
    Channels channels_;
    Window window_;
};

} // namespace

bool is_exr(std::span<const std::byte> bytes) {
    constexpr std::array<std::byte, 4> Magic = {std::byte{0x76}, std::byte{0x2f}, std::byte{0x31},
                                                std::byte{0x01}};
    return bytes.size() >= Magic.size() && std::equal(Magic.begin(), Magic.end(), bytes.begin());
}

namespace {

/// Runs `read` and gives OpenEXR's errors the form of our messages.
template<typename Read>
auto with_own_messages(const std::string& name, const Read& read) {
    try {
        return read();
    } catch (const std::exception& error) {
        std::string message = error.what();
        if (message.starts_with(name + ": ")) // our own message, which may quote the file
            throw std::runtime_error(name + files::printable(message.substr(name.size())));
        // OpenEXR quotes the name of the stream, which is always "file" here.
        for (std::size_t at = 0; (at = message.find("\"file\"")) != std::string::npos;)
            message.replace(at, 6, "it");
        throw std::runtime_error(fmt::format("{}: expected an intact OpenEXR image, got: {}", name,
                                             files::printable(message, ' ')));
    }
}

} // namespace

ImageFile decode_exr(std::span<const std::byte> bytes, const std::string& name) {
    return with_own_messages(name, [&] { return ExrDecoder(source_of(bytes), name).decode(); });
}

ImageSize exr_size(const std::filesystem::path& path) {
    const std::string name = path.string();
    return with_own_messages(name, [&] { return ExrDecoder(source_of(path), name).size(); });
}

namespace {

class ExrRows : public ImageRows {
public:
    explicit ExrRows(const std::filesystem::path& path)
        : name_(path.string()), decoder_(source_of(path), name_) {}

    bool begin() {
        return with_own_messages(name_, [&] {
            std::optional<ImageFile> head = decoder_.begin_rows(colors_);
            if (head)
                head_ = std::move(*head);
            return head.has_value();
        });
    }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        return with_own_messages(name_, [&] {
            Counts counts{.num_transparent = decoder_.read_rows(first, pixels)};
            if (colors_)
                counts.num_outside = colors_->convert(pixels);
            return counts;
        });
    }

private:
    std::string name_;
    ExrDecoder decoder_;
};

} // namespace

std::unique_ptr<ImageRows> exr_rows(const std::filesystem::path& path) {
    auto rows = std::make_unique<ExrRows>(path);
    return rows->begin() ? std::move(rows) : nullptr;
}

} // namespace relumine::cubemap
