// JPEG XL whose numbers are light above white: floats, PQ or HLG.
// Based on: ISO/IEC 18181-1 and -2; the documentation of libjxl's decoder.
#include <array>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>

#include <fmt/format.h>

#include "cubemap/image/image_file.h"

#ifdef RELUMINE_HDR_PHOTOS
#include <jxl/decode.h>
#include <jxl/thread_parallel_runner.h>
#include <jxl/version.h>

#include "cubemap/image/icc_profile.h"
#include "files/parallel.h"
#endif

namespace relumine::cubemap {

bool is_jxl(std::span<const std::byte> bytes) {
    constexpr std::array<unsigned char, 12> Container = {0,   0,   0,    0x0c, 'J',  'X',
                                                         'L', ' ', '\r', '\n', 0x87, '\n'};
    constexpr std::array<unsigned char, 2> Bare = {0xff, 0x0a};
    const auto begins_with = [&](const auto& mark) {
        return bytes.size() >= mark.size() &&
               std::memcmp(bytes.data(), mark.data(), mark.size()) == 0;
    };
    return begins_with(Container) || begins_with(Bare);
}

#ifdef RELUMINE_HDR_PHOTOS

namespace {

/// Numbers are decoded in the file's own colours, and become light here.
class JxlRows : public ImageRows {
public:
    explicit JxlRows(FileBytes file)
        : file_(std::move(file)), bytes_(file_.read(0, file_.size())), decoder_(made()) {
        constexpr std::uint64_t MostPixelsPerByte = 20'000; // one colour takes hardly any
        expect(JXL_DEC_BASIC_INFO);
        if (JxlDecoderGetBasicInfo(decoder_.get(), &info_) != JXL_DEC_SUCCESS)
            broken();
        file_.check_size(info_.xsize, info_.ysize, MostPixelsPerByte);
        head_.width = info_.xsize;
        head_.height = info_.ysize;
        num_channels_ = info_.alpha_bits > 0 ? 4 : 3;
        expect(JXL_DEC_COLOR_ENCODING);
        find_colors();
    }

    [[nodiscard]] std::uint32_t rows_together() const override { return head_.height; }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        std::call_once(is_decoded_, [&] { decode(); });
        const float* value = &numbers_[std::size_t{first} * head_.width * num_channels_];
        for (std::size_t i = 0; i < pixels.size(); ++i)
            std::memcpy(&pixels[i], value + i * num_channels_, sizeof pixels[i]);
        Counts counts;
        if (colors_)
            counts.num_outside = colors_->convert(pixels);
        for (std::size_t i = 0; num_channels_ == 4 && i < pixels.size(); ++i) {
            const float alpha = value[4 * i + 3];
            pixels[i] *= info_.alpha_premultiplied != JXL_FALSE ? 1.0f : alpha;
            counts.num_transparent += alpha == 0.0f ? 1 : 0;
        }
        return counts;
    }

private:
    using Decoder = std::unique_ptr<JxlDecoder, void (*)(JxlDecoder*)>;

    [[nodiscard]] Decoder made() const {
        Decoder decoder(JxlDecoderCreate(nullptr), JxlDecoderDestroy);
        if (!decoder)
            throw std::bad_alloc();
        JxlDecoderSubscribeEvents(decoder.get(),
                                  JXL_DEC_BASIC_INFO | JXL_DEC_COLOR_ENCODING | JXL_DEC_FULL_IMAGE);
        JxlDecoderSetParallelRunner(decoder.get(), JxlThreadParallelRunner, runner_.get());
        JxlDecoderSetInput(decoder.get(), reinterpret_cast<const std::uint8_t*>(bytes_.data()),
                           bytes_.size());
        return decoder;
    }

    [[noreturn]] void broken() const { file_.refuse("a whole JPEG XL picture", "broken data"); }

    void expect(JxlDecoderStatus event) const {
        if (JxlDecoderProcessInput(decoder_.get()) != event)
            broken();
    }

