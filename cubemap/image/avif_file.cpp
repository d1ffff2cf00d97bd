// AVIF whose numbers are light above white: PQ or HLG, as Lightroom, Photoshop and cameras write
// it. Based on: Alliance for Open Media, "AV1 Image File Format" 1.1; code points of ITU-T H.273.
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <string_view>

#include <fmt/format.h>

#include "cubemap/image/image_file.h"

#ifdef RELUMINE_HDR_PHOTOS
#include <avif/avif.h>

#include "files/parallel.h"
#endif

namespace relumine::cubemap {

bool is_avif(std::span<const std::byte> bytes) {
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()),
                                std::min<std::size_t>(bytes.size(), 64));
    return head.size() >= 16 && head.substr(4, 4) == "ftyp" &&
           head.find("avi", 8) != std::string_view::npos;
}

#ifdef RELUMINE_HDR_PHOTOS

namespace {

class AvifRows : public ImageRows {
public:
    explicit AvifRows(FileBytes file)
        : file_(std::move(file)), bytes_(file_.read(0, file_.size())) {
        constexpr std::uint32_t MostEdge = 65536;
        decoder_->maxThreads = static_cast<int>(files::num_threads());
        decoder_->imageSizeLimit = 1U << 28; // the library's own
        decoder_->strictFlags = AVIF_STRICT_DISABLED;
        require(avifDecoderSetIOMemory(
            decoder_.get(), reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size()));
        require(avifDecoderParse(decoder_.get()));
        const avifImage& image = *decoder_->image;
        if (image.width > MostEdge || image.height > MostEdge)
            file_.refuse(fmt::format("edges of up to {} pixels", MostEdge),
                         fmt::format("{}x{}", image.width, image.height));
        constexpr std::uint64_t MostPixelsPerByte = 20'000; // one colour takes hardly any
        file_.check_size(image.width, image.height, MostPixelsPerByte);
        const bool is_pq = image.transferCharacteristics == AVIF_TRANSFER_CHARACTERISTICS_SMPTE2084;
        if (!is_pq && image.transferCharacteristics != AVIF_TRANSFER_CHARACTERISTICS_HLG)
            file_.refuse("an AVIF by PQ or HLG",
                         fmt::format("the transfer {} of H.273, which holds no light above white",
                                     image.transferCharacteristics));
        std::array<float, 8> xy{};
        avifColorPrimariesGetValues(image.colorPrimaries, xy.data());
        colors_.emplace(*space_of({{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}},
                                  is_pq ? Transfer::Pq : Transfer::Hlg));
        has_alpha_ = decoder_->alphaPresent != AVIF_FALSE;
        head_.width = image.width;
        head_.height = image.height;
        head_.remarks.push_back(
            fmt::format("{} bits; a display's white of 203 cd/m2 is 1", image.depth));
        if ((image.transformFlags & (AVIF_TRANSFORM_IROT | AVIF_TRANSFORM_IMIR)) != 0)
            head_.remarks.emplace_back("its turn or mirror is not done");
    }

    [[nodiscard]] std::uint32_t rows_together() const override { return head_.height; }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        std::call_once(is_decoded_, [&] { decode(); });
        const std::size_t num_channels = has_alpha_ ? 4 : 3;
        const std::uint16_t* value = &numbers_[std::size_t{first} * head_.width * num_channels];
        constexpr float Most = std::numeric_limits<std::uint16_t>::max();
        for (glm::vec3& pixel : pixels) {
            pixel = glm::vec3(value[0], value[1], value[2]) / Most;
            value += num_channels;
        }
        Counts counts{.num_outside = colors_->convert(pixels)};
        if (has_alpha_) {
            const std::uint16_t* alpha = &numbers_[std::size_t{first} * head_.width * 4 + 3];
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                pixels[i] *= alpha[4 * i] / Most;
                counts.num_transparent += alpha[4 * i] == 0 ? 1 : 0;
            }
        }
        return counts;
    }

private:
    void require(avifResult result) const {
        if (result != AVIF_RESULT_OK)
            file_.refuse("a whole AVIF picture", avifResultToString(result));
    }

    /// 16 bits for each channel; colours are not multiplied by alpha.
    void decode() const {
        require(avifDecoderNextImage(decoder_.get()));
        avifRGBImage rgb;
        avifRGBImageSetDefaults(&rgb, decoder_->image);
        rgb.depth = 16;
        rgb.format = has_alpha_ ? AVIF_RGB_FORMAT_RGBA : AVIF_RGB_FORMAT_RGB;
        const std::size_t num_channels = has_alpha_ ? 4 : 3;
        numbers_.resize(std::size_t{rgb.width} * rgb.height * num_channels);
        rgb.pixels = reinterpret_cast<std::uint8_t*>(numbers_.data());
        rgb.rowBytes = static_cast<std::uint32_t>(rgb.width * num_channels * sizeof numbers_[0]);
        require(avifImageYUVToRGB(decoder_->image, &rgb));
    }

    FileBytes file_;
    std::vector<std::byte> bytes_;
    std::unique_ptr<avifDecoder, void (*)(avifDecoder*)> decoder_{avifDecoderCreate(),
                                                                  avifDecoderDestroy};
    bool has_alpha_ = false;
    mutable std::once_flag is_decoded_;
    mutable std::vector<std::uint16_t> numbers_;
};

} // namespace

std::unique_ptr<ImageRows> open_avif(FileBytes file) {
    return std::make_unique<AvifRows>(std::move(file));
}

#endif

} // namespace relumine::cubemap