    /// Asks the decoder about the colours that numbers are decoded in.
    template<typename... Arguments>
    [[nodiscard]] bool ask(auto function, Arguments... arguments) const {
#if JPEGXL_NUMERIC_VERSION >= JPEGXL_COMPUTE_NUMERIC_VERSION(0, 9, 0)
        return function(decoder_.get(), JXL_COLOR_PROFILE_TARGET_DATA, arguments...) ==
               JXL_DEC_SUCCESS;
#else
        const JxlPixelFormat unused = {3, JXL_TYPE_FLOAT, JXL_NATIVE_ENDIAN, 0};
        return function(decoder_.get(), &unused, JXL_COLOR_PROFILE_TARGET_DATA, arguments...) ==
               JXL_DEC_SUCCESS;
#endif
    }

    /// Returns the colours; empty where only a profile tells them.
    [[nodiscard]] std::optional<JxlColorEncoding> plain_colors() const {
        JxlColorEncoding colors;
        return ask(JxlDecoderGetColorAsEncodedProfile, &colors) ? std::optional(colors)
                                                                : std::nullopt;
    }

    [[nodiscard]] std::vector<std::byte> profile() const {
        std::size_t size = 0;
        if (!ask(JxlDecoderGetICCProfileSize, &size))
            return {};
        std::vector<std::byte> result(size);
        if (!ask(JxlDecoderGetColorAsICCProfile, reinterpret_cast<std::uint8_t*>(result.data()),
                 size))
            broken();
        return result;
    }

    void find_colors() {
        const std::optional<JxlColorEncoding> colors = plain_colors();
        const auto curve = colors ? colors->transfer_function : JXL_TRANSFER_FUNCTION_UNKNOWN;
        const bool is_display =
            curve == JXL_TRANSFER_FUNCTION_PQ || curve == JXL_TRANSFER_FUNCTION_HLG;
        if (info_.exponent_bits_per_sample == 0 && !is_display)
            file_.refuse("a JPEG XL of floats, by PQ or by HLG",
                         fmt::format("whole numbers of {} bits, which hold no light above white",
                                     info_.bits_per_sample));
        std::optional<ColorSpace> space;
        if (curve == JXL_TRANSFER_FUNCTION_LINEAR || curve == JXL_TRANSFER_FUNCTION_SRGB ||
            is_display) {
            const auto xy = [](const double* at) {
                return glm::dvec2(at[0], at[1]);
            };
            constexpr Primaries Rec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.329}};
            const bool is_grey = colors->color_space == JXL_COLOR_SPACE_GRAY;
            space = space_of(
                is_grey ? Rec709
                        : Primaries{xy(colors->primaries_red_xy), xy(colors->primaries_green_xy),
                                    xy(colors->primaries_blue_xy), xy(colors->white_point_xy)},
                curve == JXL_TRANSFER_FUNCTION_PQ     ? Transfer::Pq
                : curve == JXL_TRANSFER_FUNCTION_HLG  ? Transfer::Hlg
                : curve == JXL_TRANSFER_FUNCTION_SRGB ? Transfer::Srgb
                                                      : Transfer::Linear);
        } else {
            space = space_of_icc(profile(), head_.remarks);
        }
        if (space)
            colors_.emplace(*space);
        if (is_display)
            head_.remarks.emplace_back("a display's white of 203 cd/m2 is 1");
    }

    void decode() const {
        const JxlPixelFormat format = {num_channels_, JXL_TYPE_FLOAT, JXL_NATIVE_ENDIAN, 0};
        numbers_.resize(std::size_t{head_.width} * head_.height * num_channels_);
        expect(JXL_DEC_NEED_IMAGE_OUT_BUFFER);
        if (JxlDecoderSetImageOutBuffer(decoder_.get(), &format, numbers_.data(),
                                        numbers_.size() * sizeof(float)) != JXL_DEC_SUCCESS)
            broken();
        expect(JXL_DEC_FULL_IMAGE);
    }

    FileBytes file_;
    std::vector<std::byte> bytes_;
    std::unique_ptr<void, void (*)(void*)> runner_{
        JxlThreadParallelRunnerCreate(nullptr, files::num_threads()),
        JxlThreadParallelRunnerDestroy};
    Decoder decoder_;
    JxlBasicInfo info_{};
    std::uint32_t num_channels_ = 3;
    mutable std::once_flag is_decoded_;
    /// [height * width * num_channels_]
    mutable std::vector<float> numbers_;
};

} // namespace

std::unique_ptr<ImageRows> open_jxl(FileBytes file) {
    return std::make_unique<JxlRows>(std::move(file));
}

#endif

} // namespace relumine::cubemap
